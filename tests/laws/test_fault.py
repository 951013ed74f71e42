"""What every fault must obey: a row in the table of failures, nothing at severity 0, the same numbers at every severity."""

from __future__ import annotations

import re
from functools import cache
from typing import Any

import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave import _core
from strainwave.dataset.faults import changes, prepared, with_faults

from tests.support.strategies import built

FAULTS = _core.fault_families["fault"]
DRIVES = ("robot-joint", "space-pointing-joint", "position-drive", "tilt-actuator", "tilt-actuator-lumped", "two-inertia-gear")
REFUSED = re.compile(r"needs a law|needs the teeth|changes nothing of this drive|holds no more")

every_fault = pytest.mark.parametrize("kind", FAULTS.values(), ids=list(FAULTS))
any_fault = st.one_of([built(kind) for kind in FAULTS.values()])
any_drive = st.sampled_from(DRIVES)
load = cache(sw.load)


def ready_for(name: str, faults: list[Any]) -> sw.Drive | None:
    """The drive prepared for the faults; None if it says that it lacks a part."""
    try:
        return prepared(load(name), faults)
    except ValueError as error:
        if not REFUSED.search(str(error)):
            raise
        return None


def numbers(drive: sw.Drive) -> dict[str, float]:
    return {path: value for path, value, *_ in _core.parameters(drive)}


@every_fault
def test_a_fault_says_what_fails_what_changes_and_where_it_shows(kind: Any) -> None:
    assert all(len(text) > 10 and not text.endswith(".") for text in (kind.mode, kind.effect, kind.signal))
    assert re.search("severity 1", kind.__doc__, re.IGNORECASE)
    assert kind.fields[0]["name"] == "severity"
    assert (kind.fields[0]["min"], kind.fields[0]["max"]) == (0.0, 1.0)


@given(any_fault, any_drive)
def test_severity_0_changes_no_number(fault: Any, name: str) -> None:
    healthy = fault.replace(severity=0.0)
    ready = ready_for(name, [healthy])
    if ready:
        known = numbers(ready)
        assert all(value == known[path] for path, value in changes(ready, [healthy]).items())
        assert with_faults(load(name), [healthy]) == ready


@given(any_fault, any_drive, st.floats(0.0, 1.0))
def test_the_numbers_that_change_are_the_same_at_every_severity(fault: Any, name: str, severity: float) -> None:
    other = fault.replace(severity=severity)
    ready = ready_for(name, [fault])
    assert ready == ready_for(name, [other])
    if ready:
        assert list(changes(ready, [fault])) == list(changes(ready, [other]))


@given(any_fault, any_drive)
def test_what_is_prepared_needs_no_preparation(fault: Any, name: str) -> None:
    ready = ready_for(name, [fault])
    if ready:
        assert prepared(ready, [fault]) == ready


@every_fault
def test_a_fault_of_severity_1_changes_a_drive_that_has_its_parts(kind: Any) -> None:
    drive = load("robot-joint")
    ready = prepared(drive, [kind()])
    known = numbers(ready)
    assert any(value != known[path] for path, value in changes(ready, [kind()]).items())


@every_fault
@pytest.mark.parametrize("name", DRIVES)
def test_a_prepared_drive_runs_as_the_healthy_one_to_the_last_bit(kind: Any, name: str) -> None:
    ready = ready_for(name, [kind()])
    if ready is None:
        return
    healthy = _run(name)
    run = sw.simulate(ready, _command())
    assert all((run[column] == healthy[column]).all() for column in healthy.names)


@given(st.lists(any_fault, min_size=2, max_size=3))
def test_faults_act_in_their_order_on_the_numbers_that_those_before_leave(faults: list[Any]) -> None:
    try:
        ready = prepared(load("robot-joint"), faults)
        after_first = ready.replace(changes(ready, faults[:1]))
        step_by_step = after_first.replace(changes(after_first, faults[1:]))
        at_once = ready.replace(changes(ready, faults))
    except ValueError:  # a number leaves its range, or a law holds no more waves
        return
    assert numbers(at_once) == pytest.approx(numbers(step_by_step), rel=1e-12, abs=1e-18)


def test_what_is_no_fault_is_refused() -> None:
    with pytest.raises(TypeError, match=r"a fault must be a model of strainwave\.fault, not Linear"):
        prepared(sw.Drive(), [sw.stiffness.Linear(k=1.0)])


def test_a_drive_that_is_not_prepared_is_refused_by_changes() -> None:
    with pytest.raises(ValueError, match=r"not prepared for linkage_play: gear\.stiffness lacks backlash; call prepared first"):
        changes(sw.Drive(), [sw.fault.LinkagePlay()])


def _command() -> sw.scenario.Scenario:
    return sw.scenario.sine(0.05, 5.0, 0.05)


@cache
def _run(name: str) -> sw.Run:
    return sw.simulate(load(name), _command())
