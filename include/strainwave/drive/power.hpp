#pragma once
#include <strainwave/load/load.hpp>
#include <strainwave/meter/meter.hpp>

/// Powers of a drive by their destination, and its energies: from a state `x`, its continuous numbers `y`, the input `u`, and the
/// derivatives there, `now`.
namespace strainwave {

template <class S, class Drive>
constexpr meter::Powers<S> powers(const Drive& drive, const typename Drive::State& x, const typename Drive::Continuous& y,
                                  const typename Drive::Input& u, const typename Drive::Derivatives& now) {
    const auto& gear = drive.gear;
    const auto& mesh = now.mesh;
    const auto shafts = drive.gear_shafts(x, y, u);
    const auto electric = drive.motor.power(y.motor, now.actuation, drive.rotor(x, y, u, now));
    const auto inner = gear.energies(y.structure, shafts, mesh);
    const bool rigid = gear.structure.rigid();
    const S temperature = drive.temperatures(y, u).gear, damped = gear.damping * mesh.twist_rate;
    const S held = mesh.spring - damped - gear.material.torque(y.material),
            remembered = held - gear.spring_torque(y.structure, shafts, mesh, temperature);
    const S warming = drive.thermal.gear_rate(now.rate.thermal, u.temperature_rate);
    const S drift = gear.error_drift(y.structure, shafts, mesh, now.rate.input_speed, warming);
    return {electric.supplied,
            electric.lost,
            now.friction_input * y.input_speed,
            now.friction_mesh * (mesh.per_input * y.input_speed),
            now.friction_output * y.output_speed,
            damped * mesh.twist_rate + inner.damping + gear.material.lost(y.material),
            remembered * (rigid ? mesh.twist_rate - drift : mesh.twist_rate),
            gear.softening.dissipation_rate(warming) * gear.spring_energy(y.structure, shafts, mesh, temperature),
            (rigid ? held : inner.under_error) * drift,
            now.load_torque * y.output_speed};
}

template <class S, class Drive>
constexpr meter::Stored<S> stored(const Drive& drive, const typename Drive::State& x, const typename Drive::Continuous& y,
                                  const typename Drive::Input& u, const typename Drive::Derivatives& now) {
    const auto shafts = drive.gear_shafts(x, y, u);
    const auto inner = drive.gear.energies(y.structure, shafts, now.mesh);
    const S spring = drive.gear.spring_energy(y.structure, shafts, now.mesh, drive.temperatures(y, u).gear);
    // A shaft that is moved from outside has no inertia of its own.
    const S output = prescribes(drive.load) ? S(0.0) : S(0.5) * drive.output_inertia() * y.output_speed * y.output_speed;
    return {S(0.5) * drive.input_inertia() * y.input_speed * y.input_speed, output,
            spring + inner.elastic + drive.gear.material.stored(y.material), inner.kinetic,
            drive.motor.power(y.motor, now.actuation, drive.rotor(x, y, u, now)).stored};
}

}  // namespace strainwave
