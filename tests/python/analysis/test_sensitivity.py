"""Derivatives of a run against closed forms."""

from __future__ import annotations

import pickle
import re
from typing import Any

import numpy as np
import pytest
import strainwave as sw

from tests.support.reference_drive import DRIVE, command

TORQUE_CONSTANT, RESISTANCE, INERTIA = 0.05, 0.5, 1e-4  # N.m/A, ohm, kg.m2


def free_input(friction: Any, back_emf: float) -> sw.Drive:
    """A motor whose shaft feels nothing of the gear: the spring is all but nothing."""
    return sw.Drive(
        gear=sw.Gear(stiffness=sw.stiffness.Linear(k=1e-20), friction_input=friction),
        motor=sw.motor.DC(resistance=RESISTANCE, torque_constant=TORQUE_CONSTANT, back_emf=back_emf, inertia=INERTIA),
        load=sw.loads.Inertia(inertia=1.0),
    )


def test_the_speed_of_a_motor_falls_with_its_friction_as_its_solution_says() -> None:
    """J dv/dt = K (u - k v) / R - b v, so v = v_end (1 - e^(-t/T)) with v_end = K u / (R b + K k), T = J R / (R b + K k)."""
    viscous, back_emf, voltage = 1e-3, 0.05, 12.0
    drive = free_input(sw.friction.Viscous(viscous=viscous), back_emf)
    paths = ["gear.friction_input.viscous", "motor.inertia"]
    found = sw.analysis.derivatives(drive, sw.scenario.constant(voltage, 0.1), paths, sample=1e-3)
    time, damping = found.run.time, RESISTANCE * viscous + TORQUE_CONSTANT * back_emf
    end, constant = TORQUE_CONSTANT * voltage / damping, INERTIA * RESISTANCE / damping
    fading = np.exp(-time / constant)
    assert found.run["input_speed"] == pytest.approx(end * (1.0 - fading), rel=1e-9, abs=1e-9)
    by_viscous = -end * RESISTANCE / damping * (1.0 - fading - time / constant * fading)
    by_inertia = -end * fading * time / (constant * INERTIA)
    assert found["input_speed", paths[0]] == pytest.approx(by_viscous, rel=1e-7, abs=1e-4)
    assert found["input_speed", paths[1]] == pytest.approx(by_inertia, rel=1e-7, abs=1e-2)


def test_derivatives_go_through_the_moment_of_breakaway_which_moves() -> None:
    """Under a torque c t a shaft that F_s holds sets off at t_0 = F_s / c: J v = c (t^2 - t_0^2) / 2 - F_c (t - t_0)."""
    coulomb, breakaway, rate = 0.03, 0.045, 10.0  # N.m, N.m, V/s
    drive = free_input(sw.friction.Coulomb(coulomb=coulomb, breakaway=breakaway), 0.0)
    paths = ["gear.friction_input.coulomb", "gear.friction_input.breakaway"]
    found = sw.analysis.derivatives(drive, sw.scenario.ramp(rate, 0.1), paths, sample=1e-3)
    growth = TORQUE_CONSTANT * rate / RESISTANCE
    start = breakaway / growth
    time = np.maximum(found.run.time, start)
    assert np.any(time == start)
    speed = (0.5 * growth * (time**2 - start**2) - coulomb * (time - start)) / INERTIA
    assert found.run["input_speed"] == pytest.approx(speed, rel=1e-9, abs=1e-12)
    assert found["input_speed", paths[0]] == pytest.approx(-(time - start) / INERTIA, rel=1e-7, abs=1e-9)
    later = -(breakaway - coulomb) / (growth * INERTIA)
    assert found["input_speed", paths[1]] == pytest.approx(np.where(time > start, later, 0.0), rel=1e-7, abs=1e-9)


@pytest.mark.parametrize("count", [1, 4, 5, 8, 9, 12])
def test_a_derivative_is_the_same_whatever_others_are_asked_for(count: int) -> None:
    """They are worked out several at a time, in as many runs as that takes; each stands elsewhere among others."""
    numbers = [f"gear.hysteresis.{name}[{i}]" for name in ("stiffness", "breakaway") for i in range(6)]
    numbers += ["gear.damping", "motor.inertia", "load.inertia"]
    all_of_them, some = (sw.analysis.derivatives(DRIVE, command(0.05), each) for each in (numbers, numbers[-count:]))
    assert np.array_equal(some.values, all_of_them.values[-count:])
    assert np.all(np.any(some.values, axis=(1, 2)))
    assert some.run == all_of_them.run


def test_the_path_of_a_sequence_is_all_its_elements() -> None:
    gear = sw.Gear(kinematic_error=sw.kinematic_error.Fourier(order=[1.0, 2.0], amplitude=[1e-4, 2e-4], phase=[0.0, 0.5]))
    drive = sw.Drive(gear=gear)
    found = sw.analysis.derivatives(drive, sw.scenario.step(1.0, 0.01), ["gear.kinematic_error.amplitude", "motor.resistance"])
    assert dict(found.parameters) == {
        "gear.kinematic_error.amplitude[0]": "rad",
        "gear.kinematic_error.amplitude[1]": "rad",
        "motor.resistance": "Ohm",
    }
    assert found.values.shape == (3, len(found.run.names) - 1, len(found.run))
    angle = found.run["input_angle"]
    assert found["kinematic_error", "gear.kinematic_error.amplitude[1]"][0] == pytest.approx(np.sin(2.0 * angle[0] + 0.5))


def test_steps_too_coarse_at_rest_are_refused_as_they_are_of_a_run() -> None:
    """Of a hysteresis that is stiff at first, and lets go in a run that steps cannot follow."""
    sudden = sw.hysteresis.BoucWen(stiffness=1e7, saturation=0.1)
    drive = sw.Drive(gear=sw.Gear(hysteresis=sudden), load=sw.loads.Inertia(inertia=0.01))
    volts = sw.scenario.constant(10.0, 0.1)
    with pytest.raises(FloatingPointError, match="too coarse for this drive") as refusal:
        sw.simulate(drive, volts)
    with pytest.raises(FloatingPointError, match=re.escape(str(refusal.value))):
        sw.analysis.derivatives(drive, volts, ["load.inertia"])


def test_derivatives_go_through_a_pickle() -> None:
    found = sw.analysis.derivatives(DRIVE, command(0.05), ["motor.resistance", "load.inertia"], sample=1e-3)
    again = pickle.loads(pickle.dumps(found))
    assert np.array_equal(again.values, found.values)
    assert (again.run, again.parameters) == (found.run, found.parameters)


def test_what_there_is_not_is_refused_with_what_there_is() -> None:
    drive, command = sw.Drive(), sw.scenario.step(1.0, 0.01)
    with pytest.raises(ValueError, match=r'^the model has no parameter "motor.resistanse"; near it are motor.resistance'):
        sw.analysis.derivatives(drive, command, ["motor.resistanse"])
    with pytest.raises(ValueError, match=r"^parameters must name at least one number$"):
        sw.analysis.derivatives(drive, command, [])
    with pytest.raises(TypeError, match=r"^parameters must be a list of names, not 'motor.resistance'$"):
        sw.analysis.derivatives(drive, command, "motor.resistance")
    found = sw.analysis.derivatives(drive, command, ["motor.resistance"])
    with pytest.raises(ValueError, match=r'^no output "speed"; there are command, input_angle'):
        found["speed", "motor.resistance"]
    with pytest.raises(ValueError, match=r'^no derivatives by "motor.inertia"; there are those by motor.resistance$'):
        found["torque", "motor.inertia"]
    with pytest.raises(ValueError, match=r"read-only"):
        found["torque", "motor.resistance"][0] = 1.0


@pytest.mark.parametrize(
    ("sensor", "name", "why"),
    [
        (sw.sensor.Noisy(amplitude=1e-5, seed=3), "seed", "it selects the noise, not its size"),
        (sw.sensor.Encoder(counts=4096), "counts", "a reading that is rounded jumps, and derivatives ignore the rounding"),
        (
            sw.sensor.Quantised(resolution=1e-3),
            "resolution",
            "a reading that is rounded jumps, and derivatives ignore the rounding",
        ),
    ],
)
def test_there_is_no_derivative_by_what_is_no_measure(sensor: object, name: str, why: str) -> None:
    """They would come out as 0, though the run does change."""
    drive = DRIVE.replace(sensors=sw.Sensors(input_angle=sensor))
    with pytest.raises(ValueError, match=f"^there is no derivative by sensors.input_angle.{name}: {why}$"):
        sw.analysis.derivatives(drive, command(0.01), [f"sensors.input_angle.{name}", "load.inertia"])
    with pytest.raises(ValueError, match=r"^there is no derivative by gear\.kinematic_noise\.seed: "):
        sw.analysis.derivatives(drive, command(0.01), ["gear.kinematic_noise.seed"])
