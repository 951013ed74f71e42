#pragma once
#include <strainwave/limits.hpp>

/// Interface of a controller. A law of control turns a command and a measurement into the actuation of the motor: its voltage,
/// current or torque. It has
///
///     State                                 continuous numbers; Stateless if there are none
///     act(state, command, measurement)      -> actuation
///     rate(state, command, measurement)     -> State
///     relaxation_rate()                     -> State, 1/s: relaxation rate of each number to its input; 0 of an integral
///
/// and, if it does not act on every motor,
///
///     gives                                 the actuation that a motor must take, by name
///     needs_current()                       true if it acts by the measured current, without delay
///
/// A law that acts at instants only also has
///
///     Discrete                              numbers that change at its instants only
///     held(discrete)                        -> actuation, in place of act
///     due(discrete, within)                 -> true if this is an instant, in any lane, or one is within so many seconds
///     sampled(discrete, within, command, measurement) -> Discrete, where it is due
///     elapsed(discrete, dt)                 -> Discrete, `dt` [s] later
///     schedule(discrete)                    -> Schedule
namespace strainwave::control {

/// Command of a drive at one instant.
template <class S>
struct Command {
    S value{0.0};            ///< As the scenario gives it
    S rate{0.0};             ///< Its time derivative
    S ratio{1.0};            ///< Signed, of the gear: input angle per output angle
    S input_lead{0.0};       ///< lead of the input angle over `ratio * value`, rad
    S input_lead_rate{0.0};  ///< rad/s
    S feedforward{0.0};      ///< added to the output of the law, in its unit

    constexpr S input_angle() const { return ratio * value + input_lead; }
    constexpr S input_speed() const { return ratio * rate + input_lead_rate; }
};

/// Measurement of a controller: each number through its sensor, and the limits of its motor.
template <class S>
struct Measurement {
    S input_angle{0.0}, input_speed{0.0}, output_angle{0.0}, output_speed{0.0}, current{0.0}, torque{0.0};
    Limits<S> limits{};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, input_angle, "rad", "Input angle"));
        visit(SW_FIELD(m, input_speed, "rad/s", "Input speed"));
        visit(SW_FIELD(m, output_angle, "rad", "Output angle"));
        visit(SW_FIELD(m, output_speed, "rad/s", "Output speed"));
        visit(SW_FIELD(m, current, "A", "Motor current, under the actuation that a sampled controller holds"));
        visit(SW_FIELD(m, torque, "N.m", "Torque transmitted, at the output"));
        visit(SW_PART(m, limits, "Limits of the actuation that the motor can follow"));
    }
};

/// The encoder that a position loop closes on.
enum class Feedback { input, output };
constexpr Array<const char*, 2> choices(Feedback) { return {{"input", "output"}}; }

/// Commanded minus measured, of the shaft whose encoder the loop closes on, at the input: of angles [rad] and of speeds [rad/s].
template <class S>
constexpr S angle_error(Feedback feedback, const Command<S>& command, const Measurement<S>& measured) {
    if (feedback == Feedback::output) return command.ratio * command.value - command.ratio * measured.output_angle;
    return command.input_angle() - measured.input_angle;
}
/// `commanded`: the output speed.
template <class S>
constexpr S speed_error(Feedback feedback, const S& commanded, const Command<S>& command, const Measurement<S>& measured) {
    if (feedback == Feedback::output) return command.ratio * commanded - command.ratio * measured.output_speed;
    return command.ratio * commanded + command.input_lead_rate - measured.input_speed;
}

/// When a sampled law acts next [s from now]: at the first instant, and on in periods. A period of 0: it acts all the time.
template <class S>
struct Schedule {
    S first{0.0}, period{0.0}, delay{0.0};
};

namespace detail {
template <class S, class Law>
struct DiscreteOf {
    using type = Stateless<S>;
};
template <class S, class Law>
    requires requires { typename Law::Discrete; }
struct DiscreteOf<S, Law> {
    using type = typename Law::Discrete;
};
}  // namespace detail
/// Numbers that change at the instants of a law only; none for a continuous law.
template <class S, class Law>
using DiscreteOf = typename detail::DiscreteOf<S, Law>::type;

/// Actuation that the motor of a law must take, by name; nothing if any is possible.
template <class Law>
constexpr const char* given_by(const Law& law) {
    if constexpr (requires { law.gives(); })
        return law.gives();
    else if constexpr (requires { Law::gives; })
        return Law::gives;
    else if constexpr (requires { law.law; })
        return given_by(law.law);
    else
        return "";
}

/// True for a law that follows a commanded output angle.
template <class Law>
constexpr bool follows_angle(const Law& law) {
    if constexpr (requires { law.follows_angle(); })
        return law.follows_angle();
    else if constexpr (requires { Law::command_unit; })
        return same(Law::command_unit, "rad");
    else
        return false;
}

inline constexpr double max_ratio_error = 1e-3;  ///< relative, of the ratio of a model of the gear

/// Ratio of the gear of which a law or a compensator has a model; 0 if it has none.
template <class S, class Law>
constexpr S model_ratio(const Law& law) {
    if constexpr (requires { law.model_ratio(); })
        return law.model_ratio();
    else
        return S(0.0);
}

/// Longest sample period [s] of a law or a compensator; unbounded if it has none.
template <class S, class Law>
constexpr S max_period(const Law& law) {
    if constexpr (requires { law.max_period(); })
        return law.max_period();
    else
        return S(unbounded);
}

/// True if a law acts at once by the measured current: then the current must not follow the actuation at once.
template <class Law>
constexpr bool needs_current(const Law& law) {
    if constexpr (requires { law.needs_current(); })
        return law.needs_current();
    else
        return false;
}

template <class S, class Law, class State, class Discrete>
constexpr S actuation(const Law& law, const State& x, const Discrete& held, const Command<S>& command,
                      const Measurement<S>& measured) {
    if constexpr (requires { law.actuation(x, held, command, measured); })
        return law.actuation(x, held, command, measured);
    else if constexpr (requires { typename Law::Discrete; })
        return law.held(held);
    else
        return law.act(x, command, measured);
}

/// The actuation that a law holds from its last instant; 0 of one that acts all the time.
template <class S, class Law, class Discrete>
constexpr S held(const Law& law, const Discrete& x) {
    if constexpr (requires { law.held(x); })
        return law.held(x);
    else
        return S(0.0);
}

template <class S, class Law, class Discrete>
constexpr Discrete sampled(const Law& law, const Discrete& x, const S& within, const Command<S>& command,
                           const Measurement<S>& measured) {
    if constexpr (requires { law.sampled(x, within, command, measured); })
        return law.sampled(x, within, command, measured);
    else
        return x;
}

template <class S, class Law, class Discrete>
constexpr Discrete elapsed(const Law& law, const Discrete& x, const S& dt) {
    if constexpr (requires { law.elapsed(x, dt); })
        return law.elapsed(x, dt);
    else
        return x;
}

/// True if a law changes a number at this instant, in any lane.
template <class S, class Law, class Discrete>
constexpr bool due(const Law& law, const Discrete& x, const S& within) {
    if constexpr (requires { law.due(x, within); })
        return law.due(x, within);
    else
        return false;
}

template <class S, class Law>
constexpr auto initial_discrete(const Law& law) {
    if constexpr (requires { law.initial_discrete(); })
        return law.initial_discrete();
    else
        return DiscreteOf<S, Law>{};
}

template <class S, class Law, class Discrete>
constexpr Schedule<S> schedule(const Law& law, const Discrete& x) {
    if constexpr (requires { law.schedule(x); })
        return law.schedule(x);
    else
        return {};
}

}  // namespace strainwave::control
