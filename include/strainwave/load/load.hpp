#pragma once
#include <strainwave/field.hpp>

/// Interface of a load. It has
///
///     inertia                       kg.m2
///     torque(angle, speed)          -> N.m, holding the output back
///
/// or prescribes the motion of the output shaft. A load names its input, unless that is a torque that adds to its own. One that
/// holds the output shaft at rest, as a brake, has besides
///
///     slip(input)                   -> N.m, against slip of either sense
///     hold(input)                   -> N.m, the most that it balances at rest
///
/// and one whose torque follows the angle
///
///     steepest()                    -> N.m/rad, steepest slope of the torque over the angle, without sign
namespace strainwave::load {

/// The input of a load that names no other.
inline constexpr Field torque_input{"load_torque", "N.m", "Torque that holds the output back, besides the load's own"};

/// True for a load that prescribes the motion of the output shaft; of a choice, if one of its loads does.
template <class Load>
inline constexpr bool can_prescribe = requires { Load::prescribes; };

/// True for a load that brakes the output shaft; of a choice, if one of its loads does.
template <class Load>
inline constexpr bool can_brake = requires(const Load& load) { load.hold(0.0); };

/// kg.m2: of a shaft that no torque moves.
inline constexpr double immovable = 1e30;

}  // namespace strainwave::load

namespace strainwave {

template <class Load>
constexpr bool prescribes(const Load&) {
    return load::can_prescribe<Load>;
}

template <class Load>
constexpr bool brakes(const Load&) {
    return load::can_brake<Load>;
}

/// Torque of a load against slip, and the largest torque that it balances at rest, N.m.
template <class S>
struct Braking {
    S slip{0.0}, hold{0.0};
};
template <class S, class Load>
constexpr Braking<S> braking(const Load& load, const S& input) {
    if constexpr (requires { load.braking(input); })
        return load.braking(input);
    else if constexpr (requires { load.hold(input); })
        return {load.slip(input), load.hold(input)};
    else
        return {};
}

/// The torque [N.m] of a load, without braking, that holds the output back.
template <class S, class Load>
constexpr S load_torque(const Load& load, const S& angle, const S& speed, const S& input) {
    if constexpr (requires { load.load_torque(angle, speed, input); })
        return load.load_torque(angle, speed, input);
    else if constexpr (requires { Load::input; })
        return load.torque(angle, speed);
    else
        return load.torque(angle, speed) + input;
}

/// Steepest slope of the torque of a load over the output angle [N.m/rad].
template <class S, class Load>
constexpr S load_stiffness(const Load& load) {
    if constexpr (requires { load.steepest(); })
        return load.steepest();
    else
        return S(0.0);
}

/// The inertia of a part [kg.m2].
template <class S, class Part>
constexpr S inertia_of(const Part& part) {
    if constexpr (load::can_prescribe<Part>)
        return S(load::immovable);
    else
        return part.inertia;
}

}  // namespace strainwave
