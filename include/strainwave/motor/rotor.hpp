#pragma once
#include <strainwave/angle.hpp>
#include <strainwave/limits.hpp>

/// Interface of a motor. A motor turns the actuation of its controller into a torque. It has
///
///     State, Output                        continuous numbers, and channels in recordings
///     actuation                            the name of the output that is the actuation
///     inertia                              kg.m2
///     torque(state, actuation, rotor)      -> N.m
///     current(state, actuation, rotor)     -> A, as its sensor finds it
///     output(state, actuation, rotor)      -> Output
///     power(state, actuation, rotor)       -> Power
///     rate(state, actuation, rotor)        -> State
///     relaxation_rate()                    -> State, 1/s
///
/// and, if it cannot follow every actuation,
///
///     limits(state, rotor)                 -> Limits
///
/// and, if its currents change faster by themselves than by the relaxation rate,
///
///     fastest()                            -> rad/s, which fixed steps must follow
///
/// and, if it prescribes the motion of the input shaft, so that its torque is a result,
///
///     acceleration(actuation)              -> rad/s2
namespace strainwave::motor {

/// Angle, speed and torque of the shaft of a motor, and temperature of its winding.
template <class S>
struct Rotor {
    Angle<S> angle{};
    S speed{0.0};        ///< rad/s
    S temperature{0.0};  ///< K
    S torque{0.0};       ///< N.m, that a prescribed motion needs; 0 until that is known, and of every other motor
};

/// True for a motor that prescribes the motion of the input shaft; of a choice, if one of its motors does.
template <class Motor>
inline constexpr bool can_prescribe = requires(const Motor& motor) { motor.acceleration(0.0); };

template <class Motor>
constexpr bool prescribes(const Motor& motor) {
    if constexpr (requires { motor.prescribes(); })
        return motor.prescribes();
    else
        return can_prescribe<Motor>;
}

/// The acceleration [rad/s2] that a motor prescribes; 0 of one that prescribes none.
template <class S, class Motor>
constexpr S acceleration(const Motor& motor, const S& actuation) {
    if constexpr (can_prescribe<Motor>)
        return motor.acceleration(actuation);
    else
        return S(0.0);
}

/// Electrical power of a motor: supplied, lost and stored.
template <class S>
struct Power {
    S supplied;  ///< W, taken from outside
    S lost;      ///< W, turned into heat
    S stored;    ///< J, held by now
};

template <class S, class Motor, class State>
constexpr Limits<S> limits(const Motor& motor, const State& x, const Rotor<S>& rotor) {
    if constexpr (requires { motor.limits(x, rotor); })
        return motor.limits(x, rotor);
    else
        return {};
}

/// The name of the actuation of a motor.
template <class Motor>
constexpr const char* taken_by(const Motor& motor) {
    if constexpr (requires { motor.actuation(); })
        return motor.actuation();
    else
        return Motor::actuation;
}

/// True if the current of a motor is a state: it does not follow the actuation at once.
template <class S, class Motor>
constexpr bool has_current(const Motor& motor) {
    if constexpr (requires { motor.has_current(); }) {
        return motor.has_current();
    } else if constexpr (size_of<S, decltype(motor.relaxation_rate())> == 0) {
        return false;
    } else {
        const auto rates = flattened<S>(motor.relaxation_rate());
        return rates.size() > 0 && all(rates[0] > S(0.0));
    }
}

}  // namespace strainwave::motor
