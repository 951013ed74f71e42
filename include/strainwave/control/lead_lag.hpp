#pragma once
#include <strainwave/control/law.hpp>

namespace strainwave::control {

template <class S>
struct LeadLag {
    S gain{1.0};
    S lead_numerator{0.05};
    S lead_denominator{0.005};
    S lag_numerator{1.0};
    S lag_denominator{1.0};
    S limit{48.0};
    Feedback feedback{Feedback::input};

    static constexpr auto name = "lead_lag";
    static constexpr auto command_unit = "rad";
    static constexpr auto source = "FranklinPowellEmamiNaeini2002, section 6.7";
    static constexpr auto doc = R"(
        Position controller of two first-order sections: lead and lag.

        .. math:: u = \operatorname{clip}\left(k\, \frac{1 + a_1 s}{1 + b_1 s}\, \frac{1 + a_2 s}{1 + b_2 s}\, \epsilon,
                  \pm u_{max}\right)

        with epsilon the angle error of the shaft that feedback names, referred to the input: i r - theta_in or i (r -
        theta_out); k = gain, a_1, b_1 = lead_numerator, lead_denominator, a_2, b_2 = lag_numerator, lag_denominator, u_max =
        limit. The first section leads if a_1 > b_1, the second lags if a_2 < b_2. Either section can do either. Both begin at
        rest. Steps of a fixed length must not be longer than 2.5 times the shorter of b_1 and b_2, unless the controller is
        sampled. The first section of a sampled controller is exact for an error that is constant over a period. The second is
        of first order in the period: it takes the output of the first as constant over the period.

        The units below are those of a motor that takes a voltage u. For a motor that takes a current or a torque read A or N.m
        in place of V.

        >>> from strainwave.control import LeadLag
        >>> LeadLag(gain=2.0, lead_numerator=0.02, lead_denominator=0.002).limit
        48.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, gain, "V/rad", "Voltage per error of the input angle, at rest", 0));
        visit(SW_FIELD(m, lead_numerator, "s", "Time constant a_1", 0));
        visit(SW_FIELD(m, lead_denominator, "s", "Time constant b_1", smallest));
        visit(SW_FIELD(m, lag_numerator, "s", "Time constant a_2", 0));
        visit(SW_FIELD(m, lag_denominator, "s", "Time constant b_2", smallest));
        visit(SW_FIELD(m, limit, "V", "Largest voltage, of either sign", smallest));
        visit(SW_FIELD(m, feedback, "1", "The shaft whose encoder the loop closes on"));
    }

    struct State {
        S lead{0.0}, lag{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, lead, "rad", "Error through the first denominator"));
            visit(SW_FIELD(m, lag, "rad", "Output of the first section through the second denominator"));
        }
    };

    constexpr S act(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        const S lag = section(lead(x, command, measured), x.lag, lag_numerator / lag_denominator);
        return measured.limits.within(limit).limited(gain * lag + command.feedforward);
    }
    constexpr State rate(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        return {(error(command, measured) - x.lead) / lead_denominator, (lead(x, command, measured) - x.lag) / lag_denominator};
    }
    constexpr State relaxation_rate() const { return {S(1.0) / lead_denominator, S(1.0) / lag_denominator}; }
    /// A Runge-Kutta step of fourth order is stable up to 2.78 times the time of a decay.
    constexpr S fastest() const { return S(1.0 / 2.5) / min(lead_denominator, lag_denominator); }

private:
    static constexpr S section(const S& given, const S& filtered, const S& jump) { return filtered + jump * (given - filtered); }
    constexpr S lead(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        return section(error(command, measured), x.lead, lead_numerator / lead_denominator);
    }
    constexpr S error(const Command<S>& command, const Measurement<S>& measured) const {
        return angle_error(feedback, command, measured);
    }
};

}  // namespace strainwave::control
