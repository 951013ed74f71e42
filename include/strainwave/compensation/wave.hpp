#pragma once
#include <strainwave/math.hpp>

namespace strainwave::compensation {

/// Sine and cosine of `order * angle - phase`. Whole turns are taken out first, to keep the digits of large angles.
template <class S>
constexpr SinCos<S> wave(const S& order, const S& angle, const S& phase) {
    const S turns = rint(angle * S(0.5 / pi)), turned = order * turns;
    const S within = order * (angle - S(2.0 * pi) * turns);
    return sincos(within - phase + S(2.0 * pi) * (turned - rint(turned)));
}

/// Hat function: 1 at 0, falling to 0 at a distance of 1.
template <class S>
constexpr S hat(const S& apart) {
    return max(S(1.0) - abs(apart), S(0.0));
}

}  // namespace strainwave::compensation
