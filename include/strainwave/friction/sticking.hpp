#pragma once
#include <strainwave/field.hpp>

/// How a side of a drive moves that set-valued friction can bring to rest and hold there, whichever laws these are. The side
/// slides one way or the other, `sliding` -1 or 1, or sticks, `sliding` 0. Its `balance` is what drives it [N.m], friction that
/// can stick left out; `hold` the most [N.m] that this friction balances.
namespace strainwave::friction {

/// N.m. What a side that can stick holds at the least: less is the rounding of its balance, to which it would set off and stop
/// without end.
inline constexpr double negligible_hold = 1e-12;

/// The sense of sliding of a side found at some speed, which is `sliding` if it is at rest.
template <class S>
constexpr S sense_at(const S& speed, const S& sliding) {
    return select(speed == S(0.0), sign(sliding), sign(speed));
}

/// Which way a side goes at an event: one that stops sticks if its friction holds it.
template <class S, class Mask>
constexpr S sense_after(const S& balance, const S& hold, const Mask& stops) {
    return select(stops & !(abs(balance) > hold), S(0.0), sign(balance));
}

/// Where a side sticks and is driven beyond what holds it.
template <class S>
constexpr auto sets_off(const S& sliding, const S& hold, const S& balance) {
    return (sliding == S(0.0)) & (hold < abs(balance));
}

/// How far a side is from changing between sticking and sliding; below zero, it has.
template <class S>
constexpr S margin(const S& sliding, const S& speed, const S& hold, const S& balance) {
    return select(sliding == S(0.0), hold - abs(balance), sliding * speed);
}

/// The share of its hold that a side which sticks makes use of, with the sense of what it balances.
template <class S>
constexpr S share_of_hold(const S& balance, const S& hold) {
    return clip(balance / max(hold, S(smallest)), S(-1.0), S(1.0));
}

/// How a side moves after an impulse.
template <class S>
struct Arrival {
    S momentum, sliding;
};

/// A side of some momentum under a `push` [N.m.s] and the impulse friction(way) opposite to its way, which a side at rest must
/// overcome `hold` [N.m.s] to set off against.
template <class S, class Friction>
constexpr Arrival<S> arrival(const S& sliding, const S& momentum, const S& push, const S& hold, const Friction& friction) {
    const S free = momentum + push, way = sign(free), left = free - friction(way);
    const auto rests = (hold >= abs(free)) & !(sliding * free > S(0.0));
    const auto onward = !(S(0.0) >= left * way);
    const auto moves = onward & !rests;
    return {select(moves, left, S(0.0)), select(moves, way, S(0.0))};
}

}  // namespace strainwave::friction
