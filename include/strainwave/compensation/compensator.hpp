#pragma once
#include <strainwave/control/law.hpp>

/// What takes away what the gear does to the motion, beside the controller. A sampled controller asks it at its instants.
///
/// A feed-forward knows the drive beforehand. It has
///
///     State
///     planned(state, command, period)            -> Planned: what it asks for, and its state a period later
///
/// An observer or a learning compensator goes by what is measured. It has
///
///     State
///     added(state, plan)                         -> Asked, to which it adds its own
///     advance(state, plan, asked, given, period) -> State, a period later; `given` is the torque of the motor [N.m]
namespace strainwave::compensation {

/// Whether a compensator makes any difference; asked of a choice, the one chosen.
template <class Compensator>
constexpr bool active(const Compensator& compensator) {
    if constexpr (requires { compensator.active(); })
        return compensator.active();
    else
        return true;
}

/// What is asked for beside the controller.
template <class S>
struct Asked {
    S input_lead{0.0};       ///< How far the input is to lead the rigid motion, rad
    S input_lead_rate{0.0};  ///< rad/s
    S torque{0.0};           ///< of the motor, N.m
    S friction{0.0};         ///< what of it overcomes friction, N.m

    constexpr Asked operator+(const Asked& other) const {
        return {input_lead + other.input_lead, input_lead_rate + other.input_lead_rate, torque + other.torque,
                friction + other.friction};
    }
};

/// What a feed-forward asks for, and its state a period later.
template <class S, class State>
struct Planned {
    Asked<S> asked;
    State later;
};

/// What a compensator goes by: what is commanded, measured and asked for already.
template <class S>
struct Plan {
    control::Command<S> command;
    control::Measurement<S> measured;
    Asked<S> asked;

    constexpr S input_angle() const { return command.ratio * command.value + asked.input_lead; }
    constexpr S input_speed() const { return command.ratio * command.rate + asked.input_lead_rate; }
};

}  // namespace strainwave::compensation
