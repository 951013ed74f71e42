#pragma once
#include <strainwave/control/reference.hpp>
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::control {

template <class S>
struct PID {
    S proportional{1.0};
    S integral{0.0};
    S derivative{0.0};
    S limit{48.0};

    static constexpr auto name = "pid";
    static constexpr auto command_unit = "rad";
    static constexpr auto source = "AstromHagglund1995, chapter 3; anti-windup by conditional integration, section 3.5";
    static constexpr auto doc = R"(
        Position controller at the input: proportional, integral, derivative, with the supply voltage as limit.

        .. math:: u = \operatorname{clip}(k_p \epsilon + k_i \textstyle\int \epsilon\,dt + k_d \dot\epsilon, \pm u_{max}), \qquad
                  \epsilon = i r - \theta_{in}

        with r the commanded output angle [rad], i the signed ratio, theta_in the input angle, k_p = proportional,
        k_i = integral, k_d = derivative, u_max = limit. The integral rests while the voltage is limited. The feedback is the
        motor's encoder, so error and wind-up of the gear stay outside the loop.

        >>> from strainwave.control import PID
        >>> PID(proportional=2.0, derivative=0.05, limit=48.0).integral
        0.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, proportional, "V/rad", "Voltage per input angle", 0));
        visit(SW_FIELD(m, integral, "V/(rad.s)", "Voltage per integral of the input angle error", 0));
        visit(SW_FIELD(m, derivative, "V.s/rad", "Voltage per input speed error", 0));
        visit(SW_FIELD(m, limit, "V", "Largest voltage, of either sign", smallest));
    }

    struct State {
        S error_integral{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, error_integral, "rad.s", "Integral of the input angle error"));
        }
    };

    constexpr S voltage(const State& x, const Reference<S>& reference) const {
        return clip(unlimited(x, reference), -limit, limit);
    }
    constexpr State rate(const State& x, const Reference<S>& reference) const {
        return {select(abs(unlimited(x, reference)) < limit, reference.position_error, S(0.0))};
    }

private:
    constexpr S unlimited(const State& x, const Reference<S>& reference) const {
        return proportional * reference.position_error + integral * x.error_integral + derivative * reference.speed_error;
    }
};

}  // namespace strainwave::control
