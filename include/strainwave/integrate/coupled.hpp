#pragma once
#include <strainwave/integrate/crossing.hpp>
#include <strainwave/integrate/exponential.hpp>
#include <strainwave/integrate/matrix.hpp>

namespace strainwave::integrate {

/// Coefficients of Krogstad's method (2005, eq. (51)) for a block of numbers that obey y' = A y + n(y, rest) over a step: A, and
/// what its functions phi_1, phi_2, phi_3 of half the step and of all of it weigh rates with. Written for the changes of n since
/// the start of the step, so that A y + n, the rate, is all that the first stage needs.
template <class Numbers>
class Coupling {
    using S = ScalarOf<Numbers>;

    Square<Numbers> linear, half_first, half_second;
    PhiFunctions<Numbers> whole;
    S h;

public:
    /// Coefficients of A, over a step of `dt`.
    constexpr void set(const Square<Numbers>& a, const S& dt) {
        linear = a;
        h = dt;
        const S half = S(0.5) * dt;
        auto &z = half_second, &room = half_first;
        size_like(a, z);
        for (int j = 0; j < a.size(); ++j)
            for (int i = 0; i < a.size(); ++i) z[j][i] = half * a[j][i];
        whole.set(z, room);
        half_first = whole.first;
        half_second = whole.second;
        whole.double_integrals(dt == dt);  // everywhere
    }

    /// Change of n since the start of the step, where the rate was `at_start`, and the numbers are `moved` from there.
    constexpr Numbers change(const Numbers& rate, const Numbers& at_start, const Numbers& moved) const {
        Numbers d = times(linear, moved);
        for (int i = 0; i < d.size(); ++i) d[i] = (rate[i] - at_start[i]) - d[i];
        return d;
    }
    // Change of the numbers to the stages in the middle of the step, and to its end.
    constexpr Numbers to_second(const Numbers& at_start) const { return moved(S(0.5), half_first, at_start); }
    constexpr Numbers to_third(const Numbers& second_moved, const Numbers& d2) const {
        return sum(second_moved, moved(S(1.0), half_second, d2));
    }
    constexpr Numbers with_rate_of_start(const Numbers& at_start) const { return moved(S(1.0), whole.first, at_start); }
    constexpr Numbers to_fourth(const Numbers& by_start, const Numbers& d3) const {
        return sum(by_start, moved(S(2.0), whole.second, d3));
    }
    constexpr Numbers to_end(const Numbers& by_start, const Numbers& d2, const Numbers& d3, const Numbers& d4) const {
        Numbers twice = d2, rest = d2;
        for (int i = 0; i < d2.size(); ++i) {
            const S both = d2[i] + d3[i];
            twice[i] = S(2.0) * both - d4[i];
            rest[i] = d4[i] - both;
        }
        return sum(by_start, sum(moved(S(1.0), whole.second, twice), moved(S(4.0), whole.third, rest)));
    }

private:
    constexpr Numbers moved(const S& share, const Square<Numbers>& phi, const Numbers& rate) const {
        Numbers y = times(phi, rate);
        const S by = share * h;
        for (int i = 0; i < y.size(); ++i) y[i] = by * y[i];
        return y;
    }
    static constexpr Numbers sum(const Numbers& a, const Numbers& b) {
        Numbers c = a;
        for (int i = 0; i < c.size(); ++i) c[i] = a[i] + b[i];
        return c;
    }
};

/// One step without events, of fourth order: the coupled block by Krogstad's method, however stiff it is, all else as in
/// `exponential_step`. Both have the weights of the classical Runge-Kutta scheme where nothing is stiff.
template <class S, class System, class Numbers>
constexpr typename System::State coupled_step(const System& system, const typename System::Evaluation& from,
                                              const Interval<typename System::Input>& u, const S& dt,
                                              const Coupling<Numbers>& coupling) {
    using Continuous = typename System::Continuous;
    auto x = from.state;
    const Continuous& y1 = from.state.continuous;
    const auto& now = from.derivatives;
    const Relaxation<S, Continuous> scheme(system::relaxation_rate<S>(system, y1, now), dt);
    const Numbers start = system.coupled(y1), rate = system.coupled(now.rate);
    const auto stage = [&](Continuous y, const Numbers& moved) {
        Numbers numbers = start;
        for (int i = 0; i < numbers.size(); ++i) numbers[i] = numbers[i] + moved[i];
        system.set_coupled(y, numbers);
        return system::clamped(system, y, now);
    };
    const auto evaluated = [&](const Continuous& y, const auto& input) { return system.derivatives(x, y, input).rate; };
    const auto change = [&](const Continuous& then, const Numbers& moved) {
        return coupling.change(system.coupled(then), rate, moved);
    };
    const auto n1 = scheme.forcing(now.rate, y1);
    const Numbers moved2 = coupling.to_second(rate), by_start = coupling.with_rate_of_start(rate);
    const Continuous y2 = stage(scheme.halfway(y1, n1), moved2), rate2 = evaluated(y2, u.middle);
    const auto n2 = scheme.forcing(rate2, y2);
    const Numbers d2 = change(rate2, moved2), moved3 = coupling.to_third(moved2, d2);
    const Continuous y3 = stage(scheme.halfway(y1, n2), moved3), rate3 = evaluated(y3, u.middle);
    const auto n3 = scheme.forcing(rate3, y3);
    const Numbers d3 = change(rate3, moved3), moved4 = coupling.to_fourth(by_start, d3);
    const Continuous y4 = stage(scheme.onward(y2, n3, n1), moved4), rate4 = evaluated(y4, u.end);
    const auto n4 = scheme.forcing(rate4, y4);
    const Numbers d4 = change(rate4, moved4);
    const Continuous end = stage(scheme.complete(y1, n1, n2, n3, n4), coupling.to_end(by_start, d2, d3, d4));
    x.continuous = system::update_mode(system, end, now);
    system::finish_step(system, x, dt);
    return x;
}

/// The matrix of a coupled block at a state.
template <class System>
constexpr auto coupled_matrix(const System& system, const typename System::State& x) {
    const auto mode = system.coupled_mode(x);
    using Numbers = decltype(system.coupled(x.continuous));
    const Numbers zeros = zeros_like(system.coupled(x.continuous));
    Square<Numbers> a;
    for (int j = 0; j < zeros.size(); ++j) {
        Numbers unit = zeros;
        unit[j] = ScalarOf<Numbers>(1.0);
        a[j] = system.coupled_rate(mode, unit);
    }
    return a;
}

/// Steps without events of one system, one after the other. If that has a coupled block, it keeps what a step worked out of the
/// block, for others of the same length. Where the rates jump on the way the step is taken in parts, one of which, short, holds the
/// jump: to step over it would be an error of first order.
template <class S, class System, int n = system::coupled_count<System>>
class Steps {
    using Input = typename System::Input;
    using State = typename System::State;
    using Evaluation = typename System::Evaluation;
    using Mode = decltype(System{}.coupled_mode(State{}));

    Coupling<decltype(System{}.coupled(State{}.continuous))> coupling;
    Mode mode;
    S length;
    bool known = false;
    S undivided{0.0};

public:
    /// Sets the length of a step [s] that events may divide. As times add up, steps of one length differ by their rounding: they
    /// count as the first of them. Lengths of parts never do, so that no lane of a pack depends on events in the others.
    constexpr void begin(const S& dt) { undivided = select(close(dt, undivided), undivided, value_only(dt)); }
    constexpr State operator()(const System& system, const Evaluation& from, const Interval<Input>& u, const S& dt) {
        if (!system.couples()) return exponential_step(system, from, u, dt);
        prepare(system, from.state, dt);
        const State end = coupled_step(system, from, u, dt, coupling);
        const S before = system.side(from.state), margin = facing(before, system.side(end));
        const auto jumps = (margin < S(0.0)) & !(before == S(0.0));
        if (!any(jumps)) return end;
        const auto ahead = [&](const S& fraction) { return facing(before, system.side(from.state, end, dt, fraction)); };
        const S moment = crossing(ahead, S(0.0), abs(before), select(jumps, margin, S(1.0)));
        return chosen<S>(jumps, in_parts(system, from, u, dt, moment), end);
    }

private:
    static constexpr double same_length = 1e-8;  // relative
    /// Fraction of a step, larger than the error of the moment of a jump.
    static constexpr double jump_margin = 1e-3;

    static constexpr auto close(const S& dt, const S& to) { return abs(dt - to) < S(same_length) * to; }
    constexpr void prepare(const System& system, const State& x, const S& dt) {
        const Mode asked = system.coupled_mode(x);
        const S taken = select(close(dt, undivided), undivided + (dt - value_only(dt)), dt);
        if (known) {
            auto same = taken == length;
            for (int i = 0; i < asked.size(); ++i) same = same & (mode[i] == asked[i]);
            if (all(same) && !is_differentiated(taken - length)) return;
        }
        coupling.set(coupled_matrix(system, x), taken);
        mode = asked;
        length = taken;
        known = true;
    }
    /// A step in three parts: to shortly before a moment, past it, and on to the end.
    constexpr State in_parts(const System& system, const Evaluation& from, const Interval<Input>& u, const S& dt, const S& moment) {
        const S middle = clip(moment, S(2.0 * jump_margin), S(1.0 - 2.0 * jump_margin));
        const S ends[] = {middle - S(jump_margin), middle + S(jump_margin), S(1.0)};
        Evaluation at = from;
        S begin{0.0};
        for (int i = 0;; ++i) {
            const S taken = (ends[i] - begin) * dt;
            const auto part = u.part(begin, ends[i], dt);
            prepare(system, at.state, taken);
            const State next = coupled_step(system, at, part, taken, coupling);
            if (i == 2) return next;
            at = system.evaluate(next, part.end);
            begin = ends[i];
        }
    }
    /// Positive where `x` lies on the same side.
    static constexpr S facing(const S& side, const S& x) { return select(side < S(0.0), -x, x); }
};
template <class S, class System>
class Steps<S, System, 0> {
public:
    constexpr void begin(const S&) {}
    constexpr typename System::State operator()(const System& system, const typename System::Evaluation& from,
                                                const Interval<typename System::Input>& u, const S& dt) const {
        return exponential_step(system, from, u, dt);
    }
};

}  // namespace strainwave::integrate
