#pragma once
#include <strainwave/compensation/compensator.hpp>
#include <strainwave/compiled.hpp>
#include <strainwave/friction/coulomb.hpp>

namespace strainwave::compensation {

/// States of a friction that follows the measured motion, and its scale.
template <class S, class Friction>
struct BristleStates {
    Friction friction{};
    S sense{0.0};
    S scale{1.0};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, friction, "State of the friction"));
        visit(SW_FIELD(m, sense, "1", "Sense of friction, in [-1, 1]"));
        visit(SW_FIELD(m, scale, "1", "Friction over that of the law"));
    }
};

template <class S, class Friction_ = friction::Coulomb<S>>
struct BristleObserver {
    using Friction = Friction_;

    Friction friction{};
    S friction_share{1.0};
    S bristle_gain{0.0};
    S position_gain{20.0};
    S gain{0.0};
    S min_scale{0.5};
    S max_scale{1.5};
    S min_speed{1.0};
    S presliding{0.002};
    S temperature{room_temperature};

    static constexpr auto name = "bristle_observer";
    static constexpr auto source =
        "CanudasDeWit1995: bristles that follow the measured speed and the error; scale: SlotineLi1991, section 8.2; "
        "presliding of the sense of friction: Dahl1968";
    static constexpr auto doc = R"(
        Observer of friction: a law of friction follows the measured input, and the motor supplies its torque.

        .. math:: \tau \leftarrow \tau - \tau_{fric} + \rho\, \hat s\, F(\hat z, \theta, \omega), \qquad
                  \dot{\hat z} = f(\hat z, v), \quad v = \omega + k \sigma, \qquad
                  \sigma = \omega_r - \omega + \lambda\, (\theta_r - \theta)

        .. math:: \dot{\hat s} = \gamma \rho F \sigma \;\text{ where } |\omega_r| \ge \omega_{min}, \qquad
                  \hat s \in [s_{min}, s_{max}]

        with ``friction`` the law of all friction at the input, F its torque, z its bristles, theta, omega and theta_r, omega_r the
        input angle and speed measured and commanded, rho = friction_share, k = bristle_gain, lambda = position_gain, gamma = gain.
        tau_fric is the friction that the feed-forward already requests. It is taken off, so no friction is supplied twice.

        k = 0 bends the bristles by the measured speed alone: friction is supplied after the input has moved. k = 1 bends them by
        omega_r + lambda (theta_r - theta). A shaft at rest then receives more torque until it breaks away, at most rho s^ times
        the breakaway torque. Bristles never leave their bounds. A set-valued law acts in the sense s of v, as
        ds = (sgn(v) - s) |v| dt / presliding. F is evaluated at the measured speed. Its load is the torque that
        feed-forward and dither request without friction, thus with the inertial torque.

        The scale converges to the true one over rho. rho s_max is the largest share of the friction of the law that is
        supplied: keep it below the true scale if over-compensation must not occur. Over-compensated friction drives the shaft by
        itself, because the compensation follows the measured motion. Let the loop give k_c sigma, with an inertia
        J <= k_c / lambda, F exact and s/rho within [s_min, s_max]. Then J (sigma^2 + lambda^2 (theta_r - theta)^2) +
        (s/rho - s^)^2 / gamma never grows.
        Below omega_min of the command the scale stands still.

        >>> import strainwave as sw
        >>> law = sw.friction.Coulomb(coulomb=0.05, breakaway=0.07)
        >>> sw.compensation.BristleObserver(friction=law, friction_share=0.9, gain=5.0).max_scale
        1.5)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, friction, "Law of all friction, at the input"));
        visit(SW_FIELD(m, friction_share, "1", "Share rho of the friction that is supplied", 0, 1));
        visit(SW_FIELD(m, bristle_gain, "1", "Share k of the error that bends the bristles", 0, 10));
        visit(SW_FIELD(m, position_gain, "1/s", "Weight lambda of the error of the input angle", 0));
        visit(SW_FIELD(m, gain, "1/(N.m.rad)", "Rate gamma of the scale per friction and error sigma; 0: constant scale", 0, 1e12));
        visit(SW_FIELD(m, min_scale, "1", "Least scale s_min, of the friction of the law", 0, 1));
        visit(SW_FIELD(m, max_scale, "1", "Largest scale s_max", 1, 10));
        visit(SW_FIELD(m, min_speed, "rad/s", "Slowest commanded input speed omega_min that determines the scale", 0));
        visit(SW_FIELD(m, presliding, "rad", "Input angle over which the old sense of set-valued friction falls to 1/e", smallest));
        visit(SW_FIELD(m, temperature, "K", "Temperature of the friction", smallest));
    }

    constexpr auto compile() const {
        return BristleObserver<S, decltype(compiled(friction))>{
            compiled(friction), friction_share, bristle_gain, position_gain, gain,
            min_scale,          max_scale,      min_speed,    presliding,    temperature};
    }

    using State = BristleStates<S, typename Friction::State>;
    constexpr State initial_state() const { return {strainwave::initial_state(friction), S(0.0), S(1.0)}; }

    constexpr Request<S> request(const State& x, const Inputs<S>& inputs) const {
        const S supplied = friction_share * x.scale * torque(x, inputs) - inputs.request.friction;
        return {S(0.0), S(0.0), S(0.0), supplied, supplied};
    }
    constexpr State advance(const State& x, const Inputs<S>& inputs, const Request<S>&, const S&, const S& period) const {
        const S commanded = inputs.input_speed(), measured = inputs.measured.input_speed;
        const S error = commanded - measured + position_gain * (inputs.input_angle() - inputs.measured.input_angle);
        const S bending = measured + bristle_gain * error;
        const S slope = gain * friction_share * torque(x, inputs) * error;
        const S moved = select(abs(commanded) < min_speed, S(0.0), slope * period);
        return {friction::slide(friction, x.friction, contact(x, inputs).moving(bending), period),
                slid_sense(x.sense, bending * period, presliding), clip(x.scale + moved, min_scale, max_scale)};
    }

private:
    constexpr friction::Contact<S> contact(const State& x, const Inputs<S>& inputs) const {
        const S load = inputs.request.torque - inputs.request.friction;
        return {inputs.measured.input_speed, x.sense, reduced(inputs.measured.input_angle), load, temperature};
    }
    /// Torque of the law at the measured motion [N.m].
    constexpr S torque(const State& x, const Inputs<S>& inputs) const {
        return friction::torque(friction, x.friction, contact(x, inputs));
    }
};

}  // namespace strainwave::compensation
