#pragma once
#include <strainwave/friction/stribeck.hpp>

namespace strainwave::friction {

template <class S>
struct CurvedViscous {
    S coulomb{0.03};
    S breakaway{0.03};
    S stribeck_speed{2.0};
    S viscous_torque{0.02};
    S exponent{0.7};
    S reference_speed{100.0};

    static constexpr auto name = "curved_viscous";
    static constexpr auto source = "Olsson1998, section 2: viscous friction with an exponent; the fall as in Stribeck";
    static constexpr auto doc = R"(
        Friction with a viscous part that is a power of the speed, and a Stribeck fall, set-valued at rest.

        .. math:: F = \left[F_c + (F_s - F_c) e^{-(v/v_s)^2} + F_v \left(|v|/v_r\right)^p\right] \operatorname{sgn} v
                  \quad (v \ne 0), \qquad |F| \le F_s \quad (v = 0)

        with v the speed of the side it acts on, F_c = coulomb, F_s = breakaway, v_s = stribeck_speed, F_v = viscous_torque at
        the speed v_r = reference_speed, p = exponent. Grease of a wave generator has p < 1 as a rule: the torque rises fast at
        first, then more slowly (0.5 to 1 is an order of magnitude, assumed). p = 1 is Stribeck's law with viscous = F_v / v_r,
        and p = 2 a drag. breakaway defaults to coulomb, and a smaller value counts as coulomb; stribeck_speed then has no
        effect. Below v_r / 10^6 the viscous part falls linearly, so that it has a slope at rest. Valid within the measured
        range of speeds. Leaves out presliding (see LuGre).

        >>> from strainwave.friction import CurvedViscous
        >>> law = CurvedViscous(coulomb=0.02, viscous_torque=0.03, exponent=0.5, reference_speed=100.0)
        >>> law.steady([25.0, 100.0]).round(12)
        array([0.035, 0.05 ]))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, coulomb, "N.m", "Kinetic friction torque F_c", 0));
        visit(SW_FOLLOWS(m, breakaway, coulomb, "N.m", "Static friction torque F_s", 0));
        visit(SW_FIELD(m, stribeck_speed, "rad/s", "Speed at which the excess F_s - F_c has fallen to 1/e", smallest));
        visit(SW_REQUIRED(m, viscous_torque, "N.m", "Viscous torque F_v at reference_speed", 0));
        visit(SW_REQUIRED(m, exponent, "1", "Exponent p of the speed", 0.1, 4));
        visit(SW_REQUIRED(m, reference_speed, "rad/s", "Speed v_r of viscous_torque", smallest));
    }

    using State = Stateless<S>;

    /// Torque that opposes sliding, in N.m.
    constexpr S torque(const State&, const Contact<S>& contact) const {
        return contact.sliding * contact.dry * stribeck_curve(coulomb, max(breakaway, coulomb), stribeck_speed, contact.speed) +
               along(contact.speed, contact.viscous * viscous(contact.speed));
    }

    /// The largest torque it balances at rest, in N.m.
    constexpr S hold(const Contact<S>& contact) const { return contact.dry * max(breakaway, coulomb); }

private:
    /// Share of reference_speed below which the viscous torque falls linearly, with a slope at rest.
    static constexpr double linear_share = 1e-6;

    /// F_v (|v|/v_r)^p.
    constexpr S viscous(const S& speed) const {
        const S slow = S(linear_share) * reference_speed, fast = max(abs(speed), slow);
        const S depth = exponent * (log(max(fast, S(smallest))) - log(reference_speed));
        return viscous_torque * exp(min(depth, S(beyond_digits))) * min(abs(speed) / max(slow, S(smallest)), S(1.0));
    }
};

}  // namespace strainwave::friction
