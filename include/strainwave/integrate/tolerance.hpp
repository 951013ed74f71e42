#pragma once

namespace strainwave::integrate {

/// Error allowed of a continuous number, and of the watched one: `absolute`, in its own unit, plus `relative` times the largest it
/// has been.
struct Tolerance {
    double relative = 1e-6;
    double absolute = 1e-12;
};

}  // namespace strainwave::integrate
