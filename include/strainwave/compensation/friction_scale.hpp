#pragma once
#include <strainwave/compensation/compensator.hpp>

namespace strainwave::compensation {

template <class S>
struct FrictionScale {
    S gain{1.0};
    S position_gain{20.0};
    S min_scale{0.5};
    S max_scale{1.5};
    S min_speed{1.0};

    static constexpr auto name = "friction_scale";
    static constexpr auto source = "SlotineLi1991, section 8.2: gradient of a Lyapunov function, linear in the unknown";
    static constexpr auto doc = R"(
        Observer of the friction over that of the model. Friction changes with wear and temperature.

        .. math:: \tau \leftarrow \tau + (\hat s - 1) F, \qquad \dot{\hat s} = \gamma F \sigma
                  \;\text{ where } |\omega_r| \ge \omega_{min}, \qquad \hat s \in [s_{min}, s_{max}], \qquad
                  \sigma = \omega_r - \omega + \lambda\, (\theta_r - \theta)

        with F the friction of the feed-forward, theta_r, omega_r and theta, omega the input angle and speed commanded and
        measured, gamma = gain, lambda = position_gain, that of the position loop, omega_min = min_speed, s_min, s_max =
        min_scale, max_scale. If the loop gives k sigma, and the inertia J at the input is at most k / lambda, the function J
        (sigma^2 + lambda^2 (theta_r - theta)^2) + (s - s^)^2 / gamma never grows, whatever the gain; with a delay in the loop
        gamma must be small. With lambda = 0, a motion of one sense under a position loop does not determine s. The scale is
        constant below omega_min, because rest and presliding do not determine s.

        The law of control must have no integral: PositionSpeed with speed_integral = 0. An integral supplies the missing friction
        itself, so that sigma no longer depends on s, and the scale may move the wrong way.

        >>> from strainwave.compensation import FrictionScale
        >>> FrictionScale(gain=5.0).max_scale
        1.5)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, gain, "1/(N.m.rad)", "Rate gamma of the scale per friction and error sigma", 0, 1e12));
        visit(SW_FIELD(m, position_gain, "1/s", "Weight lambda of the error of the input angle", 0));
        visit(SW_FIELD(m, min_scale, "1", "Least scale s_min, of the friction of the model", 0, 1));
        visit(SW_FIELD(m, max_scale, "1", "Largest scale s_max", 1, 10));
        visit(SW_FIELD(m, min_speed, "rad/s", "Slowest commanded input speed omega_min that determines the scale", 0));
    }

    struct State {
        S scale{1.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, scale, "1", "Friction over that of the model"));
        }
    };

    constexpr State initial_state() const { return {}; }
    constexpr Request<S> request(const State& x, const Inputs<S>& inputs) const {
        const S friction = (x.scale - S(1.0)) * inputs.request.friction;
        return {S(0.0), S(0.0), S(0.0), friction, friction};
    }
    constexpr State advance(const State& x, const Inputs<S>& inputs, const Request<S>&, const S&, const S& period) const {
        const S wanted = inputs.input_speed();
        const S error = wanted - inputs.measured.input_speed + position_gain * (inputs.input_angle() - inputs.measured.input_angle);
        const S moved = select(abs(wanted) < min_speed, S(0.0), gain * inputs.request.friction * error * period);
        return {clip(x.scale + moved, min_scale, max_scale)};
    }
};

}  // namespace strainwave::compensation
