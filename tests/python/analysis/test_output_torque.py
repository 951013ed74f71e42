"""Torque by the angles of both shafts, against loops over samples in numpy that share nothing with the package."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.files.identified_tables import Covariance

Array = NDArray[np.float64]

RATIO = -80.0
SPRING = {"k1": 14200.0, "k2": 23500.0, "k3": 31000.0, "t1": 7.0, "t2": 25.0}
ELEMENTS = {"stiffness": [5000.0, 2500.0], "breakaway": [0.6, 0.5]}
WAVES = {"order": [2.0, 4.0], "amplitude": [6.4e-5, 1.7e-5], "phase": [0.0, 0.8]}
DAMPING = 12.0
GEAR = sw.Gear(
    kinematics=sw.kinematics.StrainWave(flexspline_teeth=160, circular_spline_teeth=162, fixed="circular_spline"),
    stiffness=sw.stiffness.ThreeSegment(**SPRING),
    hysteresis=sw.hysteresis.MaxwellSlip(**ELEMENTS),
    kinematic_error=sw.kinematic_error.Fourier(**WAVES),
    damping=DAMPING,
)
TIME = np.linspace(0.0, 2.0, 801)
INPUT = 30.0 * np.sin(3.0 * TIME)
ZERO = 2e-4


def brute_force(twist: Array, **changed: float) -> Array:
    """Torque of a spring of three segments and two slip elements, sample by sample, from no twist."""
    k1, k2, k3, t1, t2 = (changed.get(name, value) for name, value in SPRING.items())
    stiffness = [changed.get(f"h{j}", value) for j, value in enumerate(ELEMENTS["stiffness"])]
    breakaway = [changed.get(f"f{j}", value) for j, value in enumerate(ELEMENTS["breakaway"])]
    slip, last, torque = [0.0, 0.0], 0.0, []
    for now in twist:
        size = abs(now)
        d1, d2 = t1 / k1, t1 / k1 + (t2 - t1) / k2
        spring = k1 * size if size < d1 else t1 + k2 * (size - d1) if size < d2 else t2 + k3 * (size - d2)
        for j in range(2):
            slip[j] = min(max(slip[j] + stiffness[j] * (now - last), -breakaway[j]), breakaway[j])
        last = now
        torque.append(np.copysign(spring, now) + sum(slip))
    return np.array(torque)


@pytest.fixture(scope="module")
def angles() -> tuple[Array, Array, Array]:
    """Twist along reversals within reversals, and the angles of both shafts that make it."""
    twist = 1.2e-3 * np.sin(5.0 * TIME) + 3e-4 * np.sin(31.0 * TIME)
    waves = sum(a * np.sin(n * INPUT + p) for n, a, p in zip(WAVES["order"], WAVES["amplitude"], WAVES["phase"], strict=True))
    return twist, INPUT, INPUT / RATIO - waves - twist - ZERO


def test_it_is_that_of_the_brute_force(angles: tuple[Array, Array, Array]) -> None:
    twist, of_input, of_output = angles
    found = sw.analysis.output_torque(GEAR, of_input, of_output, zero=ZERO)
    assert found.twist == pytest.approx(twist, abs=1e-12)
    assert found.torque == pytest.approx(brute_force(twist), abs=1e-7)
    assert np.isnan(found.sigma).all()


def test_with_the_time_the_damping_counts(angles: tuple[Array, Array, Array]) -> None:
    _, of_input, of_output = angles
    plain, damped = (sw.analysis.output_torque(GEAR, of_input, of_output, zero=ZERO, time=time).torque for time in (None, TIME))
    rate = 1.2e-3 * 5.0 * np.cos(5.0 * TIME) + 3e-4 * 31.0 * np.cos(31.0 * TIME)
    assert damped[1:-1] - plain[1:-1] == pytest.approx((DAMPING * rate)[1:-1], abs=2e-4)


def test_its_standard_deviation_is_that_of_drawn_gears(angles: tuple[Array, Array, Array]) -> None:
    twist, of_input, of_output = angles
    names = {"k1": 140.0, "k2": 200.0, "t1": 0.2, "h0": 60.0, "f0": 0.01}
    deviations = np.array(list(names.values()))
    correlation = np.eye(5)
    correlation[0, 2] = correlation[2, 0] = -0.6
    covariance = correlation * np.outer(deviations, deviations)
    paths = ["gear.stiffness.k1", "gear.stiffness.k2", "gear.stiffness.t1", "gear.hysteresis.stiffness[0]",
             "gear.hysteresis.breakaway[0]"]  # fmt: skip
    gear_set = replace(sw.GearSet.of(GEAR, name="x", source="x"), covariance=Covariance(tuple(paths), covariance.tolist()))
    found = sw.analysis.output_torque(gear_set, of_input, of_output, zero=ZERO)
    middle = np.array([SPRING["k1"], SPRING["k2"], SPRING["t1"], 5000.0, 0.6])
    drawn = np.random.default_rng(3).multivariate_normal(middle, covariance, 150)
    expected = np.std([brute_force(twist[::8], **dict(zip(names, each, strict=True))) for each in drawn], axis=0)
    coarse = sw.analysis.output_torque(gear_set, of_input[::8], of_output[::8], zero=ZERO).sigma
    large = expected > 0.3 * expected.max()
    assert np.median(coarse[large] / expected[large]) == pytest.approx(1.0, abs=0.1)
    assert np.isfinite(found.sigma).all()


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"output_angle": np.zeros(3)}, r"input_angle has the shape \(2,\) and output_angle \(3,\)"),
        ({"input_angle": np.array([0.0, np.nan])}, "must be finite"),
        ({"time": np.array([1.0, 1.0])}, "time must increase"),
        ({"gear": "tilt-actuator"}, r"structure = .* makes the torque depend on more than the twist"),
    ],
)
def test_what_is_wrong_is_refused(changed: dict[str, Any], words: str) -> None:
    given = {"gear": GEAR, "input_angle": np.zeros(2), "output_angle": np.zeros(2)} | changed
    with pytest.raises(ValueError, match=words):
        sw.analysis.output_torque(**given)
