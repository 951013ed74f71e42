#pragma once
#include <strainwave/integrate/crossing.hpp>
#include <strainwave/integrate/moreau_jean.hpp>

namespace strainwave::integrate {

/// Largest count of events in a step; more are chattering.
inline constexpr int max_events = 16;

/// Repeats a step that ended `there`, behind an event, as stretches that end at events. At each, the event is applied and the next
/// stretch begins. Where events chatter, what is left of the step is one of Moreau and Jean's.
template <class S, class System, class Smooth>
constexpr void step_through_events(const System& system, const typename System::Evaluation& from,
                                   typename System::Evaluation& there, const Interval<typename System::Input>& u, const S& dt,
                                   const Smooth& smooth) {
    auto here = from;
    S done{0.0};
    const auto reach = [&](const S& fraction) { return smooth(system, here, u.part(done, fraction, dt), (fraction - done) * dt); };
    for (int events = 0;; ++events) {
        const S left = system::event_function<S>(system, there);
        const auto crosses = left < S(0.0);
        if (!any(crosses)) return;
        if (events == max_events) {
            const auto end = moreau_jean_step(system, here, u.part(done, S(1.0), dt), (S(1.0) - done) * dt);
            there = system.evaluate(chosen<S>(crosses, end, there.state), u.end);
            return;
        }
        const auto at = [&](const S& fraction) { return system::event_function<S>(system, reach(fraction)); };
        const S moment = crossing(at, done, system::event_function<S>(system, here), left);
        const auto then = u.part(S(0.0), moment, dt).end;
        here = system.evaluate(chosen<S>(crosses, system::apply_event(system, reach(moment), then, crosses), there.state), then);
        done = moment;
        // A lane that has arrived takes no further step, not even of 0 s.
        const auto end = chosen<S>(done < S(1.0), reach(S(1.0)).state, here.state);
        there = system.evaluate(chosen<S>(crosses, end, there.state), u.end);  // a lane without event stays as it was
    }
}

/// A step from where every shaft that sticks is held. To copy an evaluation would take a tenth of the step: only events do.
template <class S, class System, class Smooth>
constexpr typename System::Evaluation held_step(const System& system, const typename System::Evaluation& from,
                                                const Interval<typename System::Input>& u, const S& dt, const Smooth& smooth) {
    auto there = smooth(system, from, u, dt);
    if (any(system::event_function<S>(system, there) < S(0.0))) step_through_events(system, from, there, u, dt, smooth);
    return there;
}

/// One step with events. `smooth` takes a step without.
template <class S, class System, class Smooth>
constexpr typename System::Evaluation event_driven_step(const System& system, const typename System::Evaluation& from,
                                                        const Interval<typename System::Input>& u, const S& dt,
                                                        const Smooth& smooth) {
    if (system::breaks_away(system, from)) return held_step(system, system::break_away(system, from, u.start), u, dt, smooth);
    return held_step(system, from, u, dt, smooth);
}

}  // namespace strainwave::integrate
