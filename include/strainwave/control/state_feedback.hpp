#pragma once
#include <strainwave/control/law.hpp>

namespace strainwave::control {

template <class S>
struct StateFeedback {
    S input_angle{0.0};
    S input_speed{0.0};
    S output_angle{0.0};
    S output_speed{0.0};
    S current{0.0};
    S torque{0.0};
    S limit{48.0};

    static constexpr auto name = "state_feedback";
    static constexpr auto command_unit = "rad";
    static constexpr auto source = "FranklinPowellEmamiNaeini2002, section 7.5";
    static constexpr auto doc = R"(
        Position controller that feeds back all measured quantities, each with its own gain.

        .. math:: u = \operatorname{clip}\big(k_1 (i r - \theta_{in}) + k_2 (i \dot r - \omega_{in}) + k_3 (r - \theta_{out})
                  + k_4 (\dot r - \omega_{out}) - k_5 i_m - k_6 T, \pm u_{max}\big)

        with r the commanded output angle, i the signed ratio, i_m the current, T the torque transmitted, k_1 to k_6 = input_angle,
        input_speed, output_angle, output_speed, current, torque, u_max = limit. ``sw.linearise`` gives the matrices from which the
        gains follow, by placing poles or as a linear-quadratic regulator.

        The units below are those of a motor that takes a voltage u. For a motor that takes a current or a torque read A or N.m
        in place of V.

        >>> from strainwave.control import StateFeedback
        >>> StateFeedback(input_angle=2.0, input_speed=0.05, torque=0.01).limit
        48.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, input_angle, "V/rad", "Voltage per error k_1 of the input angle"));
        visit(SW_FIELD(m, input_speed, "V.s/rad", "Voltage per error k_2 of the input speed"));
        visit(SW_FIELD(m, output_angle, "V/rad", "Voltage per error k_3 of the output angle"));
        visit(SW_FIELD(m, output_speed, "V.s/rad", "Voltage per error k_4 of the output speed"));
        visit(SW_FIELD(m, current, "V/A", "Voltage k_5 taken away per current"));
        visit(SW_FIELD(m, torque, "V/(N.m)", "Voltage k_6 taken away per torque transmitted"));
        visit(SW_FIELD(m, limit, "V", "Largest voltage, of either sign", smallest));
    }

    using State = Stateless<S>;

    constexpr bool needs_current() const { return is_differentiated(current) || any(!(current == S(0.0))); }
    constexpr S act(const State&, const Command<S>& command, const Measurement<S>& measured) const {
        const S of_input = input_angle * (command.input_angle() - measured.input_angle) +
                           input_speed * (command.input_speed() - measured.input_speed);
        const S of_output =
            output_angle * (command.value - measured.output_angle) + output_speed * (command.rate - measured.output_speed);
        return measured.limits.within(limit).limited(of_input + of_output - current * measured.current - torque * measured.torque +
                                                     command.feedforward);
    }
    constexpr State rate(const State&, const Command<S>&, const Measurement<S>&) const { return {}; }
    constexpr State relaxation_rate() const { return {}; }
};

}  // namespace strainwave::control
