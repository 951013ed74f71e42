#pragma once
#include <strainwave/integrate/interval.hpp>

namespace strainwave::integrate {

/// Coefficients of Cox and Matthews (2002), eqs. (26)-(29), for one number that decays by e^-x over the step.
template <class S>
struct Exponential {
    S half{1.0}, full{1.0}, stage{0.5}, first{1.0 / 6.0}, middle{1.0 / 3.0}, last{1.0 / 6.0};

    static constexpr Exponential of(const S& x) {
        const S half = exp(S(-0.5) * x), full = half * half;
        const S c = select(x > S(series_below), x, S(1.0));
        // phi_1, phi_2, phi_3 of -x: upwards from phi_1 where x is large, down from the series of phi_3 where it is small; the
        // other way round each would lose its digits.
        const auto large = x > S(series_below);
        const S up1 = (S(1.0) - full) / c, up2 = (S(1.0) - up1) / c, up3 = (S(0.5) - up2) / c;
        const S phi3 = select(large, up3, series(-min(x, S(series_below))));
        const S phi2 = select(large, up2, S(0.5) - x * phi3), phi1 = select(large, up1, S(1.0) - x * phi2);
        const S thrice = S(3.0) * phi3;  // in this order of terms Runge and Kutta's for x = 0, to the last digit
        return {half,
                full,
                phi1 / (half + S(1.0)),
                phi3 + (phi1 - S(3.0) * phi2 + thrice),
                S(2.0) * phi3 + S(2.0) * (phi2 - thrice),
                phi3 + (thrice - phi2)};
    }

private:
    static constexpr double series_below = 0.5;
    /// The sum of z^j / (j + 3)!, nested: 1/6 (1 + z/4 (1 + z/5 (...))). A template, so that 1/k is a constant of the scalar's
    /// kind.
    template <int k = 4>
    static constexpr S series(const S& z) {
        if constexpr (k == 4)
            return S(1.0 / 6.0) * (S(1.0) + z * S(1.0 / k) * series<k + 1>(z));
        else if constexpr (k < 16)
            return S(1.0) + z * S(1.0 / k) * series<k + 1>(z);
        else
            return S(1.0);
    }
};

/// One step of the exponential scheme: every number of X obeys y' = n(y) - rate y with its relaxation rate frozen at the step's
/// start. Where that is zero this is the classical Runge-Kutta scheme.
template <class S, class X>
class Relaxation {
    using Scalars = Flat<S, X>;
    Scalars relaxation, half, full;
    Scalars stage, first, middle, last;  ///< times the step

public:
    constexpr Relaxation(const X& rates, const S& dt) : relaxation(flattened<S>(rates)) {
        size_like(relaxation, half, full, stage, first, middle, last);
        for_each_index(relaxation, [&](int i) {
            set(i, any(relaxation[i] > S(0.0)) ? Exponential<S>::of(relaxation[i] * dt) : Exponential<S>{}, dt);
        });
    }
    constexpr Scalars forcing(const X& rate, const X& at) const {
        Scalars force = flattened<S>(rate);
        const Scalars y = flattened<S>(at);
        for_each_index(force, [&](int i) { force[i] = force[i] + relaxation[i] * y[i]; });
        return force;
    }
    constexpr X halfway(const X& from, const Scalars& force) const {
        Scalars y = flattened<S>(from);
        for_each_index(y, [&](int i) { y[i] = half[i] * y[i] + stage[i] * force[i]; });
        return refilled(from, y);
    }
    constexpr X onward(const X& halfway, const Scalars& force, const Scalars& at_start) const {
        Scalars y = flattened<S>(halfway);
        for_each_index(y, [&](int i) { y[i] = half[i] * y[i] + stage[i] * (S(2.0) * force[i] - at_start[i]); });
        return refilled(halfway, y);
    }
    /// Exponential Euler over the whole step.
    constexpr X across(const X& from, const Scalars& force) const {
        Scalars y = flattened<S>(from);
        for_each_index(y, [&](int i) { y[i] = full[i] * y[i] + stage[i] * (S(1.0) + half[i]) * force[i]; });
        return refilled(from, y);
    }
    constexpr X complete(const X& from, const Scalars& n1, const Scalars& n2, const Scalars& n3, const Scalars& n4) const {
        Scalars y = flattened<S>(from);
        for_each_index(y,
                       [&](int i) { y[i] = full[i] * y[i] + (first[i] * n1[i] + middle[i] * (n2[i] + n3[i]) + last[i] * n4[i]); });
        return refilled(from, y);
    }

private:
    constexpr void set(int i, const Exponential<S>& c, const S& dt) {
        half[i] = c.half;
        full[i] = c.full;
        stage[i] = dt * c.stage;
        first[i] = dt * c.first;
        middle[i] = dt * c.middle;
        last[i] = dt * c.last;
    }
};

/// One step without events, of fourth order: what relaxes does so exactly, memory is a return map, the rest is the classical
/// Runge-Kutta scheme.
template <class S, class System>
constexpr typename System::State exponential_step(const System& system, const typename System::Evaluation& from,
                                                  const Interval<typename System::Input>& u, const S& dt) {
    using Continuous = typename System::Continuous;
    auto x = from.state;
    const Continuous& y1 = from.state.continuous;
    const auto& now = from.derivatives;
    const auto rate = [&](const Continuous& y, const auto& input) { return system.derivatives(x, y, input).rate; };
    const auto clamped = [&](const Continuous& y) { return system::clamped(system, y, now); };
    const Relaxation<S, Continuous> scheme(system::relaxation_rate<S>(system, y1, now), dt);
    const auto n1 = scheme.forcing(now.rate, y1);
    const auto y2 = clamped(scheme.halfway(y1, n1));
    const auto n2 = scheme.forcing(rate(y2, u.middle), y2);
    const auto y3 = clamped(scheme.halfway(y1, n2));
    const auto n3 = scheme.forcing(rate(y3, u.middle), y3);
    const auto y4 = clamped(scheme.onward(y2, n3, n1));
    const auto n4 = scheme.forcing(rate(y4, u.end), y4);
    x.continuous = system::update_mode(system, clamped(scheme.complete(y1, n1, n2, n3, n4)), now);
    system::finish_step(system, x, dt);
    return x;
}

/// The same step, and the evaluation at its end, of a system whose `foreseen` is cheaper for two stages together. Positions follow
/// from speeds: those of two stages are known before the torques are.
template <class S, class System>
constexpr typename System::Evaluation foreseeing_step(const System& system, const typename System::Evaluation& from,
                                                      const Interval<typename System::Input>& u, const S& dt) {
    using Continuous = typename System::Continuous;
    typename System::Evaluation there{from.state, {}};
    auto& x = there.state;
    const Continuous& y1 = from.state.continuous;
    const auto& now = from.derivatives;
    const auto clamped = [&](const Continuous& y) { return system::clamped(system, y, now); };
    const Relaxation<S, Continuous> scheme(system::relaxation_rate<S>(system, y1, now), dt);
    const auto coasting = [&](const Continuous& y) { return scheme.forcing(system.coasting(now.rate, y), y); };
    const auto forcing = [&](const Continuous& y, const auto& input, const auto& foreseen) {
        return scheme.forcing(system.derivatives(x, y, input, foreseen).rate, y);
    };
    const auto at = [&](const Continuous& y) {
        typename System::State ahead = x;
        ahead.continuous = y;
        return ahead;
    };
    const auto n1 = scheme.forcing(now.rate, y1);
    const auto y2 = clamped(scheme.halfway(y1, n1));
    const auto in_middle = system.foreseen(at(y2), at(scheme.halfway(y1, coasting(y2))));
    const auto n2 = forcing(y2, u.middle, in_middle[0]);
    const auto y3 = clamped(scheme.halfway(y1, n2));
    const auto n3 = forcing(y3, u.middle, in_middle[1]);
    const auto y4 = clamped(scheme.onward(y2, n3, n1));
    auto end = at(scheme.complete(y1, n1, n2, n3, coasting(y4)));
    system::finish_step(system, end, dt);
    const auto at_end = system.foreseen(at(y4), end);
    const auto n4 = forcing(y4, u.end, at_end[0]);
    x.continuous = system::update_mode(system, clamped(scheme.complete(y1, n1, n2, n3, n4)), now);
    system::finish_step(system, x, dt);
    system.refresh(there, u.end, at_end[1]);
    return there;
}

}  // namespace strainwave::integrate
