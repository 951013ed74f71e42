#pragma once
#include <strainwave/fault/fault.hpp>

namespace strainwave::fault {

template <class S>
struct PhaseResistance {
    S severity{1.0};
    S rise{0.2};
    S excess{0.0};

    static constexpr auto name = "phase_resistance";
    static constexpr auto mode = "Resistance of the winding or of a contact";
    static constexpr auto effect = "more voltage and heat for the same current; one uneven phase makes the torque ripple";
    static constexpr auto signal =
        "ratio of voltage to current at low speed; of an uneven phase, order 2 p of the input in motor current and torque";
    static constexpr auto source = "Kirchhoff's laws of three phases; the numbers at severity 1 are assumed";
    static constexpr auto doc = R"(
        Increased resistance of the winding, in all phases, or in one by a bad contact.

        .. math:: R \leftarrow (1 + s\, r)\, R, \qquad \Delta R \leftarrow \Delta R + s\, \Delta

        with s = severity, R the resistance of the motor, r = rise, Delta = excess, Delta R the phase_resistance_excess of a PMSM.
        An excess needs a PMSM: the other motors have no phases. p is the number of its pole pairs. Leaves out shorted turns.

        >>> from strainwave.fault import Facts, PhaseResistance
        >>> PhaseResistance(severity=0.5).changes(Facts())[0][:4]
        ('motor', 'resistance', 'scale', 1.1))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, severity, "1", "Share s of the changes below", 0, 1));
        visit(SW_FIELD(m, rise, "1", "Rise r of the resistance of all phases at severity 1, relative to the healthy motor", 0));
        visit(SW_FIELD(m, excess, "Ohm", "Resistance Delta that one phase of a PMSM gains at severity 1", 0));
    }

    template <class Visit>
    constexpr void changes(const Facts<S>&, Visit&& visit) const {
        visit(scale(motor_place, "resistance", S(1.0) + severity * rise));
        if (any(excess > S(0.0))) visit(add(motor_place, "phase_resistance_excess", severity * excess, "pmsm"));
    }
};

}  // namespace strainwave::fault
