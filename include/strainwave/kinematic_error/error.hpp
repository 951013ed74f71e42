#pragma once
#include <strainwave/angle.hpp>

/// Pure kinematic error e(theta_in), at the output: what two encoders see of a gear that transmits no torque.
namespace strainwave::kinematic_error {

template <class S>
struct Error {
    S value{0.0};  ///< rad
    S slope{0.0};  ///< rad/rad
};

}  // namespace strainwave::kinematic_error
