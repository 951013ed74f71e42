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

/// True if an error depends on the temperature of the gear.
template <class Law>
constexpr bool follows_temperature(const Law& law) {
    if constexpr (requires { law.follows_temperature(); })
        return law.follows_temperature();
    else
        return false;
}
/// The error of a gear at a temperature [K].
template <class S, class Law>
constexpr Error<S> warmed(const Law& law, const Angle<S>& angle, const S& temperature) {
    if constexpr (requires { law.warmed(angle, temperature); })
        return law.warmed(angle, temperature);
    else
        return law.at(angle);
}
/// Rise of an error per kelvin [rad/K] at a constant angle.
template <class S, class Law>
constexpr S per_kelvin(const Law& law, const Angle<S>& angle) {
    if constexpr (requires { law.per_kelvin(angle); })
        return law.per_kelvin(angle);
    else
        return S(0.0);
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
