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
    S bristle_damping{5e-5};
    S viscous{0.0};
    S damping_fading{0.0};

    static constexpr auto name = "lugre";
    static constexpr auto source = "CanudasDeWit1995, eqs. (1)-(4); passivity: BarabanovOrtega2000; fading damping: " SW_REVIEW;
    static constexpr bool odd = true;
    static constexpr auto doc = R"(
        LuGre friction of an elastic bristle: presliding, breakaway, Stribeck fall and viscous rise.

        .. math:: \dot z = v - \sigma_0 |v| z / G(v), \quad G(v) = F_c + (F_s - F_c) e^{-(v/v_s)^2}, \quad
                  F = \sigma_0 z + \sigma_1(v) \dot z + \sigma_2 v, \quad \sigma_1(v) = \sigma_1 e^{-(\varphi v)^2}

        with v the speed of the place it acts on, F_c = coulomb, F_s = breakaway, v_s = stribeck_speed,
        sigma_0 = bristle_stiffness, sigma_1 = bristle_damping, sigma_2 = viscous, phi = damping_fading: the reciprocal of the
        speed v_d at which the bristle's damping has fallen to 1/e, 0 for a constant one.

        Valid for one contact under constant load. Leaves out load, position and temperature. At rest it is elastic and drifts:
        each wave of a load that varies below breakaway moves the shaft a little further. Use Coulomb or Stribeck if the shaft
        must not drift. G must be positive: without reach at rest a bristle would lose all its torque at every reversal at
        once. Dissipates for every motion if sigma_2 >= max_v sigma_1(v) (F_s/G(v) - 1), which for a constant damping is
        sigma_2 >= sigma_1 (F_s - F_c)/F_c and then also necessary. A set that violates this is accepted, and ``check()`` warns
        with both sides.

        >>> from strainwave.friction import LuGre
        >>> law = LuGre(coulomb=0.05, breakaway=0.07, stribeck_speed=0.1, bristle_stiffness=50.0, bristle_damping=5e-5,
        ...             viscous=4e-4)
        >>> law.steady(1.0)
        0.0504)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, coulomb, "N.m", "Kinetic friction torque F_c", 0));
        visit(SW_REQUIRED(m, breakaway, "N.m", "Static friction torque F_s", 0));
        visit(SW_REQUIRED(m, stribeck_speed, "rad/s", "Speed at which the excess F_s - F_c has fallen to 1/e", smallest));
        visit(SW_REQUIRED(m, bristle_stiffness, "N.m/rad", "Torque per bristle deflection", smallest));
        visit(SW_REQUIRED(m, bristle_damping, "N.m.s/rad", "Torque per bristle rate, at rest", 0));
        visit(SW_FIELD(m, viscous, "N.m.s/rad", "Torque per speed", 0));
        visit(SW_FIELD(m, damping_fading, "s/rad", "Reciprocal of the speed at which bristle_damping has fallen to 1/e", 0));
    }

    constexpr const char* problem() const {
        return all((breakaway > S(0.0)) | !(coulomb > S(0.0))) ? nullptr : "breakaway must be positive if coulomb is positive";
    }

    struct State {
        S deflection{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, deflection, "rad", "Mean bristle deflection z"));
        }
    };

    /// The bristle of a contact that has long been sliding.
    constexpr State steady_state(const Contact<S>& contact) const { return {sign(contact.speed) * reach(contact)}; }

    /// Torque that opposes the motion, in N.m, for the present bristle.
    constexpr S torque(const State& x, const Contact<S>& contact) const { return torque(x, contact, rate(x, contact)); }
    /// Torque at a known rate of the bristle.
    constexpr S torque(const State& x, const Contact<S>& contact, const State& rate) const {
        return bristle_stiffness * x.deflection + damping(contact.speed) * rate.deflection +
               contact.viscous * viscous * contact.speed;
    }

    /// Rate of the bristle [rad/s].
    constexpr State rate(const State& x, const Contact<S>& contact) const {
        return {contact.speed - abs(contact.speed) * (x.deflection / reach(contact))};
    }

    /// Forgetting rate of the bristle [1/s].
    constexpr State relaxation_rate(const State&, const Contact<S>& contact) const { return {abs(contact.speed) / reach(contact)}; }

    /// No motion bends the bristle beyond max(F_s, F_c) / sigma_0, whatever the history: an exact invariant.
    constexpr State clamped(const State& x, const Contact<S>& contact) const {
        const S limit = max(contact.dry_most * max(breakaway, coulomb) / bristle_stiffness, least_reach(contact.speed));
        return {clip(x.deflection, -limit, limit)};
    }

    /// The bristle after `dt` [s] under one contact: the exact solution, so any step is stable.
    constexpr State advance(const State& x, const Contact<S>& contact, const S& dt) const {
        const S slipping = steady_state(contact).deflection;
        return {slipping + (x.deflection - slipping) * exp(-relaxation_rate(x, contact).deflection * dt)};
    }

    /// Elastic energy [J] held by the bristle.
    constexpr S stored(const State& x) const { return S(0.5) * bristle_stiffness * x.deflection * x.deflection; }

    /// Dissipates for every motion if this holds; a bristle of constant damping that starts to slip hardest, only if.
    constexpr Condition<S> passivity() const {
        return {"viscous", viscous, "the largest over v of bristle_damping(v) (breakaway / G(v) - 1)",
                bristle_damping * largest_surplus(), "N.m.s/rad"};
    }

private:
    constexpr S damping(const S& speed) const {
        if (!any(damping_fading > S(0.0))) return bristle_damping;
        const S faded = damping_fading * speed;
        return bristle_damping * exp(-min(faded * faded, S(beyond_digits)));
    }

    /// Deflection of the bristle in steady sliding [rad]. Without any dry friction it still bends a little, so that it forgets
    /// within 2^-100 s: slower than never, and finite in every scalar; as is its bend over that of any other speed.
    constexpr S reach(const Contact<S>& contact) const {
        const S torque = contact.dry * stribeck_curve(coulomb, breakaway, stribeck_speed, contact.speed);
        return max(torque / bristle_stiffness, least_reach(contact.speed));
    }
    static constexpr S least_reach(const S& speed) {
        constexpr double max_rate = 1267650600228229401496703205376.0;  // 1/s; a power of two, for exact division
        return clip(abs(speed) / S(max_rate), S(smallest), S(1.0));
    }

    /// The largest y^r (F_s / (F_c + D y) - 1) over y = exp(-(v/v_s)^2) in [0, 1], with D = F_s - F_c, r = (v_s/v_d)^2. It lies at
    /// the root of r D y^2 + (F_s - r (D - F_c)) y - r F_c, here divided by 1 + r. Where D < 0, at rest.
    constexpr S largest_surplus() const {
        const S excess = breakaway - coulomb, ratio = stribeck_speed * damping_fading;
        const S r = min(ratio * ratio, S(1e12));  // further out the surplus is nil
        const S share = r / (S(1.0) + r), a = share * excess, c = share * coulomb;
        const S b = breakaway / (S(1.0) + r) - share * (excess - coulomb);
        const S root = sqrt(max(b * b + S(4.0) * a * c, S(smallest)));
        const S inner = select(b > S(0.0), S(2.0) * c / max(b + root, S(smallest)), (root - b) / max(S(2.0) * a, S(smallest)));
        const S y = select(excess < S(0.0), S(1.0), min(inner, S(1.0)));
        const S level = max(coulomb + excess * y, S(smallest));
        return exp(r * log(max(y, S(smallest)))) * (max(breakaway, coulomb) / level - S(1.0));
    }
};

}  // namespace strainwave::friction
