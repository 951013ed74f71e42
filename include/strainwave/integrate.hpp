#pragma once
#include <strainwave/drive.hpp>

/// Steps in time. A smooth stretch is a fourth-order exponential Runge-Kutta step: the bristles relax exactly, the hysteresis is a
/// return map, the rest is the classical scheme. Set-valued friction adds events, located and stepped to exactly.
namespace strainwave {

/// The inputs over one step: at its start, middle and end.
template <class S>
struct Interval {
    Input<S> start{}, middle{}, end{};

    /// The stretch between two fractions of the step. Between the three instants, the command is Hermite's cubic.
    constexpr Interval part(const S& from, const S& to, const S& dt) const {
        return {at(from, dt), at(S(0.5) * (from + to), dt), at(to, dt)};
    }

private:
    constexpr Input<S> at(const S& fraction, const S& dt) const {
        const auto late = fraction > S(0.5);
        const S x = S(2.0) * fraction - select(late, S(1.0), S(0.0)), half = S(0.5) * dt;
        const S a = select(late, middle.command, start.command), b = select(late, end.command, middle.command);
        const S da = half * select(late, middle.command_rate, start.command_rate);
        const S db = half * select(late, end.command_rate, middle.command_rate);
        const S bend = S(3.0) * (b - a) - S(2.0) * da - db, turn = S(2.0) * (a - b) + da + db;
        const auto straight = [&](S Input<S>::* signal) {
            const S from = select(late, middle.*signal, start.*signal);
            return from + x * (select(late, end.*signal, middle.*signal) - from);
        };
        return {a + x * (da + x * (bend + x * turn)), (da + x * (S(2.0) * bend + S(3.0) * x * turn)) / max(half, S(smallest)),
                straight(&Input<S>::load_torque), straight(&Input<S>::temperature)};
    }
};

namespace detail {

/// Coefficients of Cox and Matthews (2002), eqs. (26)-(29), for one state that decays by e^-x over the step.
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
        return {half,
                full,
                phi1 / (half + S(1.0)),
                phi1 - S(3.0) * phi2 + S(4.0) * phi3,
                S(2.0) * phi2 - S(4.0) * phi3,
                S(4.0) * phi3 - phi2};
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

/// One step of the exponential scheme: every member of X obeys y' = n(y) - decay y with its decay frozen at the step's start.
/// Where the decay is zero this is the classical Runge-Kutta scheme.
template <class S, class X>
class Relaxation {
    static constexpr int n = size_of<S, X>;
    using Scalars = Array<S, n>;
    Scalars decay, half, full, stage, first, middle, last;  // the last four times the step

public:
    constexpr Relaxation(const X& rates_of_decay, const S& dt) : decay(flattened<S>(rates_of_decay)) {
        for (int i = 0; i < n; ++i) set(i, any(decay[i] > S(0.0)) ? Exponential<S>::of(decay[i] * dt) : Exponential<S>{}, dt);
    }
    constexpr Scalars forcing(const X& rate, const X& at) const {
        Scalars force = flattened<S>(rate);
        const Scalars y = flattened<S>(at);
        for (int i = 0; i < n; ++i) force[i] = force[i] + decay[i] * y[i];
        return force;
    }
    constexpr X halfway(const X& from, const Scalars& force) const {
        Scalars y = flattened<S>(from);
        for (int i = 0; i < n; ++i) y[i] = half[i] * y[i] + stage[i] * force[i];
        return shaped<X>(y);
    }
    constexpr X onward(const X& halfway, const Scalars& force, const Scalars& at_start) const {
        Scalars y = flattened<S>(halfway);
        for (int i = 0; i < n; ++i) y[i] = half[i] * y[i] + stage[i] * (S(2.0) * force[i] - at_start[i]);
        return shaped<X>(y);
    }
    constexpr X complete(const X& from, const Scalars& n1, const Scalars& n2, const Scalars& n3, const Scalars& n4) const {
        Scalars y = flattened<S>(from);
        for (int i = 0; i < n; ++i) y[i] = full[i] * y[i] + (first[i] * n1[i] + middle[i] * (n2[i] + n3[i]) + last[i] * n4[i]);
        return shaped<X>(y);
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

/// One step without events.
template <class S, class Drive>
constexpr typename Drive::State smooth_step(const Drive& drive, const typename Drive::State& before, const Interval<S>& u,
                                            const S& dt) {
    const auto y1 = before.motion;
    const auto now = drive.flow(before, y1, u.start);
    auto x = drive.remembered(before, now.mesh.twist);
    const auto rate = [&](const auto& y, const Input<S>& input) { return drive.flow(x, y, input).rate; };
    const auto confined = [&](const auto& y) { return drive.confined(y, now.contacts, now.mesh.per_input); };
    const Relaxation<S, typename Drive::Motion> scheme(drive.decay(y1, now.contacts), dt);
    const auto n1 = scheme.forcing(now.rate, y1);
    const auto y2 = confined(scheme.halfway(y1, n1));
    const auto n2 = scheme.forcing(rate(y2, u.middle), y2);
    const auto y3 = confined(scheme.halfway(y1, n2));
    const auto n3 = scheme.forcing(rate(y3, u.middle), y3);
    const auto y4 = confined(scheme.onward(y2, n3, n1));
    const auto n4 = scheme.forcing(rate(y4, u.end), y4);
    x.motion = drive.renewed(confined(scheme.complete(y1, n1, n2, n3, n4)), now.contacts, now.mesh.per_input);
    return drive.wrapped(x);
}

/// The moment within (from, 1] at which the margin first falls below zero, in lanes where it does by the end; 1 in the others.
/// Illinois' variant of regula falsi, which keeps the bracket.
template <class S, class Margin>
constexpr S crossing(const Margin& margin, const S& from, const S& at_start, const S& at_end) {
    const auto crosses = at_end < S(0.0);
    S a = from, b{1.0}, fa = detached(max(at_start, S(0.0))), fb = detached(at_end), x{1.0};
    for (int i = 0; i < 80; ++i) {
        S guess = b - fb * (b - a) / select(crosses, fb - fa, S(-1.0));
        guess = select((guess > a) & (guess < b), guess, S(0.5) * (a + b));
        const S f = detached(margin(select(crosses, guess, S(1.0))));
        const auto moved = crosses & (abs(guess - x) > S(1e-15)) & (b - a > S(1e-15));
        x = select(crosses, guess, S(1.0));
        if (!any(moved)) break;
        const auto before = f > S(0.0);
        fa = select(before, f, S(0.5) * fa);
        fb = select(before, S(0.5) * fb, f);
        a = select(before, x, a);
        b = select(before, b, x);
    }
    if constexpr (differentiates<S>) {  // the moment moves with the parameters: implicit function theorem
        const S h(1e-4);
        const S slope = detached((margin(x + h) - margin(x - h)) / (S(2.0) * h));
        x = select(crosses & (abs(slope) > S(smallest)), x - (margin(x) - detached(margin(x))) / slope, x);
    }
    return x;
}

}  // namespace detail

/// The drive after one step of `dt` [s].
///
/// With set-valued friction the step ends each stretch where a side stops or breaks away, puts that side exactly at rest or sets
/// it sliding, and goes on. Events show at the end of a step: a side that crosses zero speed and returns within one is not seen,
/// which a smaller step cures. A drive that changes its mind more than 64 times in one step has no usable answer at this step size:
/// its speed is returned as not-a-number, which the caller reports.
template <class S, class Drive>
constexpr typename Drive::State step(const Drive& drive, const typename Drive::State& before, const Interval<S>& u, const S& dt) {
    if (!drive.set_valued()) return detail::smooth_step(drive, before, u, dt);
    auto x = drive.released(before, u.start);
    S done{0.0};
    for (int events = 0; events < 64; ++events) {
        const auto reach = [&](const S& fraction) {
            return detail::smooth_step(drive, x, u.part(done, fraction, dt), (fraction - done) * dt);
        };
        const auto end = reach(S(1.0));
        const S margin = drive.margin(end, u.end);
        if (!any(margin < S(0.0))) return end;
        const auto at = [&](const S& fraction) { return drive.margin(reach(fraction), u.part(S(0.0), fraction, dt).end); };
        const S moment = detail::crossing(at, done, drive.margin(x, u.part(S(0.0), done, dt).end), margin);
        x = drive.settled(reach(moment), u.part(S(0.0), moment, dt).end, margin < S(0.0));
        done = moment;
    }
    x.motion.input_speed = sqrt(S(-1.0));
    return x;
}

}  // namespace strainwave
