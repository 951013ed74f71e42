#pragma once
#include <strainwave/control/law.hpp>
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::control {

template <class S>
struct PID {
    S proportional{1.0};
    S integral{0.0};
    S derivative{0.0};
    S limit{48.0};
    Feedback feedback{Feedback::input};

    static constexpr auto name = "pid";
    static constexpr auto command_unit = "rad";
    static constexpr auto source = "AstromHagglund1995, chapter 3; anti-windup by conditional integration, section 3.5";
    static constexpr auto doc = R"(
        Position controller with proportional, integral and derivative gain, and a limit.

        .. math:: u = \operatorname{clip}(k_p \epsilon + k_i \textstyle\int \epsilon\,dt + k_d \dot\epsilon, \pm u_{max}), \qquad
                  \epsilon = i r - \theta_{in} \text{ or } \epsilon = i\,(r - \theta_{out})

        with r the commanded output angle [rad], i the signed ratio, k_p = proportional, k_i = integral, k_d = derivative,
        u_max = limit. The error is that of the encoder that feedback names. If it is the encoder of the motor, on the input
        shaft, the loop does not correct kinematic error and wind-up of the gear. If it is the encoder of the output shaft, the
        loop corrects them. The error is referred to the input, so that the gains have the same meaning. The integral grows up
        to the limits of controller and motor. Beyond a limit its rate falls, to zero at 5 % of the range between the limits.

        The units below are those of a motor that takes a voltage u. For a motor that takes a current or a torque read A or N.m
        in place of V.

        >>> from strainwave.control import PID
        >>> PID(proportional=2.0, derivative=0.05, limit=48.0).integral
        0.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, proportional, "V/rad", "Voltage per input angle", 0));
        visit(SW_FIELD(m, integral, "V/(rad.s)", "Voltage per integral of the input angle error", 0));
        visit(SW_FIELD(m, derivative, "V.s/rad", "Voltage per input speed error", 0));
        visit(SW_FIELD(m, limit, "V", "Largest voltage, of either sign", smallest));
        visit(SW_FIELD(m, feedback, "1", "The shaft whose encoder the loop closes on"));
    }

    struct State {
        S error_integral{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, error_integral, "rad.s", "Integral of the input angle error"));
        }
    };

    constexpr S act(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        return measured.limits.within(limit).limited(unlimited(x, error(command, measured), command.feedforward));
    }
    constexpr State rate(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        const Error now = error(command, measured);
        return {measured.limits.within(limit).integral_rate(unlimited(x, now, command.feedforward), now.angle)};
    }
    constexpr State relaxation_rate() const { return {}; }

private:
    /// Commanded minus measured, at the input.
    struct Error {
        S angle, speed;
    };
    constexpr Error error(const Command<S>& command, const Measurement<S>& measured) const {
        return {angle_error(feedback, command, measured), speed_error(feedback, command.rate, command, measured)};
    }
    constexpr S unlimited(const State& x, const Error& now, const S& feedforward) const {
        return proportional * now.angle + integral * x.error_integral + derivative * now.speed + feedforward;
    }
};

}  // namespace strainwave::control
