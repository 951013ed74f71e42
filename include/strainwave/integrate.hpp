#pragma once
#include <strainwave/integrate/adaptive.hpp>
#include <strainwave/integrate/event_driven.hpp>
#include <strainwave/integrate/rosenbrock.hpp>

/// Steps in time, over any described state.
namespace strainwave {

/// The drive after one step of `dt` [s]: of fourth order, with events located and stepped to exactly where friction can stick.
/// Events show at the end of a step: a side that crosses zero speed and returns within one is not seen, which a smaller step cures.
/// `smooth` takes a step without events.
template <class S, class Drive, class Smooth>
constexpr typename Drive::State step(const Drive& drive, const typename Drive::State& before, const Interval<S>& u, const S& dt,
                                     const Smooth& smooth) {
    return drive.set_valued() ? integrate::event_driven_step(drive, before, u, dt, smooth) : smooth(drive, before, u, dt);
}

template <class S, class Drive>
constexpr typename Drive::State step(const Drive& drive, const typename Drive::State& before, const Interval<S>& u, const S& dt) {
    return step(drive, before, u, dt, [](const Drive& moved, const typename Drive::State& x, const Interval<S>& over, const S& h) {
        return integrate::exponential_step(moved, x, over, h);
    });
}

}  // namespace strainwave
