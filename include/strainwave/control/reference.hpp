#pragma once

namespace strainwave::control {

/// What a controller compares.
template <class S>
struct Reference {
    S command{0.0};         ///< As the scenario gives it
    S position_error{0.0};  ///< rad at the input: commanded minus actual input angle
    S speed_error{0.0};     ///< rad/s at the input
};

}  // namespace strainwave::control
