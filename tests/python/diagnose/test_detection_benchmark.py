"""The benchmark of detection counts what it says, on few units with faults that nobody overlooks."""

from __future__ import annotations

from dataclasses import replace
from math import exp, inf, log

import numpy as np
import pytest

from tests.evidence import detection_benchmark
from tests.evidence.detection_benchmark import (
    BASE,
    DETECTORS,
    FAULTS,
    SEARCH,
    Count,
    Joint,
    Result,
    is_lost_again,
    results,
    severity_cell,
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


@pytest.mark.slow("diagnose")
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


@pytest.mark.slow("diagnose")
@pytest.mark.usefixtures("few")
def test_thresholds_are_exceeded_by_the_stated_share_of_healthy_days(monkeypatch: pytest.MonkeyPatch) -> None:
    """A rate of 1 in 3 of six days, three in each condition: the third largest change, which two days exceed."""
    changes: list[tuple[float, float]] = []
    simple = detection_benchmark.Unit.simple

    def recorded(
        unit: detection_benchmark.Unit, record: tuple[detection_benchmark.Array, detection_benchmark.Array]
    ) -> tuple[float, float]:
        changes.append(simple(unit, record))
        return changes[-1]

    monkeypatch.setattr(detection_benchmark.Unit, "simple", recorded)
    monkeypatch.setattr(detection_benchmark, "FALSE_ALARM", 1.0 / 3.0)
    assert trained(1, [CASE], seed=3) == {(CASE.noise, CASE.length): tuple(np.sort(changes, axis=0)[-3])}
    assert np.shape(changes) == (6, 2)
    assert np.min(changes) > 0.0


@pytest.mark.usefixtures("few")
def test_days_of_a_unit_differ_in_friction_and_load_alone() -> None:
    joint = Joint(2, seed=1)
    one, other = joint.day(0, 40.0), joint.day(0, 40.0)
    differing = {path for path in one if one[path] != other[path]}
    assert differing == {*detection_benchmark.FRICTION_PATHS, "load.held_torque[0]", "load.held_torque[1]"}
    units = {path for path, value in joint.day(1, 40.0).items() if value != one[path]}
    assert {"gear.stiffness.k2", "motor.inertia", "load.inertia", "motor.torque_constant"} < units


def counted(alarms: tuple[int, ...]) -> Result:
    """Return a result of 20 units with some alarms at each severity of a crack."""
    by_severity = zip(FAULTS["crack"][1], alarms, strict=True)
    return Result(BASE, {("crack", each): {"diagnose": Count(count, 20)} for each, count in by_severity}, 0)


def test_the_severity_for_a_probability_lies_between_two_by_their_logarithm() -> None:
    assert severity_for(counted((0, 0, 4, 16, 20, 20)), "crack", "diagnose") == pytest.approx(exp(0.5 * (log(0.25) + log(0.5))))
    assert severity_for(counted((0, 0, 0, 0, 0, 0)), "crack", "diagnose") == inf
    assert severity_cell(counted((0, 0, 0, 0, 0, 17)), "crack", "diagnose") == "> 1"


def test_a_severity_has_a_star_if_a_larger_one_is_not_found() -> None:
    assert not is_lost_again(counted((0, 0, 18, 20, 18, 20)), "crack", "diagnose")
    assert severity_cell(counted((0, 0, 18, 20, 18, 20)), "crack", "diagnose") == "0.12"
    assert severity_cell(counted((0, 0, 18, 20, 20, 17)), "crack", "diagnose") == "0.12*"
