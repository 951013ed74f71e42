"""The cycle of a torsion test as a plan: what to lay on the pans and take off at each step.

The torsional stiffness article's cycle has five stages: the peak, positive unloading, negative loading, negative unloading,
positive loading. A pure couple needs the same mass on both pans of a pair, so that the torque has steps (its erratum 6). Masses
are laid on so that each step only adds or only takes off: whoever exchanges masses turns the shaft back and forth, and leaves
the loop.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal, NamedTuple, get_args

import numpy as np

from strainwave import arguments, typeset
from strainwave.files.gear_file import at
from strainwave.presentation import Presented, Row, Statement, counted
from strainwave.rig.bench.setup import Rig
from strainwave.rig.bench.steps import Step, by_place, place_words

Pans = Literal["equal", "unequal"]
SIDES = ("positive", "negative")
STAGES = ("peak", "positive unloading", "negative loading", "negative unloading", "positive loading")
MAX_STEPS = 100_000  # of a plan: a month at 25 seconds a step
_MASS_TOLERANCE = 1e-6  # share of the smallest mass [1]: totals that differ by less are equal
Laid = tuple[Counter[float], Counter[float]]  # how many of each mass lie on the two pans of a pair
Kind = Literal[
    "skipped", "swapped", "repeated", "extra", "wrong masses", "not made", "unplanned", "peak", "not closed", "unfinished"
]
_MASS_RESOLUTION = 1e-6  # kg: totals that differ by less are equal
Masses = tuple[int, int]  # on the positive and the negative pans [mg]


class PlannedStep(NamedTuple):
    """One step of a plan.

    Attributes:
        step: its number, masses, position and unit
        name: of the stage of the cycle, one of `STAGES`
        torque: of the masses, with the full radius of the disk [N.m]
        task: what to do to get there, in words
    """

    step: Step
    name: str
    torque: float
    task: str


@dataclass(frozen=True)
class Plan(Presented):
    """The steps of a torsion test, and what to do for each.

    Attributes:
        stages: every step with its stage, torque and task
        wanted: the peak torque that was asked for [N.m]
        peak: the one that the masses reach [N.m]
        remarks: what whoever makes the test must know

    >>> from strainwave.rig import load
    >>> made = plan(load("couple-rig"), positions=[0.0])
    >>> len(made.steps), round(made.peak, 4)
    (29, 0.3432)
    >>> made.stages[1].task
    'positive pans: take 25 g off each'
    """

    stages: tuple[PlannedStep, ...]
    wanted: float
    peak: float
    remarks: tuple[str, ...] = ()

    @property
    def steps(self) -> tuple[Step, ...]:
        """Return the masses on the pans at each step."""
        return tuple(stage.step for stage in self.stages)

    def _headline(self) -> str:
        return f"{counted(len(self.stages), 'step')} to {typeset.quantity(self.peak, 'N.m')}"

    def _rows(self) -> Iterator[Row]:
        for stage in self.stages:
            step = stage.step
            place = f"{math.degrees(step.position):g}° {step.unit}".rstrip()
            masses = f"{1e3 * step.mass_positive:.6g} g and {1e3 * step.mass_negative:.6g} g"
            yield Row(f"step {step.number}", stage.torque, "N.m", note=f"at {place}, {masses}, {stage.name}: {stage.task}")


def plan(
    rig: Rig,
    peak: float = 0.36,
    *,
    step: float | None = None,
    pans: Pans = "equal",
    positions: Sequence[float] = (0.0, math.radians(60.0), math.radians(120.0)),
    units: Sequence[str] = ("",),
    cycles: int = 1,
) -> Plan:
    """Return a plan of cycles from the positive peak over the negative one and back, for each unit at each position.

    Args:
        rig: its masses, radius and gravity
        peak: torque to be reached; the nearest that the masses make is planned [N.m]
        step: of the torque [N.m]; the smallest that the masses make if None
        pans: whether both pans of a pair get the same mass, for a pure couple, or may differ by one mass, for half the step
        positions: of the flexspline in its mount [rad]
        units: the specimens
        cycles: how many follow each other without a pause

    Returns:
        The steps with their masses [kg] and tasks, and the peak torque that the masses reach [N.m].

    Raises:
        ValueError: the rig has no masses, or not enough of them, or a torque is not positive

    >>> from strainwave.rig import load
    >>> fine = plan(load("couple-rig"), pans="unequal", positions=[0.0])
    >>> len(fine.steps), round(fine.peak, 4)
    (61, 0.3677)
    >>> print(fine.remarks[0])
    0.36 N.m is no step of these masses: nearest are 0.3432 N.m (350 g) and 0.3677 N.m (375 g); planned is 0.3677 N.m.
    """
    peak = arguments.number("peak", peak, "N.m", low=0.0)
    arguments.one_of("pans", pans, get_args(Pans))
    arguments.whole("cycles", cycles, 1)
    if not rig.masses:
        raise ValueError(f"{rig.name} has no masses; write [[masses]] with mass and count in its file")
    quantum = _quantum(rig, pans)
    unit = quantum * _torque_of_mass(rig)
    most = sum(masses.mass * masses.count for masses in rig.masses)
    top = max(1, round(min(peak / unit, 2.0 * most / quantum)))
    _check_reach(rig, pans, peak, top * quantum)
    stride = 1 if step is None else max(1, round(min(arguments.number("step", step, "N.m", low=0.0) / unit, top)))
    count = 4 * (top // stride + 1) * cycles * len(positions) * len(units)
    if count > MAX_STEPS:
        allowed = f"at most {MAX_STEPS} are allowed; take larger steps, or fewer cycles"
        raise ValueError(f"peak = {peak:g} N.m: the plan has about {count} steps; {allowed}")
    with at(f"peak = {peak:g} N.m:"):
        stacks = _stacks(rig, pans, quantum, top, stride)
    up = [*stacks]
    down = up[::-1]
    loads = [*down, *(-level for level in up[1:]), *(-level for level in down[1:]), *up[1:]]
    loads += loads[1:] * (cycles - 1)
    places = [(position, specimen) for specimen in units for position in positions]
    stages = tuple(_stages(rig, loads, stacks, places, quantum))
    return Plan(stages, peak, top * unit, tuple(_remarks(rig, pans, peak, quantum, top, stacks, cycles)))


def reachable(rig: Rig, torque: float, pans: Pans = "equal") -> tuple[float, float]:
    """The largest torque of the masses that is not above a wanted one, and the smallest that is not below [N.m].

    >>> from strainwave.rig import load
    >>> [round(each, 3) for each in reachable(load("couple-rig"), 0.36)]
    [0.343, 0.392]
    """
    unit = _quantum(rig, pans) * _torque_of_mass(rig)
    count = torque / unit
    return unit * math.floor(count + _MASS_TOLERANCE), unit * math.ceil(count - _MASS_TOLERANCE)


# Masses


def _torque_of_mass(rig: Rig) -> float:
    """Torque of a mass on a pair of pans, at the full radius [N.m/kg]."""
    return rig.gravity.value * rig.disk_radius.value


def _quantum(rig: Rig, pans: Pans) -> float:
    """The smallest change of the total on a pair of pans [kg]."""
    return min(masses.mass for masses in rig.masses) * (2 if pans == "equal" else 1)


def _check_reach(rig: Rig, pans: Pans, wanted: float, total: float) -> None:
    """Refuse a peak for which all masses of the rig do not suffice."""
    pieces = 2 if pans == "equal" else 1  # both pans of a pair need a mass of each kind, or either may have it
    most = sum(masses.mass * (masses.count // pieces) * pieces for masses in rig.masses)
    if total > most + _MASS_TOLERANCE * min(masses.mass for masses in rig.masses):
        raise ValueError(
            f"peak = {wanted:g} N.m: the masses ({_there(rig)}) do not make {_grams(total)} on a pair of pans that carry "
            f"{_carry(pans)}; at most {_grams(most)}, which is {most * _torque_of_mass(rig):.4g} N.m: ask for less, or give "
            "the rig more masses"
        )


def _stacks(rig: Rig, pans: Pans, quantum: float, top: int, stride: int) -> dict[int, Laid]:
    """Return the masses on a pair of pans at each level, in quanta: added step by step, so that none is exchanged.

    Where the small masses do not suffice for that, each level is made of the largest masses that fit.
    """
    levels = sorted({*range(0, top, stride), top})
    left = Counter({masses.mass: masses.count for masses in rig.masses})
    stacks: dict[int, Laid] = {0: (Counter(), Counter())}
    for before, level in pairwise(levels):
        added = _taken(left, pans, quantum * (level - before), level - before, before)
        if added is None:
            return {level: _composed(rig, pans, quantum * level) for level in levels}
        stacks[level] = (stacks[before][0] + added[0], stacks[before][1] + added[1])
    return stacks


def _taken(left: Counter[float], pans: Pans, total: float, count: int, before: int) -> Laid | None:
    """Take a total out of what is left, for both pans; None if that is impossible."""
    smallest = min(left)
    if pans == "equal":
        one = _picked(left, 0.5 * total, pieces=2)
        return None if one is None else (one, one)
    shares = [(before + count + lead) // 2 - (before + lead) // 2 for lead in (1, 0)]  # one pan leads by a mass
    first, second = (_picked(left, smallest * share, pieces=1) for share in shares)
    return None if first is None or second is None else (first, second)


def _picked(left: Counter[float], total: float, pieces: int) -> Counter[float] | None:
    """Take the largest masses that make a total out of what is left, so many times; None if nothing makes it."""
    picked: Counter[float] = Counter()
    rest = total
    for mass in sorted(left, reverse=True):
        if number := min(left[mass] // pieces, int(rest / mass + _MASS_TOLERANCE)):
            picked[mass] = number
            rest -= number * mass
    if rest > _MASS_TOLERANCE * min(left):
        return None
    left.subtract({mass: pieces * number for mass, number in picked.items()})
    return picked


def _composed(rig: Rig, pans: Pans, total: float) -> Laid:
    """A total on a pair of pans, made of the largest masses that fit."""
    left = Counter({masses.mass: masses.count for masses in rig.masses})
    count = round(total / min(left))
    laid = _taken(left, pans, total, count, 0) if abs(count * min(left) - total) < _MASS_TOLERANCE * min(left) + 1e-12 else None
    if laid is None:
        raise ValueError(f"the masses ({_there(rig)}) do not make {_grams(total)} on a pair of pans that carry {_carry(pans)}")
    return laid


def _there(rig: Rig) -> str:
    return ", ".join(f"{masses.count} x {_grams(masses.mass)}" for masses in rig.masses)


def _carry(pans: Pans) -> str:
    return "the same" if pans == "equal" else "the same but for one mass"


# Words


def _stages(
    rig: Rig, loads: Sequence[int], stacks: Mapping[int, Laid], places: Sequence[tuple[float, str]], quantum: float
) -> Iterator[PlannedStep]:
    number = 0
    for place, (position, unit) in enumerate(places):
        before: int | None = None
        for load in loads:
            number += 1
            masses = (max(load, 0) * quantum, max(-load, 0) * quantum)
            words = _changes(stacks, before or 0, load)
            if before is None:
                clear, of = "take all masses off; " if place else "", f"specimen {unit}, " if unit else ""
                words = f"{clear}{of}flexspline at {math.degrees(position):g} degrees; {words}"
            step = Step(number, round(masses[0], 12), round(masses[1], 12), position=position, unit=unit)
            yield PlannedStep(step, _stage(before, load), load * quantum * _torque_of_mass(rig), words)
            before = load


def _stage(before: int | None, load: int) -> str:
    if before is None:
        return STAGES[0]
    if load < before:
        return STAGES[1] if load >= 0 else STAGES[2]
    return STAGES[3] if load <= 0 else STAGES[4]


def _changes(stacks: Mapping[int, Laid], before: int, load: int) -> str:
    ends = [(sign * before, sign * load) for sign in (1, -1)]
    changes = [_change(side, *(stacks[max(end, 0)] for end in pair)) for side, pair in zip(SIDES, ends, strict=True)]
    return "; ".join(filter(None, changes))


def _change(side: str, before: Laid, after: Laid) -> str:
    """Return the change on a pair of pans in words; empty if nothing changes."""
    if before[0] == before[1] and after[0] == after[1]:
        words = _moved(before[0], after[0], " each")
        return f"{side} pans: {words}" if words else ""
    of_pans = [(pan, _moved(one, other, "")) for pan, (one, other) in enumerate(zip(before, after, strict=True), 1)]
    return "; ".join(f"{side} pan {pan}: {words}" for pan, words in of_pans if words)


def _moved(before: Counter[float], after: Counter[float], each: str) -> str:
    off, on = before - after, after - before
    return ", ".join([f"take {_pieces(off)} off{each}"] * bool(off) + [f"lay {_pieces(on)} on{each}"] * bool(on))


def _pieces(masses: Counter[float]) -> str:
    return " and ".join(
        (f"{number} x " if number > 1 else "") + _grams(mass) for mass, number in sorted(masses.items(), reverse=True)
    )


def _grams(mass: float) -> str:
    return f"{1e3 * mass:.6g} g"


def _remarks(
    rig: Rig, pans: Pans, wanted: float, quantum: float, top: int, stacks: Mapping[int, Laid], cycles: int
) -> Iterator[str]:
    low, high = reachable(rig, wanted, pans)
    unit = _torque_of_mass(rig)
    if high > low:
        ends = " and ".join(f"{each:.4f} N.m ({_grams(each / unit)})" for each in (low, high))
        yield f"{wanted:g} N.m is no step of these masses: nearest are {ends}; planned is {top * quantum * unit:.4f} N.m."
    if pans == "equal":
        yield f"Both pans of a pair carry the same: a pure couple, in steps of {quantum * unit:.4f} N.m or more."
    else:
        force = quantum * rig.gravity.value
        differ = f"The pans of a pair differ by up to {_grams(quantum)}"
        yield f"{differ}: a side force of up to {force:.3g} N on the shaft, no pure couple."
    if any(one - other and other - one for pair in pairwise(stacks.values()) for one, other in zip(*pair, strict=True)):
        yield "There are too few small masses: some steps exchange masses, and the shaft turns back and forth meanwhile."
    if cycles == 1:
        yield "A first cycle depends on what the gear went through before; plan two cycles to see the loop that repeats."


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
    of_plan, of_record = (
        by_place([replace(step, position=round(step.position, 9)) for step in each]) for each in (planned, steps)
    )
    findings: list[Deviation] = []
    for place in dict.fromkeys((*of_plan, *of_record)):
        if place not in of_record:
            findings.append(Deviation("not made", 0, f"{place_words(place)}: planned, but not made"))
        elif place not in of_plan:
            findings.append(Deviation("unplanned", of_record[place][0].number, f"{place_words(place)}: made, but not planned"))
        else:
            findings += _of_place(of_plan[place], of_record[place])
    return findings


def _masses(step: Step) -> Masses:
    return round(step.mass_positive / _MASS_RESOLUTION), round(step.mass_negative / _MASS_RESOLUTION)


def _in_words(step: Step) -> str:
    return f"{1e3 * step.mass_positive:.6g} g on the positive pans, {1e3 * step.mass_negative:.6g} g on the negative ones"


def _of_place(planned: Sequence[Step], made: Sequence[Step]) -> Iterator[Deviation]:
    changes = _edits([_masses(step) for step in planned], [_masses(step) for step in made])
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


def _edits(planned: Sequence[Masses], made: Sequence[Masses]) -> list[tuple[str, int, int]]:
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
