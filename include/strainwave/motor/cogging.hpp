#pragma once
#include <strainwave/angle.hpp>

namespace strainwave::motor {

/// The torque with which the magnets of a rotor hold to the teeth of its stator: a sine over the angle, without loss.
template <class S>
struct CoggingTorque {
    S amplitude{0.0};  ///< N.m
    S order{1.0};      ///< periods per revolution
    bool acts = false;

    static constexpr CoggingTorque of(const S& amplitude, const S& order) {
        return {amplitude, order, is_differentiated(amplitude) || any(amplitude > S(0.0))};
    }
    /// Torque of a motor with this electric torque [N.m]; exactly that torque without cogging.
    constexpr S added_to(const S& electric, const Angle<S>& angle) const {
        return acts ? electric + amplitude * sin(order * angle.within) : electric;
    }
    /// The energy [J] of a motor, that of cogging included.
    constexpr S stored_with(const S& magnetic, const Angle<S>& angle) const {
        return acts ? magnetic + amplitude / order * cos(order * angle.within) : magnetic;
    }
};

}  // namespace strainwave::motor
