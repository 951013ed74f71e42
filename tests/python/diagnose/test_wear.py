"""Wear over the transmitted work: the rate and the life of simulated gears, and what tests do not determine."""

from __future__ import annotations

from math import inf, pi
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.dataset.faults import grown

GEARS = 400
RATE, START, LIMIT, NOISE = 3e-11, 1e-4, 4e-4, 5e-6  # rad/J, rad


@pytest.mark.parametrize("tests", [3, 5, 8])
def test_the_interval_contains_the_true_life(tests: int) -> None:
    """The line is true and the noise normal, so that Fieller's interval has 95 % for any number of tests."""
    random = np.random.default_rng(tests)
    work = np.linspace(0.0, 3e6, tests)
    true = (LIMIT - START) / RATE - work[-1]
    covered = determined = 0
    for _ in range(GEARS):
        play = START + RATE * work + random.normal(0.0, NOISE, tests)
        life = sw.diagnose.wear_life(work, {"play": play.tolist()}, {"play": LIMIT})
        covered += life.low <= true <= life.high
        determined += life.high < inf
    assert abs(covered / GEARS - 0.95) < 4.0 * np.sqrt(0.95 * 0.05 / GEARS)
    assert determined > 0.6 * GEARS


def test_the_interval_of_the_first_of_several_contains_the_true_life() -> None:
    random, work = np.random.default_rng(1), np.linspace(0.0, 3e6, 5)
    rates, limits = {"play": RATE, "amplitude": 0.4 * RATE}, {"play": LIMIT, "amplitude": 2.2e-4}
    true = min((limits[name] - START) / rate for name, rate in rates.items()) - work[-1]
    covered = 0
    for _ in range(GEARS):
        tests = {name: START + rate * work + random.normal(0.0, NOISE, 5) for name, rate in rates.items()}
        life = sw.diagnose.wear_life(work, {name: values.tolist() for name, values in tests.items()}, limits)
        covered += life.low <= true <= life.high
    assert covered / GEARS > 0.95 - 3.0 * np.sqrt(0.95 * 0.05 / GEARS)


def test_a_gear_that_does_not_wear_has_no_life() -> None:
    """Not determined in at least 95 % of gears, since noise alone is a significant rise in one of forty."""
    random, work = np.random.default_rng(2), np.linspace(0.0, 3e6, 4)
    lives = [
        sw.diagnose.wear_life(work, {"play": (START + random.normal(0.0, NOISE, 4)).tolist()}, {"play": LIMIT})
        for _ in range(GEARS)
    ]
    assert sum(life.limited_by == "" for life in lives) > 0.95 * GEARS
    undetermined = next(life for life in lives if not life.limited_by)
    assert (undetermined.remaining, undetermined.high) == (inf, inf)
    assert "does not differ from zero" in undetermined.remarks[0]
    with pytest.raises(ValueError, match="the life is not determined"):
        _ = undetermined.onset


def test_tests_on_a_line_have_the_noise_of_their_last_digit() -> None:
    """True values between the written ones: the interval of three tests that lie on a line by chance contains their life."""
    random, work = np.random.default_rng(3), np.array([0.0, 1e6, 2e6])
    covered = on_line = 0
    for slope, start in zip(random.uniform(2e-11, 4e-11, GEARS), random.uniform(0.9e-4, 1.1e-4, GEARS), strict=True):
        play = np.round(start + slope * work, 5)
        life = sw.diagnose.wear_life(work, {"play": play.tolist()}, {"play": LIMIT}, resolution={"play": 1e-5})
        if abs(np.diff(play, 2).item()) < 1e-9:
            on_line += 1
            covered += life.low <= (LIMIT - start) / slope - work[-1] <= life.high
    assert on_line > 0.3 * GEARS
    assert covered > 0.95 * on_line


def test_a_limit_that_the_first_test_is_past_is_refused() -> None:
    values = {"stiffness": [2.0e4, 1.95e4, 1.85e4]}
    with pytest.raises(ValueError, match="the stiffness: 20 kN·m/rad, limit 25 kN·m/rad, and wear lowers it"):
        sw.diagnose.wear_life([0.0, 1e6, 2e6], values, {"stiffness": 25e3})


def test_a_life_far_beyond_the_tests_is_stated_as_assumed() -> None:
    work = [0.0, 1e6, 2e6, 3e6]
    play = [1.0e-4, 1.31e-4, 1.58e-4, 1.92e-4]
    assert sw.diagnose.wear_life(work, {"play": play}, {"play": 4e-4}).remarks == ()
    (remark,) = sw.diagnose.wear_life(work, {"play": play}, {"play": 4e-3}).remarks
    assert "the life is 42 times the work between the first and the last test, 3 MJ" in remark.replace(
        "\N{NO-BREAK SPACE}", " "
    )


def test_a_quantity_that_moves_away_from_its_limit_promises_nothing() -> None:
    life = sw.diagnose.wear_life([0.0, 1e6, 2e6, 3e6], {"stiffness": [1.0e4, 1.1e4, 1.2e4, 1.3e4]}, {"stiffness": 8e3})
    assert (life.low, life.high, life.limited_by) == (0.0, inf, "")


def test_the_fault_at_the_end_of_life_has_all_quantities_at_their_lines() -> None:
    work = np.array([0.0, 1e6, 2e6, 4e6])
    tests = {
        "play": 1e-4 + 3e-11 * work,
        "amplitude": 5e-5 + 1e-11 * work,
        "friction": 2.0 + 1e-7 * work,
        "stiffness": 2e4 - 5e-4 * work,
    }
    limits = {"play": 4e-4, "amplitude": 1e-3, "friction": 1e3, "stiffness": 1e3}
    life = sw.diagnose.wear_life(work, {name: values.tolist() for name, values in tests.items()}, limits)
    assert life.limited_by == "play"
    assert life.remaining == pytest.approx(6e6)
    half = grown(life.fault, life.onset, 5e6)
    assert half.severity == pytest.approx(0.5)
    drive = sw.Drive(
        gear=sw.Gear(
            kinematics=sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline"),
            stiffness=sw.stiffness.Linear(k=2e4),
            friction_mesh=sw.friction.Coulomb(coulomb=2.0),
        )
    )
    worn: Any = sw.dataset.with_faults(drive, [half]).gear
    assert worn.stiffness.clearance == pytest.approx(3e-11 * 5e6)
    assert worn.stiffness.law.k == pytest.approx(2e4 - 5e-4 * 5e6)
    assert worn.friction_mesh.coulomb == pytest.approx(2.0 + 1e-7 * 5e6)
    assert worn.kinematic_error.amplitude == pytest.approx([1e-11 * 5e6])


def test_transmitted_work_is_that_of_a_sine_under_gravity() -> None:
    """Torque m sin(a) over the angle a from 0 to pi and back: 4 m."""
    angle = 0.5 * pi * (1.0 - np.cos(np.linspace(0.0, 2.0 * pi, 4001)))
    recording = sw.Recording({"torque": 5.0 * np.sin(angle), "output_angle": angle}, {"torque": "N.m", "output_angle": "rad"})
    assert sw.diagnose.transmitted_work(recording) == pytest.approx(20.0, rel=1e-5)


@pytest.mark.parametrize(
    ("work", "tests", "limits", "why"),
    [
        (np.arange(10_001.0), {"play": np.arange(10_001.0)}, {"play": 1e5}, "one row for each test, not a log"),
        ([0.0, 1.0], {"play": [1.0, 2.0]}, {"play": 3.0}, "need 3 tests, not 2"),
        ([1.0, 1.0, 1.0], {"play": [1.0, 2.0, 3.0]}, {"play": 3.0}, "all tests are after the same work, 1 J"),
        ([0.0, 1.0, 2.0], {"wobble": [1.0, 2.0, 3.0]}, {"wobble": 3.0}, "give one or more of play, amplitude, friction"),
        ([0.0, 1.0, 2.0], {}, {}, "tests has the quantities none"),
        ([0.0, 1.0, 2.0], {"play": [1.0, 2.0, 3.0]}, {}, 'limits lacks "play"'),
        ([0.0, 1.0, 2.0], {"play": [1.0, 2.0]}, {"play": 3.0}, "play has 2 values for 3 tests"),
    ],
)
def test_what_cannot_be_fitted_is_refused(
    work: list[float], tests: dict[str, list[float]], limits: dict[str, float], why: str
) -> None:
    with pytest.raises(ValueError, match=why):
        sw.diagnose.wear_life(work, tests, limits)


@pytest.mark.parametrize("sigma", [{"ply": 1.0}, {"play": float("nan")}, {"play": -1e-5}])
def test_deviations_that_are_none_are_refused(sigma: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="sigma"):
        sw.diagnose.wear_life([0.0, 1e6, 2e6, 3e6], {"play": [1e-4, 1.3e-4, 1.6e-4, 1.9e-4]}, {"play": 4e-4}, sigma=sigma)
