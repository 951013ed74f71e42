#pragma once
#include <strainwave/control/law.hpp>

namespace strainwave::control {

template <class S>
struct PositionSpeed {
    S position_gain{20.0};
    S speed_proportional{0.05};
    S speed_integral{0.0};
    S speed_limit{500.0};
    S limit{10.0};
    S speed_feedforward{0.0};
    S viscous_feedforward{0.0};
    S coulomb_feedforward{0.0};
    Feedback feedback{Feedback::input};

    static constexpr auto name = "position_speed";
    static constexpr auto command_unit = "rad";
    static constexpr auto source =
        "GrossHamannWiegaertner2001, cascade of position and speed; anti-windup by conditional integration: AstromHagglund1995, "
        "section 3.5";
    static constexpr auto doc = R"(
        Position loop around a speed loop, for motors that take a current or a torque.

        .. math:: \omega_r = \operatorname{clip}(k_p \epsilon + f\, i \dot r, \pm \omega_{max}), \qquad
                  u = \operatorname{clip}(k_s (\omega_r - \omega) + k_i \textstyle\int (\omega_r - \omega)\,dt
                  + b\, i \dot r + c \operatorname{sgn}(i \dot r), \pm u_{max})

        with r the commanded output angle, i the signed ratio, omega the input speed, epsilon the error of the angle, referred
        to the input: that of the input shaft, i r - theta_in, or of the output shaft, i (r - theta_out), as feedback names it.
        k_p = position_gain, k_s = speed_proportional, k_i = speed_integral, f, b, c = speed_, viscous_ and
        coulomb_feedforward, omega_max = speed_limit, u_max = limit. The integral grows up to the limits of controller and
        motor. Beyond a limit its rate falls, to zero at 5 % of the range between the limits.

        The units below are those of a motor that takes a current u. For a motor that takes a torque or a voltage read N.m or V
        in place of A.

        >>> from strainwave.control import PositionSpeed
        >>> PositionSpeed(position_gain=30.0, speed_proportional=0.1, speed_integral=2.0).speed_limit
        500.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, position_gain, "1/s", "Input speed per error of the input angle", 0));
        visit(SW_FIELD(m, speed_proportional, "A.s/rad", "Current per error of the input speed", 0));
        visit(SW_FIELD(m, speed_integral, "A/rad", "Current per integral of the error of the input speed", 0));
        visit(SW_FIELD(m, speed_limit, "rad/s", "Largest input speed that is requested", smallest));
        visit(SW_FIELD(m, limit, "A", "Largest current, of either sign", smallest));
        visit(SW_FIELD(m, speed_feedforward, "1", "Share of the commanded speed that is requested without any error"));
        visit(SW_FIELD(m, viscous_feedforward, "A.s/rad", "Current per commanded input speed"));
        visit(SW_FIELD(m, coulomb_feedforward, "A", "Current in the sense of the commanded speed"));
        visit(SW_FIELD(m, feedback, "1", "The shaft whose encoder the position loop closes on"));
    }

    struct State {
        S speed_integral{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, speed_integral, "rad", "Integral of the error of the input speed"));
        }
    };

    constexpr S act(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        return measured.limits.within(limit).limited(asked(x, command, measured));
    }
    constexpr State rate(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        return {measured.limits.within(limit).integral_rate(asked(x, command, measured), speed_error(command, measured))};
    }
    constexpr State relaxation_rate() const { return {}; }

    /// Actuation before any limit.
    constexpr S asked(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        const S commanded = command.input_speed();
        return speed_proportional * speed_error(command, measured) + speed_integral * x.speed_integral +
               viscous_feedforward * commanded + coulomb_feedforward * sign(commanded) + command.feedforward;
    }
    constexpr S speed_error(const Command<S>& command, const Measurement<S>& measured) const {
        const S wanted = position_gain * angle_error(feedback, command, measured) + speed_feedforward * command.input_speed();
        return clip(wanted, -speed_limit, speed_limit) - measured.input_speed;
    }
};

}  // namespace strainwave::control
