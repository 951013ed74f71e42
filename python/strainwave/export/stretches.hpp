// Steps through a stretch of time, cut where a sampled controller acts.
#pragma once
#include <strainwave/math.hpp>

namespace strainwave::exported {

// Relative: steps closer than this are of one length, and instants closer than this share of a step are one.
template <class S>
inline constexpr double same_length = sizeof(S) == sizeof(float) ? 1e-4 : 1e-9;
inline constexpr double rounding = 1e-9;   // relative: a step that differs less from the longest one is the longest one
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

// Takes a drive through `duration` [s] in equal steps of at most `max_step` [s], each cut where a sampled controller acts. `state`
// gives the state of the drive, take(time since the begin, length) takes a step; where it is false, no further one is taken.
template <class S, class Drive, class Current, class Take>
constexpr bool in_steps(const Drive& drive, const S& duration, const S& max_step, const Current& state, const Take& take) {
    S count = rint(duration / max_step);
    if (count * max_step * S(1.0 + same_length<S>) < duration || count < S(1.0)) count = count + S(1.0);
    S dt = duration / count;
    if (abs(dt - max_step) <= S(rounding) * max_step) dt = max_step;
    const S tolerance = S(same_length<S>) * max_step;
    for (S i{0.0}; i < count; i = i + S(1.0))
        for (S within{0.0};;) {
            const S left = dt - within, next = next_instant(drive, state(), left, max_step);
            const bool is_last = next >= left - tolerance;
            if (!take(i * dt + within, is_last ? left : next)) return false;
            if (is_last) break;
            within = within + next;
        }
    return true;
}

}  // namespace strainwave::exported
