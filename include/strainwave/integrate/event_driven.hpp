#pragma once
#include <strainwave/integrate/exponential.hpp>
#include <strainwave/integrate/moreau_jean.hpp>

namespace strainwave::integrate {

/// The moment within (from, 1] at which the margin first falls below zero, in lanes where it does by the end; 1 in the others.
/// Anderson and Bjorck's variant of regula falsi, which closes a bracket around it; and of that the end, for before a margin jumps
/// nothing tells which side's it is.
template <class S, class Margin>
constexpr S crossing(const Margin& margin, const S& from, const S& at_start, const S& at_end) {
    const S within(1e-12);  // less than a state so close by differs from its rounding
    const auto crosses = at_end < S(0.0);
    S a = from, b{1.0}, fa = detached(max(at_start, S(0.0))), fb = detached(at_end), last{0.0};
    for (int i = 0; i < 80; ++i) {
        const auto sought = crosses & (b - a > within) & !(fb == S(0.0));  // a lane that has found its moment keeps it
        if (!any(sought)) break;
        const S secant = b - fb * (b - a) / select(sought, fb - fa, S(-1.0)), middle = S(0.5) * (a + b);
        const auto serves = (secant > a) & (secant < b) & (S(i) < S(20.0));  // it finds no jump
        // So far from the ends that one beside the moment closes the bracket.
        const S guess = clip(select(serves, secant, middle), a + S(0.5) * within, b - S(0.5) * within);
        const S f = detached(margin(select(sought, guess, b)));
        const auto before = f > S(0.0);
        // The end that stays for the second time counts less, or it would hold the secant back.
        const auto again = f * last > S(0.0);
        const S weight = select(again, max(S(1.0) - f / select(again, last, S(1.0)), S(0.1)), S(1.0));
        fa = select(before, f, weight * fa);
        fb = select(sought, select(before, weight * fb, f), fb);
        last = f;
        a = select(sought & before, guess, a);
        b = select(sought & !before, guess, b);
    }
    if constexpr (differentiates<S>)  // the moment moves with the parameters
        return select(crosses, moving_root(margin, b), b);
    else
        return b;
}

/// How many events a step may hold before they count as chattering.
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
        there = system.evaluate(chosen<S>(done < S(1.0), reach(S(1.0)).state, here.state), u.end);
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
