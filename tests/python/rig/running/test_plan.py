"""Plans of torsion tests, and records held against them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import assume, given, strategies as st
from strainwave.rig.bench.rig_file import load
from strainwave.rig.bench.setup import Masses, Rig, Value
from strainwave.rig.bench.steps import Step
from strainwave.rig.running.plan import Pans, Plan, check, plan, reachable

RIG = Rig("bench", "input", Value(0.1), gravity=Value(9.81), masses=(Masses(0.025, 16), Masses(0.1, 9)))
PLAN = plan(load("couple-rig"), positions=[0.0])
STEPS = list(PLAN.steps)


def test_the_torques_of_document_t_are_those_of_its_masses() -> None:
    """Erratum E-T6: 14, 15 and 16 masses of 25 g give 0.343, 0.368 and 0.392 N.m; with equal pans 15 are impossible."""
    assert [round(each, 3) for each in reachable(RIG, 0.36)] == [0.343, 0.392]
    assert [round(each, 3) for each in reachable(RIG, 0.36, "unequal")] == [0.343, 0.368]
    assert reachable(RIG, 14 * 0.025 * 9.81 * 0.1) == pytest.approx((0.34335, 0.34335), rel=1e-12)


def test_the_plan_of_document_t_is_its_cycle_in_steps_of_two_masses() -> None:
    made = plan(RIG)
    assert round(made.peak, 3) == 0.343
    assert {step.position for step in made.steps} == {0.0, math.radians(60.0), math.radians(120.0)}
    cycle = [step.mass_positive - step.mass_negative for step in made.steps[:29]]
    assert cycle == pytest.approx([0.05 * abs(n) - 0.35 for n in range(14, -15, -1)], abs=1e-12)
    names = [stage.name for stage in made.stages[:29]]
    ends = [names.index(name) for name in dict.fromkeys(names)]
    assert list(zip(ends, dict.fromkeys(names), strict=True)) == [
        (0, "peak"), (1, "positive unloading"), (8, "negative loading"), (15, "negative unloading"), (22, "positive loading"),
    ]  # fmt: skip


def test_a_plan_says_what_the_peak_comes_to_and_what_unequal_pans_cost() -> None:
    nearest, couple, _ = plan(RIG).remarks
    near = "nearest are 0.3434 N.m (350 g) and 0.3924 N.m (400 g)"
    assert nearest == f"0.36 N.m is no step of these masses: {near}; planned is 0.3434 N.m."
    assert couple == "Both pans of a pair carry the same: a pure couple, in steps of 0.0491 N.m or more."
    assert plan(RIG, pans="unequal").remarks[1] == (
        "The pans of a pair differ by up to 25 g: a side force of up to 0.245 N on the shaft, no pure couple."
    )
    assert plan(RIG, 0.0981 * 3, cycles=2).remarks == (couple,)


def test_a_plan_says_what_to_do() -> None:
    tasks = [stage.task for stage in plan(RIG, positions=[0.0, math.radians(60.0)], units=["A"]).stages]
    assert tasks[0] == "specimen A, flexspline at 0 degrees; positive pans: lay 7 x 25 g on each"
    assert tasks[1] == "positive pans: take 25 g off each"
    assert tasks[8] == "negative pans: lay 25 g on each"
    assert tasks[29] == "take all masses off; specimen A, flexspline at 60 degrees; positive pans: lay 7 x 25 g on each"


def test_unequal_pans_are_changed_in_turn() -> None:
    tasks = [stage.task for stage in plan(RIG, pans="unequal", positions=[0.0]).stages]
    assert tasks[1:3] == ["positive pan 1: take 25 g off", "positive pan 2: take 25 g off"]


def test_a_plan_prints_a_row_for_each_step() -> None:
    made = plan(RIG, positions=[math.radians(60.0)])
    rows = made.to_dict()["rows"]
    assert len(rows) == 29
    note = "at 60°, 300 g and 0 g, positive unloading: positive pans: take 25 g off each"
    assert (round(rows["step 2"]["value"], 4), rows["step 2"]["note"]) == (0.2943, note)
    assert all(f"  {name} " in str(made) for name in rows)


def test_too_few_small_masses_are_told() -> None:
    few = Rig("bench", "input", Value(0.1), masses=(Masses(0.025, 6), Masses(0.1, 8)))
    assert any("some steps exchange masses" in remark for remark in plan(few).remarks)
    assert not any("some steps exchange masses" in remark for remark in plan(RIG).remarks)


@pytest.mark.parametrize(
    ("peak", "arguments", "message"),
    [
        (2.0, {}, "peak = 2 N.m: the masses (16 x 25 g, 9 x 100 g) do not make 2050 g on a pair of pans that carry the same"),
        (1.25, {}, "at most 1200 g, which is 1.177 N.m: ask for less"),
        (2.0, {"pans": "unequal"}, "at most 1300 g, which is 1.275 N.m: ask for less"),
        (-0.36, {}, "peak = -0.36 N.m must lie in (0, inf)"),
        (math.nan, {}, "peak = nan N.m must lie in (0, inf)"),
        (0.36, {"step": 0.0}, "step = 0.0 N.m must lie in (0, inf)"),
        (1e300, {}, "at most 1200 g"),
        (0.36, {"cycles": 10**6}, "the plan has about 96000000 steps; at most 100000 are allowed; take larger"),
        (0.36, {"cycles": 0}, "cycles = 0 must be 1 or more"),
        (0.36, {"pans": "one"}, 'pans = "one" must be one of equal, unequal'),
    ],
)
def test_a_plan_that_cannot_be_is_refused(peak: float, arguments: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        plan(RIG, peak, **arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("pans", "masses", "level"),
    [
        ("equal", (Masses(0.025, 2), Masses(0.1, 8)), "100 g on a pair of pans that carry the same"),
        ("unequal", (Masses(0.025, 2), Masses(0.1, 9)), "75 g on a pair of pans that carry the same but for one mass"),
    ],
)
def test_a_level_between_that_the_masses_do_not_make_is_refused(pans: Pans, masses: tuple[Masses, ...], level: str) -> None:
    """All masses together suffice for the peak; those that are small enough for a step do not."""
    with pytest.raises(ValueError, match=re.escape(f" do not make {level}")):
        plan(Rig("bench", "input", Value(0.1), masses=masses), 0.3, pans=pans)


def test_a_rig_without_masses_has_no_plan() -> None:
    with pytest.raises(ValueError, match=re.escape("bench has no masses; write [[masses]] with mass and count in its file")):
        plan(Rig("bench", "input", Value(0.1)))


# Laws


sets = st.tuples(st.sampled_from([0.02, 0.025, 0.05]), st.integers(2, 30), st.sampled_from([2, 4, 5]), st.integers(0, 12)).map(
    lambda given: tuple(Masses(mass, count) for mass, count in ((given[0], given[1]), (given[0] * given[2], given[3])) if count)
)


@contextmanager
def reject_where_masses_are_missing() -> Iterator[None]:
    try:
        yield
    except ValueError as refused:
        assume("do not make" not in str(refused))
        raise


@st.composite
def plans(draw: st.DrawFn) -> tuple[Rig, Plan]:
    rig = Rig("bench", "input", Value(draw(st.floats(0.05, 0.3))), gravity=Value(9.81), masses=draw(sets))
    peak = draw(st.floats(0.02, 0.8))
    step = draw(st.none() | st.floats(0.01, 0.3))
    pans = draw(st.sampled_from(["equal", "unequal"]))
    cycles = draw(st.integers(1, 2))
    with reject_where_masses_are_missing():
        return rig, plan(rig, peak, step=step, pans=pans, positions=[0.0, 1.0], cycles=cycles)


@given(made=plans())
def test_every_plan_follows_from_its_tasks_with_the_masses_there_are(made: tuple[Rig, Plan]) -> None:
    """Whoever does what is written, mass by mass, has the masses of each step on the pans, and never more than there are."""
    rig, planned = made
    none = {masses.mass: 0 for masses in rig.masses}
    pans = {(side, pan): dict(none) for side in ("positive", "negative") for pan in (1, 2)}
    for stage in planned.stages:
        follow(stage.task, pans, rig)
        for side in ("positive", "negative"):
            total = sum(mass * number for pan in (1, 2) for mass, number in pans[side, pan].items())
            assert total == pytest.approx(getattr(stage.step, f"mass_{side}"), abs=1e-9)
        for masses in rig.masses:
            assert sum(pan[masses.mass] for pan in pans.values()) <= masses.count


def follow(words: str, pans: dict[tuple[str, int], dict[float, int]], rig: Rig) -> None:
    """Does what a task says; no pan gives what it does not carry."""
    if "take all masses off" in words:
        for laid in pans.values():
            laid.update(dict.fromkeys(laid, 0))
    for side, number, what in re.findall(r"(positive|negative) pans?( \d)?: ([^;]+)", words):
        for verb, pieces in re.findall(r"(take|lay) (.+?) (?:off|on)", what):
            for count, grams in re.findall(r"(?:(\d+) x )?([\d.]+) g", pieces):
                mass = min((each.mass for each in rig.masses), key=lambda mass: abs(1e3 * mass - float(grams)))
                for pan in (int(number),) if number else (1, 2):
                    pans[side, pan][mass] += int(count or 1) * (1 if verb == "lay" else -1)
                    assert pans[side, pan][mass] >= 0


@given(made=plans())
def test_every_step_changes_one_pair_alone_and_every_stage_goes_one_way(made: tuple[Rig, Plan]) -> None:
    for before, after in pairwise(made[1].stages):
        if after.name != "peak":
            changed = [getattr(before.step, name) != getattr(after.step, name) for name in ("mass_positive", "mass_negative")]
            assert changed.count(True) == 1
            rising = after.name in ("negative unloading", "positive loading")
            assert (after.torque > before.torque) == rising


@given(made=plans())
def test_every_cycle_is_closed_and_as_deep_as_it_is_high(made: tuple[Rig, Plan]) -> None:
    _, planned = made
    for position in (0.0, 1.0):
        of_position = [stage.torque for stage in planned.stages if stage.step.position == position]
        assert of_position[0] == of_position[-1] == max(of_position) == pytest.approx(planned.peak)
        assert min(of_position) == -max(of_position)
        assert of_position == of_position[::-1]
        assert 0.0 in of_position
    assert [step.number for step in planned.steps] == list(range(1, len(planned.steps) + 1))


@given(made=plans())
def test_the_peak_is_the_nearest_that_the_masses_make(made: tuple[Rig, Plan]) -> None:
    rig, planned = made
    pans = "unequal" if "side force" in " ".join(planned.remarks) else "equal"
    away = [abs(each - planned.wanted) for each in reachable(rig, planned.wanted, pans) if each > 0.0]
    assert abs(planned.peak - planned.wanted) == pytest.approx(min(away), abs=1e-9)


def test_the_rig_of_document_t_reaches_its_torque_without_exchanging_masses() -> None:
    assert len(plan(load("couple-rig"), positions=[0.0]).steps) == 29


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
