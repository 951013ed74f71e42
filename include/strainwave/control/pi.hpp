#pragma once
#include <strainwave/control/law.hpp>

namespace strainwave::control {

template <class S>
struct PI {
    S proportional{0.1};
    S integral{0.0};
    S limit{48.0};
    Feedback feedback{Feedback::input};

    static constexpr auto name = "pi";
    static constexpr auto command_unit = "rad/s";
    static constexpr auto source = "AstromHagglund1995, chapter 3; anti-windup by conditional integration, section 3.5";
    static constexpr auto doc = R"(
        Speed controller: proportional and integral.

        .. math:: u = \operatorname{clip}(k_p \epsilon + k_i \textstyle\int \epsilon\,dt, \pm u_{max}), \qquad
                  \epsilon = i r - \omega_{in} \text{ or } \epsilon = i\,(r - \omega_{out})

        with r the commanded output speed [rad/s], i the signed ratio, k_p = proportional, k_i = integral, u_max = limit. The
        error is that of the shaft that feedback names, referred to the input. The integral grows up to the limits of
        controller and motor. Beyond a limit its rate falls, to zero at 5 % of the range between the limits.

        The units below are those of a motor that takes a voltage u. For a motor that takes a current or a torque read A or N.m
        in place of V.

        >>> from strainwave.control import PI
        >>> PI(proportional=0.2, integral=5.0).limit
        48.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, proportional, "V.s/rad", "Voltage per error of the input speed", 0));
        visit(SW_FIELD(m, integral, "V/rad", "Voltage per integral of the error of the input speed", 0));
        visit(SW_FIELD(m, limit, "V", "Largest voltage, of either sign", smallest));
        visit(SW_FIELD(m, feedback, "1", "The shaft whose speed the loop closes on"));
    }

    struct State {
        S error_integral{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, error_integral, "rad", "Integral of the error of the input speed"));
        }
    };

    constexpr S act(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        return measured.limits.within(limit).limited(asked(x, command, error(command, measured)));
    }
    constexpr State rate(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        const S now = error(command, measured);
        return {measured.limits.within(limit).integral_rate(asked(x, command, now), now)};
    }
    constexpr State relaxation_rate() const { return {}; }

private:
    constexpr S error(const Command<S>& command, const Measurement<S>& measured) const {
        return speed_error(feedback, command.value, command, measured);
    }
    constexpr S asked(const State& x, const Command<S>& command, const S& error) const {
        return proportional * error + integral * x.error_integral + command.feedforward;
    }
};

}  // namespace strainwave::control
