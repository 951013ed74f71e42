#pragma once
#include "run.hpp"

/// The torque that a motion needs.
namespace strainwave::kernel {

/// A motion of the input at an instant, as an array: angle [rad], speed [rad/s], acceleration [rad/s2], and the time since the
/// motion before it [s]; 0 where friction has long been sliding.
struct Motion {
    double angle, speed, acceleration, step;
    static constexpr int count = 4;
};
constexpr Motion motion_from(const double* numbers) { return {numbers[0], numbers[1], numbers[2], numbers[3]}; }

/// The state of friction under a contact: the one before it, a step later, or that of steady sliding where the step is 0.
template <class Law, class S>
typename Law::State under(const Law& law, const typename Law::State& before, const friction::Contact<S>& contact, const S& mean,
                          double step) {
    if (step <= 0.0) return friction::steady_state(law, contact);
    const auto on_the_way = contact.moving(mean);
    return friction::clamped(law, friction::advance(law, before, on_the_way, S(step)), on_the_way);
}

/// Torque of the motor of a drive at an instant [N.m] so that the input shaft moves as it does, the output shaft with it: the gear
/// is as stiff as a rigid one, its kinematic error included but for its curvature, and friction has the state that the motion up
/// to there leaves in `x`. Friction that grows with the torque transmitted is found in rounds.
template <class S, class Drive>
S needed_torque(const Drive& drive, typename Drive::State& x, const Motion& now, const Input<S>& u) {
    constexpr int rounds = 4;  // each leaves the share of the last that friction takes of what is transmitted
    const auto& gear = drive.gear;
    const double turns = rint(now.angle / (2.0 * pi)), within = now.angle - 2.0 * pi * turns;
    const S speed(now.speed), acceleration(now.acceleration);
    const S moved = S(within) - x.continuous.input_angle + S(2.0 * pi) * (S(turns) - x.turns);
    const S mean = now.step > 0.0 ? moved / S(now.step) : speed;
    const auto before = x.continuous;
    x.continuous.input_angle = S(within);
    x.turns = S(turns);
    x.continuous.input_speed = speed;
    x.continuous.transmission_error = S(0.0);
    drive.settle_gear(x, drive.geometry(x, x.continuous, u), S(0.0), S(0.0), S(0.0));
    auto mesh = drive.geometry(x, x.continuous, u);
    const S per_shaft = mesh.per_input / mesh.per_output;
    x.continuous.output_speed = per_shaft * speed;
    x.input_slip_direction = sign(speed);
    x.output_slip_direction = sign(x.continuous.output_speed);
    const S held = load_torque<S>(drive.load, drive.output_angle(x, x.continuous), x.continuous.output_speed, u.load) +
                   x.output_slip_direction * braking<S>(drive.load, u.load).slip;
    const S carried = drive.output_inertia() * per_shaft * acceleration + held;
    S transmitted = carried, at_input = mesh.per_input * carried;
    const auto contacts_under_load = [&] {
        mesh.torque = transmitted;
        mesh.input_torque = at_input;
        const Contacts<S> at = contacts::at<S>(drive, x, x.continuous, mesh, u);
        x.continuous.friction_input = under(gear.friction_input, before.friction_input, at.input, mean, now.step);
        x.continuous.friction_mesh = under(gear.friction_mesh, before.friction_mesh, at.mesh, mesh.per_input * mean, now.step);
        x.continuous.friction_output = under(gear.friction_output, before.friction_output, at.output, per_shaft * mean, now.step);
        return at;
    };
    S last(0.0);
    for (int i = 0; i < rounds && (i == 0 || !all(at_input == last)); ++i) {
        last = at_input;
        const Contacts<S> at = contacts_under_load();
        transmitted = carried + friction::torque(gear.friction_output, x.continuous.friction_output, at.output.steady());
        at_input =
            mesh.per_input * (transmitted + friction::torque(gear.friction_mesh, x.continuous.friction_mesh, at.mesh.steady()));
    }
    const Contacts<S> at = contacts_under_load();
    return drive.input_inertia() * acceleration + at_input +
           friction::torque(gear.friction_input, x.continuous.friction_input, at.input.steady());
}

/// Calls write(instant, torque) for consecutive instants: `motion` has `Motion::count` numbers of each.
template <class S, class Drive, class Write>
void needed_torques(const Drive& drive, const double* motion, const double* inputs, std::size_t instants, const Write& write) {
    auto x = drive.initial_state();
    for (std::size_t i = 0; i < instants; ++i)
        write(i, needed_torque<S>(drive, x, motion_from(motion + Motion::count * i), input_from<S>(inputs + input_count * i)));
}

}  // namespace strainwave::kernel
