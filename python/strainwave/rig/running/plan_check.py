"""A record held against its plan: steps skipped, swapped, repeated, with other masses, and peaks that were not reached."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import degrees
from typing import Literal

import numpy as np

from strainwave.presentation import Statement
from strainwave.rig.bench.steps import Step
from strainwave.rig.running.plan import Plan

Kind = Literal[
    "skipped", "swapped", "repeated", "extra", "wrong masses", "not made", "unplanned", "peak", "not closed", "unfinished"
]
_MASS_RESOLUTION = 1e-6  # kg: totals that differ by less are equal
Masses = tuple[int, int]  # on the positive and the negative pans [mg]


@dataclass(frozen=True)
class Deviation(Statement):
    """A deviation of a record from its plan.

    Attributes:
        kind: how
        step: number of the step in the record, or in the plan where the record has none; 0 where it is no single step
        words: what was found, in one line

    >>> import strainwave as sw
    >>> made = sw.rig.plan(sw.rig.load("couple-rig"), positions=[0.0])
    >>> (deviation,) = sw.rig.check([step for step in made.steps if step.number != 4], made)
    >>> deviation.kind, deviation.step
    ('skipped', 4)
    """

    kind: Kind
    step: int
    words: str

    def _headline(self) -> str:
        return self.words


def check(steps: Sequence[Step], plan: Plan | Sequence[Step]) -> list[Deviation]:
    """Compare a record with its plan: for each position and unit, the order of masses that needs the fewest changes.

    Args:
        steps: as recorded
        plan: the plan, or its steps

    Returns:
        What differs, in the order of the record; nothing where it is as planned.

    >>> from strainwave.rig import load, plan
    >>> made = plan(load("couple-rig"), positions=[0.0])
    >>> record = [step for step in made.steps if step.number != 4]
    >>> [str(finding) for finding in check(record, made)]
    ['step 4 of the plan is skipped: 200 g on the positive pans, 0 g on the negative ones']
    """
    planned = plan.steps if isinstance(plan, Plan) else plan
    of_plan, of_record = _places(planned), _places(steps)
    findings: list[Deviation] = []
    for place in dict.fromkeys((*of_plan, *of_record)):
        if place not in of_record:
            findings.append(Deviation("not made", 0, f"{_called(place)}: planned, but not made"))
        elif place not in of_plan:
            findings.append(Deviation("unplanned", of_record[place][0].number, f"{_called(place)}: made, but not planned"))
        else:
            findings += _of_place(of_plan[place], of_record[place])
    return findings


def _places(steps: Sequence[Step]) -> dict[tuple[float, str], list[Step]]:
    found: dict[tuple[float, str], list[Step]] = {}
    for step in steps:
        found.setdefault((round(step.position, 9), step.unit), []).append(step)
    return found


def _called(place: tuple[float, str]) -> str:
    return f"{f'unit {place[1]}, ' if place[1] else ''}flexspline at {degrees(place[0]):.6g} degrees"


def _masses(step: Step) -> Masses:
    return round(step.mass_positive / _MASS_RESOLUTION), round(step.mass_negative / _MASS_RESOLUTION)


def _in_words(step: Step) -> str:
    return f"{1e3 * step.mass_positive:.6g} g on the positive pans, {1e3 * step.mass_negative:.6g} g on the negative ones"


def _of_place(planned: Sequence[Step], made: Sequence[Step]) -> Iterator[Deviation]:
    changes = _changes([_masses(step) for step in planned], [_masses(step) for step in made])
    end = len(changes)
    while end and changes[end - 1][0] == "skipped":
        end -= 1
    for kind, row, place in changes[:end]:
        yield from _deviation_in_words(kind, planned, made, row, place)
    if end < len(changes):
        missing = [planned[row].number for _, row, _ in changes[end:]]
        rest = (
            f"steps {missing[0]} to {missing[-1]} of the plan are" if len(missing) > 1 else f"step {missing[0]} of the plan is"
        )
        words = f"the record ends after step {made[-1].number}: {rest} still to be made"
        yield Deviation("unfinished", made[-1].number, words)
    yield from _of_peaks(planned, made, finished=end == len(changes))


def _deviation_in_words(kind: str, planned: Sequence[Step], made: Sequence[Step], row: int, place: int) -> Iterator[Deviation]:
    """A change in words; `row` and `place` are those that it begins with in plan and record."""
    if kind == "skipped":
        step = planned[row]
        yield Deviation("skipped", step.number, f"step {step.number} of the plan is skipped: {_in_words(step)}")
    elif kind == "extra":
        step = made[place]
        again = place > 0 and _masses(made[place - 1]) == _masses(step)
        here = "repeats the one before" if again else f"is not in the plan: {_in_words(step)}"
        words = f"step {step.number} {here}"
        yield Deviation("repeated" if again else "extra", step.number, words)
    elif kind == "wrong":
        step = made[place]
        yield Deviation(
            "wrong masses", step.number, f"step {step.number} has {_in_words(step)}; planned are {_in_words(planned[row])}"
        )
    elif kind == "swapped":
        yield Deviation("swapped", made[place].number, f"steps {made[place].number} and {made[place + 1].number} are swapped")


def _of_peaks(planned: Sequence[Step], made: Sequence[Step], finished: bool) -> Iterator[Deviation]:
    for name, pans in (("mass_positive", "positive"), ("mass_negative", "negative")):
        wanted, reached = (max(getattr(step, name) for step in steps) for steps in (planned, made))
        if finished and reached < wanted - _MASS_RESOLUTION:
            words = f"the {pans} peak is not reached: at most {1e3 * reached:.6g} g of {1e3 * wanted:.6g} g lay on its pans"
            yield Deviation("peak", 0, words)
    if finished and _masses(made[-1]) != _masses(planned[-1]):
        words = f"the last step, {made[-1].number}, does not return to where the cycle began: {_in_words(made[-1])}"
        yield Deviation("not closed", made[-1].number, words)


def _changes(planned: Sequence[Masses], made: Sequence[Masses]) -> list[tuple[str, int, int]]:
    """The fewest changes that make the plan the record, its beginning first: what, and where in both.

    Two neighbours may be swapped: the distance of Damerau1964 between two texts, and its path.
    """
    n, m = len(planned), len(made)
    cost = np.zeros((n + 1, m + 1), dtype=int)  # of what is left of both
    cost[:, m], cost[n, :] = np.arange(n, -1, -1), np.arange(m, -1, -1)
    for i in range(n - 1, -1, -1):
        for j in range(m - 1, -1, -1):
            cost[i, j] = min(each for _, _, _, each in _ways(planned, made, cost, i, j))
    changes: list[tuple[str, int, int]] = []
    i = j = 0
    while i < n or j < m:
        kind, on_i, on_j = next((kind, a, b) for kind, a, b, each in _ways(planned, made, cost, i, j) if each == cost[i, j])
        changes.append((kind, i, j))
        i, j = i + on_i, j + on_j
    return changes


def _ways(
    planned: Sequence[Masses], made: Sequence[Masses], cost: np.ndarray[tuple[int, int], np.dtype[np.int_]], i: int, j: int
) -> Iterator[tuple[str, int, int, int]]:
    """Yield the ways to continue from steps i and j: kind, steps taken in plan and record, and cost until the end."""
    more_planned, more_made = len(planned) - i, len(made) - j
    if more_planned and more_made:
        alike = planned[i] == made[j]
        yield "as planned" if alike else "wrong", 1, 1, int(cost[i + 1, j + 1]) + (not alike)
    if more_planned > 1 and more_made > 1 and planned[i] == made[j + 1] != planned[i + 1] == made[j]:
        yield "swapped", 2, 2, int(cost[i + 2, j + 2]) + 1
    if more_planned:
        yield "skipped", 1, 0, int(cost[i + 1, j]) + 1
    if more_made:
        yield "extra", 0, 1, int(cost[i, j + 1]) + 1
