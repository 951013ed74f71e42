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
    S x = b;
    if constexpr (differentiates<S>) {  // the moment moves with the parameters: implicit function theorem
        const S now = margin(x), slope = derivative(margin, x, now);
        x = select(crosses & (abs(slope) > S(smallest)), x - (now - detached(now)) / slope, x);
    }
    return x;
}

/// How many events a step may hold before they count as chattering.
inline constexpr int most_events = 16;

/// Leads a step that ended `there`, where a margin lies below zero, to its right end. Each stretch ends where a side stops or
/// breaks away; that side is put exactly at rest or set sliding, and the next begins. Where events chatter, what is left of the
/// step is one of Moreau and Jean's.
template <class S, class Drive, class Smooth>
constexpr void lead_through_events(const Drive& drive, const typename Drive::Standing& from, typename Drive::Standing& there,
                                   const Interval<S>& u, const S& dt, const Smooth& smooth) {
    auto here = from;
    S done{0.0};
    const auto reach = [&](const S& fraction) { return smooth(drive, here, u.part(done, fraction, dt), (fraction - done) * dt); };
    for (int events = 0;; ++events) {
        const S margin = drive.margin(there);
        const auto crosses = margin < S(0.0);
        if (!any(crosses)) return;
        if (events == most_events) {
            const auto end = moreau_jean_step(drive, here, u.part(done, S(1.0), dt), (S(1.0) - done) * dt);
            there = drive.standing(chosen<S>(crosses, end, there.state), u.end);
            return;
        }
        const auto at = [&](const S& fraction) { return drive.margin(reach(fraction)); };
        const S moment = crossing(at, done, drive.margin(here), margin);
        const auto then = u.part(S(0.0), moment, dt).end;
        here = drive.standing(chosen<S>(crosses, drive.settled(reach(moment), then, crosses), there.state), then);
        done = moment;
        // A lane that has arrived takes no further step, not even of 0 s.
        there = drive.standing(chosen<S>(done < S(1.0), reach(S(1.0)).state, here.state), u.end);
    }
}

/// A step from where every side that sticks is held. To copy where a drive stands would take a tenth of the step: only events do.
template <class S, class Drive, class Smooth>
constexpr typename Drive::Standing held_step(const Drive& drive, const typename Drive::Standing& from, const Interval<S>& u,
                                             const S& dt, const Smooth& smooth) {
    auto there = smooth(drive, from, u, dt);
    if (any(drive.margin(there) < S(0.0))) lead_through_events(drive, from, there, u, dt, smooth);
    return there;
}

/// One step with set-valued friction. `smooth` leads to the end of a step without events.
template <class S, class Drive, class Smooth>
constexpr typename Drive::Standing event_driven_step(const Drive& drive, const typename Drive::Standing& from, const Interval<S>& u,
                                                     const S& dt, const Smooth& smooth) {
    if (drive.sets_off(from)) return held_step(drive, drive.released(from, u.start), u, dt, smooth);
    return held_step(drive, from, u, dt, smooth);
}

}  // namespace strainwave::integrate
