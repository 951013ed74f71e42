"""The four regimes of a torsion loop: where it turns back, where its torque changes sign, and what belongs to no cycle."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from strainwave.analysis.branches import turning_points
from strainwave.equality import ComparedByFields
from strainwave.rig.loop import Loop

Array = NDArray[np.float64]
Rows = NDArray[np.intp]
RegimeName = Literal["positive_unloading", "negative_loading", "negative_unloading", "positive_loading"]
NAMES: tuple[RegimeName, ...] = ("positive_unloading", "negative_loading", "negative_unloading", "positive_loading")
FALLING, RISING = -1, 1

MIN_RUN_SHARE = 0.5  # share of the span [1]: a run that comes back by less is no branch of the cycle
PEAK_TOLERANCE = 0.1  # share of the span of torque [1]: a branch that ends this near to an extreme reaches it
CLOSING_TOLERANCE = 0.05  # share of the span of torque [1], or one and a half steps, that a closed cycle may lack
MAX_DETOURS_PER_POINT = 0.1  # turns that lead to no peak [1]; with more, the points are not in the order measured
MAX_SMALL_LOOP_TURNS = 4  # count of such turns that smaller loops may explain
MAX_BACKWARD_SHARE = 0.1  # share of the span [1] by which an elastic gear may go back while the other quantity goes one way
MIN_ALIKE_SHARE = 0.6  # share of the steps of torque that must be alike before another is called a gap [1]
MIN_GAP_RATIO = 1.5  # a longer step is a gap, in usual steps [1]
MAX_GAPS_SHOWN = 4  # gaps that a remark lists
MAX_BACKWARD_STEPS = 0.1  # share of the steps that go back [1]; beyond it, sorted points may be those of two branches


@dataclass(frozen=True, eq=False)
class Branch(ComparedByFields):
    """One way from peak to peak, from the lower torque to the higher whichever way it was run.

    Attributes:
        sense: 1 where the torque rises with time, -1 where it falls
        rows: of the loop, shape (n,)
        torque: never falls along the branch; noise that takes it back is levelled [N.m], shape (n,)
        angle: [rad], shape (n,)
        angle_sigma: [rad], shape (n,)
        torque_sigma: [N.m], shape (n,)
    """

    sense: int
    rows: Rows
    torque: Array
    angle: Array
    angle_sigma: Array
    torque_sigma: Array

    @property
    def low(self) -> float:
        """Lowest torque [N.m]."""
        return float(self.torque[0])

    @property
    def high(self) -> float:
        """Highest torque [N.m]."""
        return float(self.torque[-1])


@dataclass(frozen=True, eq=False)
class Regime(ComparedByFields):
    """A quarter of the cycle, between zero torque and a peak, from the lower torque to the higher.

    Attributes:
        name: which quarter
        torque: [N.m], shape (n,); begins or ends with 0, which is interpolated where the branch passes it between two points
        angle: [rad], shape (n,)
        angle_sigma: [rad], shape (n,)
        torque_sigma: [N.m], shape (n,); of a peak from which it unloads, with twice the error of the pulleys' friction, which
            has the other sign there than on the rest of the way
        rows: of the loop, shape (n,); -1 where it was interpolated
    """

    name: RegimeName
    torque: Array
    angle: Array
    angle_sigma: Array
    torque_sigma: Array
    rows: Rows

    @property
    def from_zero(self) -> bool:
        """True if the regime begins or ends at zero torque; else the branch begins or ends a little before."""
        return bool(np.any(self.torque == 0.0))

    @property
    def measured(self) -> NDArray[np.bool_]:
        """Return a mask of the points that were measured, shape (n,)."""
        return np.asarray(self.rows >= 0)


@dataclass(frozen=True, eq=False)
class Segmented(ComparedByFields):
    """A loop cut into what it is made of.

    Attributes:
        loop: the loop
        falling, rising: the branches of the cycle; None where the loop has none that passes zero torque or reaches a peak
        regimes: those that were measured from zero torque to the peak, in the order of the cycle
        cycle: rows of the closed cycle in the order measured; empty where it does not close
        cycles: how many complete cycles the loop holds
        remarks: what was left out, and why, in words
    """

    loop: Loop
    falling: Branch | None
    rising: Branch | None
    regimes: tuple[Regime, ...]
    cycle: Rows
    cycles: int
    remarks: tuple[str, ...]

    @property
    def closed(self) -> bool:
        """True if the loop returns over both peaks to the torque at which it began."""
        return len(self.cycle) > 0


def segment(loop: Loop) -> Segmented:
    """Cuts a loop into branches and regimes; of several cycles the last complete one.

    A branch ends where torque and angle, each in shares of its span, turn back together. So it ends at the corner of a loop
    with a level stretch, and after the creep at a peak.

    Raises:
        ValueError: there are fewer than three points, the torque or the angle never changes, one falls where the other grows,
            the times fall, or the points do not follow each other as measured

    >>> loop = Loop([3.0, 2.0, -3.0, -2.0, 3.0], [1.0, 0.0, -1.0, 0.0, 1.0], side="output", name="example")
    >>> [regime.name for regime in segment(loop).regimes]
    ['positive_unloading', 'negative_loading', 'negative_unloading', 'positive_loading']
    """
    runs = _checked_runs(loop)
    cycle, falling, rising = _cycle(loop, runs)
    regimes = tuple(regime for name in NAMES if (regime := _regime(name, falling, rising, loop)) is not None)
    remarks = tuple(_remarks_on_steps(loop, [turn for run in runs for turn in run.turns[::2]], regimes))
    return Segmented(loop, falling, rising, regimes, cycle, len(_pairs(runs)), remarks)


def cycles(loop: Loop) -> list[Loop]:
    """Return the complete cycles of a loop, each as a loop; the loop itself if it has one or none.

    >>> torque = [1.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 1.0]
    >>> twice = Loop([3.0, 2.0, -3.0, -2.0, 3.0, 2.0, -3.0, -2.0, 3.1], torque, side="output", name="example")
    >>> [len(each) for each in cycles(twice)]
    [5, 5]
    """
    runs = _checked_runs(loop)
    pairs = _pairs(runs)
    if len(pairs) < 2:
        return [loop]
    return [part(loop, slice(a.first, b.last + 1), f"{loop.name}, cycle {n}") for n, (a, b) in enumerate(pairs, 1)]


def part(loop: Loop, rows: slice | Rows, name: str) -> Loop:
    """Some rows of a loop as a loop."""
    series = ("angle", "torque", "angle_sigma", "torque_sigma", "time", "temperature")
    taken: dict[str, Any] = {key: None if getattr(loop, key) is None else getattr(loop, key)[rows] for key in series}
    return replace(loop, name=name, **taken)


# ---- Where it turns ---------------------------------------------------------------------------------------------------


def _checked_runs(loop: Loop) -> list[_Run]:
    """Return the runs from turn to turn, or refuse points that are no loop in the order measured."""
    n = len(loop)
    if n < 3:
        raise ValueError(
            f"{loop.name}: {n} points are no loop; measure steps from one peak of the torque to the other and back"
        )
    for name, values, unit in (("torque", loop.torque, "N.m"), ("angle", loop.angle, "rad")):
        if np.ptp(values) == 0.0:
            raise ValueError(
                f"{loop.name}: the {name} is {values[0]:g} {unit} throughout; a loop must load and unload the gear"
            )
    if loop.time is not None and np.any(np.diff(loop.time) < 0.0):
        row = int(np.flatnonzero(np.diff(loop.time) < 0.0)[0]) + 1
        raise ValueError(
            f"{loop.name}: time[{row}] = {loop.time[row]:g} s is before time[{row - 1}] = {loop.time[row - 1]:g} s; "
            "put the points in the order measured"
        )
    ends, minor = _ends(loop)
    runs = [_Run(loop, first, last, minor) for first, last in pairwise(ends)]
    detours = len(minor) + sum(not run.complete for run in runs[1:-1])
    if detours > max(MAX_SMALL_LOOP_TURNS, MAX_DETOURS_PER_POINT * n):
        raise ValueError(
            f"{loop.name}: torque and angle turn back {detours} times in {n} points without reaching a peak; "
            "put the points in the order measured, not sorted by torque or angle"
        )
    for name, other in (("angle", loop.torque), ("torque", loop.angle)):
        forward = other if other[-1] >= other[0] else -other
        backward = float(np.max(np.maximum.accumulate(forward) - forward))
        if runs_one_way(getattr(loop, name)) and backward > MAX_BACKWARD_SHARE * np.ptp(other):
            raise ValueError(
                f"{loop.name}: its points are sorted by {name}, which mixes the branches; put the points in the order measured"
            )
    if np.cov(loop.angle, loop.torque)[0, 1] < 0.0:
        raise ValueError(
            f"{loop.name}: the torque falls as the angle grows; give both the same sense, as an elastic gear has them: "
            "reverse the sign of one of the two"
        )
    return runs


def _path(loop: Loop) -> Array:
    """Torque and angle in shares of their spans, together: both grow while the gear is loaded."""
    return np.asarray(loop.torque / np.ptp(loop.torque) + loop.angle / np.ptp(loop.angle))


def _ends(loop: Loop) -> tuple[list[int], list[int]]:
    """Rows between which the branches run, first and last row included; and those where a branch turns for a while."""
    path = _path(loop)
    turns = turning_points(path)
    ends = [0, *turns, len(path) - 1]
    least = MIN_RUN_SHARE * float(np.ptp(path))
    while len(ends) > 3:  # smaller loops go, the smallest first; the first and the last run may be short
        ranges = np.abs(np.diff(path[ends]))[1:-1]
        if not ranges.min() < least:
            break
        smallest = 1 + int(np.argmin(ranges))
        del ends[smallest : smallest + 2]
    return ends, [row for row in turns if row not in ends]


class _Run:
    """Rows of a loop on the way from one turn to the next, without those of smaller loops on the way."""

    def __init__(self, loop: Loop, first: int, last: int, minor: Sequence[int]) -> None:
        path = _path(loop)
        self.first, self.last = first, last
        self.sense = RISING if path[last] > path[first] else FALLING
        rows = np.arange(first, last + 1)
        self.turns = [row for row in minor if first < row < last]
        kept = np.ones(len(rows), bool)
        for turn in self.turns[::2]:
            kept &= (rows <= turn) | (self.sense * path[rows] > self.sense * path[turn])
        self.rows = rows[kept]
        torque = loop.torque
        tolerance = PEAK_TOLERANCE * float(np.ptp(torque))
        low, high = sorted((float(torque[first]), float(torque[last])))
        self.low, self.high = low, high
        self.complete = low <= torque.min() + tolerance and high >= torque.max() - tolerance


def _pairs(runs: Sequence[_Run]) -> list[tuple[_Run, _Run]]:
    found: list[tuple[_Run, _Run]] = []
    i = 0
    while i < len(runs) - 1:
        if runs[i].complete and runs[i + 1].complete:
            found.append((runs[i], runs[i + 1]))
            i += 2
        else:
            i += 1
    return found


def _cycle(loop: Loop, runs: Sequence[_Run]) -> tuple[Rows, Branch | None, Branch | None]:
    """Rows of the last cycle, and its branches."""
    pairs = _pairs(runs)
    if pairs and not (len(runs) == 3 and _completes(loop, runs[0], runs[2])):
        first, second = pairs[-1]
        return np.arange(first.first, second.last + 1), *_in_order(_branch(loop, [first]), _branch(loop, [second]))
    whole = [i for i, run in enumerate(runs) if run.complete]
    if len(runs) == 3 and 1 in whole:
        whole = [1]
    if not whole:
        return np.empty(0, int), *_best(loop, runs)
    middle = whole[-1]
    pieces = [runs[i] for i in (middle + 1, middle - 1) if 0 <= i < len(runs)]
    rows = np.empty(0, int)
    if len(pieces) == 2 and _meet(loop, pieces[0], pieces[1]):
        rows = np.arange(pieces[1].first, pieces[0].last + 1)
    elif len(pieces) == 2:
        pieces = sorted(pieces, key=lambda run: run.high - run.low)[-1:]
    return rows, *_in_order(_branch(loop, [runs[middle]]), _branch(loop, pieces) if pieces else None)


def _best(loop: Loop, runs: Sequence[_Run]) -> tuple[Branch | None, Branch | None]:
    """Return the longest run of each sense, for a loop without a whole branch."""
    found: list[Branch | None] = []
    for sense in (FALLING, RISING):
        same = [run for run in runs if run.sense == sense]
        found.append(_branch(loop, [max(same, key=lambda run: run.high - run.low)]) if same else None)
    return found[0], found[1]


def _meet(loop: Loop, late: _Run, early: _Run) -> bool:
    torque = loop.torque
    step = float(np.median(np.abs(np.diff(torque))))
    lacking = late.sense * (float(torque[early.first]) - float(torque[late.last]))
    return lacking <= max(CLOSING_TOLERANCE * float(np.ptp(torque)), 1.5 * step)


def _completes(loop: Loop, early: _Run, late: _Run) -> bool:
    """True if the beginning of a loop has the peak that its end does not come back to."""
    torque, sense = loop.torque, late.sense
    lacking = float((sense * torque[early.rows]).max() - sense * torque[late.last])
    step = float(np.median(np.abs(np.diff(torque))))
    return sense == early.sense and lacking > 0.5 * step and _meet(loop, late, early)


def _in_order(one: Branch | None, other: Branch | None) -> tuple[Branch | None, Branch | None]:
    falling = [each for each in (one, other) if each is not None and each.sense == FALLING]
    rising = [each for each in (one, other) if each is not None and each.sense == RISING]
    return falling[0] if falling else None, rising[0] if rising else None


def _branch(loop: Loop, runs: Sequence[_Run]) -> Branch:
    """Return the branch of one run, or of the end of a loop and its beginning; where these overlap, the end counts."""
    from scipy.optimize import isotonic_regression

    late, *early = runs
    rows = late.rows
    for run in early:
        beyond = late.sense * loop.torque[run.rows] > late.sense * loop.torque[late.rows[-1]]
        rows = np.concatenate((rows, run.rows[beyond]))
    if late.sense == FALLING:
        rows = rows[::-1]
    torque = isotonic_regression(loop.torque[rows]).x
    return Branch(late.sense, rows, torque, loop.angle[rows], loop.angle_sigma[rows], loop.torque_sigma[rows])


# ---- Quarters ---------------------------------------------------------------------------------------------------------


def _regime(name: RegimeName, falling: Branch | None, rising: Branch | None, loop: Loop) -> Regime | None:
    """The part of a branch between zero torque and a peak; None where it was not measured from end to end."""
    branch = falling if name in ("positive_unloading", "negative_loading") else rising
    sign = 1.0 if name.startswith("positive") else -1.0
    peak = float((sign * loop.torque).max())
    if branch is None or peak <= 0.0:
        return None
    ends, near = sorted((sign * branch.low, sign * branch.high)), PEAK_TOLERANCE * float(np.ptp(loop.torque))
    if ends[0] > near or ends[1] < peak - near:
        return None
    torque = loop.torque[branch.rows]
    inside = sign * torque >= 0.0
    sigma = _from_peak(sign * torque, branch, loop) if name.endswith("unloading") else branch.torque_sigma
    found = Regime(name, torque[inside], branch.angle[inside], branch.angle_sigma[inside], sigma[inside], branch.rows[inside])
    crosses = ends[0] < 0.0 and not np.any(torque == 0.0)
    return _with_crossing(found, branch, 0 if sign > 0.0 else len(found.rows)) if crosses else found


def _from_peak(size: Array, branch: Branch, loop: Loop) -> Array:
    """Errors of the torque along a branch that leaves a peak, which was reached the other way."""
    sigma = branch.torque_sigma.copy()
    if np.any(sigma > 0.0) or np.any(branch.angle_sigma > 0.0):
        held = size == size.max()
        sigma[held] = np.hypot(sigma[held], 2.0 * loop.friction_sigma)
    return sigma


def _with_crossing(regime: Regime, branch: Branch, at: int) -> Regime:
    torque, angle, angle_sigma, torque_sigma = _crossing(branch)
    return replace(
        regime,
        torque=np.insert(regime.torque, at, torque),
        angle=np.insert(regime.angle, at, angle),
        angle_sigma=np.insert(regime.angle_sigma, at, angle_sigma),
        torque_sigma=np.insert(regime.torque_sigma, at, torque_sigma),
        rows=np.insert(regime.rows, at, -1),
    )


def _crossing(branch: Branch) -> tuple[float, float, float, float]:
    """Torque 0, the angle there on the straight line between its neighbours, and the errors of both."""
    after = int(np.searchsorted(branch.torque, 0.0, "right"))
    near = slice(after - 1, after + 1)
    torque, angle = branch.torque[near], branch.angle[near]
    share = np.array([torque[1], -torque[0]]) / (torque[1] - torque[0])
    angle_sigma, torque_sigma = (float(np.hypot(*(share * sigma[near]))) for sigma in (branch.angle_sigma, branch.torque_sigma))
    return 0.0, float(share @ angle), angle_sigma, torque_sigma


def _remarks_on_steps(loop: Loop, turns: Iterable[int], regimes: Sequence[Regime]) -> Iterator[str]:
    """Yield remarks on sorted points, smaller loops (from rows `turns`), gaps, and regimes that are missing or begin late."""
    yield from _of_sorted(loop)
    for turn in turns:
        at = f"the torque turns back at point {turn + 1} ({loop.torque[turn]:.4g} N.m) before the peak"
        yield f"{at}; what lies on that smaller loop is in no regime"
    yield from _of_gaps(loop)
    found = [regime.name for regime in regimes]
    if missing := [name.replace("_", " ") for name in NAMES if name not in found]:
        yield f"not measured from zero torque to the peak: {', '.join(missing)}"
    for regime in regimes:
        if not regime.from_zero:
            least = float(np.abs(regime.torque).min())
            yield f"{regime.name.replace('_', ' ')} is measured from {least:.3g} N.m on: it has no secant from zero torque"


def runs_one_way(values: NDArray[np.float64]) -> bool:
    """True if a series never falls, or never rises."""
    steps = np.diff(values)
    return bool(np.all(steps >= 0.0) or np.all(steps <= 0.0))


def _of_sorted(loop: Loop) -> Iterator[str]:
    """Points in the order of their angle or torque: one way by itself, or a whole loop that somebody has sorted."""
    for name, other, values in (("angle", "torque", loop.torque), ("torque", "angle", loop.angle)):
        sense = np.sign(values[-1] - values[0])
        if runs_one_way(getattr(loop, name)) and np.mean(sense * np.diff(values) < 0.0) > MAX_BACKWARD_STEPS:
            yield (
                f"the {name} goes one way through all points while the {other} goes to and fro: if the file holds a whole "
                f"loop, it was sorted by {name}, and its branches are mixed; put the points in the order measured"
            )


def _of_gaps(loop: Loop) -> Iterator[str]:
    steps = np.abs(np.diff(loop.torque))
    usual = float(np.median(steps))
    alike = np.abs(steps - usual) < 0.05 * usual
    if usual == 0.0 or np.mean(alike) < MIN_ALIKE_SHARE:
        return
    rows = np.flatnonzero(steps > MIN_GAP_RATIO * usual).tolist()
    if not rows:
        return
    listed = ", ".join(f"{row + 1} and {row + 2} by {steps[row]:.4g} N.m" for row in rows[:MAX_GAPS_SHOWN])
    more = f" and {len(rows) - MAX_GAPS_SHOWN} more" if len(rows) > MAX_GAPS_SHOWN else ""
    yield (
        f"the torque changes between points {listed}{more}, and by {usual:.4g} N.m as a rule: steps were left out, or "
        "not recorded. Values between are taken on a straight line"
    )
