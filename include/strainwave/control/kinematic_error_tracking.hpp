#pragma once
#include <strainwave/control/reference.hpp>

namespace strainwave::control {

template <class S, class Gear_ = drive_model::PlainGear<S>, class Load_ = drive_model::PlainLoad<S>>
struct KinematicErrorTracking : OfModelAndReference<S, KinematicErrorTracking<S, Gear_, Load_>> {
    using Gear = Gear_;
    using Load = Load_;

    Gear gear{};
    Load load{};
    S motor_inertia{1e-4};
    S bandwidth{20.0};
    S speed_gain{0.02};
    S reference_time{0.005};
    S actuation_per_torque{1.0};
    S actuation_per_speed{0.0};
    S limit{10.0};
    Feedback feedback{Feedback::output};

    static constexpr auto name = "kinematic_error_tracking";
    static constexpr auto command_unit = "rad";
    static constexpr auto source =
        "GandhiGhorbel2002, in the form of SlotineLi1991, section 9.1, with the load and the sign convention of this package";
    static constexpr auto doc = R"(
        Position controller of a stiff gear that compensates its kinematic error.

        .. math:: q = \theta/i - e(\theta), \qquad g = 1/i - e'(\theta), \qquad M = J_{in} + J g^2, \qquad
                  M \dot\omega + \tfrac{1}{2} M' \omega^2 = \tau - g\, T_{load}

        .. math:: \omega_r = \frac{\dot r + \lambda (r - q)}{g}, \qquad s = \omega - \omega_r, \qquad
                  \tau = M \dot\omega_r + \tfrac{1}{2} M' \omega\, \omega_r + g\, T_{load} - K s

        with r the commanded output angle, theta, omega the measured input angle and speed, i the signed ratio, e the kinematic
        error of ``gear``, J and T_load inertia and torque of ``load``, J_in = motor_inertia + gear.input_inertia, lambda =
        bandwidth, K = speed_gain. q is the measured output angle, or that of the equation where ``feedback`` names the input.
        The actuation is clip(p tau + b omega + u_f, limit) as that of FeedbackLinearisation.

        M' comes from e'', a difference over 1 mrad of the input. V = M s^2 / 2 obeys dV/dt = -K s^2 if the gear is rigid and
        the model exact. Then s falls at the rate K / M, and the error r - q at lambda. A torque d that the model lacks leaves
        |s| up to |d| / K, and an error up to g |d| / (K lambda). A slope e' that is wrong by D leaves an error up to D omega /
        lambda. The acceleration of the command comes from a lag of the time reference_time, which must be at least the period
        of a sampled controller.

        The law leaves out torsion: K / M must be well below the vibration of load and gear. It leaves out friction: compensate
        it by a compensation, whose input leads the law ignores. It has no integral. If actuation_per_speed of the
        ``Compensation`` is not 0, set that of the law to 0: both add the back-EMF.

        >>> import strainwave as sw
        >>> error = sw.kinematic_error.Fourier(order=[2.0], amplitude=[3e-4], phase=[0.0])
        >>> law = sw.control.KinematicErrorTracking(gear=sw.Gear(kinematic_error=error), load=sw.loads.Inertia(inertia=0.5))
        >>> law.bandwidth
        20.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, gear, "Model of the gear"));
        visit(SW_PART(m, load, "Model of the load"));
        visit(SW_FIELD(m, motor_inertia, "kg.m2", "Inertia of the motor's rotor", 0));
        visit(SW_FIELD(m, bandwidth, "1/s", "Rate lambda at which the error of the output falls", smallest));
        visit(SW_FIELD(m, speed_gain, "N.m.s/rad", "Torque K per error s of the input speed", 0));
        visit(SW_FIELD(m, reference_time, "s", "Time of the lag that the acceleration of the command comes from", smallest));
        visit(SW_FIELD(m, actuation_per_torque, "1/(N.m)", "Actuation of the motor per torque, p", smallest));
        visit(SW_FIELD(m, actuation_per_speed, "s/rad", "Actuation of the motor per input speed, b: its back-EMF"));
        visit(SW_FIELD(m, limit, "1", "Largest actuation, of either sign", smallest));
        visit(SW_FIELD(m, feedback, "1", "The shaft whose encoder gives the output angle"));
    }

    constexpr auto compile() const {
        return KinematicErrorTracking<S, decltype(gear.compile()), decltype(compiled(load))>{
            {},         gear.compile(), compiled(load),       motor_inertia,       bandwidth,
            speed_gain, reference_time, actuation_per_torque, actuation_per_speed, limit,
            feedback};
    }

    using State = ReferenceLags<S>;

    constexpr S motor_torque(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        const auto error = drive_model::error_with_curvature<S>(gear, measured.input_angle);
        const S inverse = S(1.0) / command.ratio, per_input = inverse - error.slope;
        const S speed = measured.input_speed, output_speed = per_input * speed, inertia = inertia_of<S>(load);
        const S output = feedback == Feedback::output ? measured.output_angle : inverse * measured.input_angle - error.value;
        const S wanted = (command.rate + bandwidth * (command.value - output)) / per_input;
        const ReferenceMotion<S> reference(x, command, reference_time);
        // d/dt of wanted * per_input = reference speed; per_input changes by -e'' per input angle
        const S towards = reference.acceleration + bandwidth * (command.rate - output_speed);
        const S wanted_rate = (towards + wanted * error.curvature * speed) / per_input;
        const S mass = motor_inertia + gear.input_inertia + inertia * per_input * per_input;
        const S half_slope = -inertia * per_input * error.curvature;
        const S carried = load_torque<S>(load, output, output_speed, S(0.0));
        return mass * wanted_rate + half_slope * speed * wanted + per_input * carried - speed_gain * (speed - wanted);
    }
};

}  // namespace strainwave::control
