#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

/// Friction torque opposes the motion of the side it acts on.
namespace strainwave::friction {

/// How the two surfaces of a side move against each other.
template <class S>
struct Contact {
    S speed{0.0};    ///< rad/s
    S sliding{1.0};  ///< Sense of sliding of a set-valued law: -1, 1, or 0 while it sticks

    /// Sliding at `speed`, as a measurement at constant speed has it.
    static constexpr Contact at(const S& speed) { return {speed, sign(speed)}; }
};

/// A law that can hold a side at rest: while it sticks it balances any torque up to `hold()`.
template <class Law>
concept SetValued = requires(const Law& law) { law.hold(); };

/// A law with internal state that relaxes: rate = forcing - decay * state.
template <class Law>
concept Bristle = requires(const Law& law) { law.decay({}); };

/// Torque [N.m] that opposes steady sliding at `speed` [rad/s], all transients gone.
template <class Law, class S>
constexpr S steady(const Law& law, const S& speed) {
    if constexpr (requires { law.settled(speed); })
        return law.torque(law.settled(speed), Contact<S>::at(speed));
    else
        return law.torque({}, Contact<S>::at(speed));
}

}  // namespace strainwave::friction
