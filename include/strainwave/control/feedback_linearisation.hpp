#pragma once
#include <strainwave/control/reference.hpp>

namespace strainwave::control {

template <class S, class Gear_ = drive_model::PlainGear<S>, class Load_ = drive_model::PlainLoad<S>>
struct FeedbackLinearisation : OfModelAndReference<S, FeedbackLinearisation<S, Gear_, Load_>> {
    using Gear = Gear_;
    using Load = Load_;

    Gear gear{};
    Load load{};
    S motor_inertia{1e-4};
    S bandwidth{50.0};
    S reference_time{0.005};
    S actuation_per_torque{1.0};
    S actuation_per_speed{0.0};
    S limit{10.0};

    static constexpr auto name = "feedback_linearisation";
    static constexpr auto command_unit = "rad";
    static constexpr auto source =
        "Spong1987, section 3, with the kinematic error and its reaction; feedback linearisation is asked for "
        "by " SW_POSITION_ARTICLE;
    static constexpr auto doc = R"(
        Position controller of a flexible joint: the output obeys a linear equation of fourth order.

        .. math:: \delta = \theta/i - q - e(\theta), \qquad J \ddot q = T(\delta) - T_{load}(q, \dot q), \qquad
                  \dot\delta = g\,\omega - \dot q, \qquad g = 1/i - e'(\theta)

        .. math:: v = 4 w\,(\hat r^{(3)} - q^{(3)}) + 6 w^2 (\hat{\ddot r} - \ddot q) + 4 w^3 (\dot r - \dot q) + w^4 (r - q)

        .. math:: \ddot\delta = \frac{J v + \ddot T_{load} - T''(\delta)\, \dot\delta^2}{T'(\delta)}, \qquad
                  \tau = J_{in}\, \frac{\ddot\delta + e''\omega^2 + \ddot q}{g} + g\, T(\delta), \qquad
                  u = \operatorname{clip}(p\,\tau + b\,\omega + u_f, \pm u_{max})

        with r the commanded output angle, theta, omega the measured input angle and speed, q the measured output angle, i the
        signed ratio, e the kinematic error, T the stiffness of ``gear``, J the inertia of ``load``, J_in = motor_inertia +
        gear.input_inertia, w = bandwidth, p = actuation_per_torque, b = actuation_per_speed (see ``Compensation``), u_f the
        feed-forward of a compensation, u_max = limit. If the model is exact and the limit is not reached, the output has four
        poles at -w. Its error obeys (d/dt + w)^4 (r - q) = r^(4) plus the error of the derivatives of r by the lags.

        It needs both encoders. The second and third derivative of the output follow from the twist. Those of the command come
        from two lags of the time reference_time, which must be at least the period of a sampled controller. Derivatives of
        load and stiffness over the motion are central differences over 0.01 / w, and e'' is one over 1 mrad of the input.

        A stiffness of the model of k times the real one moves the poles to those of

        .. math:: s^4 + 4 w s^3 + (6 w^2 - (k - 1)\, \Omega^2)\, s^2 + (4 w^3 s + w^4)/k, \qquad
                  \Omega^2 = \frac{T'}{J} \Big(1 + \frac{J}{i^2 J_{in}}\Big)

        Omega is the vibration of the joint with both ends free. With k above 1 the joint is stable only if w^2 exceeds
        (k - 1) Omega^2 / (5 - 1/k). If the stiffness is uncertain, use a smaller one.

        The law leaves out friction, damping and hysteresis of the gear, the relief of its kinematic error by load, and a brake
        of the load. Compensate the friction by a compensation. The law has no integral. A load torque d that the model lacks
        leaves the error (6/w^2 - T'/(J w^4)) d/J: its twist counts as acceleration. The law ignores the input leads of a
        compensation, because it contains gear and load. A ModelFeedforward for it must have the friction alone. If
        actuation_per_speed of the ``Compensation`` is not 0, set that of the law to 0: both add the back-EMF. The stiffness
        must be nowhere zero. Sensors and period must be fast against w. A large w amplifies noise by w^4.

        >>> import strainwave as sw
        >>> gear = sw.Gear(stiffness=sw.stiffness.Cubic(a1=1.2e4, a3=1e9))
        >>> sw.control.FeedbackLinearisation(gear=gear, load=sw.loads.Inertia(inertia=0.5), bandwidth=40.0).limit
        10.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, gear, "Model of the gear"));
        visit(SW_PART(m, load, "Model of the load"));
        visit(SW_FIELD(m, motor_inertia, "kg.m2", "Inertia of the motor's rotor", 0));
        visit(SW_FIELD(m, bandwidth, "rad/s", "Magnitude w of the four poles of the output", 1e-3, 1e5));
        visit(SW_FIELD(m, reference_time, "s", "Time of the lags that the derivatives of the command come from", smallest));
        visit(SW_FIELD(m, actuation_per_torque, "1/(N.m)", "Actuation of the motor per torque, p", smallest));
        visit(SW_FIELD(m, actuation_per_speed, "s/rad", "Actuation of the motor per input speed, b: its back-EMF"));
        visit(SW_FIELD(m, limit, "1", "Largest actuation, of either sign", smallest));
    }

    constexpr auto compile() const {
        return FeedbackLinearisation<S, decltype(gear.compile()), decltype(compiled(load))>{
            {},        gear.compile(), compiled(load),       motor_inertia,
            bandwidth, reference_time, actuation_per_torque, actuation_per_speed,
            limit};
    }

    using State = ReferenceLags<S>;

    constexpr S motor_torque(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        const Motion at = motion(command, measured);
        return motor_torque(at, measured.input_speed, snap(x, command, measured, at));
    }

private:
    static constexpr double share_of_difference = 0.01;  ///< of 1 / bandwidth, over which derivatives are differences
    static constexpr double least_stiffness = 1e-3;      ///< of inertia times bandwidth squared: what the law divides by at least

    /// Quantities that the model determines from the measurements.
    struct Motion {
        S per_input;          ///< twist per input angle g
        S per_input_rate;     ///< 1/s
        S torque;             ///< of the spring, N.m
        S tangent;            ///< N.m/rad
        S tangent_rate;       ///< N.m/(rad.s)
        S twist_rate;         ///< rad/s
        S acceleration;       ///< of the output, rad/s2
        S jerk;               ///< rad/s3
        S load_acceleration;  ///< second derivative of the load torque over time, N.m/s2
    };

    constexpr Motion motion(const Command<S>& command, const Measurement<S>& measured) const {
        const S inverse = S(1.0) / command.ratio, inertia = inertia_of<S>(load), step = S(share_of_difference) / bandwidth;
        const auto error = drive_model::error_with_curvature<S>(gear, measured.input_angle);
        const S per_step = S(0.5) / step;
        Motion at{};
        at.per_input = inverse - error.slope;
        at.per_input_rate = -error.curvature * measured.input_speed;
        const S twist = inverse * measured.input_angle - measured.output_angle - error.value;
        at.twist_rate = at.per_input * measured.input_speed - measured.output_speed;
        const S twisted = step * at.twist_rate;
        at.torque = gear.stiffness.torque(twist);
        at.tangent = gear.stiffness.tangent(twist);
        at.tangent_rate = (gear.stiffness.tangent(twist + twisted) - gear.stiffness.tangent(twist - twisted)) * per_step;

        const S carried = carried_after(measured, S(0.0), S(0.0), S(0.0));
        at.acceleration = (at.torque - carried) / inertia;
        const S load_rate =
            (carried_after(measured, at.acceleration, S(0.0), step) - carried_after(measured, at.acceleration, S(0.0), -step)) *
            per_step;
        at.jerk = (at.tangent * at.twist_rate - load_rate) / inertia;
        const S around =
            carried_after(measured, at.acceleration, at.jerk, step) + carried_after(measured, at.acceleration, at.jerk, -step);
        at.load_acceleration = (around - S(2.0) * carried) / (step * step);
        return at;
    }
    /// Fourth derivative of the output angle that is to be [rad/s4].
    constexpr S snap(const State& x, const Command<S>& command, const Measurement<S>& measured, const Motion& at) const {
        const ReferenceMotion<S> wanted(x, command, reference_time);
        const S w = bandwidth;
        const S position = command.value - measured.output_angle, speed = command.rate - measured.output_speed;
        return w * (S(4.0) * (wanted.jerk - at.jerk) +
                    w * (S(6.0) * (wanted.acceleration - at.acceleration) + w * (S(4.0) * speed + w * position)));
    }
    constexpr S motor_torque(const Motion& at, const S& input_speed, const S& snap) const {
        const S inertia = inertia_of<S>(load), tangent = max(at.tangent, S(least_stiffness) * inertia * bandwidth * bandwidth);
        const S twist_acceleration = (inertia * snap + at.load_acceleration - at.tangent_rate * at.twist_rate) / tangent;
        const S input_acceleration = (twist_acceleration - at.per_input_rate * input_speed + at.acceleration) / at.per_input;
        return (motor_inertia + gear.input_inertia) * input_acceleration + at.per_input * at.torque;
    }
    /// Torque of the load after a time [s] of a motion from the measured one on [N.m].
    constexpr S carried_after(const Measurement<S>& measured, const S& acceleration, const S& jerk, const S& time) const {
        const S angle = measured.output_angle + time * (measured.output_speed + S(0.5) * time * acceleration);
        const S speed = measured.output_speed + time * (acceleration + S(0.5) * time * jerk);
        return load_torque<S>(load, angle, speed, S(0.0));
    }
};

}  // namespace strainwave::control
