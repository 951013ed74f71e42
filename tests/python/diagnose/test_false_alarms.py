"""False alarms on healthy units: a small `python -m tests.evidence.false_alarms`, and many runs of the comparison alone."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binom
from strainwave import Recording
from strainwave.diagnose.baseline import Baseline, OrderChange, baseline_of, compared
from strainwave.diagnose.detection import DETECTION_PROBABILITY
from strainwave.diagnose.diagnosis import Diagnosis
from strainwave.diagnose.refusals import usable
from strainwave.diagnose.replicates import JointMotion, joint_motion
from strainwave.parameters import every

from tests.evidence.false_alarms import (
    RATES,
    Days,
    diagnoses,
    exceeds,
    joint,
    least_probability,
    numbers,
    table,
    units_with_an_alarm,
)
from tests.support.samples import sample
from tests.support.shares import share_interval

DAYS = Days(baseline=3, later=3)
RATE = 0.05  # stated rate of false alarms
CHANGED = sample(40, 100)  # units with a change
UNITS = sample(100, 200)  # of the comparison alone, with one run each: runs of one unit are not independent


@pytest.fixture(scope="module")
def found() -> list[Diagnosis]:
    return list(diagnoses(2, DAYS, day_spread=0.1, noise=(0.003, 0.003), false_alarm=RATE))


@pytest.mark.slow("diagnose")
def test_healthy_units_raise_no_more_alarms_than_stated(found: list[Diagnosis]) -> None:
    runs = [run for each in found for run in each.runs]
    assert len(runs) == 2 * DAYS.later
    assert {run.verdict for run in runs} <= {"no change found", "changed"}  # all are compared
    assert min(least_probability(run) for run in runs) > RATES[-1]  # six runs: none is an alarm at 0.001


@pytest.mark.slow("diagnose")
def test_the_least_probability_of_a_run_determines_its_alarm_at_every_stated_rate(found: list[Diagnosis]) -> None:
    for each in found:
        for run in each.runs:
            assert 0.0 < least_probability(run) <= 1.0
            assert (least_probability(run) < RATE) == (run.verdict == "changed")


def day(random: np.random.Generator, amplitudes: np.ndarray, spread: float, noise: float) -> JointMotion:
    """Return a day of a motion to and fro with friction, gravity, and two orders whose amplitudes vary from day to day."""
    time = np.arange(0.0, 10.0, 0.01)
    output = 0.5 * np.sin(0.2 * np.pi * time)
    angle, sense = 100.0 * output, np.sign(np.cos(0.2 * np.pi * time))
    current = 2.0 * np.sin(output) + 0.3 * (1.0 + 0.1 * random.standard_normal()) * sense
    for order, amplitude in zip((2.0, 4.0), amplitudes, strict=True):
        current += amplitude * (1.0 + spread * random.standard_normal()) * np.sin(order * angle + order)
    current += noise * random.standard_normal(len(time))
    columns = {"time": time, "input_angle": angle, "current": current}
    recording = Recording(columns, {"time": "s", "input_angle": "rad", "current": "A"})
    return joint_motion(usable(recording, "a day", ratio=100.0))


@pytest.mark.slow("diagnose")
def test_the_comparison_alone_has_no_more_alarms_than_stated_in_many_runs() -> None:
    random, probabilities = np.random.default_rng(2), list[float]()
    for _ in range(UNITS):
        unit = 0.03 * np.exp(0.3 * random.standard_normal(2)), 0.1, 0.02
        baseline = baseline_of([day(random, *unit) for _ in range(DAYS.baseline)], [2.0, 4.0])
        changes = compared(baseline, day(random, *unit)).changes
        probabilities.append(min(each.false_alarm for each in changes))
    for rate in (0.3, *RATES):
        assert sum(each < rate for each in probabilities) <= binom.isf(1e-3, len(probabilities), rate), rate


@pytest.mark.slow("diagnose")
@pytest.mark.parametrize("spread", [0.0, 0.1])
def test_a_change_of_the_detectable_size_is_an_alarm_in_nine_of_ten(spread: float) -> None:
    """With a spread from day to day that is to be estimated, and without one, where the share is larger."""
    random, alarms = np.random.default_rng(3), 0
    for _ in range(CHANGED):
        amplitudes = 0.03 * np.exp(0.3 * random.standard_normal(2))
        baseline = baseline_of([day(random, amplitudes, spread, 0.02) for _ in range(DAYS.baseline)], [2.0, 4.0])
        size = change_of_order(baseline, day(random, amplitudes, spread, 0.02)).detectable
        alarms += change_of_order(baseline, day(random, amplitudes + np.array([size, 0.0]), spread, 0.02)).alarm
    assert binom.isf(0.999, CHANGED, DETECTION_PROBABILITY) <= alarms
    assert spread == 0.0 or alarms <= binom.isf(1e-3, CHANGED, DETECTION_PROBABILITY)


def change_of_order(baseline: Baseline, motion: JointMotion) -> OrderChange:
    changes = compared(baseline, motion, false_alarm=0.01).changes
    return next(each for each in changes if each.order == 2.0 and each.direction == "forward")


def test_units_and_days_differ() -> None:
    drive, random = joint().drive, np.random.default_rng(1)
    units = [numbers(drive, DAYS, 0.1, random) for _ in range(2)]
    for path in ("gear.friction_input.coulomb", "load.gravity_torque", "gear.kinematic_error.amplitude[0]"):
        assert len({day[path] for unit in units for day in unit}) == 2 * DAYS.all
        assert all(day[path] > 0.0 for unit in units for day in unit)
    assert len({day["gear.stiffness.k1"] for unit in units for day in unit}) == 2  # of a unit
    assert every(drive)["gear.stiffness.k1"].value not in {day["gear.stiffness.k1"] for unit in units for day in unit}


def test_alarms_of_one_unit_count_as_one_unit() -> None:
    least = [[0.5, 0.0005, 0.004], *[[0.5, 0.6, 0.7]] * 8, [0.03, 0.5, 0.5]]
    assert [units_with_an_alarm(least, rate) for rate in RATES] == [2, 1, 1]
    rows = [line.split() for line in table(least).splitlines()[1:]]
    assert [row[:3] for row in rows] == [["0.05", "3", "30"], ["0.01", "2", "30"], ["0.001", "1", "30"]]
    assert [" ".join(row[4:7]) for row in rows] == ["2 of 10", "1 of 10", "1 of 10"]
    assert not any(exceeds(least, rate) for rate in RATES)
    assert exceeds([[0.0005, 0.5]] * 10, 0.001)


def test_the_interval_of_a_share_is_that_of_clopper_and_pearson() -> None:
    low, high = share_interval(0, 1000)
    assert low == 0.0
    assert high == pytest.approx(1.0 - 0.025 ** (1.0 / 1000.0), rel=1e-6)
