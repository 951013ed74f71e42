#pragma once
#include <strainwave/friction/resistance.hpp>
#include <strainwave/load/load.hpp>
#include <strainwave/math.hpp>
#include <strainwave/motor/rotor.hpp>

/// Shafts whose motion comes from outside: a motor that prescribes that of the input, a load that prescribes that of the output. No
/// torque moves these; the torque that they need is a result.
namespace strainwave::prescribed_motion {

/// The numbers with the output shaft where its load puts it.
template <class S, class Drive>
constexpr typename Drive::Continuous placed(const Drive& drive, const typename Drive::State& x, typename Drive::Continuous y,
                                            const typename Drive::Input& u) {
    y.transmission_error = drive.input_angle(x, y) * drive.gear.kinematics.inverse_ratio() - u.load;
    y.output_speed = u.load_rate;
    return y;
}

/// Puts a state where motor and load have it. Such shafts slip the way they move.
template <class S, class Drive>
constexpr void place(const Drive& drive, typename Drive::State& x, const typename Drive::Input& u) {
    if constexpr (load::can_prescribe<decltype(drive.load)>) {
        if (prescribes(drive.load)) {
            x.continuous = placed<S>(drive, x, x.continuous, u);
            x.output_slip_direction = sign(u.load_rate);
        }
    }
    if constexpr (motor::can_prescribe<decltype(drive.motor)>)
        if (motor::prescribes(drive.motor)) x.input_slip_direction = sign(x.continuous.input_speed);
}

/// The inertia [kg.m2] that a torque of the gear moves at the input.
template <class S, class Drive>
constexpr S movable(const Drive& drive, const S& inertia) {
    return motor::prescribes(drive.motor) ? S(load::immovable) : inertia;
}

/// Torque [N.m] of all but set-valued friction at the input that gives the prescribed acceleration [rad/s2].
template <class S, class Drive>
constexpr S driving_torque(const Drive& drive, const S& acceleration, const typename Drive::Mesh& mesh,
                           const friction::Resistance<S>& of_mesh, const friction::Resistance<S>& of_input) {
    return drive.input_inertia() * acceleration + of_mesh.sliding * mesh.per_input + of_input.sliding;
}

/// The torque of the motor, N.m: Newton's second law.
template <class S, class Drive>
constexpr S motor_torque(const Drive& drive, const typename Drive::Derivatives& now) {
    return drive.input_inertia() * now.rate.input_speed + now.mesh.input_torque + now.friction_mesh * now.mesh.per_input +
           now.friction_input;
}

}  // namespace strainwave::prescribed_motion
