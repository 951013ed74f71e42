#pragma once
#include <strainwave/fault/fault.hpp>

namespace strainwave::fault {

template <class S>
struct OpenPhase {
    S severity{1.0};
    S resistance{20.0};

    static constexpr auto name = "open_phase";
    static constexpr auto mode = "Open phase of motor or inverter";
    static constexpr auto effect = "two phases carry the current; the torque falls to zero twice per pole pair";
    static constexpr auto signal = "order 2 p of the input in motor current, torque and speed, as large as their mean";
    static constexpr auto source = "Kirchhoff's laws of three phases; the resistance at severity 1 is assumed";
    static constexpr auto doc = R"(
        Open phase of a PMSM: it conducts hardly any current.

        .. math:: \Delta R \leftarrow \Delta R + s\, R_o

        with s = severity, R_o = resistance, Delta R the phase_resistance_excess of the motor, p the number of its pole pairs. A
        resistance far above R and p omega L is an open phase; the current of the phase falls in inverse proportion to it. A
        severity below 1 is a contact that opens. Fixed steps must follow the decay by 2/3 R_o / L: a larger resistance needs
        shorter steps.

        >>> from strainwave.fault import Facts, OpenPhase
        >>> OpenPhase(severity=0.5).changes(Facts())[0][:4]
        ('motor', 'phase_resistance_excess', 'add', 10.0))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, severity, "1", "Share s of the resistance", 0, 1));
        visit(SW_FIELD(m, resistance, "Ohm", "Resistance R_o that the phase gains at severity 1", 0));
    }

    template <class Visit>
    constexpr void changes(const Facts<S>&, Visit&& visit) const {
        visit(add(motor_place, "phase_resistance_excess", severity * resistance, "pmsm"));
    }
};

}  // namespace strainwave::fault
