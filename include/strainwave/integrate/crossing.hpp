#pragma once
#include <strainwave/math.hpp>

namespace strainwave::integrate {

/// Return the first moment within (from, 1] at which the margin falls below zero, in lanes where it does by the end; 1 in the
/// others. Anderson and Bjorck's variant of regula falsi, which closes a bracket around it; and of that the end, for before a
/// margin jumps the side is not determined.
template <class S, class Margin>
constexpr S crossing(const Margin& margin, const S& from, const S& at_start, const S& at_end) {
    // Less than a state so close by differs from its rounding, and some units in the last place of the moment: a float resolves no
    // less, and all 80 rounds would be taken.
    const S within(sizeof(Real<S>) < sizeof(double) ? 0x1p-21 : 1e-12);
    const auto crosses = at_end < S(0.0);
    S a = from, b{1.0}, fa = value_only(max(at_start, S(0.0))), fb = value_only(at_end), last{0.0};
    for (int i = 0; i < 80; ++i) {
        const auto searching = crosses & (b - a > within) & !(fb == S(0.0));  // a lane that has found its moment keeps it
        if (!any(searching)) break;
        const S secant = b - fb * (b - a) / select(searching, fb - fa, S(-1.0)), middle = S(0.5) * (a + b);
        const auto serves = (secant > a) & (secant < b) & (S(i) < S(20.0));  // it finds no jump
        // Away from the ends, so that a guess next to the moment closes the bracket.
        const S guess = clip(select(serves, secant, middle), a + S(0.5) * within, b - S(0.5) * within);
        const S f = value_only(margin(select(searching, guess, b)));
        const auto before = f > S(0.0);
        // The end that stays for the second time counts less, or it would hold the secant back.
        const auto again = f * last > S(0.0);
        const S weight = select(again, max(S(1.0) - f / select(again, last, S(1.0)), S(0.1)), S(1.0));
        fa = select(before, f, weight * fa);
        fb = select(searching, select(before, weight * fb, f), fb);
        last = f;
        a = select(searching & before, guess, a);
        b = select(searching & !before, guess, b);
    }
    if constexpr (differentiates<S>)  // the moment moves with the parameters
        return select(crosses, moving_root(margin, b), b);
    else
        return b;
}

}  // namespace strainwave::integrate
