#pragma once
#include <strainwave/friction/contact.hpp>

namespace strainwave::friction {

/// Sliding torque that falls from `breakaway` to `coulomb` as the speed passes `stribeck_speed`.
template <class S>
constexpr S stribeck_curve(const S& coulomb, const S& breakaway, const S& stribeck_speed, const S& speed) {
    const S u = speed / stribeck_speed;
    return coulomb + (breakaway - coulomb) * exp(-min(u * u, S(beyond_digits)));
}

template <class S>
struct Stribeck {
    S coulomb{0.03};
    S breakaway{0.045};
    S stribeck_speed{2.0};
    S viscous{0.0};

    static constexpr auto name = "stribeck";
    static constexpr auto source = "Stribeck1902; ArmstrongHelouvry1994, eq. (3) with exponent 2";
    static constexpr auto doc = R"(
        Stribeck friction: the level falls from static to kinetic with speed; viscous, and set-valued at rest.

        .. math:: F = \left[F_c + (F_s - F_c) e^{-(v/v_s)^2}\right] \operatorname{sgn} v + b v \quad (v \ne 0), \qquad
                  |F| \le F_s \quad (v = 0)

        with v the speed of the side it acts on, F_c = coulomb, F_s = breakaway, v_s = stribeck_speed, b = viscous. Leaves out
        presliding: the contact is rigid before breakaway (see LuGre).

        >>> from strainwave.friction import Stribeck
        >>> Stribeck(coulomb=0.05, breakaway=0.07, stribeck_speed=0.1, viscous=4e-4).steady(1.0)
        0.0504)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, coulomb, "N.m", "Kinetic friction torque F_c", 0));
        visit(SW_REQUIRED(m, breakaway, "N.m", "Static friction torque F_s", 0));
        visit(SW_REQUIRED(m, stribeck_speed, "rad/s", "Speed at which the excess F_s - F_c has fallen to 1/e", smallest));
        visit(SW_FIELD(m, viscous, "N.m.s/rad", "Torque per speed", 0));
    }

    using State = Stateless<S>;

    /// Torque that opposes sliding, in N.m.
    constexpr S torque(const State&, const Contact<S>& contact) const {
        return contact.sliding * contact.dry * stribeck_curve(coulomb, breakaway, stribeck_speed, contact.speed) +
               contact.viscous * viscous * contact.speed;
    }

    /// The largest torque it balances at rest, in N.m.
    constexpr S hold(const Contact<S>& contact) const { return contact.dry * max(breakaway, coulomb); }
};

}  // namespace strainwave::friction
