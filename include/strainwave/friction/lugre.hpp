#pragma once
#include <strainwave/condition.hpp>
#include <strainwave/friction/stribeck.hpp>

namespace strainwave::friction {

template <class S>
struct LuGre {
    S coulomb{0.03};
    S breakaway{0.045};
    S stribeck_speed{2.0};
    S bristle_stiffness{50.0};
    S bristle_damping{0.02};
    S viscous{5e-5};

    static constexpr auto name = "lugre";
    static constexpr auto source = "CanudasDeWit1995, eqs. (1)-(4); passivity: BarabanovOrtega2000";
    static constexpr auto doc = R"(
        Friction of an elastic bristle that bends before it slips: presliding, breakaway, Stribeck fall, viscous rise.

        .. math:: \dot z = v - \sigma_0 |v| z / G(v), \quad G(v) = F_c + (F_s - F_c) e^{-(v/v_s)^2}, \quad
                  F = \sigma_0 z + \sigma_1 \dot z + \sigma_2 v

        with v the speed of the side it acts on, F_c = coulomb, F_s = breakaway, v_s = stribeck_speed,
        sigma_0 = bristle_stiffness, sigma_1 = bristle_damping, sigma_2 = viscous.

        Valid for one contact under constant load; leaves out load, position and temperature. Dissipates for every motion only
        if viscous >= bristle_damping (breakaway / coulomb - 1); a set that violates this is accepted, and ``check()`` warns
        with both sides.

        >>> from strainwave.friction import LuGre
        >>> LuGre(coulomb=0.05, breakaway=0.07, stribeck_speed=0.1, viscous=4e-4).steady(1.0)
        0.0504)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, coulomb, "N.m", "Kinetic friction torque F_c", 0));
        visit(SW_FIELD(m, breakaway, "N.m", "Static friction torque F_s", 0));
        visit(SW_FIELD(m, stribeck_speed, "rad/s", "Speed at which the excess F_s - F_c has fallen to 1/e", smallest));
        visit(SW_FIELD(m, bristle_stiffness, "N.m/rad", "Torque per bristle deflection", smallest));
        visit(SW_FIELD(m, bristle_damping, "N.m.s/rad", "Torque per bristle rate", 0));
        visit(SW_FIELD(m, viscous, "N.m.s/rad", "Torque per speed", 0));
    }

    struct State {
        S deflection{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, deflection, "rad", "Mean bristle deflection z"));
        }
    };

    /// The bristle of a contact that has long been sliding at `speed` [rad/s].
    constexpr State settled(const S& speed) const { return {sign(speed) * sliding_torque(speed) / bristle_stiffness}; }

    /// Torque that opposes the motion, in N.m, for the bristle as it stands.
    constexpr S torque(const State& x, const Contact<S>& contact) const {
        return bristle_stiffness * x.deflection + bristle_damping * rate(x, contact).deflection + viscous * contact.speed;
    }

    /// Rate of the bristle [rad/s].
    constexpr State rate(const State& x, const Contact<S>& contact) const {
        return {contact.speed - decay(contact).deflection * x.deflection};
    }

    /// How fast the bristle forgets [1/s].
    constexpr State decay(const Contact<S>& contact) const {
        return {min(bristle_stiffness * abs(contact.speed) / max(sliding_torque(contact.speed), S(smallest)), S(fastest))};
    }

    /// No motion bends the bristle beyond max(F_s, F_c) / sigma_0, whatever the history: an exact invariant.
    constexpr State confined(const State& x) const {
        const S limit = max(breakaway, coulomb) / bristle_stiffness;
        return {clip(x.deflection, -limit, limit)};
    }

    /// The bristle after `dt` [s] at constant `speed` [rad/s]: the exact solution, so any step is stable.
    constexpr State advance(const State& x, const S& speed, const S& dt) const {
        const S slipping = settled(speed).deflection;
        return {slipping + (x.deflection - slipping) * exp(-decay({speed}).deflection * dt)};
    }

    /// Dissipates for every motion if and only if this holds.
    constexpr Condition<S> passivity() const {
        return {"viscous", viscous, "bristle_damping (breakaway / coulomb - 1)",
                bristle_damping * (breakaway / max(coulomb, S(smallest)) - S(1.0)), "N.m.s/rad"};
    }

private:
    static constexpr double fastest = 1e30;  // 1/s: keeps the limit of no friction at all finite in every scalar
    constexpr S sliding_torque(const S& speed) const { return stribeck_curve(coulomb, breakaway, stribeck_speed, speed); }
};

}  // namespace strainwave::friction
