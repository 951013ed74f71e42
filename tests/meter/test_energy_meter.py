"""Where the power goes: columns by their definition, energies in closed form, and the balance of drives of any parts."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from scipy.linalg import expm
from strainwave import Drive, _core
from strainwave.simulation.resolution import diverged
from strainwave.simulation.run import METHOD_WORDS

from tests.laws.test_gear import speeds
from tests.meter.joints import BALANCED_WITH_STAGES, COMMAND, DURATION, UNLISTED, drawn, inputs
from tests.support.strategies import models_of

Array = NDArray[np.float64]

SEEDS = range(36, 63)  # hold every listed model between them
CASES = [*SEEDS, *UNLISTED]
POWERS = (
    "supplied",
    "motor",
    "friction_input",
    "friction_mesh",
    "friction_output",
    "damping",
    "hysteresis",
    "softening",
    "kinematic_noise",
    "load",
)
TAKERS = POWERS[1:]
STORES = ("stored_input", "stored_output", "stored_spring", "stored_motor")


@cache
def run_of(case: int | str) -> tuple[Drive, sw.Run]:
    drive = drawn(case)
    return drive, sw.simulate_adaptively(drive, COMMAND, 1e-8, inputs=inputs(drive), sample=5e-4)


def missing(run: sw.Recording) -> Array:
    """What was supplied, less what was taken and what is stored more than at the start, of the largest energy in play."""
    stored = sum(run[name] for name in STORES)
    gap: Array = run["energy_supplied"] - sum(run[f"energy_{name}"] for name in TAKERS) - (stored - stored[0])
    return gap / max(np.abs(run[name]).max() for name in (*STORES, *(f"energy_{name}" for name in POWERS)))


# Drives of any parts


@pytest.mark.parametrize("case", CASES)
def test_what_a_drive_of_any_parts_takes_is_lost_goes_to_the_load_or_is_stored(case: int | str) -> None:
    """To 1e-9 of the largest energy in play, all along the run."""
    _, run = run_of(case)
    assert np.abs(missing(run)).max() < 1e-9


def test_the_drives_drawn_move_but_for_a_few_that_friction_holds() -> None:
    moved = [np.abs(run_of(seed)[1]["input_speed"]).max() > 1.0 for seed in SEEDS]
    assert np.count_nonzero(moved) >= len(SEEDS) - 3


COMPENSATING = {"feedforward", "learning", "observer", "dither"}  # they change what a motor is asked for, and no energy
ACTING_AS_OTHERS = {"StateSpace", "FeedbackLinearisation", "KinematicErrorTracking"}  # laws of control without energy


def test_the_drives_drawn_hold_every_model_between_them() -> None:
    """But what has no energy to measure by, and a table of a density, which is a law over the same as the other density."""
    drawn_ones = set().union(*(models_of(drawn(case)) for case in CASES))
    families = {name: models for name, models in _core.families.items() if name not in COMPENSATING}
    known = {model.__name__ for models in families.values() for model in models.values()}
    exceptions = {"NoMeter", "GridDensity"} | BALANCED_WITH_STAGES | ACTING_AS_OTHERS
    assert known - drawn_ones == exceptions, "add the model to its list in tests/meter/joints.py; then SEEDS must draw it"


# Powers by definition


def electric(motor: Any, run: sw.Recording) -> tuple[Array, Array, Array]:
    """Power [W] that a motor takes and loses, and energy [J] that it holds, by what it shows of itself."""
    speed, none = run["input_speed"], np.zeros(len(run))
    if isinstance(motor, sw.motor.TorqueSource | sw.motor.AccelerationSource):
        return run["motor_torque"] * speed, none, none
    current = run["current"]
    if isinstance(motor, sw.motor.CurrentSource):
        lost = motor.resistance * current**2
        return motor.torque_constant * current * speed + lost, lost, none
    winding = run["winding_temperature"] if "winding_temperature" in run.names else run["temperature"]
    copper = motor.resistance * (1.0 + motor.resistance_rise * (winding - 293.15))
    if isinstance(motor, sw.motor.PMSM):
        along = run["direct_current"]
        supplied = 1.5 * (run["voltage"] * current + run["direct_voltage"] * along)
        magnetic = 0.75 * (motor.quadrature_inductance * current**2 + motor.direct_inductance * along**2)
        cogging = motor.cogging_torque / motor.cogging_order * np.cos(motor.cogging_order * run["input_angle"])
        return supplied, 1.5 * copper * (current**2 + along**2), magnetic + cogging
    lost = copper * current**2
    if isinstance(motor, sw.motor.DC):
        lost = lost + motor.brush_drop * np.abs(current) + (motor.back_emf - motor.torque_constant) * speed * current
    return run["voltage"] * current, lost, 0.5 * motor.inductance * current**2


def softened(gear: sw.Gear, run: sw.Recording) -> Array:
    """What the spring is multiplied by."""
    return np.exp(-gear.softening.stiffness_fall * (run["temperature"] - gear.softening.reference_temperature))


def by_definition(drive: Drive, run: sw.Recording) -> dict[str, Array]:
    """The columns that follow from the signals beside them."""
    gear = drive.gear
    supplied, lost, held = electric(drive.motor, run)
    moving = speeds(gear, run)
    damped = gear.damping * (moving["friction_mesh"] - run["output_speed"]) ** 2
    inertia = 0.0 if isinstance(drive.load, sw.loads.Prescribed) else drive.load.inertia
    relaxing = {  # torques of a material are not recorded: tests/material has them
        "power_damping": damped,
        "stored_spring": softened(gear, run) * gear.stiffness.energy(run["twist"]),
    }
    return ({} if gear.material.fields else relaxing) | {
        "power_supplied": supplied,
        "power_motor": lost,
        **{f"power_{place}": run[place] * speed for place, speed in moving.items()},
        "power_load": run["load_torque"] * run["output_speed"],
        "stored_input": 0.5 * (drive.motor.inertia + gear.input_inertia) * run["input_speed"] ** 2,
        "stored_output": 0.5 * inertia * run["output_speed"] ** 2,
        "stored_motor": held,
    }


@pytest.mark.parametrize("case", CASES)
def test_powers_and_stores_are_what_their_definition_makes_of_the_signals(case: int | str) -> None:
    """To rounding; the slope of the error is told to less by an angle that is not counted from its turn."""
    drive, run = run_of(case)
    for name, expected in by_definition(drive, run).items():
        np.testing.assert_allclose(run[name], expected, rtol=0.0, atol=1e-9 * np.abs(expected).max() + 1e-15, err_msg=name)


# A linear drive, in closed form

LINEAR = Drive(
    gear=sw.Gear(
        stiffness=sw.stiffness.Linear(k=1.2e4),
        damping=8.0,
        friction_input=sw.friction.Viscous(viscous=2e-4),
        friction_mesh=sw.friction.Viscous(viscous=0.5),
        friction_output=sw.friction.Viscous(viscous=0.3),
        input_inertia=2e-5,
    ),
    motor=sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.11, inertia=1e-4),
    load=sw.loads.TorsionSpring(inertia=0.05, stiffness=200.0, damping=0.5, rest_angle=0.01),
    meter=sw.meter.EnergyMeter(),
)


def linear_system(drive: Drive, volts: float) -> tuple[Array, dict[str, Array]]:
    """M of z' = M z with z = (current, input angle, input speed, transmission error, output speed, 1), and each power z Q z."""
    gear, motor, load, inverse = drive.gear, drive.motor, drive.load, 1.0 / drive.gear.kinematics.ratio
    current, input_angle, input_speed, error, output_speed, one = np.eye(6)
    output_angle, twist_rate = inverse * input_angle - error, inverse * input_speed - output_speed
    torque = gear.stiffness.k * error + gear.damping * twist_rate
    at_input = gear.friction_input.viscous * input_speed
    at_mesh, at_output = gear.friction_mesh.viscous * inverse * input_speed, gear.friction_output.viscous * output_speed
    load_torque = load.stiffness * (output_angle - load.rest_angle * one) + load.damping * output_speed
    rates = [
        (volts * one - motor.resistance * current - motor.back_emf * input_speed) / motor.inductance,
        input_speed,
        (motor.torque_constant * current - (torque + at_mesh) * inverse - at_input) / (motor.inertia + gear.input_inertia),
        inverse * input_speed - output_speed,
        (torque - load_torque - at_output) / load.inertia,
        0.0 * one,
    ]
    iron = (motor.back_emf - motor.torque_constant) * np.outer(current, input_speed)
    return np.array(rates), {
        "supplied": volts * np.outer(one, current),
        "motor": motor.resistance * np.outer(current, current) + iron,
        "friction_input": np.outer(at_input, input_speed),
        "friction_mesh": np.outer(at_mesh, inverse * input_speed),
        "friction_output": np.outer(at_output, output_speed),
        "damping": gear.damping * np.outer(twist_rate, twist_rate),
        "load": np.outer(load_torque, output_speed),
    }


def integrated(system: Array, weight: Array, duration: float) -> Array:
    """The integral of exp(M t)' Q exp(M t) over a duration: C. F. Van Loan's exponential of a matrix of blocks."""
    n = len(system)
    blocks = expm(np.block([[-system.T, weight], [np.zeros((n, n)), system]]) * duration)
    found: Array = blocks[n:, n:].T @ blocks[:n, n:]
    return found


def exact_energies(drive: Drive, volts: float, interval: float, samples: int) -> dict[str, Array]:
    """From rest, a sample each interval, which is short so that the blocks keep their digits."""
    system, powers = linear_system(drive, volts)
    onward, state = expm(system * interval), np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    weights = {name: integrated(system, power, interval) for name, power in powers.items()}
    energies = {name: np.zeros(samples) for name in powers}
    for k in range(1, samples):
        for name, weight in weights.items():
            energies[name][k] = energies[name][k - 1] + state @ weight @ state
        state = onward @ state
    return energies


VOLTS, INTERVAL = 6.0, 1e-3


def test_energies_of_a_linear_drive_are_those_of_matrix_exponentials() -> None:
    run = sw.simulate(LINEAR, sw.scenario.constant(VOLTS, 0.1), 1e-5, sample=INTERVAL)
    for name, energy in exact_energies(LINEAR, VOLTS, INTERVAL, len(run)).items():
        assert np.abs(run[f"energy_{name}"] - energy).max() < 1e-10 * np.abs(energy).max(), name
    for name in ("hysteresis", "softening", "kinematic_noise"):
        assert np.abs(run[f"energy_{name}"]).max() < 1e-13


def test_the_balance_of_a_smooth_drive_closes_with_the_fourth_power_of_the_step() -> None:
    def gap(dt: float) -> float:
        return float(np.abs(missing(sw.simulate(LINEAR, sw.scenario.constant(VOLTS, 0.1), dt, sample=INTERVAL))).max())

    assert np.log2(gap(2e-4) / gap(1e-4)) == pytest.approx(4.0, abs=0.4)
    assert np.log2(gap(1e-4) / gap(5e-5)) == pytest.approx(4.0, abs=0.4)


def test_a_motor_that_turns_steadily_loses_what_it_takes_but_what_friction_does() -> None:
    """u = R i + k w, k i = b w: of a motor with as much friction as its load. Nothing is stored any more."""
    resistance, constant, viscous, volts = 0.5, 0.1, 1e-3, 5.0
    drive = Drive(
        gear=sw.Gear(damping=5.0, friction_input=sw.friction.Viscous(viscous=viscous)),
        motor=sw.motor.DC(resistance=resistance, torque_constant=constant, back_emf=constant, inertia=1e-5),
        load=sw.loads.Inertia(inertia=1e-3),
        meter=sw.meter.EnergyMeter(),
    )
    run = sw.simulate(drive, sw.scenario.constant(volts, 0.5), 1e-5, sample=0.1)
    current = volts / (resistance + constant**2 / viscous)
    speed = constant * current / viscous
    assert run["power_supplied"][-1] == pytest.approx(volts * current, rel=1e-9)
    assert run["power_motor"][-1] == pytest.approx(resistance * current**2, rel=1e-9)
    assert run["power_friction_input"][-1] == pytest.approx(viscous * speed**2, rel=1e-9)


# Places that some drives have only


def test_a_loop_of_hysteresis_takes_its_area() -> None:
    """Of Maxwell elements, swung to and fro by X, each cycle 4 F (X - F / k) of every one that slips."""
    stiffness, breakaway, swing, frequency, cycles = np.array([2e3, 1e3]), np.array([0.3, 0.6]), 1e-3, 5.0, 3
    drive = Drive(
        gear=sw.Gear(hysteresis=sw.hysteresis.MaxwellSlip(stiffness=stiffness, breakaway=breakaway), input_inertia=1e3),
        load=sw.loads.Prescribed(),
        control=sw.control.OpenLoop(gain=0.0),
        meter=sw.meter.EnergyMeter(),
    )
    angle = sw.scenario.sine(swing, frequency, cycles / frequency)
    rest = sw.scenario.constant(0.0, cycles / frequency)
    run = sw.simulate(drive, rest, 1e-5, inputs={"output_angle": angle}, sample=0.1, initial={"input_speed": 0.0})
    area = 4.0 * float(np.sum(breakaway * np.maximum(swing - breakaway / stiffness, 0.0)))
    taken = run["energy_hysteresis"]
    assert taken[-1] - taken[-3] == pytest.approx(area, rel=1e-5)  # a cycle
    assert run["energy_load"][-1] - run["energy_load"][-3] == pytest.approx(-area, rel=1e-5)


def test_a_spring_that_softens_turns_the_share_to_heat_that_its_energy_falls_by() -> None:
    """Under a torque T the twist is T / k exp(a warmth): half of what the load gives is stored, and half turns to heat."""
    fall, torque, stiffness, warmth = 5e-3, 20.0, 1e4, 40.0
    drive = Drive(
        gear=sw.Gear(
            stiffness=sw.stiffness.Linear(k=stiffness),
            damping=2.0,
            softening=sw.softening.ThermalSoftening(stiffness_fall=fall),
            input_inertia=1e9,
        ),
        control=sw.control.OpenLoop(gain=0.0),
        load=sw.loads.Inertia(inertia=0.05),
        meter=sw.meter.EnergyMeter(),
    )
    warming = sw.scenario.constant(293.15, 2.0) + sw.scenario.ramp(warmth / 2.0, 2.0)
    run = sw.simulate(
        drive,
        sw.scenario.constant(0.0, 2.0),
        initial={"torque": -torque},
        load_torque=-torque,
        temperature=warming,
        sample=0.1,
    )
    gained = 0.5 * torque**2 / stiffness * (np.exp(fall * warmth) - 1.0)
    assert run["energy_softening"][-1] == pytest.approx(gained, rel=1e-3)
    assert run["stored_spring"][-1] - run["stored_spring"][0] == pytest.approx(gained, rel=1e-3)
    assert run["energy_load"][-1] == pytest.approx(-2.0 * gained, rel=1e-3)
    assert np.abs(missing(run)).max() < 1e-9


def test_a_random_error_works_on_the_shafts_as_its_amplitude_changes() -> None:
    """By the torque, at the rate of the error that the angle does not tell: differences of the recorded error show it."""
    noise = sw.kinematic_error.Stochastic(amplitude=5e-5, seed=3, load_sensitivity=0.05, speed_sensitivity=0.02)
    gear = sw.Gear(kinematic_noise=noise, stiffness=sw.stiffness.Linear(k=1.2e4), damping=8.0)
    drive = LINEAR.replace(gear=gear)
    step = 1e-5
    run = sw.simulate_adaptively(drive, sw.scenario.sine(12.0, 60.0, DURATION), 1e-9, load_torque=5.0, sample=step)
    mesh = speeds(gear, run)["friction_mesh"]
    damped = gear.damping * (mesh - run["output_speed"])
    rate = np.gradient(run["kinematic_error"], step) - (run["input_speed"] / gear.kinematics.ratio - mesh)
    power, worked = run["power_kinematic_noise"], (run["torque"] - damped) * rate
    assert np.quantile(np.abs(worked - power), 0.9) < 1e-3 * np.abs(power).max()  # but where torque or speed turn over
    assert np.abs(missing(run)).max() < 1e-9
    assert np.abs(run["energy_kinematic_noise"]).max() > 1e-6 * np.abs(run["energy_supplied"]).max()  # what would be missing


# Whoever measures changes nothing


@pytest.mark.parametrize(("method", "within"), {**dict.fromkeys(METHOD_WORDS, 0.0), "rosenbrock": 1e-12}.items())
@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_a_meter_changes_no_run_in_fixed_steps(seed: int, method: Any, within: float) -> None:
    """Not a bit; but the W-method solves equations for all numbers of a state at once, and more of them round otherwise."""
    drive = drawn(seed)
    bare = drive.replace(meter=sw.meter.NoMeter())
    with_meter, without = (sw.simulate(one, COMMAND, 5e-5, method=method, inputs=inputs(drive)) for one in (drive, bare))
    assert set(without.names) < set(with_meter.names)
    for name in without.names:
        assert np.abs(with_meter[name] - without[name]).max() <= within * np.abs(without[name]).max(), name


def test_a_run_that_goes_on_goes_on_counting() -> None:
    whole = sw.simulate(LINEAR, sw.scenario.constant(VOLTS, 0.02), sample=1e-3)
    half = sw.scenario.constant(VOLTS, 0.01)
    first = sw.simulate(LINEAR, half, sample=1e-3)
    then = sw.simulate(LINEAR, half, sample=1e-3, initial=first.end)
    assert then["energy_supplied"][0] == first["energy_supplied"][-1]
    assert then["energy_supplied"][-1] == pytest.approx(whole["energy_supplied"][-1], rel=1e-12)


def test_a_run_that_diverges_names_some_columns_and_how_many_more() -> None:
    """Powers and energies make them so many that a message of all would be no line to read."""
    names = list(run_of(SEEDS[0])[1].units)[1:]
    said = diverged(np.array([0.0, 0.1]), names, np.full((len(names), 2), np.inf), "take a smaller dt")
    assert said.startswith("the simulation diverged at t = 0 s (command, input_angle, ")
    assert said.endswith(f" and {len(names) - 20} more); take a smaller dt")
    assert len(said) < 500
