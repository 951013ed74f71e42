"""Error over the temperature, against the sum of two waves in closed form."""

from __future__ import annotations

import math

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


def test_a_run_has_the_error_of_its_temperature() -> None:
    """A slow turn without load: what two encoders see is the error."""
    gear = sw.load("hfuc-25-100").replace(kinematic_error=LAW)
    drive = sw.Drive(gear=gear, motor=sw.motor.AccelerationSource(), load=sw.loads.Inertia(inertia=0.1))
    run = sw.simulate(drive, sw.scenario.constant(1.0, 1.0), sample=0.05)
    assert run["kinematic_error"] == pytest.approx(LAW.error(run["input_angle"]), rel=0.0, abs=1e-15)


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
