#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave {

/// An angle as the drive carries it: exact after any number of turns.
template <class S>
struct Angle {
    S within{0.0};  ///< rad, in [-pi, pi]
    S turns{0.0};   ///< whole revolutions
};

/// An angle [rad] in turns and the rest.
template <class S>
constexpr Angle<S> reduced(const S& angle) {
    const S turns = rint(angle * S(0.5 / pi));
    return {angle - S(2.0 * pi) * turns, turns};
}

}  // namespace strainwave
