#pragma once
#include <strainwave/angle.hpp>

/// Pure kinematic error e(theta_in), at the output: the difference of two encoders on a gear that transmits no torque.
namespace strainwave::kinematic_error {

template <class S>
struct Error {
    S value{0.0};  ///< rad
    S slope{0.0};  ///< rad/rad
};

/// Factor of an error under load, and its slope over the torque [1/(N.m)].
template <class S>
struct Relief {
    S factor{1.0};
    S slope{0.0};
};

/// True if an error depends on the torque that the gear transmits.
template <class Law>
constexpr bool follows_load(const Law& law) {
    if constexpr (requires { law.follows_load(); })
        return law.follows_load();
    else
        return false;
}
template <class S, class Law>
constexpr Relief<S> relief(const Law& law, const S& torque) {
    if constexpr (requires { law.relief(torque); })
        return law.relief(torque);
    else
        return {};
}

/// Turns its sign where the slope of an error jumps; 1 of an error whose slope never does.
template <class S, class Law>
constexpr S side(const Law& law, const Angle<S>& angle) {
    if constexpr (requires { law.side(angle); })
        return law.side(angle);
    else
        return S(1.0);
}

}  // namespace strainwave::kinematic_error
