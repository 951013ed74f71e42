#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/friction/coulomb.hpp>

namespace strainwave::friction {

template <class S, class Law_ = Coulomb<S>>
struct Asymmetric {
    using Law = Law_;

    Law law{};
    S dry_asymmetry{0.0};
    S viscous_asymmetry{0.0};

    static constexpr auto name = "asymmetric";
    static constexpr auto source =
        "CanudasDeWit1995, section II: G(v) need not be symmetrical, so that friction depends on the direction; one factor for "
        "each direction is assumed";
    static constexpr bool odd = false;
    static constexpr auto doc = R"(
        Friction that differs between the two directions of motion.

        .. math:: F_{dry} \propto 1 + a_d \operatorname{sgn} v, \qquad F_{viscous} \propto 1 + a_v \operatorname{sgn} v

        with v the speed of the place it acts on, a_d = dry_asymmetry, a_v = viscous_asymmetry, law the mean of both
        directions. The factors multiply its dry levels (Coulomb, breakaway) and its viscous torque. At rest the direction is
        that of the driving torque. viscous_asymmetry defaults to dry_asymmetry: the whole curve then has one factor for each
        direction.

        In each direction it is the law with other levels, so it dissipates if the law dissipates with these levels. A bristle
        keeps its stiffness and damping; it must also dissipate with the smaller viscous torque. ``TorqueEfficiency`` is not
        allowed: its torque would jump at a reversal and create energy.

        A constant offset of a torque sensor looks similar. For Coulomb friction without viscous_asymmetry the two are the
        same.

        >>> from strainwave.friction import Asymmetric, Coulomb
        >>> law = Asymmetric(law=Coulomb(coulomb=0.25, viscous=0.01), dry_asymmetry=0.5, viscous_asymmetry=0.0)
        >>> law.steady([10.0, -10.0]), law.hold([1.0, -1.0])
        (array([ 0.475, -0.225]), array([0.375, 0.125])))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, law, "Friction law, mean of both directions"));
        visit(SW_FIELD(m, dry_asymmetry, "1", "Excess a_d of dry friction at positive speed, relative to the mean", -1, 1));
        visit(SW_FOLLOWS(m, viscous_asymmetry, dry_asymmetry, "1",
                         "Excess a_v of viscous friction at positive speed, relative to the mean", -1, 1));
    }

    using State = typename Law::State;

    /// Factors of friction in its direction: that of slip if the law can stick, so that a step past the end of the motion stays
    /// smooth; else that of the speed.
    struct Modulator {
        S dry_asymmetry, viscous_asymmetry;
        bool sticks;

        constexpr Factors<S> factors(const Contact<S>& contact) const {
            const S sense = sticks ? contact.sliding : sign(contact.speed);
            return {S(1.0) + dry_asymmetry * sense, S(1.0) + abs(dry_asymmetry), S(1.0) + viscous_asymmetry * sense};
        }
    };
    constexpr Modulator modulator() const { return {dry_asymmetry, viscous_asymmetry, set_valued(law)}; }

    constexpr auto compile() const { return Modulated<S, decltype(compiled(law)), Modulator>{modulator(), compiled(law)}; }

    constexpr Contact<S> modulated(const Contact<S>& contact) const { return contact.scaled(modulator().factors(contact)); }
};

}  // namespace strainwave::friction
