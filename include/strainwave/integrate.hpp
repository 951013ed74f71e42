#pragma once
#include <strainwave/integrate/adaptive.hpp>
#include <strainwave/integrate/event_driven.hpp>
#include <strainwave/integrate/rosenbrock.hpp>

/// Steps in time, over any described state.
namespace strainwave {

/// Where the drive stands after one step of `dt` [s]: of fourth order, with events located and stepped to exactly where friction
/// can stick. Events show at the end of a step: a side that crosses zero speed and returns within one, or sets off and stops, is
/// not seen, which a smaller step cures. `smooth` leads to the end of a step without events.
template <class S, class Drive, class Smooth>
constexpr typename Drive::Standing step(const Drive& drive, const typename Drive::Standing& from, const Interval<S>& u, const S& dt,
                                        const Smooth& smooth) {
    return drive.set_valued() ? integrate::event_driven_step(drive, from, u, dt, smooth) : smooth(drive, from, u, dt);
}

/// The state after such a step, from a state alone. What it remembers may yet have to be brought up to date, as the next step does.
template <class S, class Drive>
constexpr typename Drive::State step(const Drive& drive, const typename Drive::State& before, const Interval<S>& u, const S& dt) {
    const auto from = drive.standing(before, u.start);
    if (!drive.set_valued()) return integrate::exponential_step(drive, from, u, dt);
    const auto smooth = [](const Drive& moved, const typename Drive::Standing& at, const Interval<S>& over, const S& h) {
        return moved.standing(integrate::exponential_step(moved, at, over, h), over.end);
    };
    return integrate::event_driven_step(drive, from, u, dt, smooth).state;
}

}  // namespace strainwave
