#pragma once
#include <strainwave/friction/contact.hpp>

namespace strainwave::friction {

template <class S>
struct Viscous {
    S viscous{0.0};

    static constexpr auto name = "viscous";
    static constexpr auto source = "Newton's law of viscosity; " SW_POSITION_ARTICLE ", b_m and b_l of Table 3";
    static constexpr auto doc = R"(
        Viscous friction, proportional to the speed.

        .. math:: F = b v

        with v the speed of the side it acts on, b = viscous. Leaves out all effects of friction near rest.

        >>> from strainwave.friction import Viscous
        >>> Viscous(viscous=0.5).steady(2.0)
        1.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, viscous, "N.m.s/rad", "Torque per speed", 0));
    }

    using State = Stateless<S>;

    /// Torque that opposes the motion, in N.m.
    constexpr S torque(const State&, const Contact<S>& contact) const { return contact.viscous * viscous * contact.speed; }
};

}  // namespace strainwave::friction
