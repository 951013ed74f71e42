"""False alarms of the whole diagnosis on simulated healthy units: a small version of `python -m tests.false_alarms`."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binom
from strainwave.diagnose.diagnosis import Diagnosis
from strainwave.parameters import every

from tests.false_alarms import Days, diagnoses, interval, joint, least_probability, numbers

DAYS = Days(baseline=3, later=3)
RATE = 0.05  # stated rate of false alarms


@pytest.fixture(scope="module")
def found() -> list[Diagnosis]:
    return list(diagnoses(2, DAYS, day_spread=0.1, noise=(0.003, 0.003), false_alarm=RATE))


def test_healthy_units_raise_no_more_alarms_than_stated(found: list[Diagnosis]) -> None:
    runs = [run for each in found for run in each.runs]
    assert len(runs) == 2 * DAYS.later
    assert {run.verdict for run in runs} <= {"no change found", "changed"}  # all are compared
    assert sum(run.verdict == "changed" for run in runs) <= binom.isf(1e-3, len(runs), RATE)


def test_the_least_probability_of_a_run_determines_its_alarm_at_every_stated_rate(found: list[Diagnosis]) -> None:
    for each in found:
        for run in each.runs:
            assert 0.0 < least_probability(run) <= 1.0
            assert (least_probability(run) < RATE) == (run.verdict == "changed")


def test_units_and_days_differ() -> None:
    drive, random = joint().drive, np.random.default_rng(1)
    units = [numbers(drive, DAYS, 0.1, random) for _ in range(2)]
    for path in ("gear.friction_input.coulomb", "load.gravity_torque", "gear.kinematic_error.amplitude[0]"):
        assert len({day[path] for unit in units for day in unit}) == 2 * DAYS.all
        assert all(day[path] > 0.0 for unit in units for day in unit)
    assert len({day["gear.stiffness.k1"] for unit in units for day in unit}) == 2  # of a unit
    assert every(drive)["gear.stiffness.k1"].value not in {day["gear.stiffness.k1"] for unit in units for day in unit}


def test_the_interval_of_a_rate_is_that_of_clopper_and_pearson() -> None:
    low, high = interval(0, 1000)
    assert low == 0.0
    assert high == pytest.approx(1.0 - 0.025 ** (1.0 / 1000.0), rel=1e-6)
