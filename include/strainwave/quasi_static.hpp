#pragma once
#include <strainwave/field.hpp>

namespace strainwave {

/// Spring and hysteresis of a gear at a temperature [K], whose input is held, twisted slowly from `begin` on, where it has no
/// history.
template <class S, class Gear>
class QuasiStatic {
    const Gear& gear;
    const S temperature;
    decltype(initial_state(gear.hysteresis)) held;
    S at, factor{1.0};

public:
    constexpr QuasiStatic(const Gear& gear_, const S& temperature_, const S& begin = S(0.0))
        : gear(gear_), temperature(temperature_), held(initial_state(gear_.hysteresis)), at(begin) {}

    /// Torque [N.m] at a twist [rad] that is reached without reversal.
    constexpr S torque(const S& twist) const { return gear.held_torque(twist, held, twist - at, temperature, factor); }
    /// The stiffness of the spring, relative to its mean, for all later calls.
    constexpr void vary(const S& stiffness_factor) { factor = stiffness_factor; }
    constexpr void move(const S& twist) {
        if constexpr (requires { gear.hysteresis.move(held, twist - at); })
            gear.hysteresis.move(held, twist - at);
        else
            held = gear.hysteresis.advance(held, twist - at);
        at = twist;
    }

    /// The twist at which `wanted` [N.m] is reached without turning back on the way; not a finite number if there is none.
    constexpr S twist(const S& wanted) const {
        return reached([&](const S& x) { return torque(x); }, wanted);
    }
    /// The twist of the spring in series with a `compliance` [rad/(N.m)], at a `whole` twist [rad].
    constexpr S twist_within(const S& whole, const S& compliance) const {
        return reached([&](const S& x) { return x + compliance * torque(x); }, whole);
    }

private:
    /// Root of a function that rises with the twist, by a bracket.
    template <class F>
    constexpr S reached(const F& f, const S& wanted) const {
        const S away = wanted < f(at) ? S(-1.0) : S(1.0);
        S low = at, high = at, reach = max(abs(at), S(1e-9)) * away;
        while (away * (f(high) - wanted) < S(0.0)) {
            low = high;
            reach = reach * S(2.0);
            high = at + reach;
            if (!(abs(high) < S(unbounded))) return high;
        }
        for (int i = 0; i < 2000; ++i) {
            const S middle = low + S(0.5) * (high - low);
            if (middle == low || middle == high) break;
            (away * (f(middle) - wanted) < S(0.0) ? low : high) = middle;
        }
        const S root = abs(f(low) - wanted) < abs(f(high) - wanted) ? low : high;
        if constexpr (differentiates<S>)
            return moving_root([&](const S& x) { return f(x) - wanted; }, root);
        else
            return root;
    }
};

}  // namespace strainwave
