#pragma once
#include <strainwave/control/position_speed.hpp>

namespace strainwave::control {

template <class S>
struct Cascade {
    S position_gain{20.0};
    S speed_proportional{0.05};
    S speed_integral{0.0};
    S current_proportional{1.0};
    S current_integral{0.0};
    S speed_limit{500.0};
    S current_limit{10.0};
    S voltage_limit{48.0};
    S speed_feedforward{0.0};
    S viscous_feedforward{0.0};
    S coulomb_feedforward{0.0};
    S back_emf_feedforward{0.0};
    Feedback feedback{Feedback::input};

    static constexpr auto name = "cascade";
    static constexpr auto command_unit = "rad";
    static constexpr auto gives = "voltage";
    static constexpr auto source =
        "GrossHamannWiegaertner2001, cascade of position, speed and current; anti-windup by conditional integration: "
        "AstromHagglund1995, section 3.5";
    static constexpr auto doc = R"(
        Position loop around a speed loop around a current loop, for motors that take a voltage.

        .. math:: u = \operatorname{clip}(k_c (i_r - i_m) + k_{ci} \textstyle\int (i_r - i_m)\,dt + K \omega, \pm u_{max})

        with i_r the current that the loops of PositionSpeed request, limited to current_limit, i_m the measured current, omega
        the measured input speed, k_c = current_proportional, k_ci = current_integral, K = back_emf_feedforward, u_max =
        voltage_limit. The motor returns the voltage that it can follow. If u_max or the motor limits the voltage, neither
        integral grows further; if the current is limited, the integral of the speed does not. The rate of the integral falls
        to zero at a limit as that of PI.

        A current loop of the bandwidth w [rad/s] around resistance R and inductance L has k_c = L w and k_ci = R w. The motor
        must have an inductance, or the controller must be sampled. Otherwise voltage and current determine each other in the
        same instant.

        >>> from strainwave.control import Cascade
        >>> law = Cascade(position_gain=30.0, speed_proportional=0.1, speed_integral=2.0, current_proportional=2.0)
        >>> law.current_limit
        10.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, position_gain, "1/s", "Input speed per error of the input angle", 0));
        visit(SW_FIELD(m, speed_proportional, "A.s/rad", "Current per error of the input speed", 0));
        visit(SW_FIELD(m, speed_integral, "A/rad", "Current per integral of the error of the input speed", 0));
        visit(SW_FIELD(m, current_proportional, "V/A", "Voltage per error of the current", 0));
        visit(SW_FIELD(m, current_integral, "V/(A.s)", "Voltage per integral of the error of the current", 0));
        visit(SW_FIELD(m, speed_limit, "rad/s", "Largest input speed that is requested", smallest));
        visit(SW_FIELD(m, current_limit, "A", "Largest current that is requested, of either sign", smallest));
        visit(SW_FIELD(m, voltage_limit, "V", "Largest voltage, of either sign", smallest));
        visit(SW_FIELD(m, speed_feedforward, "1", "Share of the commanded speed that is requested without any error"));
        visit(SW_FIELD(m, viscous_feedforward, "A.s/rad", "Current per commanded input speed"));
        visit(SW_FIELD(m, coulomb_feedforward, "A", "Current in the sense of the commanded speed"));
        visit(SW_FIELD(m, back_emf_feedforward, "V.s/rad", "Voltage per input speed, as the back-EMF takes it"));
        visit(SW_FIELD(m, feedback, "1", "The shaft whose encoder the position loop closes on"));
    }

    struct State {
        S speed_integral{0.0}, current_integral{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, speed_integral, "rad", "Integral of the error of the input speed"));
            visit(SW_FIELD(m, current_integral, "A.s", "Integral of the error of the current"));
        }
    };

    constexpr bool needs_current() const { return true; }
    constexpr S act(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        const S current_error = limited_current(asked_current(x, command, measured)) - measured.current;
        return measured.limits.within(voltage_limit).limited(asked_voltage(x, current_error, measured));
    }
    constexpr State rate(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        const S asked = asked_current(x, command, measured), current_error = limited_current(asked) - measured.current;
        const S voltage = asked_voltage(x, current_error, measured);
        const Limits<S> voltages = measured.limits.within(voltage_limit), currents{-current_limit, current_limit};
        const S speed_error = outer().speed_error(command, measured);
        return {voltages.integral_rate(voltage, currents.integral_rate(asked, speed_error)),
                voltages.integral_rate(voltage, current_error)};
    }
    constexpr State relaxation_rate() const { return {}; }

private:
    constexpr PositionSpeed<S> outer() const {
        return {position_gain,     speed_proportional,  speed_integral,      speed_limit, current_limit,
                speed_feedforward, viscous_feedforward, coulomb_feedforward, feedback};
    }
    constexpr S asked_current(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        return outer().asked({x.speed_integral}, command, measured);
    }
    constexpr S limited_current(const S& asked) const { return clip(asked, -current_limit, current_limit); }
    constexpr S asked_voltage(const State& x, const S& current_error, const Measurement<S>& measured) const {
        return current_proportional * current_error + current_integral * x.current_integral +
               back_emf_feedforward * measured.input_speed;
    }
};

}  // namespace strainwave::control
