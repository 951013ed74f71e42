#pragma once
#include <strainwave/load/load.hpp>
#include <strainwave/meter/meter.hpp>

/// Where the power goes that a drive takes, and what it holds: from a state `x`, its continuous numbers `y`, the input `u`, and the
/// derivatives there, `now`.
namespace strainwave {

template <class S, class Drive>
constexpr meter::Powers<S> powers(const Drive& drive, const typename Drive::State& x, const typename Drive::Continuous& y,
                                  const typename Drive::Input& u, const typename Drive::Derivatives& now) {
    const auto& gear = drive.gear;
    const auto electric = drive.motor.power(y.motor, now.actuation, drive.rotor(x, y, u));
    const S temperature = drive.temperatures(y, u).gear, twist_rate = now.mesh.twist_rate, damped = gear.damping * twist_rate;
    const S held = now.mesh.torque - damped, remembered = held - gear.spring_torque(now.mesh.twist, temperature);
    const S noise_rate = gear.noise_rate({y.input_angle, x.turns}, y.input_speed, now.rate.input_speed, y.transmission_error,
                                         now.rate.transmission_error);
    const S warming = drive.thermal.gear_rate(now.rate.thermal, u.temperature_rate);
    return {electric.supplied,
            electric.lost,
            now.friction_input * y.input_speed,
            now.friction_mesh * (now.mesh.per_input * y.input_speed),
            now.friction_output * y.output_speed,
            damped * twist_rate,
            remembered * (twist_rate - noise_rate),
            gear.softening.dissipation_rate(warming) * gear.spring_energy(now.mesh.twist, temperature),
            held * noise_rate,
            now.load_torque * y.output_speed};
}

template <class S, class Drive>
constexpr meter::Stored<S> stored(const Drive& drive, const typename Drive::State& x, const typename Drive::Continuous& y,
                                  const typename Drive::Input& u, const typename Drive::Derivatives& now) {
    // A shaft that is moved from outside has no inertia of its own.
    const S output = prescribes(drive.load) ? S(0.0) : S(0.5) * drive.output_inertia() * y.output_speed * y.output_speed;
    return {S(0.5) * drive.input_inertia() * y.input_speed * y.input_speed, output,
            drive.gear.spring_energy(now.mesh.twist, drive.temperatures(y, u).gear),
            drive.motor.power(y.motor, now.actuation, drive.rotor(x, y, u)).stored};
}

}  // namespace strainwave
