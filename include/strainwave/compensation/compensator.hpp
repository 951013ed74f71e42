#pragma once
#include <strainwave/angle.hpp>
#include <strainwave/control/law.hpp>

/// Compensators: additions to a controller that reduce the errors which the gear causes. A sampled controller evaluates them at
/// each sampling instant.
///
/// A feed-forward contains a model of the drive and uses no measurement. It has
///
///     State
///     step(state, command, period) -> RequestAndState: its request, and its state after the period
///
/// An observer or a learning compensator uses measurements. It has
///
///     State
///     request(state, inputs) -> Request: its own request, without those in the inputs
///     advance(state, inputs, request, motor_torque, period) -> State after the period, in which the motor gave a torque [N.m]
namespace strainwave::compensation {

/// True if a compensator changes the command. For a choice, that of the chosen compensator.
template <class Compensator>
constexpr bool active(const Compensator& compensator) {
    if constexpr (requires { compensator.active(); })
        return compensator.active();
    else
        return true;
}

/// Request of a compensator: a lead of the input angle and a torque of the motor.
template <class S>
struct Request {
    S input_lead{0.0};       ///< lead of the input angle over `ratio * command`, rad
    S input_lead_rate{0.0};  ///< rad/s
    S torsion{0.0};          ///< share of `input_lead` that takes up the twist of the gear, rad
    S torque{0.0};           ///< of the motor, N.m
    S friction{0.0};         ///< share of `torque` that overcomes friction, N.m

    constexpr Request operator+(const Request& other) const {
        return {input_lead + other.input_lead, input_lead_rate + other.input_lead_rate, torsion + other.torsion,
                torque + other.torque, friction + other.friction};
    }
};

/// Request of a feed-forward, and its state after the period.
template <class S, class State>
struct RequestAndState {
    Request<S> request;
    State next;
};

/// Inputs of a compensator: the command, the measurement and the requests of the compensators before it.
template <class S>
struct Inputs {
    control::Command<S> command;
    control::Measurement<S> measured;
    Request<S> request;

    constexpr S input_angle() const { return command.ratio * command.value + request.input_lead; }
    constexpr S input_speed() const { return command.ratio * command.rate + request.input_lead_rate; }
};

/// Sense of a set-valued friction, in [-1, 1], after its surfaces moved by an angle [rad].
template <class S>
constexpr S slid_sense(const S& sense, const S& moved, const S& presliding) {
    const S towards = sign(moved);
    const S next = towards + (sense - towards) * exp(-min(abs(moved) / presliding, S(beyond_digits)));
    return select(towards == S(0.0), sense, next);
}

}  // namespace strainwave::compensation
