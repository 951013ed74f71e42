#pragma once
#include "run.hpp"

/// The torque that a motion needs.
namespace strainwave::kernel {

/// What the motor of a drive must give at an instant [N.m] so that the input shaft moves as it does, the output shaft with it: the
/// gear is as stiff as a rigid one, its kinematic error included but for its curvature, and friction slides steadily. Friction that
/// grows with the torque transmitted is found in rounds.
template <class S, class Drive>
S needed_torque(const Drive& drive, const double* motion, const Input<S>& u) {
    constexpr int rounds = 4;  // each leaves the share of the last that friction takes of what is transmitted
    const auto& gear = drive.gear;
    const double turns = rint(motion[0] / (2.0 * pi));
    const S speed(motion[1]), acceleration(motion[2]);
    auto x = drive.initial_state();
    x.continuous.input_angle = S(motion[0] - 2.0 * pi * turns);
    x.turns = S(turns);
    x.continuous.input_speed = speed;
    drive.settle_gear(x, drive.geometry(x, x.continuous), S(0.0), S(0.0), S(0.0));
    auto mesh = drive.geometry(x, x.continuous);
    x.continuous.output_speed = mesh.per_input * speed / mesh.per_output;
    x.input_slip_direction = sign(speed);
    x.output_slip_direction = sign(x.continuous.output_speed);
    const S held = load_torque<S>(drive.load, drive.output_angle(x, x.continuous), x.continuous.output_speed, u.load) +
                   x.output_slip_direction * braking<S>(drive.load, u.load).slip;
    const S carried = drive.output_inertia() * (mesh.per_input * acceleration / mesh.per_output) + held;
    S transmitted = carried, at_input = mesh.per_input * carried;
    for (int i = 0; i < rounds; ++i) {
        mesh.torque = transmitted;
        mesh.input_torque = at_input;
        const Contacts<S> at = contacts::at<S>(drive, x, x.continuous, mesh, u);
        transmitted = carried + friction::steady(gear.friction_output, at.output);
        at_input = mesh.per_input * (transmitted + friction::steady(gear.friction_mesh, at.mesh));
    }
    mesh.torque = transmitted;
    mesh.input_torque = at_input;
    const Contacts<S> at = contacts::at<S>(drive, x, x.continuous, mesh, u);
    return drive.input_inertia() * acceleration + at_input + friction::steady(gear.friction_input, at.input);
}

/// The same at each of some instants: motion[3 i ...] are angle [rad], speed [rad/s] and acceleration [rad/s2] of the input.
template <int n, class Drive>
void needed_torques(const Drive& drive, const double* motion, const double* inputs, std::size_t instants, std::size_t first,
                    std::size_t count, double* torque, double* slopes) {
    for (std::size_t i = 0; i < instants; ++i) {
        const Dual<n> needed = needed_torque<Dual<n>>(drive, motion + 3 * i, input_from<Dual<n>>(inputs + input_count * i));
        torque[i] = needed.value;
        for (std::size_t p = first; p < first + n && p < count; ++p) slopes[p * instants + i] = needed.slope[p - first];
    }
}

}  // namespace strainwave::kernel
