#pragma once
#include <strainwave/integrate/event_driven.hpp>

namespace strainwave::integrate {

/// What a member of the motion, and the torque, may err by: `absolute`, in its own unit, plus `relative` times the largest it has
/// been.
struct Tolerance {
    double relative = 1e-6;
    double absolute = 1e-12;
};

/// Steps as long as a tolerance allows, taken by `smooth`, which knows no events and is of fourth order; by Moreau and Jean's
/// scheme where events chatter. The error of two steps is told by one of twice their length. A step ends where a side stops, breaks
/// away or turns round. Between its ends a step is known as exactly as there: by a step of part of its length. `Inputs` tells what
/// drives the drive at a fraction of an interval, and over a part of it, as an Interval does. For scalars that are plain numbers.
template <class S, class Drive, class Smooth, class Inputs = Interval<S>>
class Adaptive {
    using Standing = typename Drive::Standing;
    static constexpr int n = size_of<S, typename Drive::Motion> + 1;
    using Measured = Array<S, n>;

    const Drive& drive;
    const Smooth& smooth;
    const Tolerance tolerance;
    Measured largest{};
    S next;  ///< length of the next step, s

public:
    long accepted = 0, rejected = 0;

    /// Whether one of the shortest steps after the other missed the tolerance, where `through` ended.
    constexpr bool gave_up() const { return missed > most_missed; }

    constexpr Adaptive(const Drive& drive_, const Smooth& smooth_, const Tolerance& tolerance_, const S& first)
        : drive(drive_), smooth(smooth_), tolerance(tolerance_), next(first) {}

    /// The drive after the interval `u` of `dt` [s]. Calls within(done, to, end, at) for each step taken: between which fractions
    /// of the interval, where the drive stands at its end, and a function that tells where at any fraction in between.
    template <class Within>
    constexpr Standing through(Standing from, const Inputs& u, const S& dt, const Within& within) {
        S done{0.0};
        while (done < S(1.0)) {
            if (drive.sets_off(from)) from = drive.released(from, u.at(done, dt));
            // What is left is not cut so that a sliver remains.
            const S left = (S(1.0) - done) * dt, steps = left / next;
            const S length = steps <= S(1.0) ? left : steps < S(2.0) ? S(0.5) * left : next;
            const Trial planned = trial(from, u, dt, done, length < left ? done + length / dt : S(1.0));
            const Stop stop = chatters() ? Stop{planned.to} : this->stop(from, planned, u, dt);
            const auto settled = [&](const Standing& at) {
                const Input<S> then = u.at(stop.at, dt);
                return drive.as_settled(at, drive.settled(along(from, planned, u, dt, stop.met), then, true), then);
            };
            if (stop.event && stop.at == done) {
                from = settled(from);
                ++events;
                continue;
            }
            const bool cut = stop.at < planned.to;
            Trial tried = cut ? trial(from, u, dt, done, stop.at) : planned;
            const S taken = (tried.to - done) * dt;
            if (!stands(error(from, tried, taken), taken, cut)) continue;
            if (gave_up()) return from;
            if (stop.event) tried.end = settled(tried.end);
            within(done, tried.to, tried.end, [&](const S& at) { return along(from, tried, u, dt, at); });
            events = chatters() ? most_events - 1 : taken > S(brief) ? stop.event : events + stop.event;
            if (missed == 0) note(tried.end);
            from = tried.end;
            done = tried.to;
        }
        return from;
    }

private:
    static constexpr double shortest = 1e-9;  ///< s
    static constexpr int most_missed = 100;
    int missed = 0;  ///< of the shortest steps, one after the other
    /// s. Where a jump of the forces makes a step this short, its error no longer falls faster than its length.
    static constexpr double brief = 1e-6;
    /// s. A drive forgets an error within about this time, so that errors of steps may add up to the tolerance over it.
    static constexpr double forgetting = 0.1;
    int events = 0;  ///< each within a brief time of the other

    /// Whether events follow so fast that the next step is one of Moreau and Jean's.
    constexpr bool chatters() const { return events >= most_events; }

    /// Whether a step of some `length` [s] that misses so much may stand, be it as one of the shortest; and how long the next one
    /// is. What an event has `cut` says nothing of longer ones, nor does what the end of the interval has made much shorter.
    constexpr bool stands(const S& error, const S& length, bool cut) {
        const S most_growth(4.0);
        // An error of what is not a number is larger than any; a step must not become nothing.
        const S factor = error < S(1e4) ? clip(S(0.9) * exp(S(-0.25) * log(max(error, S(1e-3)))), S(0.2), most_growth) : S(0.2);
        const bool kept = error <= S(1.0), last = next <= S(shortest);
        if (!kept || !(cut || most_growth * length < next)) next = max(length * factor, S(shortest));
        ++(kept || last ? accepted : rejected);
        if (kept || last) missed = kept ? 0 : missed + 1;
        return kept || last;
    }

    /// A step between two fractions of the interval, and two of half its length.
    struct Trial {
        Standing whole, half, end;
        S begin, middle, to;
    };
    constexpr Trial trial(const Standing& from, const Inputs& u, const S& dt, const S& begin, const S& to) const {
        const S middle = S(0.5) * (begin + to);
        const Standing half = stretch(from, u, dt, begin, middle);
        return {stretch(from, u, dt, begin, to), half, stretch(half, u, dt, middle, to), begin, middle, to};
    }
    /// Where the drive stands on the way of a trial.
    constexpr Standing along(const Standing& from, const Trial& tried, const Inputs& u, const S& dt, const S& at) const {
        if (at == tried.to) return tried.end;
        return at < tried.middle ? stretch(from, u, dt, tried.begin, at) : stretch(tried.half, u, dt, tried.middle, at);
    }
    constexpr Standing stretch(const Standing& from, const Inputs& u, const S& dt, const S& begin, const S& end) const {
        const Interval<S> part = u.part(begin, end, dt);
        const S length = (end - begin) * dt;
        if (chatters()) return drive.standing(moreau_jean_step(drive, from, part, length), part.end);
        return smooth(drive, from, part, length);
    }

    /// Where a step must end, as a fraction of the interval, be it at an event; and where it is seen that one was met.
    struct Stop {
        S at;
        bool event = false;
        S met{0.0};
    };
    /// The first on the way of a trial; its end if there is none.
    constexpr Stop stop(const Standing& from, const Trial& tried, const Inputs& u, const S& dt) const {
        if (const Look look = closest(from, tried.half, u, dt, tried.begin, tried.middle); look.margin < S(0.0)) {
            // An event within the shortest time of a step is one at once.
            const S soon = min(tried.begin + S(shortest) / dt, look.at);
            if (drive.margin(stretch(from, u, dt, tried.begin, soon)) < S(0.0)) return {tried.begin, true, soon};
            const S met = moment(from, look, u, dt, tried.begin);
            return {met, true, met};
        }
        if (const Look look = closest(tried.half, tried.end, u, dt, tried.middle, tried.to); look.margin < S(0.0)) {
            const S met = moment(tried.half, look, u, dt, tried.middle);
            return {met, true, met};
        }
        return {tried.to};
    }
    /// The margin at a fraction of the interval.
    struct Look {
        S at, margin;
    };
    /// Where between two fractions a margin is first seen to be used up, if at all: where the torque turns over, for there friction
    /// that grows with it holds nothing, be it for a moment; or at the end.
    constexpr Look closest(const Standing& start, const Standing& end, const Inputs& u, const S& dt, const S& from,
                           const S& to) const {
        const S before = start.flow.mesh.torque, after = end.flow.mesh.torque;
        if (before * after < S(0.0) && drive.sticks(start.state)) {
            const auto reach = [&](const S& fraction) { return stretch(start, u, dt, from, from + fraction * (to - from)); };
            const auto left = [&](const S& fraction) { return sign(before) * reach(fraction).flow.mesh.torque; };
            const S empty = crossing(left, S(0.0), abs(before), -abs(after));
            const S soon = min(empty + S(shortest) / ((to - from) * dt), S(1.0));  // a moment that a step can resolve
            if (const S margin = drive.margin(reach(soon)); margin < S(0.0)) return {from + soon * (to - from), margin};
        }
        return {to, drive.margin(end)};
    }
    /// The fraction of the interval behind `from` at which a margin that is used up at a look came to be so.
    constexpr S moment(const Standing& start, const Look& look, const Inputs& u, const S& dt, const S& from) const {
        const S way = look.at - from;
        const auto at = [&](const S& fraction) { return drive.margin(stretch(start, u, dt, from, from + fraction * way)); };
        return from + crossing(at, S(0.0), drive.margin(start), look.margin) * way;
    }

    /// What is held to the tolerance: the motion, and the torque, which shows what the hysteresis remembers.
    constexpr Measured measured(const Standing& at) const {
        const auto y = flattened<S>(at.state.motion);
        Measured found{};
        for (int i = 0; i < y.size(); ++i) found[i] = y[i];
        found[n - 1] = at.flow.mesh.torque;
        return found;
    }
    /// The error of a step of some `length` [s] in units of what is tolerated, the largest of all: that of the two halves, by
    /// how far the whole is off, in proportion to the step; and what contradicts it, however short the step.
    constexpr S error(const Standing& from, const Trial& tried, const S& length) const {
        Standing coarse = tried.whole;
        S& angle = coarse.state.motion.input_angle;
        angle = angle + S(2.0 * pi) * (coarse.state.turns - tried.end.state.turns);
        const Measured a = measured(coarse), b = measured(tried.end);
        const auto against = flattened<S>(contradiction(from, tried, length));
        const S share = S(forgetting / (chatters() ? 3.0 : 15.0)) / (length + S(brief));
        S worst{0.0};
        const auto note = [&](const S& off) {
            if (!(off <= worst) && worst == worst) worst = off;  // what is not a number stays
        };
        for (int i = 0; i < n; ++i) {
            const S tolerated = S(tolerance.absolute) + S(tolerance.relative) * max(largest[i], abs(b[i]));
            note(abs(a[i] - b[i]) * share / tolerated);
            if (i < against.size()) note(abs(against[i]) / tolerated);
        }
        return worst;
    }
    /// By how much the speeds miss Simpson's rule over the two halves: of the same order and size as what the whole is off, but
    /// where a force kinks on the way, and whole and halves happen to agree, it does not vanish.
    constexpr typename Drive::Motion contradiction(const Standing& from, const Trial& tried, const S& length) const {
        typename Drive::Motion missed{};
        if (chatters()) return missed;
        const auto &begin = from.flow.rate, &middle = tried.half.flow.rate, &end = tried.end.flow.rate;
        const auto rule = [&](const S& first, const S& second, const S& third) {
            return length * S(1.0 / 6.0) * (first + S(4.0) * second + third);
        };
        const auto &y = from.state.motion, &z = tried.end.state.motion;
        missed.input_speed = z.input_speed - y.input_speed - rule(begin.input_speed, middle.input_speed, end.input_speed);
        missed.output_speed = z.output_speed - y.output_speed - rule(begin.output_speed, middle.output_speed, end.output_speed);
        return missed;
    }
    constexpr void note(const Standing& at) {
        const Measured y = measured(at);
        for (int i = 0; i < n; ++i) largest[i] = max(largest[i], abs(y[i]));
    }
};

}  // namespace strainwave::integrate
