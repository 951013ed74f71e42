"""Records against their plans: what was changed on purpose is what is found."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, strategies as st
from strainwave.rig.bench.rig_file import load
from strainwave.rig.bench.steps import Step
from strainwave.rig.running.plan import plan
from strainwave.rig.running.plan_check import check

PLAN = plan(load("couple-rig"), positions=[0.0])
STEPS = list(PLAN.steps)


def numbered(steps: list[Step]) -> list[Step]:
    """As a record has them: numbers in the order made."""
    return [replace(step, number=number) for number, step in enumerate(steps, start=1)]


def found(steps: list[Step]) -> list[tuple[str, int]]:
    return [(finding.kind, finding.step) for finding in check(numbered(steps), PLAN)]


def with_masses(row: int, positive: float, negative: float = 0.0) -> list[Step]:
    return [*STEPS[:row], replace(STEPS[row], mass_positive=positive, mass_negative=negative), *STEPS[row + 1 :]]


def test_a_record_as_planned_has_no_findings() -> None:
    assert check(STEPS, PLAN) == []
    measured = [replace(step, image=f"{step.number}.png", time=1.0 * step.number) for step in STEPS]
    assert check(measured, STEPS) == []


@pytest.mark.parametrize("row", range(29))
def test_a_skipped_step_is_found_wherever_it_is(row: int) -> None:
    steps = STEPS[:row] + STEPS[row + 1 :]
    kinds = [kind for kind, _ in found(steps)]
    expected = {14: ["skipped", "peak"], 28: ["unfinished"]}  # the negative peak, and the last step
    assert kinds == expected.get(row, ["skipped"])


def test_a_skipped_step_is_named_as_in_the_plan() -> None:
    (finding,) = check(numbered(STEPS[:3] + STEPS[4:]), PLAN)
    assert str(finding) == "step 4 of the plan is skipped: 200 g on the positive pans, 0 g on the negative ones"


@pytest.mark.parametrize("row", [0, 5, 9, 20, 27])
def test_swapped_steps_are_found(row: int) -> None:
    steps = [*STEPS[:row], STEPS[row + 1], STEPS[row], *STEPS[row + 2 :]]
    assert found(steps)[0] == ("swapped", row + 1)
    assert str(check(numbered(steps), PLAN)[0]) == f"steps {row + 1} and {row + 2} are swapped"


@pytest.mark.parametrize("row", [0, 5, 14, 28])
def test_a_repeated_step_is_found(row: int) -> None:
    assert [kind for kind, _ in found([*STEPS[: row + 1], STEPS[row], *STEPS[row + 1 :]])] == ["repeated"]


def test_other_masses_are_found() -> None:
    assert found(with_masses(3, 0.225)) == [("wrong masses", 4)]
    (finding,) = check(with_masses(3, 0.225), PLAN)
    said = "step 4 has 225 g on the positive pans, 0 g on the negative ones; planned are 200 g on the positive pans"
    assert str(finding).startswith(said)


def test_masses_on_the_wrong_pans_are_found() -> None:
    assert found(with_masses(3, 0.0, 0.2)) == [("wrong masses", 4)]


def test_a_step_beyond_the_plan_is_found() -> None:
    assert found([*STEPS[:4], Step(9, 0.9), *STEPS[4:]]) == [("extra", 5)]


def test_a_peak_that_was_not_reached_is_found() -> None:
    assert found(with_masses(14, 0.0, 0.325)) == [("wrong masses", 15), ("peak", 0)]
    assert "at most 325 g of 350 g lay on its pans" in str(check(with_masses(14, 0.0, 0.325), PLAN)[1])


def test_a_cycle_that_does_not_return_is_found() -> None:
    assert found(with_masses(28, 0.3)) == [("wrong masses", 29), ("not closed", 29)]


def test_a_test_that_was_broken_off_is_unfinished_not_wrong() -> None:
    (finding,) = check(STEPS[:10], PLAN)
    assert str(finding) == "the record ends after step 10: steps 11 to 29 of the plan are still to be made"


def test_positions_and_units_are_held_against_their_own() -> None:
    rig = load("couple-rig")
    planned = plan(rig, positions=[0.0, math.radians(60.0)], units=["A", "B"])
    made = [step for step in planned.steps if step.unit == "A"]
    assert [str(each) for each in check(made, planned)] == [
        "unit B, flexspline at 0 degrees: planned, but not made",
        "unit B, flexspline at 60 degrees: planned, but not made",
    ]
    (finding,) = check([*STEPS, Step(30, 0.1, position=2.0)], PLAN)
    assert (finding.kind, finding.step) == ("unplanned", 30)


@given(rows=st.sets(st.integers(1, 27), max_size=6))
def test_no_more_is_found_than_was_left_out(rows: set[int]) -> None:
    steps = [step for row, step in enumerate(STEPS) if row not in rows]
    kinds = [kind for kind, _ in found(steps) if kind != "peak"]
    assert len(kinds) == len(rows)
