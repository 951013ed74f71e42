#pragma once
#include <strainwave/kinematics.hpp>

#include "part.hpp"

namespace strainwave::general {

/// Rigid motion by any law: each comes down to a ratio.
template <class S>
struct Kinematics : kinematics::Reduction<S> {
    void read(kernel::Reader<S>& from);
};

}  // namespace strainwave::general
