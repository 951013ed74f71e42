#pragma once
#include <strainwave/friction/resistance.hpp>
#include <strainwave/shaft.hpp>

/// The places of friction in a drive, and its torques on the two shafts.
namespace strainwave {

template <class S>
struct Contacts {
    friction::Contact<S> input, mesh, output;
};

namespace contacts {

/// Speed, angle and load of each place. The output's angle is split into whole turns before it is multiplied out.
template <class S, class Drive>
constexpr Contacts<S> at(const Drive& drive, const typename Drive::State& x, const typename Drive::Continuous& y,
                         const typename Drive::Mesh& mesh, const typename Drive::Input& u) {
    const S inverse = drive.gear.kinematics.inverse_ratio(), turned = x.turns * inverse, turns = rint(turned);
    const S rigid = S(2.0 * pi) * (turned - turns) + y.input_angle * inverse, temperature = drive.temperatures(y, u).gear;
    return {
        {y.input_speed, x.input_slip_direction, {y.input_angle, x.turns}, mesh.input_torque, temperature},
        {y.input_speed * mesh.per_input, along(mesh.per_input, x.input_slip_direction), {rigid, turns}, mesh.torque, temperature},
        {y.output_speed, x.output_slip_direction, {rigid - y.transmission_error, turns}, mesh.torque, temperature}};
}

/// The contacts of an instant, moving at other speeds.
template <class S, class Drive>
constexpr Contacts<S> moved(const typename Drive::Derivatives& now, const typename Drive::Continuous& y) {
    return {now.contacts.input.moving(y.input_speed), now.contacts.mesh.moving(y.input_speed * now.mesh.per_input),
            now.contacts.output.moving(y.output_speed)};
}

// The largest torque that holds a shaft at rest, N.m.
template <class S, class Drive>
constexpr S input_hold(const Drive& drive, const typename Drive::Derivatives& now) {
    const S push = sign(now.input_driving_torque), per_input = now.mesh.per_input;
    const S held = friction::hold(drive.gear.friction_input, now.contacts.input.pushed(push)) +
                   abs(per_input) * friction::hold(drive.gear.friction_mesh, now.contacts.mesh.pushed(along(per_input, push)));
    return max(held, S(negligible_hold));
}
template <class S, class Drive>
constexpr S output_hold(const Drive& drive, const typename Drive::Derivatives& now) {
    const S held = friction::hold(drive.gear.friction_output, now.contacts.output.pushed(sign(now.output_driving_torque)));
    return max(held + now.braking.hold, S(negligible_hold));
}

// The torque of set-valued friction against a shaft that slips one way, N.m.
template <class S, class Drive>
constexpr S input_friction(const Drive& drive, const typename Drive::State& x, const typename Drive::Derivatives& now,
                           const S& sense) {
    const auto mesh = now.contacts.mesh.pushed(along(now.mesh.per_input, sense));
    return friction::sliding_torque(drive.gear.friction_input, x.continuous.friction_input, now.contacts.input.pushed(sense)) +
           friction::sliding_torque(drive.gear.friction_mesh, x.continuous.friction_mesh, mesh) * now.mesh.per_input;
}
template <class S, class Drive>
constexpr S output_friction(const Drive& drive, const typename Drive::State& x, const typename Drive::Derivatives& now,
                            const S& sense) {
    return friction::sliding_torque(drive.gear.friction_output, x.continuous.friction_output, now.contacts.output.pushed(sense));
}

}  // namespace contacts
}  // namespace strainwave
