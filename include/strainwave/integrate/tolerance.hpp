#pragma once

namespace strainwave::integrate {

/// What a continuous number, and the watched one, may err by: `absolute`, in its own unit, plus `relative` times the largest it has
/// been.
struct Tolerance {
    double relative = 1e-6;
    double absolute = 1e-12;
};

}  // namespace strainwave::integrate
