#pragma once
#include <strainwave/integrate/event_driven.hpp>
#include <strainwave/integrate/tolerance.hpp>

namespace strainwave::integrate {

/// Steps as long as a tolerance allows, taken by `smooth`, which knows no events and is of fourth order; by Moreau and Jean's
/// scheme where events chatter. The error of two steps is their difference to one step of twice their length. A step ends at an
/// event. Between its ends a step is known as exactly as there: by a step of part of its length. `Inputs` gives the inputs at a
/// fraction of an interval, and over a part of it, as an Interval does. For scalars that are plain numbers.
template <class S, class System, class Smooth, class Inputs = Interval<typename System::Input>>
class Adaptive {
    using Evaluation = typename System::Evaluation;
    using Continuous = typename System::Continuous;
    using Input = typename System::Input;
    /// Numbers that are held to the tolerance: the continuous ones, and the watched one.
    struct Measured {
        Flat<S, Continuous> continuous;
        S watched;
    };

    const System& system;
    const Smooth& smooth;
    const Tolerance tolerance;
    Measured largest;
    S next;  ///< length of the next step, s

public:
    long accepted = 0, rejected = 0;

    /// True if consecutive steps of the shortest length missed the tolerance, so that `through` ended.
    constexpr bool gave_up() const { return failed_shortest > max_failed_shortest; }

    /// `like` is a state of the system, `first` the length of the first step [s].
    constexpr Adaptive(const System& system_, const typename System::State& like, const Smooth& smooth_,
                       const Tolerance& tolerance_, const S& first)
        : system(system_),
          smooth(smooth_),
          tolerance(tolerance_),
          largest{flattened<S>(zeroed<S>(like.continuous)), S(0.0)},
          next(first) {}

    /// The evaluation after the interval `u` of `dt` [s]. Calls within(done, to, end, at) for each step taken: between which
    /// fractions of the interval, the evaluation at its end, and a function that gives it at any fraction in between; ends where
    /// that is false.
    template <class Within>
    constexpr Evaluation through(Evaluation from, const Inputs& u, const S& dt, const Within& within) {
        S done{0.0};
        while (done < S(1.0)) {
            if (system::breaks_away(system, from)) from = system::break_away(system, from, u.at(done, dt));
            // The rest is not cut, so that no sliver remains.
            const S left = (S(1.0) - done) * dt, steps = left / next;
            const S length = steps <= S(1.0) ? left : steps < S(2.0) ? S(0.5) * left : next;
            const Trial planned = trial(from, u, dt, done, length < left ? done + length / dt : S(1.0));
            const Stop stop = chatters() ? Stop{planned.to} : this->stop(from, planned, u, dt);
            const auto apply_event = [&](const Evaluation& at) {
                const Input then = u.at(stop.at, dt);
                const auto after = system::apply_event(system, along(from, planned, u, dt, stop.met), then, true);
                return system::with_event_applied(system, at, after, then);
            };
            if (stop.event && stop.at == done) {
                from = apply_event(from);
                ++events;
                continue;
            }
            const bool cut = stop.at < planned.to;
            Trial tried = cut ? trial(from, u, dt, done, stop.at) : planned;
            const S taken = (tried.to - done) * dt;
            if (!stands(error(from, tried, taken), taken, cut)) continue;
            if (gave_up()) return from;
            if (stop.event) tried.end = apply_event(tried.end);
            if (!within(done, tried.to, tried.end, [&](const S& at) { return along(from, tried, u, dt, at); })) return from;
            events = chatters() ? max_events - 1 : taken > S(brief_step) ? stop.event : events + stop.event;
            if (failed_shortest == 0) note(tried.end);
            from = tried.end;
            done = tried.to;
        }
        return from;
    }

private:
    static constexpr double shortest_step = 1e-9;  ///< s
    static constexpr int max_failed_shortest = 100;
    int failed_shortest = 0;  ///< consecutive steps of the shortest length that missed the tolerance
    /// s. Where a jump of the forces makes a step this short, its error no longer falls faster than its length.
    static constexpr double brief_step = 1e-6;
    /// s. A system forgets an error within about this time, so that errors of steps may add up to the tolerance over it.
    static constexpr double forgetting_time = 0.1;
    int events = 0;  ///< each within a brief time of the other

    /// True if events follow so fast that the next step is one of Moreau and Jean's.
    constexpr bool chatters() const { return events >= max_events; }

    /// True if a step of this `length` [s] and error is accepted, also as one of the shortest; sets the length of the next one. A
    /// step that an event has `cut`, or that the end of the interval has shortened, does not limit longer ones.
    constexpr bool stands(const S& error, const S& length, bool cut) {
        const S max_growth(4.0);
        // The error of not-a-number is larger than any; the length of a step must not become zero.
        const S factor = error < S(1e4) ? clip(S(0.9) * exp(S(-0.25) * log(max(error, S(1e-3)))), S(0.2), max_growth) : S(0.2);
        const bool kept = error <= S(1.0), last = next <= S(shortest_step);
        if (!kept || !(cut || max_growth * length < next)) next = max(length * factor, S(shortest_step));
        ++(kept || last ? accepted : rejected);
        if (kept || last) failed_shortest = kept ? 0 : failed_shortest + 1;
        return kept || last;
    }

    /// A step between two fractions of the interval, and two of half its length.
    struct Trial {
        Evaluation whole, half, end;
        S begin, middle, to;
    };
    constexpr Trial trial(const Evaluation& from, const Inputs& u, const S& dt, const S& begin, const S& to) const {
        const S middle = S(0.5) * (begin + to);
        const Evaluation half = stretch(from, u, dt, begin, middle);
        return {stretch(from, u, dt, begin, to), half, stretch(half, u, dt, middle, to), begin, middle, to};
    }
    /// The evaluation on the way of a trial.
    constexpr Evaluation along(const Evaluation& from, const Trial& tried, const Inputs& u, const S& dt, const S& at) const {
        if (at == tried.to) return tried.end;
        return at < tried.middle ? stretch(from, u, dt, tried.begin, at) : stretch(tried.half, u, dt, tried.middle, at);
    }
    constexpr Evaluation stretch(const Evaluation& from, const Inputs& u, const S& dt, const S& begin, const S& end) const {
        const Interval<Input> part = u.part(begin, end, dt);
        const S length = (end - begin) * dt;
        if (chatters()) return system.evaluate(moreau_jean_step(system, from, part, length), part.end);
        return smooth(system, from, part, length);
    }

    /// End of a step, as a fraction of the interval, also at an event; and the fraction at which the event is detected.
    struct Stop {
        S at;
        bool event = false;
        S met{0.0};
    };
    /// The first on the way of a trial; its end if there is none.
    constexpr Stop stop(const Evaluation& from, const Trial& tried, const Inputs& u, const S& dt) const {
        if (const Look look = closest(from, tried.half, u, dt, tried.begin, tried.middle); look.left < S(0.0)) {
            // An event within the shortest time of a step is one at once.
            const S soon = min(tried.begin + S(shortest_step) / dt, look.at);
            if (event_function(stretch(from, u, dt, tried.begin, soon)) < S(0.0)) return {tried.begin, true, soon};
            const S met = moment(from, look, u, dt, tried.begin);
            return {met, true, met};
        }
        if (const Look look = closest(tried.half, tried.end, u, dt, tried.middle, tried.to); look.left < S(0.0)) {
            const S met = moment(tried.half, look, u, dt, tried.middle);
            return {met, true, met};
        }
        return {tried.to};
    }
    /// The event function at a fraction of the interval.
    struct Look {
        S at, left;
    };
    /// First fraction between two at which an event is detected, if any: the watched number changes its sign, for there friction
    /// that grows with it holds nothing, be it for a moment; or at the end.
    constexpr Look closest(const Evaluation& start, const Evaluation& end, const Inputs& u, const S& dt, const S& from,
                           const S& to) const {
        const S before = system::watched<S>(system, start), after = system::watched<S>(system, end);
        if (before * after < S(0.0) && system::sticks(system, start.state)) {
            const auto reach = [&](const S& fraction) { return stretch(start, u, dt, from, from + fraction * (to - from)); };
            const auto beyond = [&](const S& fraction) { return sign(before) * system::watched<S>(system, reach(fraction)); };
            const S empty = crossing(beyond, S(0.0), abs(before), -abs(after));
            const S soon = min(empty + S(shortest_step) / ((to - from) * dt), S(1.0));  // a moment that a step can resolve
            if (const S left = event_function(reach(soon)); left < S(0.0)) return {from + soon * (to - from), left};
        }
        return {to, event_function(end)};
    }
    /// The fraction of the interval behind `from` at which an event that a look has seen was met.
    constexpr S moment(const Evaluation& start, const Look& look, const Inputs& u, const S& dt, const S& from) const {
        const S way = look.at - from;
        const auto at = [&](const S& fraction) { return event_function(stretch(start, u, dt, from, from + fraction * way)); };
        return from + crossing(at, S(0.0), event_function(start), look.left) * way;
    }
    constexpr S event_function(const Evaluation& at) const { return system::event_function<S>(system, at); }

    constexpr Measured measured(const typename System::State& x, const Evaluation& at) const {
        return {flattened<S>(x.continuous), system::watched<S>(system, at)};
    }
    /// The largest error of a step of some `length` [s] in units of the tolerance: the difference of the two halves to the whole,
    /// in proportion to the step; and the contradiction, however short the step.
    constexpr S error(const Evaluation& from, const Trial& tried, const S& length) const {
        const Measured a = measured(system::aligned(system, tried.whole.state, tried.end.state), tried.whole);
        const Measured b = measured(tried.end.state, tried.end);
        const auto against = contradiction(from, tried, length);
        const S share = S(forgetting_time / (chatters() ? 3.0 : 15.0)) / (length + S(brief_step));
        S worst{0.0};
        const auto note = [&](const S& off) {
            if (!(off <= worst) && worst == worst) worst = off;  // what is not a number stays
        };
        const auto tolerated = [&](const S& size) { return S(tolerance.absolute) + S(tolerance.relative) * size; };
        for (int i = 0; i < against.size(); ++i) {
            const S most = tolerated(max(largest.continuous[i], abs(b.continuous[i])));
            note(abs(a.continuous[i] - b.continuous[i]) * share / most);
            note(abs(against[i]) / most);
        }
        note(abs(a.watched - b.watched) * share / tolerated(max(largest.watched, abs(b.watched))));
        return worst;
    }
    /// Deviation of the speeds from Simpson's rule over the two halves. It has the order and size of the error of the whole step,
    /// and does not vanish if a force has a kink within the step and whole and halves agree by chance.
    constexpr Flat<S, Continuous> contradiction(const Evaluation& from, const Trial& tried, const S& length) const {
        auto difference = flattened<S>(zeroed<S>(from.state.continuous));
        if (chatters()) return difference;
        const auto speeds = [&](const Continuous& y) { return flattened<S>(system::speeds<S>(system, y)); };
        const auto begin = speeds(from.derivatives.rate), middle = speeds(tried.half.derivatives.rate),
                   end = speeds(tried.end.derivatives.rate);
        const auto y = speeds(from.state.continuous), z = speeds(tried.end.state.continuous);
        for (int i = 0; i < difference.size(); ++i)
            difference[i] = z[i] - y[i] - length * S(1.0 / 6.0) * (begin[i] + S(4.0) * middle[i] + end[i]);
        return difference;
    }
    constexpr void note(const Evaluation& at) {
        const Measured now = measured(at.state, at);
        for (int i = 0; i < now.continuous.size(); ++i) largest.continuous[i] = max(largest.continuous[i], abs(now.continuous[i]));
        largest.watched = max(largest.watched, abs(now.watched));
    }
};

}  // namespace strainwave::integrate
