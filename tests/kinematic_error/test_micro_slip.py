"""Random error by micro-slip: against the random function that excites it, its variance, and what load and speed do."""

from __future__ import annotations

import math

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave.kinematic_error import MicroSlip, Stochastic

from tests.kinematic_error.test_stochastic import PERIOD, SAMPLES, TURNS, angles, seeds

LAW = MicroSlip(excitation=0.02, friction=8.0, load_share=0.5, stiffness=2e4, seed=3)


def excited(law: MicroSlip, angle: object) -> object:
    """The exciting torque per speed over its root mean square."""
    unit = Stochastic(amplitude=1.0, seed=law.seed, lowest_order=law.lowest_order, highest_order=law.highest_order)
    return unit.error(angle)  # type: ignore[call-overload]


@given(seeds, angles, st.floats(-50.0, 50.0), st.floats(-1e3, 1e3))
def test_it_is_the_slip_of_the_contact_under_the_exciting_torque(seed: int, angle: float, torque: float, speed: float) -> None:
    law = LAW.replace(seed=seed)
    force, limit = 0.02 * abs(speed) * float(excited(law, angle)), 8.0 + 0.5 * abs(torque)  # type: ignore[arg-type]
    share = np.clip(force / limit, -1.0, 1.0)
    assert law.error(angle, torque, speed) == pytest.approx(limit * share * abs(share) / (6.0 * 2e4), rel=1e-10, abs=1e-18)


def test_it_is_the_first_term_of_mindlins_slip() -> None:
    """3 F / (2 k) (1 - (1 - q)^(2/3)) - q F / k: at q = 0.03 the next term is 4 q / 9 of the first."""
    angle = 0.7
    force = float(excited(LAW, angle))  # type: ignore[arg-type]
    speed = 0.03 * 8.0 / abs(0.02 * force)
    whole = math.copysign(8.0 / 2e4 * (1.5 * (1.0 - 0.97 ** (2.0 / 3.0)) - 0.03), force)
    first = LAW.error(angle, speed=speed)
    assert first == pytest.approx(whole, rel=0.015)
    assert whole / first - 1.0 == pytest.approx(4.0 * 0.03 / 9.0, rel=0.03)


@pytest.mark.parametrize(("torque", "speed"), [(0.0, 40.0), (0.0, 80.0), (-16.0, 80.0)])
def test_its_variance_is_that_of_a_gaussian_torque(torque: float, speed: float) -> None:
    """<g^4> c^4 w^4 / (6 k F)^2, over many seeds; <g^4> of 32 cosines is 3 (1 - 1/64)."""
    limit, count = 8.0 + 0.5 * abs(torque), 3000
    values = np.array([LAW.replace(seed=seed).error([0.0, 1.0, 2.0], torque, speed) for seed in range(count)])
    root = math.sqrt(3.0 * (1.0 - 1.0 / 64.0)) * (0.02 * speed) ** 2 / (6.0 * 2e4 * limit)
    # <g^8> = 105 of a Gaussian g: the standard deviation of a mean of g^4 is sqrt(96 / n)
    assert np.mean(values**2) / root**2 == pytest.approx(1.0, abs=4.0 * math.sqrt(96.0 / values.size) / 3.0)
    assert np.abs(values.mean()) < 4.0 * root / math.sqrt(values.size)


def test_it_rises_with_the_square_of_the_speed_and_falls_with_the_load() -> None:
    quiet = LAW.error(PERIOD[:400], 0.0, 20.0)
    assert LAW.error(PERIOD[:400], 0.0, -40.0) == pytest.approx(4.0 * quiet, rel=1e-12)
    assert LAW.error(PERIOD[:400], -16.0, 20.0) == pytest.approx(0.5 * quiet, rel=1e-12)
    assert np.count_nonzero(LAW.error(PERIOD[:400])) == 0  # at rest nothing slips


def test_its_spectrum_reaches_to_three_times_the_band() -> None:
    """The part of g |g| in proportion to g holds 8 / (3 pi) of its variance, the rest has the third power and higher ones."""
    values = LAW.error(PERIOD, speed=40.0)
    power = np.abs(np.fft.rfft(values)) ** 2
    order = np.arange(len(power)) / TURNS
    assert SAMPLES / 2 > 40.0
    within = power[(order > 8.0) & (order < 40.0)].sum() / power.sum()
    assert 8.0 / (3.0 * np.pi) < within < 0.99
    assert power[order > 40.0].sum() > 100.0 * power[order > 120.0].sum()


@given(seeds, angles, st.floats(-20.0, 20.0), st.floats(10.0, 100.0))
def test_the_slope_is_the_derivative(seed: int, angle: float, torque: float, speed: float) -> None:
    law, step = LAW.replace(seed=seed), 1e-6
    ends = law.error([angle - step, angle + step], torque, speed)
    largest = 2.0 * 0.02 * speed * 6.0 * 40.0 * 0.02 * speed * 6.0 / (6.0 * 2e4 * 8.0)
    assert law.slope(angle, torque=torque, speed=speed) == pytest.approx((ends[1] - ends[0]) / (2.0 * step), abs=1e-4 * largest)


def test_beyond_its_friction_the_slip_stays() -> None:
    values = LAW.error(PERIOD[:4000], speed=1e6)
    assert np.abs(values).max() == pytest.approx(8.0 / (6.0 * 2e4), rel=1e-12)


def test_a_run_hears_it_at_high_speed_and_low_load() -> None:
    """Two encoders on a gear at constant speed: the error of the law itself, and its share under load."""
    gear = sw.Gear(stiffness=sw.stiffness.Linear(k=1e4), kinematic_noise=LAW.replace(excitation=0.03))
    drive = sw.Drive(gear=gear, motor=sw.motor.AccelerationSource(), load=sw.loads.Inertia(inertia=1.0))
    seen = {}
    for speed, load in ((40.0, 0.0), (80.0, 0.0), (80.0, 16.0)):
        ratio = gear.kinematics.ratio
        start = {"input_speed": speed, "output_speed": speed / ratio, "twist": load / 1e4}
        run = sw.simulate(drive, sw.scenario.constant(0.0, 0.3), 2e-5, load_torque=load, initial=start, sample=2e-4)
        expected = gear.kinematic_noise.error(run["input_angle"], load, speed)
        seen[speed, load] = float(np.std(run["kinematic_error"]))
        assert run["kinematic_error"] == pytest.approx(expected, abs=0.1 * np.abs(expected).max())
    assert seen[80.0, 0.0] > 3.0 * seen[40.0, 0.0]
    assert seen[80.0, 16.0] < 0.6 * seen[80.0, 0.0]
