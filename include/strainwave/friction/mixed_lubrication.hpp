#pragma once
#include <strainwave/friction/stribeck.hpp>

namespace strainwave::friction {

template <class S>
struct MixedLubrication {
    S coulomb{0.03};
    S breakaway{0.045};
    S stribeck_speed{2.0};
    S viscous{0.0};
    S viscosity_fall{0.0};
    S load_sensitivity{0.0};
    S reference_temperature{room_temperature};

    static constexpr auto name = "mixed_lubrication";
    static constexpr auto source =
        "Stribeck1902: friction over viscosity times speed per load (Hersey1914); viscosity over temperature: Reynolds1886; "
        "this curve, and how the load enters, are assumed";
    static constexpr auto doc = R"(
        Friction of a lubricated bearing, from boundary to hydrodynamic lubrication, by the Hersey number.

        .. math:: F = p \left[F_c + (F_s - F_c) e^{-h^2}\right] \operatorname{sgn} v + b\, \eta\, v \quad (v \ne 0), \qquad
                  |F| \le p F_s \quad (v = 0), \\
                  h = \frac{\eta |v|}{v_s\, p}, \qquad \eta = e^{-\beta (T - T_0)}, \qquad p = 1 + s\,|T_{load}|

        with v the speed of the side it acts on, F_c = coulomb, F_s = breakaway, v_s = stribeck_speed, b = viscous, beta =
        viscosity_fall, s = load_sensitivity, T_0 = reference_temperature; T the temperature, T_load the torque that its place
        transmits: at the input that of the gear over the ratio. eta is the viscosity, p the load on the bearing, both relative
        to T_0 and no load. h is the Hersey number: the speed at which the lubricant carries rises with the load and with the
        temperature. Warm oil lowers the viscous part and extends dry friction to higher speeds. ``Thermal`` around
        ``Stribeck`` keeps these speeds.

        >>> from strainwave.friction import MixedLubrication
        >>> law = MixedLubrication(coulomb=0.02, breakaway=0.05, stribeck_speed=5.0, viscous=1e-3, viscosity_fall=0.03)
        >>> cold, warm = (float(law.steady(speed, temperature=333.15)) > float(law.steady(speed)) for speed in (5.0, 100.0))
        >>> cold, warm  # warm oil: more friction at 5 rad/s, less at 100
        (True, False))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, coulomb, "N.m", "Friction torque F_c of full lubrication, without the viscous part", 0));
        visit(SW_REQUIRED(m, breakaway, "N.m", "Static friction torque F_s", 0));
        visit(SW_REQUIRED(m, stribeck_speed, "rad/s", "Speed v_s at which the excess has fallen to 1/e, at T_0 without load",
                          smallest));
        visit(SW_FIELD(m, viscous, "N.m.s/rad", "Torque per speed at T_0", 0));
        visit(SW_FIELD(m, viscosity_fall, "1/K", "Relative fall beta of the viscosity per kelvin", 0));
        visit(SW_FIELD(m, load_sensitivity, "1/(N.m)", "Rise s of the load on the bearing with the torque transmitted", 0));
        visit(SW_FIELD(m, reference_temperature, "K", "Temperature T_0 at which the parameters were measured", smallest));
    }

    using State = Stateless<S>;

    /// Torque that opposes sliding, in N.m.
    constexpr S torque(const State&, const Contact<S>& contact) const {
        const S p = pressed(contact), eta = viscosity(contact);
        const S hersey = min(eta * abs(contact.speed) / (stribeck_speed * p), S(1e9));
        return contact.sliding * contact.dry * p * stribeck_curve(coulomb, breakaway, S(1.0), hersey) +
               contact.viscous * viscous * eta * contact.speed;
    }

    /// The largest torque it balances at rest, in N.m.
    constexpr S hold(const Contact<S>& contact) const { return contact.dry * pressed(contact) * max(breakaway, coulomb); }

private:
    constexpr S viscosity(const Contact<S>& contact) const {
        const S warmer = viscosity_fall * (contact.temperature - reference_temperature);
        return exp(clip(-warmer, S(-beyond_digits), S(beyond_digits)));
    }
    constexpr S pressed(const Contact<S>& contact) const { return S(1.0) + min(load_sensitivity * abs(contact.load), S(1e30)); }
};

}  // namespace strainwave::friction
