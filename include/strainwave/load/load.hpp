#pragma once
#include <strainwave/field.hpp>

/// What every load is asked. It has an inertia and a torque(output angle), or prescribes the motion of the output shaft.
namespace strainwave::load {

/// The input of a load that names no other.
inline constexpr Field torque_input{"load_torque", "N.m", "Torque that holds the output back, besides the load's own"};

/// Whether a load takes the output shaft where its input says; of a choice, whether one of its loads does.
template <class Load>
inline constexpr bool can_prescribe = requires { Load::prescribes; };

/// kg.m2: of a shaft that no torque moves.
inline constexpr double immovable = 1e30;

}  // namespace strainwave::load

namespace strainwave {

template <class Load>
constexpr bool prescribes(const Load&) {
    return load::can_prescribe<Load>;
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
