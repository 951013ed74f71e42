#pragma once
#include <strainwave/integrate/adaptive.hpp>
#include <strainwave/integrate/event_driven.hpp>
#include <strainwave/integrate/rosenbrock.hpp>

/// Steps in time, of any system.
namespace strainwave {

/// The evaluation after one step of `dt` [s]: of fourth order, with events located and stepped to exactly. Events show at the end
/// of a step: a shaft that crosses zero speed and returns within one, or breaks away and stops, is not seen, which a smaller step
/// cures. `smooth` takes a step without events.
template <class S, class System, class Smooth>
constexpr typename System::Evaluation step(const System& system, const typename System::Evaluation& from,
                                           const Interval<typename System::Input>& u, const S& dt, const Smooth& smooth) {
    if (system::has_events(system)) return integrate::event_driven_step(system, from, u, dt, smooth);
    return smooth(system, from, u, dt);
}

/// The state after such a step, from a state alone. Its memory may yet have to be brought up to date, as the next step does.
/// `steps` keeps what the next step of the same length would work out again, of one system: begin with others where its numbers
/// change.
template <class S, class System>
constexpr typename System::State step(const System& system, const typename System::State& before,
                                      const Interval<typename System::Input>& u, const S& dt, integrate::Steps<S, System>& steps) {
    steps.begin(dt);
    const auto from = system.evaluate(before, u.start);
    if (!system::has_events(system)) return steps(system, from, u, dt);
    const auto smooth = [&](const System& moved, const auto& at, const auto& over, const S& h) {
        return moved.evaluate(steps(moved, at, over, h), over.end);
    };
    return integrate::event_driven_step(system, from, u, dt, smooth).state;
}
template <class S, class System>
constexpr typename System::State step(const System& system, const typename System::State& before,
                                      const Interval<typename System::Input>& u, const S& dt) {
    integrate::Steps<S, System> steps;
    return step(system, before, u, dt, steps);
}

}  // namespace strainwave
