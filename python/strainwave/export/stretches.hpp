// Steps through a stretch of time, cut where a sampled controller acts: once for all programs that step a drive.
#pragma once
#include <strainwave/kernel/run.hpp>

namespace strainwave::exported {

// Relative: steps closer than this are of one length, and instants closer than this share of a step are one.
template <class S>
inline constexpr double same_length = sizeof(S) == sizeof(float) ? 1e-4 : 1e-9;
inline constexpr double rounding = 1e-9;  // relative: a step that differs less from the longest one is the longest one
inline constexpr double max_count = 1e8;  // of steps in a stretch of time: a longer one is refused, as it takes minutes

// The time to the next instant at which a sampled controller acts, later than now; `limit` [s] if there is none before.
template <class S, class Drive>
constexpr S next_instant(const Drive& drive, const typename Drive::State& x, const S& limit, const S& max_step) {
    const auto schedule = drive.schedule(x);
    if (!(schedule.period > S(0.0))) return limit;
    const S first = schedule.first, given = first + schedule.delay;
    const S instants[] = {given - schedule.period, first, given, first + schedule.period};
    S next = limit;
    for (const S& each : instants)
        if (each > S(same_length<S>) * max_step && each < next) next = each;
    return next;
}

// Takes a drive through `duration` [s] in equal steps of at most `max_step` [s], each cut where a sampled controller acts. `at`
// gives the inputs at a time since the begin. Ends where go_on(that time), asked after each step, is false.
template <class S, class Drive, class At, class GoOn>
bool advance(const Drive& drive, typename Drive::Evaluation& here, const At& at, const S& duration, const S& max_step,
             integrate::Steps<S, Drive>& steps, const GoOn& go_on) {
    S count = rint(duration / max_step);
    if (count * max_step * S(1.0 + same_length<S>) < duration || count < S(1.0)) count = count + S(1.0);
    S dt = duration / count;
    if (abs(dt - max_step) <= S(rounding) * max_step) dt = max_step;
    const S tolerance = S(same_length<S>) * max_step;
    const auto smooth = [&steps](const Drive& moved, const auto& from, const auto& over, const S& h) {
        return kernel::smooth_step(moved, from, over, h, steps);
    };
    for (S i{0.0}; i < count; i = i + S(1.0))
        for (S within{0.0};;) {
            const S left = dt - within, next = next_instant(drive, here.state, left, max_step);
            const bool is_last = next >= left - tolerance;
            const S length = is_last ? left : next, from = i * dt + within;
            const Interval<Input<S>> u{at(from), at(from + S(0.5) * length), at(from + length)};
            here = system::up_to_date(drive, here, u.start, S(0.5) * length);
            steps.begin(length);
            here = step(drive, here, u, length, smooth);
            if (!go_on(from + length)) return false;
            if (is_last) break;
            within = within + next;
        }
    return true;
}

}  // namespace strainwave::exported
