"""The benchmark of detection counts what it says, on few units with faults that nobody overlooks."""

from __future__ import annotations

from dataclasses import replace
from math import exp, inf, log, sqrt

import pytest

from tests import detection_benchmark
from tests.detection_benchmark import (
    BASE,
    DETECTORS,
    FAULTS,
    SEARCH,
    Count,
    Joint,
    Result,
    results,
    severity_for,
    table,
    trained,
)

CASE = replace(BASE, noise=0.04)  # BASE would be searched, too


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(detection_benchmark, "LONGEST", CASE.length)
    monkeypatch.setattr(detection_benchmark, "HEALTHY_DAYS", 2)
    monkeypatch.setattr(detection_benchmark, "TRAINING_DAYS", 3)
    monkeypatch.setattr(detection_benchmark, "FAULTS", {name: (fault, (1.0,)) for name, (fault, _) in FAULTS.items()})


@pytest.mark.usefixtures("few")
def test_severe_faults_are_alarms_and_healthy_days_are_none() -> None:
    (result,) = results(1, [CASE], {(CASE.noise, CASE.length): (inf, 0.0)}, seed=5)
    assert result.not_compared == 0
    counts = {label: [each[name] for name in DETECTORS] for label, each in result.found.items()}
    assert counts["", 0.0] == [Count(0, 2), Count(0, 2), Count(2, 2)]  # any change is above a threshold of 0
    for fault in FAULTS:
        assert counts[fault, 1.0] == [Count(1, 1), Count(0, 1), Count(1, 1)], fault
    with_search = {label: {**each, SEARCH: Count(0, 1)} for label, each in result.found.items()}
    lines = table([replace(result, case=BASE, found=with_search)]).splitlines()
    assert f"| units | {BASE.label} | 2 | 0 | 0 | 2 | 0 |" in lines
    assert f"| crack | {BASE.label} | 1 | > 1 | 1 |" in lines


@pytest.mark.usefixtures("few")
def test_thresholds_are_exceeded_by_no_more_healthy_days_than_stated() -> None:
    """Of six days in each condition, the largest change: 1 in 1000 is less than one of them."""
    ((place, (ripple, rms)),) = trained(1, [CASE], seed=3).items()
    assert place == (CASE.noise, CASE.length)
    assert 0.0 < ripple < 0.3
    assert 0.0 < rms < 0.3


@pytest.mark.usefixtures("few")
def test_days_of_a_unit_differ_in_friction_and_load_alone() -> None:
    joint = Joint(2, seed=1)
    one, other = joint.day(0, 40.0), joint.day(0, 40.0)
    differing = {path for path in one if one[path] != other[path]}
    assert differing == {*detection_benchmark.FRICTION_PATHS, "load.held_torque[0]", "load.held_torque[1]"}
    units = {path for path, value in joint.day(1, 40.0).items() if value != one[path]}
    assert {"gear.stiffness.k2", "motor.inertia", "load.inertia", "motor.torque_constant"} < units


def test_the_interval_is_wilsons() -> None:
    """Wilson 1927: (p + z^2 / 2n -+ z sqrt(p (1 - p) / n + z^2 / 4 n^2)) / (1 + z^2 / n)."""
    share, count, z = 0.9, 20, 1.959964
    middle, reach = share + z**2 / (2 * count), z * sqrt(share * (1 - share) / count + z**2 / (4 * count**2))
    expected = [(middle - reach) / (1 + z**2 / count), (middle + reach) / (1 + z**2 / count)]
    assert list(Count(18, 20).interval) == pytest.approx(expected, rel=1e-5)


def test_the_severity_for_a_probability_lies_between_two_by_their_logarithm() -> None:
    alarms = dict(zip(FAULTS["crack"][1], (0, 0, 4, 16, 20, 20), strict=True))
    found = {("crack", each): {"diagnose": Count(count, 20)} for each, count in alarms.items()}
    assert severity_for(Result(BASE, found, 0), "crack", "diagnose") == pytest.approx(exp(0.5 * (log(0.25) + log(0.5))))
    none = {("crack", each): {"diagnose": Count(0, 20)} for each in alarms}
    assert severity_for(Result(BASE, none, 0), "crack", "diagnose") == inf
