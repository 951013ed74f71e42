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
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, NamedTuple, get_args

from strainwave import arguments, typeset
from strainwave.files.gear_file import at
from strainwave.presentation import Presented, Row, counted
from strainwave.rig.bench.setup import Rig
from strainwave.rig.bench.steps import Step

Pans = Literal["equal", "unequal"]
SIDES = ("positive", "negative")
STAGES = ("peak", "positive unloading", "negative loading", "negative unloading", "positive loading")
MAX_STEPS = 100_000  # of a plan: a month at 25 seconds a step
_MASS_TOLERANCE = 1e-6  # share of the smallest mass [1]: totals that differ by less are equal
Laid = tuple[Counter[float], Counter[float]]  # how many of each mass lie on the two pans of a pair


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


def task(rig: Rig, before: Step | None, step: Step, pans: Pans = "equal") -> str:
    """Return in words which masses to add and remove between two steps outside a plan; the largest masses come first.

    Args:
        rig: its masses
        before: what lies on the pans; nothing if None
        step: what is to lie there
        pans: as in `plan`

    Raises:
        ValueError: the masses of the rig do not make a total

    >>> from strainwave.rig import load, Step
    >>> task(load("couple-rig"), Step(1, mass_positive=0.35), Step(2, mass_positive=0.3))
    'positive pans: take 25 g off each'
    """
    changes = []
    for side in SIDES:
        before_it, after = (_composed(rig, pans, getattr(each, f"mass_{side}") if each else 0.0) for each in (before, step))
        changes.append(_change(side, before_it, after))
    return "; ".join(filter(None, changes)) or "leave all as it is"


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
            words = _first(position, unit, place) if before is None else ""
            words += _changes(stacks, before or 0, load)
            step = Step(number, round(masses[0], 12), round(masses[1], 12), position=position, unit=unit)
            yield PlannedStep(step, _stage(before, load), load * quantum * _torque_of_mass(rig), words)
            before = load


def _first(position: float, unit: str, place: int) -> str:
    of = f"specimen {unit}, " if unit else ""
    clear = "take all masses off; " if place else ""
    return f"{clear}{of}flexspline at {math.degrees(position):g} degrees; "


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
    if any(_is_exchange(before, after) for before, after in pairwise(stacks.values())):
        yield "There are too few small masses: some steps exchange masses, and the shaft turns back and forth meanwhile."
    if cycles == 1:
        yield "A first cycle depends on what the gear went through before; plan two cycles to see the loop that repeats."


def _is_exchange(before: Laid, after: Laid) -> bool:
    return any(one - other and other - one for one, other in zip(before, after, strict=True))
