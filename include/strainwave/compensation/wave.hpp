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

}  // namespace strainwave::compensation
