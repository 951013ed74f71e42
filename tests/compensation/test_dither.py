"""A torque that swings around zero: it adds none in the mean, and friction becomes smooth over the mean speed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.compensation import DisturbanceObserver, Dither, NoDither

from tests.compensation.ideal import LIGHT, RATIO, gear

PERIOD = 5e-4  # s
INERTIA = 2e-4  # kg.m2
STIFFNESS, DAMPING = 0.02, 2.8e-3  # N.m/rad, N.m.s/rad of the position loop
LEVEL = 0.02  # N.m
AMPLITUDE, FREQUENCY = 0.2, 20.0  # N.m, Hz
SWUNG = np.sqrt(AMPLITUDE**2 - (4.0 * LEVEL / np.pi) ** 2) / (2.0 * np.pi * FREQUENCY * INERTIA)  # rad/s
DRY = sw.friction.Coulomb(coulomb=LEVEL, breakaway=LEVEL)


def drive(dither: Any, friction: Any, observer: Any = None) -> sw.Drive:
    law = sw.control.PID(proportional=STIFFNESS, derivative=DAMPING, limit=5.0)
    part = sw.Compensation(dither=dither, observer=observer or sw.compensation.NoObserver())
    control = sw.control.Sampled(law=law, period=PERIOD, compensation=part)
    motor = sw.motor.TorqueSource(inertia=INERTIA)
    return sw.Drive(gear=gear(friction_input=friction), motor=motor, load=LIGHT, control=control)


def crept(one: sw.Drive, speed: float) -> tuple[float, float]:
    """Mean error of the input [rad] and amplitude of its speed [rad/s] over the last second, of a mean speed [rad/s]."""
    run = sw.simulate(one, sw.scenario.ramp(speed / RATIO, 4.0), 1e-4, sample=PERIOD).between(3.0, 4.0 - PERIOD)
    error = RATIO * run["command"] - run["input_angle"]
    return float(error.mean()), float(0.5 * np.ptp(run["input_speed"]))


@pytest.mark.parametrize("share", [-0.4, 0.15, 0.4, 0.8])
def test_the_mean_of_coulomb_friction_is_that_of_its_describing_function(share: float) -> None:
    """(2 / pi) F_c asin(v / a), where without dither it is F_c."""
    speed = share * SWUNG
    error, swung = crept(drive(Dither(amplitude=AMPLITUDE, frequency=FREQUENCY), DRY), speed)
    assert swung == pytest.approx(SWUNG, rel=0.03)
    assert STIFFNESS * error == pytest.approx(2.0 / np.pi * LEVEL * np.arcsin(share), rel=0.04)
    plain, _ = crept(drive(NoDither(), DRY), speed)
    assert STIFFNESS * plain == pytest.approx(np.sign(share) * LEVEL, rel=1e-3)


def test_it_adds_no_torque_in_the_mean() -> None:
    """Of a drive that is linear, and swings as an inertia does."""
    error, swung = crept(drive(Dither(amplitude=AMPLITUDE, frequency=FREQUENCY), sw.friction.Viscous()), 3.0)
    assert abs(STIFFNESS * error) < 1e-4 * AMPLITUDE
    assert swung == pytest.approx(AMPLITUDE / (2.0 * np.pi * FREQUENCY * INERTIA), rel=0.03)


def test_a_disturbance_observer_does_not_cancel_it() -> None:
    """It knows the torque: the speed swings by as much, although the observer is as fast as the dither."""
    observer = DisturbanceObserver(inertia=INERTIA, bandwidth=2.0 * np.pi * FREQUENCY, limit=1.0)
    swings = []
    for each in (sw.compensation.NoObserver(), observer):
        swings.append(crept(drive(Dither(amplitude=AMPLITUDE, frequency=FREQUENCY), sw.friction.Viscous(), each), 3.0)[1])
    # The observer holds the speed, too: an inertia with a spring-like J g (omega - omega_r) in parallel is left.
    assert swings[1] == pytest.approx(swings[0] / np.sqrt(2.0), rel=0.1)


def test_it_is_silent_while_the_command_rests_and_goes_on_with_it() -> None:
    one = drive(Dither(amplitude=AMPLITUDE, frequency=FREQUENCY), DRY)
    course = sw.scenario.table([0.0, 0.31, 2.31], [0.0, 0.031, 0.031])
    run = sw.simulate(one, course, sample=PERIOD)
    moving, resting = run.between(0.1, 0.3), run.between(2.0, 2.3)
    assert np.ptp(moving["motor_torque"]) > AMPLITUDE
    assert np.ptp(resting["motor_torque"]) == 0.0
    turns = FREQUENCY * 0.31
    phase = run.end["control.compensation.dither.phase"]
    assert (phase - turns + 0.5) % 1.0 - 0.5 == pytest.approx(0.0, abs=FREQUENCY * PERIOD)


def test_its_phase_stays_within_a_turn() -> None:
    """However long it swings."""
    one = drive(Dither(amplitude=AMPLITUDE, frequency=3.7), DRY)
    run = sw.simulate(one, sw.scenario.ramp(0.1, 20.0), sample=0.1)
    assert abs(run.end["control.compensation.dither.phase"]) <= 0.5
    turns = 3.7 * 20.0
    assert (run.end["control.compensation.dither.phase"] - turns + 0.5) % 1.0 - 0.5 == pytest.approx(0.0, abs=4e-3)


def test_a_frequency_that_the_sampling_folds_is_refused() -> None:
    """At half of the sample rate the sine is sampled at its zeros."""
    law = sw.control.PositionSpeed()
    swings = {each: sw.Compensation(dither=Dither(amplitude=0.01, frequency=each)) for each in (480.0, 500.0)}
    assert sw.control.Sampled(law=law, period=1e-3, compensation=swings[480.0]).period == 1e-3
    with pytest.raises(ValueError, match="frequency of the dither must be below half of the sample rate"):
        sw.control.Sampled(law=law, period=1e-3, compensation=swings[500.0])
