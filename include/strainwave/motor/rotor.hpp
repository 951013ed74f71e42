#pragma once
#include <strainwave/angle.hpp>
#include <strainwave/limits.hpp>

/// What every motor is asked. A motor turns what its controller asks for, its actuation, into a torque. It has
///
///     State, Output                        what changes continuously, and what it shows of itself in recordings
///     actuation                            the name of the output that is what the controller gives it
///     inertia                              kg.m2
///     torque(state, actuation, rotor)      -> N.m
///     current(state, actuation, rotor)     -> A, as its sensor finds it
///     output(state, actuation, rotor)      -> Output
///     power(state, actuation, rotor)       -> Power
///     rate(state, actuation, rotor)        -> State
///     relaxation_rate()                    -> State, 1/s
///
/// and, where it cannot give all that it may be asked for,
///
///     limits(state, rotor)                 -> Limits
///
/// and, where its currents change faster by themselves than the relaxation rate says,
///
///     fastest()                            -> rad/s, which fixed steps must follow
///
/// and, where it prescribes the motion of the input shaft, its torque being a result,
///
///     acceleration(actuation)              -> rad/s2
namespace strainwave::motor {

/// How the shaft of a motor stands, and how warm its winding is.
template <class S>
struct Rotor {
    Angle<S> angle{};
    S speed{0.0};        ///< rad/s
    S temperature{0.0};  ///< K
    S torque{0.0};       ///< N.m, that a prescribed motion needs; 0 until that is known, and of every other motor
};

/// Whether a motor prescribes the motion of the input shaft; of a choice, whether one of its motors does.
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

/// Where the power goes that a motor takes and does not give to its shaft.
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

/// The name of what a motor is given by its controller.
template <class Motor>
constexpr const char* taken_by(const Motor& motor) {
    if constexpr (requires { motor.actuation(); })
        return motor.actuation();
    else
        return Motor::actuation;
}

/// Whether the current of a motor is a state: it does not follow the actuation at once.
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
