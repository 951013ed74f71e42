#pragma once
#include <strainwave/control/law.hpp>

/// Compensators: additions to a controller that reduce the errors which the gear causes. A sampled controller evaluates them at
/// each sampling instant.
///
/// A feed-forward contains a model of the drive and uses no measurement. It has
///
///     State
///     planned(state, command, period)            -> Planned: its request, and its state after the period
///
/// An observer or a learning compensator uses measurements. It has
///
///     State
///     added(state, plan)                         -> Asked: its own request, without those in the plan
///     advance(state, plan, asked, given, period) -> State after the period; `given` is the torque of the motor [N.m]
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
struct Asked {
    S input_lead{0.0};       ///< lead of the input angle over `ratio * command`, rad
    S input_lead_rate{0.0};  ///< rad/s
    S torque{0.0};           ///< of the motor, N.m
    S friction{0.0};         ///< share of `torque` that overcomes friction, N.m

    constexpr Asked operator+(const Asked& other) const {
        return {input_lead + other.input_lead, input_lead_rate + other.input_lead_rate, torque + other.torque,
                friction + other.friction};
    }
};

/// Request of a feed-forward, and its state after the period.
template <class S, class State>
struct Planned {
    Asked<S> asked;
    State later;
};

/// Inputs of a compensator: the command, the measurement and the requests of the compensators before it.
template <class S>
struct Plan {
    control::Command<S> command;
    control::Measurement<S> measured;
    Asked<S> asked;

    constexpr S input_angle() const { return command.ratio * command.value + asked.input_lead; }
    constexpr S input_speed() const { return command.ratio * command.rate + asked.input_lead_rate; }
};

}  // namespace strainwave::compensation
