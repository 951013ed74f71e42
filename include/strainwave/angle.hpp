#pragma once
#include <strainwave/field.hpp>

namespace strainwave {

/// An angle as the drive carries it: exact after any number of turns.
template <class S>
struct Angle {
    S within{0.0};  ///< rad, in [-pi, pi]
    S turns{0.0};   ///< whole revolutions
};

}  // namespace strainwave
