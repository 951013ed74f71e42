#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave {

/// N.m. What holds a shaft at the least while it sticks. Less is the rounding of its driving torque, by which the shaft would break
/// away and stop without end.
inline constexpr double negligible_hold = 1e-12;

/// One end of a drive: a body that set-valued friction can bring to rest and hold there, whichever laws these are. A shaft slips
/// one way or the other, or sticks.
template <class S>
struct Shaft {
    bool can_stick;         ///< True if set-valued friction acts on it; without, it always slips
    S inertia;              ///< kg.m2
    S speed;                ///< rad/s
    S slip_direction;       ///< -1 or 1; 0 while it sticks
    S driving_torque{0.0};  ///< N.m: all that acts on it but set-valued friction
    S holding_torque{0.0};  ///< N.m: the most that set-valued friction balances at rest

    constexpr auto sticks() const { return slip_direction == S(0.0); }
    /// True if the shaft is driven beyond its breakaway torque.
    constexpr auto breaks_away() const {
        const auto overcome = holding_torque < abs(driving_torque);
        return sticks() & overcome;
    }
    constexpr S break_away_direction() const { return select(breaks_away(), sign(driving_torque), slip_direction); }

    /// Positive until the shaft stops, or breaks away.
    constexpr S event_function() const {
        if (!can_stick) return S(unbounded);
        return select(sticks(), holding_torque - abs(driving_torque), slip_direction * speed);
    }
    /// The slip direction after an event: a shaft that `stops` sticks if friction holds it.
    template <class Mask>
    constexpr S direction_after(const Mask& stops) const {
        const auto overcome = abs(driving_torque) > holding_torque;
        return select(stops & !overcome, S(0.0), sign(driving_torque));
    }
    /// The slip direction of a shaft from its speed and, at rest, from its last slip direction.
    constexpr S consistent_direction() const {
        if (!can_stick) return S(1.0);
        return select(speed == S(0.0), sign(slip_direction), sign(speed));
    }
    /// The share of the breakaway torque that acts while it sticks, with the sign of the driving torque.
    constexpr S share_of_hold() const {
        if (!can_stick) return S(0.0);
        return clip(driving_torque / max(holding_torque, S(smallest)), S(-1.0), S(1.0));
    }

    /// Slip of a shaft after an impulse.
    struct Impelled {
        S speed, slip_direction;
    };
    /// The shaft after `dt` [s] under the same torques, those of friction as impulses: `friction(direction)` is the torque against
    /// slip. A shaft at rest breaks away only where its driving torque exceeds the holding torque.
    template <class Friction>
    constexpr Impelled impelled(const S& dt, const Friction& friction) const {
        const S momentum = speed * inertia, push = driving_torque * dt;
        if (!can_stick) return {(momentum + push) / inertia, slip_direction};
        const S hold = holding_torque * dt;
        const S free = momentum + push, way = sign(free), left = free - friction(way) * dt;
        const auto rests = (hold >= abs(free)) & !(slip_direction * free > S(0.0));
        const auto onward = !(S(0.0) >= left * way);
        const auto slips = onward & !rests;
        return {select(slips, left, S(0.0)) / inertia, select(slips, way, S(0.0))};
    }
};

}  // namespace strainwave
