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
        Friction that is larger one way than the other.

        .. math:: F_{dry} \propto 1 + a_d \operatorname{sgn} v, \qquad F_{viscous} \propto 1 + a_v \operatorname{sgn} v

        with v the speed of the place it acts on, a_d = dry_asymmetry, a_v = viscous_asymmetry, law the mean of both directions:
        its dry levels (Coulomb, breakaway) and its viscous torque are multiplied. At rest the torque that drives it says which
        way counts. A viscous_asymmetry that is not given equals dry_asymmetry: the whole curve is then larger one way.

        Each way it is the law itself with other levels, so it takes power from every motion where those would. A bristle keeps
        its stiffness and damping, and must be damped so little that it dissipates with the smaller viscous torque, too. Not for
        ``TorqueEfficiency``, whose torque would jump in a reversal and give energy.

        A constant error of a torque sensor looks much the same: of Coulomb friction without viscous_asymmetry, exactly.

        >>> from strainwave.friction import Asymmetric, Coulomb
        >>> law = Asymmetric(law=Coulomb(coulomb=0.25, viscous=0.01), dry_asymmetry=0.5, viscous_asymmetry=0.0)
        >>> law.steady([10.0, -10.0]), law.hold([1.0, -1.0])
        (array([ 0.475, -0.225]), array([0.375, 0.125])))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, law, "The friction, mean of both directions"));
        visit(SW_FIELD(m, dry_asymmetry, "1", "How much more dry friction a positive speed has, relative to the mean", -1, 1));
        visit(SW_FOLLOWS(m, viscous_asymmetry, dry_asymmetry, "1",
                         "How much more viscous friction a positive speed has, relative to the mean", -1, 1));
    }

    using State = typename Law::State;

    /// What friction is multiplied by in its direction: that of slip where the law can stick, so that a step past the end of the
    /// motion stays smooth; else that of the speed.
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
