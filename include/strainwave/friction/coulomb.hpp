#pragma once
#include <strainwave/friction/contact.hpp>

namespace strainwave::friction {

template <class S>
struct Coulomb {
    S coulomb{0.0};
    S breakaway{0.0};
    S viscous{0.0};

    static constexpr auto name = "coulomb";
    static constexpr auto source = SW_POSITION_ARTICLE ", simplified friction model (static + Coulomb + viscous); Coulomb1785";
    static constexpr auto doc = R"(
        Coulomb and viscous friction with a breakaway torque, set-valued at rest.

        .. math:: F = F_c \operatorname{sgn} v + b v \quad (v \ne 0), \qquad |F| \le F_s \quad (v = 0)

        with v the speed of the side it acts on, F_c = coulomb, F_s = breakaway, b = viscous. At rest F balances the driving
        torque up to F_s, so that the side sticks exactly. The sign is not smoothed and the speed has no dead band: both leave
        an error that no step size removes. breakaway defaults to coulomb; a smaller value counts as coulomb.

        >>> from strainwave.friction import Coulomb
        >>> Coulomb(coulomb=0.07, breakaway=0.075, viscous=5e-4).steady(-20.0)
        -0.08)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, coulomb, "N.m", "Kinetic friction torque F_c", 0));
        visit(SW_FOLLOWS(m, breakaway, coulomb, "N.m", "Static friction torque F_s", 0));
        visit(SW_FIELD(m, viscous, "N.m.s/rad", "Torque per speed", 0));
    }

    using State = Stateless<S>;

    /// Torque that opposes sliding, in N.m.
    constexpr S torque(const State&, const Contact<S>& contact) const {
        return contact.sliding * contact.dry * coulomb + contact.viscous * viscous * contact.speed;
    }

    /// The largest torque it balances at rest, in N.m.
    constexpr S hold(const Contact<S>& contact) const { return contact.dry * max(breakaway, coulomb); }
};

}  // namespace strainwave::friction
