"""The whole drives that come with the package: complete, sourced, within their ratings, and as their documents have them."""

from __future__ import annotations

import math
import warnings
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.described import all_paths, optional

DRIVES = sw.catalogue("drives")
AT_REST_IN_THE_COLD = {"space-pointing-joint": 253.15}  # K
STEP = {"position-drive-printed": 2e-5}  # s; the others take the usual one
CASCADES = ["robot-joint", "space-pointing-joint"]
USE = {  # speed [rad/s] and acceleration [rad/s2] that the note of a set names
    "robot-joint": (2.0, 10.0),
    "space-pointing-joint": (0.1, 0.1),
    "tilt-actuator": (1.0, 3.0),
    "tilt-actuator-lumped": (1.0, 3.0),
}
every_drive = pytest.mark.parametrize("name", DRIVES)


def smooth(amplitude: float, frequency: float, periods: int = 1) -> sw.scenario.Scenario:
    """There and back without a jump of position or speed: amplitude (1 - cos) / 2."""
    return sw.scenario.sine(0.5 * amplitude, frequency, periods / frequency, -0.5 * math.pi, 0.5 * amplitude)


def run_of(name: str, command: sw.scenario.Scenario) -> sw.Recording:
    temperature = AT_REST_IN_THE_COLD.get(name, 293.15)
    return sw.simulate(sw.GearSet.read(name), command, STEP.get(name, 2e-4), sample=1e-3, temperature=temperature)


def test_the_drives_are_listed() -> None:
    assert DRIVES == [
        "position-drive",
        "position-drive-full-friction",
        "position-drive-printed",
        "robot-joint",
        "space-pointing-joint",
        "tilt-actuator",
        "tilt-actuator-lumped",
        "two-inertia-gear",
    ]
    assert not set(DRIVES) & set(sw.catalogue())
    with pytest.raises(ValueError, match=r'^of = "motors" must be one of gears, drives$'):
        sw.catalogue("motors")


@every_drive
def test_a_drive_is_loaded_and_saved_and_loaded_again(name: str, tmp_path: Path) -> None:
    gear_set = sw.GearSet.read(name)
    assert isinstance(sw.load(name), sw.Drive)
    assert sw.load(name) == gear_set.drive
    gear_set.save(tmp_path / "copy.toml")
    assert sw.GearSet.read(tmp_path / "copy.toml") == gear_set
    assert sw.load(tmp_path / "copy.toml") == sw.load(name)


@every_drive
def test_every_number_of_a_drive_has_a_source_that_says_something(name: str) -> None:
    """What has none says that it is assumed, and why; a part that is not there says so."""
    gear_set = sw.GearSet.read(name)
    paths = [path for part in ("gear", "motor", "load") for path in all_paths(part, getattr(gear_set, part))]
    assert set(paths) <= set(gear_set.sources)
    for path, entry in gear_set.sources.items():
        absent = any(path.startswith(f"{part}.") for part in {*gear_set.left_out, "control.compensation"})
        absent |= path in {f"motor.{name}" for name in optional(gear_set.motor)}  # of faults, which a file may leave out
        assert (entry.source == "not given") == absent, path
        assert not entry.source.startswith("assumed") or len(entry.source.removeprefix("assumed:").split()) > 1, path


@every_drive
def test_a_drive_runs_without_a_warning(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        run = run_of(name, smooth(0.01, 5.0))
    assert all(np.isfinite(run[column]).all() for column in run.names)


@pytest.mark.parametrize("name", USE)
def test_normal_use_keeps_the_ratings(name: str) -> None:
    """A movement up to the speed and the acceleration that the note of the set names: (pi f a, 2 pi^2 f^2 a)."""
    speed, acceleration = USE[name]
    frequency = acceleration / (2.0 * math.pi * speed)
    command = smooth(speed / (math.pi * frequency), frequency)
    assert np.abs(command.rate(np.linspace(0.0, 1.0 / frequency, 1001))).max() == pytest.approx(speed, rel=1e-5)
    run = run_of(name, command)
    checks = sw.check_ratings(sw.GearSet.read(name), run)
    assert {check.name for check in checks} >= {"peak_torque", "average_torque", "maximum_input_speed", "average_input_speed"}
    assert not any(check.exceeded for check in checks)
    assert np.abs(run["output_angle"] - run["command"]).max() < 0.02 * command.value(0.5 / frequency)


@pytest.mark.parametrize("name", CASCADES)
def test_the_loop_is_well_damped(name: str) -> None:
    """Its poles without dry friction, and its answer to a step with it: less than 5 % of overshoot, and no ringing."""
    drive = sw.load(name)
    free = sw.friction.Viscous()
    linear = sw.linearise(
        drive.replace(
            gear=drive.gear.replace(friction_input=free, friction_output=free),
            control=drive.control.law,
            sensors=drive.sensors.replace(input_angle=sw.sensor.Ideal(), output_angle=sw.sensor.Ideal()),
            thermal=sw.thermal.Isothermal(),
            meter=sw.meter.NoMeter(),
        )
    )
    assert linear.poles.real.max() < -1.0
    assert linear.damping_ratios.min() > 0.7
    stepped = run_of(name, sw.scenario.step(0.005, 4.0))["output_angle"]
    assert stepped.max() < 1.05 * 0.005
    assert np.ptp(stepped[-500:]) < 1e-3 * 0.005
    assert stepped[-1] == pytest.approx(0.005, rel=0.03)  # the loop of the robot's joint closes on the input


@pytest.mark.parametrize(("name", "gear"), [("robot-joint", "csg-25-100"), ("space-pointing-joint", "csg-14-100")])
def test_the_gear_of_a_joint_is_that_of_the_catalogue(name: str, gear: str) -> None:
    """All but its friction: numbers, sources and ratings."""
    whole, part = sw.GearSet.read(name), sw.GearSet.read(gear)
    for model in ("kinematics", "stiffness", "hysteresis", "kinematic_error", "damping", "input_inertia"):
        assert getattr(whole.gear, model) == getattr(part.gear, model)
        for path in (path for path in part.sources if path.startswith(f"gear.{model}")):
            assert whole.sources[path] == part.sources[path]
    assert whole.ratings == part.ratings
    assert (
        whole.gear.friction_input.breakaway if name == "space-pointing-joint" else whole.gear.friction_input.law.breakaway
    ) == (part.gear.friction_input.breakaway)


def test_the_motor_of_the_robot_joint_is_that_of_its_source() -> None:
    """Compliant Joint Toolbox, WMBig10k_ds, commit 5589953; k_t and i_p per rms current, r and x between two phases."""
    motor = sw.load("robot-joint").motor
    assert motor.pole_pairs == 12 / 2
    assert 1.5 * motor.pole_pairs * motor.flux_linkage * math.sqrt(2.0) == pytest.approx(0.0453, rel=1e-6)
    assert 2.0 * motor.resistance == pytest.approx(0.0885, rel=1e-12)
    assert 2.0 * motor.quadrature_inductance == pytest.approx(0.14e-3, rel=1e-12)
    assert motor.direct_inductance == motor.quadrature_inductance
    assert motor.inertia == 5.48e-5
    assert motor.supply_voltage == 24.0
    assert motor.current_limit == pytest.approx(40.0 * math.sqrt(2.0), rel=1e-4)
    assert (motor.cogging_torque, motor.cogging_order) == (15e-3, 6.0)
    assert sw.GearSet.read("robot-joint").ratings["peak_torque"].value > 100.0 * 0.0453 * 40.0


def test_the_motor_of_the_robot_joint_reaches_the_speed_of_its_source() -> None:
    """5.86 rad/s at the output, ratio 100; without friction 24 V / (sqrt(3) p psi) = 649 rad/s, with that of the gear less."""
    joint = sw.load("robot-joint")
    fastest = joint.motor.supply_voltage / (math.sqrt(3.0) * joint.motor.pole_pairs * joint.motor.flux_linkage)
    assert fastest == pytest.approx(648.9, abs=0.1)
    free = sw.Drive(gear=joint.gear, motor=joint.motor, load=sw.loads.Inertia(inertia=0.1))
    run = sw.simulate(free, sw.scenario.constant(24.0, 0.5), sample=1e-3)
    assert 586.0 < run["input_speed"][-1] < fastest


def test_the_loops_of_the_robot_joint_belong_to_its_motor() -> None:
    """Torque per amplitude 3/2 p psi, back-EMF p psi, and the limits of current and voltage."""
    joint = sw.load("robot-joint")
    motor, law = joint.motor, joint.control.law
    per_ampere = 1.5 * motor.pole_pairs * motor.flux_linkage
    assert law.back_emf_feedforward == pytest.approx(motor.pole_pairs * motor.flux_linkage, rel=1e-3)
    assert law.viscous_feedforward == pytest.approx(joint.gear.friction_input.law.viscous / per_ampere, rel=1e-3)
    assert law.current_limit == motor.current_limit
    assert law.voltage_limit == pytest.approx(motor.supply_voltage / math.sqrt(3.0), rel=1e-4)
    best = math.sqrt(5.8e4 * joint.load.inertia) / 100.0**2 / per_ampere
    assert law.speed_proportional == pytest.approx(0.9 * best, rel=5e-3)
    assert law.current_proportional / motor.quadrature_inductance == pytest.approx(2000.0, rel=1e-9)
    assert law.current_integral / motor.resistance == pytest.approx(2000.0, rel=1e-9)


def test_the_rated_torque_presses_the_bearing_of_the_pointing_joint_by_a_fifth() -> None:
    """10 N.m at the output are 0.1 N.m at the input."""
    law = sw.load("space-pointing-joint").gear.friction_input
    assert law.hold(load=0.1) / law.hold(load=0.0) == pytest.approx(1.2, rel=1e-12)


def test_the_loops_of_the_pointing_joint_are_as_fast_as_their_sources_say() -> None:
    joint = sw.load("space-pointing-joint")
    law, torque, rotor = joint.control.law, joint.motor.torque_constant, joint.motor.inertia + joint.gear.input_inertia
    below = law.speed_proportional * torque / (rotor + joint.load.inertia / 100.0**2)
    above = law.speed_proportional * torque / rotor
    assert (below, above) == pytest.approx((22.1, 277.0), rel=2e-3)
    assert below / law.position_gain == pytest.approx(7.0, abs=0.5)
    assert 4.0 < below / (law.speed_integral / law.speed_proportional) < 5.0


def test_the_joint_in_the_cold_is_stiffer_to_turn_when_it_runs_and_warms_up() -> None:
    """Grease at -20 degC is exp(0.03 x 40) = 3.3 times as viscous as at 20 degC."""
    law = sw.load("space-pointing-joint").gear.friction_input
    fast = 1e3  # rad/s: the boundary part has faded, and is equal
    cold, warm = (float(law.steady(fast, temperature=kelvin)) - law.coulomb for kelvin in (253.15, 293.15))
    assert cold / warm == pytest.approx(math.exp(0.03 * 40.0), rel=1e-9)
    run = run_of("space-pointing-joint", smooth(0.1, 0.5))
    assert run["temperature"][0] == pytest.approx(253.15)
    assert run["temperature"][-1] > 253.15


# Document P


def test_the_full_friction_of_document_p_is_that_of_its_tables() -> None:
    """Average parabola, static ratio, factor over speed; at angle 0 both models of P hold alike."""
    law, simple = (sw.load(name).gear.friction_input for name in ("position-drive-full-friction", "position-drive"))
    assert [law.hold(angle=0.0), simple.hold()] == pytest.approx([1.0388 * 0.072] * 2, rel=1e-12)
    angle = np.linspace(0.0, 240.0, 24001)
    whole_turns = angle[angle < 38.0 * 2.0 * math.pi]
    ripple = law.steady(0.8, angle=whole_turns) - 4e-4 * 0.8 - (1.5738e-6 * whole_turns**2 - 3.7901e-4 * whole_turns + 0.072)
    assert np.sqrt(np.mean(ripple**2)) == pytest.approx(0.0052, rel=2e-3)  # what Table 1 leaves unexplained
    assert np.mean(ripple) == pytest.approx(0.0, abs=1e-5)
    assert law.steady(0.8, angle=angle).min() > 0.03  # it is friction everywhere


def test_all_but_the_friction_is_equal_in_both_drives_of_document_p() -> None:
    full, simple = sw.load("position-drive-full-friction"), sw.load("position-drive")
    places = {"friction_input": simple.gear.friction_input, "friction_output": simple.gear.friction_output}
    assert full.replace(gear=full.gear.replace(**places)) == simple


def test_the_load_of_the_printed_drive_turns_a_hundred_times_as_fast_as_its_motor() -> None:
    run = run_of("position-drive-printed", sw.scenario.constant(12.0, 0.2))
    assert run["output_angle"][-1] / run["input_angle"][-1] == pytest.approx(100.0, rel=0.01)
    assert sw.load("position-drive").gear.kinematics.ratio == 100.0


# Document R


def test_the_two_inertia_gear_shows_its_energies() -> None:
    """0.19375 J go to and fro between input, output and spring; nothing is supplied, and nothing lost."""
    run = sw.simulate(
        sw.load("two-inertia-gear"),
        sw.scenario.constant(0.0, 0.1),
        1e-5,
        initial={"input_speed": 50.0, "output_speed": -0.5},
    )
    stored = [run[f"stored_{place}"] for place in ("input", "output", "spring")]
    np.testing.assert_allclose(sum(stored), 0.19375, rtol=1e-11)
    assert run["input_angle"][-1] == pytest.approx(5.000121927883016, rel=1e-10)
    assert run["output_angle"][-1] == pytest.approx(-0.04972844972996274, rel=1e-10)
    assert min(np.ptp(energy) for energy in stored) > 1e-5
    for name in run.names:
        if name.startswith("energy_"):
            assert np.abs(run[name]).max() == 0.0, name
