"""Error over the temperature, against the sum of two waves in closed form."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.kinematic_error import Fourier, Scaled, TemperatureDependent

LAW = TemperatureDependent(
    law=Fourier(order=[2.0], amplitude=[3e-4], phase=[0.4]),
    order=[2.0, 5.0],
    change=[2e-6, 1e-6],
    phase=[1.3, -0.2],
    reference_temperature=293.15,
    temperature=323.15,
)
ANGLE = np.linspace(-20.0, 20.0, 101)


def test_it_is_the_sum_of_the_law_and_its_change() -> None:
    """3e-4 sin(2 x + .4) + 30 K (2e-6 sin(2 x + 1.3) + 1e-6 sin(5 x - .2)), order 2 by the cosine rule."""
    amplitude = math.sqrt(3e-4**2 + 6e-5**2 + 2.0 * 3e-4 * 6e-5 * math.cos(0.9))
    phase = 0.4 + math.atan2(6e-5 * math.sin(0.9), 3e-4 + 6e-5 * math.cos(0.9))
    expected = amplitude * np.sin(2.0 * ANGLE + phase) + 3e-5 * np.sin(5.0 * ANGLE - 0.2)
    assert LAW.error(ANGLE) == pytest.approx(expected, rel=0.0, abs=1e-16)


def test_at_the_reference_temperature_it_is_the_law() -> None:
    assert LAW.replace(temperature=293.15).error(ANGLE) == pytest.approx(LAW.law.error(ANGLE), rel=0.0, abs=0.0)


def test_a_load_reduces_all_of_it() -> None:
    loaded = Scaled(law=LAW, insertion_depth=1e-3, depth_sensitivity=100.0)
    assert loaded.error(ANGLE) == pytest.approx(math.exp(-0.1) * LAW.error(ANGLE), rel=1e-14)


@pytest.mark.parametrize("temperature", [273.15, 323.15])
def test_a_run_has_the_error_of_its_temperature(temperature: float) -> None:
    """A slow turn without load: what two encoders see is the error, whatever temperature the law has by itself."""
    gear = sw.load("hfuc-25-100").replace(kinematic_error=LAW)
    drive = sw.Drive(gear=gear, motor=sw.motor.AccelerationSource(), load=sw.loads.Inertia(inertia=0.1))
    run = sw.simulate(drive, sw.scenario.constant(1.0, 1.0), sample=0.05, temperature=temperature)
    at_run = LAW.replace(temperature=temperature)
    assert run["kinematic_error"] == pytest.approx(at_run.error(run["input_angle"]), rel=0.0, abs=1e-15)


def heated(**parts: Any) -> sw.Drive:
    """A gear that a motor heats at a standstill: the winding alone loses power."""
    gear = sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=100.0),
        stiffness=sw.stiffness.Linear(k=1e4),
        friction_input=sw.friction.Coulomb(coulomb=10.0, breakaway=20.0),
    )
    thermal = sw.thermal.Heating(
        winding_capacity=1.0, winding_resistance=1e9, gear_capacity=1.0, gear_resistance=1e9, coupling=1e3
    )
    return sw.Drive(
        gear=gear.replace(**({"kinematic_error": LAW} | parts)),
        motor=sw.motor.CurrentSource(torque_constant=1e-9, resistance=1.0, inertia=1e-4),
        load=sw.loads.Prescribed(),
        thermal=thermal,
        meter=sw.meter.EnergyMeter(),
    )


@pytest.mark.parametrize("depth", [0.0, 1e-3])
def test_a_gear_that_warms_up_in_a_run_takes_its_error_along(depth: float) -> None:
    """Both shafts held, 4 W into 2 J/K: the twist falls as the error of the warming gear grows, and the spring with it."""
    law = Scaled(law=LAW, insertion_depth=depth, depth_sensitivity=100.0)
    drive = heated(kinematic_error=law)
    still = sw.scenario.constant(2.0, 5.0)
    run = sw.simulate(drive, still, 1e-3, inputs={"output_angle": 0.0}, initial={"input_angle": 0.7}, sample=0.1)
    assert run["temperature"][-1] == pytest.approx(293.15 + 2.0 * 5.0, abs=0.01)
    per_kelvin = math.exp(-100.0 * depth) * (2e-6 * math.sin(2.0 * 0.7 + 1.3) + 1e-6 * math.sin(5.0 * 0.7 - 0.2))
    change = per_kelvin * (run["temperature"] - run["temperature"][0])
    assert np.abs(run["input_angle"] - 0.7).max() < 1e-15
    assert run["kinematic_error"] - run["kinematic_error"][0] == pytest.approx(change, abs=1e-16)
    assert run["twist"] - run["twist"][0] == pytest.approx(-change, abs=1e-16)
    assert run["torque"] == pytest.approx(1e4 * run["twist"], abs=1e-12)


@pytest.mark.parametrize("sensitivity", [0.0, 0.05])
def test_the_work_of_an_error_that_warms_up_closes_the_balance(sensitivity: float) -> None:
    """At a standstill the spring changes by the work of the error alone; of 1/2 k twist^2, to rounding of the steps."""
    drive = heated(kinematic_error=Scaled(law=LAW, load_sensitivity=sensitivity))
    still = sw.scenario.constant(2.0, 5.0)
    run = sw.simulate(drive, still, 1e-3, inputs={"output_angle": 0.0}, initial={"input_angle": 0.7}, sample=0.1)
    stored = run["stored_spring"]
    assert abs(stored[-1] - stored[0]) > 1e-5 * stored[0] > 0.0
    assert run["energy_kinematic_noise"] == pytest.approx(stored[0] - stored, abs=1e-9 * stored.max())


def test_the_error_of_a_run_is_that_of_friction_and_softening() -> None:
    """One temperature of the gear: it rises over a run, and the recorded error follows the recorded temperature."""
    gear = sw.load("hfuc-25-100").replace(kinematic_error=LAW)
    drive = sw.Drive(gear=gear, motor=sw.motor.AccelerationSource(), load=sw.loads.Inertia(inertia=0.1))
    warming = sw.scenario.constant(280.0, 1.0) + sw.scenario.ramp(50.0, 1.0)
    run = sw.simulate(drive, sw.scenario.constant(1.0, 1.0), sample=0.05, inputs={"temperature": warming})
    expected = [
        LAW.replace(temperature=float(kelvin)).error(float(angle))
        for kelvin, angle in zip(run["temperature"], run["input_angle"], strict=True)
    ]
    assert run["temperature"][-1] == pytest.approx(330.0)
    assert run["kinematic_error"] == pytest.approx(expected, rel=0.0, abs=1e-15)


def test_a_controller_that_divides_by_the_slope_sees_the_warm_one() -> None:
    """The slope of 100 rad/rad at 30 K more is refused where that of the law alone is not."""
    steep = LAW.replace(change=[2e-4, 0.0])

    def controlled(error: TemperatureDependent) -> sw.Drive:
        gear = sw.load("hfuc-25-100").replace(kinematic_error=error)
        load = sw.loads.Inertia(inertia=1.0)
        law = sw.control.KinematicErrorTracking(
            gear=gear, load=load, bandwidth=8.0, speed_gain=5e-3, motor_inertia=1e-4, reference_time=0.05
        )
        return sw.Drive(gear=gear, control=law, load=load)

    controlled(steep.replace(temperature=293.15))
    with pytest.raises(ValueError, match="steepest slope of the kinematic error"):
        controlled(steep)


def test_sequences_must_be_equally_long() -> None:
    with pytest.raises(ValueError, match="order, change and phase must have equally many elements"):
        TemperatureDependent(order=[2.0])
