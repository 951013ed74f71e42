"""Comparison of a recording with a baseline of the same joint: the change of each order, its interval and its probability.

Blocks of the baseline are replicates. Their spread contains noise and what varies in a healthy joint: load, temperature and
place. Noise is independent from block to block and averages. The rest of the spread does not: all blocks of a recording share
the temperature and the day. So a drift that the baseline shows from its beginning to its end is no alarm afterwards.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import tau

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.diagnose.detection import CONFIDENCE_LEVEL, DETECTION_PROBABILITY, FALSE_ALARM, detectable_change
from strainwave.diagnose.refusals import JointRecording
from strainwave.diagnose.replicates import BOTH_DIRECTIONS, Cell, JointMotion, apart, blocks_of, cells_of
from strainwave.messages import listed
from strainwave.orders.comb import STRAIN_WAVE_RATIOS
from strainwave.presentation import Presented
from strainwave.statistics.linear_fit import normal_inverse

Array = NDArray[np.float64]

MIN_BLOCK_PERIODS = 8.0  # periods of the lowest order in a block
MAX_BLOCKS = 24  # of a baseline: shorter blocks contain no more of the drift
MIN_BLOCKS = 6  # of a baseline, by which a spread is estimated
BLOCK_RESOLUTIONS = 1.5  # resolutions of a block, by which two orders differ at least
SPREAD_MARGIN = 1.0  # standard deviations of the variance of replicates, added to what noise does not explain of it
LINE_CONDITIONS = ("", "speed", "load")  # over which an amplitude may change in a healthy joint, besides a mean
MIN_BLOCKS_FOR_LINE = 10  # blocks, by which a line over a condition is fitted
MAX_LEFT_OUT_SHARE = 0.8  # of the squared error of left-out blocks [1], to which a line has to reduce it
MAX_SPEED_RATIO = 1.25  # by which a block may be faster or slower than all blocks of the baseline
MAX_LOAD_SHARE = 0.25  # of the spread or size of the baseline's load, by which a block may lie outside of it
MAX_PLACE_SHARE = 0.1  # of a range of the angle [1], by which a block may lie outside of it, or be apart from it
MAX_SHOWN = 3  # ranges of the baseline in a reason
MIN_PLACE_MARGIN = 0.05  # rad of the output, by which it may lie outside or apart of any range


@dataclass(frozen=True)
class OrderChange(Presented):
    """Change of one order in one direction, recording less baseline.

    Attributes:
        order: per revolution of the shaft
        direction: `forward` or `backward`
        baseline: amplitude of the baseline under the conditions of the recording, in the unit of the column
        spread: standard deviation of a replicate of it
        amplitude: mean amplitude of the recording
        change: difference of both
        sigma: standard deviation of the change
        low, high: ends of the interval of the change, of 95 %
        limit: smallest change that is an alarm; a true change of this size is an alarm every second time
        detectable: smallest true change that is an alarm with probability 0.9
        false_alarm: probability of such a change in a joint that did not change, over all tests of the recording
        alarm: True if this probability is below the stated rate
        replicates: number of blocks of the baseline
        blocks: number of blocks of the recording
        condition: `speed` or `load`, over which the baseline is a straight line; empty if it is a mean
        is_new: True if the line was found blind in the recording and not in the baseline
    """

    order: float
    direction: str
    baseline: float
    spread: float
    amplitude: float
    change: float
    sigma: float
    low: float
    high: float
    limit: float
    detectable: float
    false_alarm: float
    alarm: bool
    replicates: int
    blocks: int
    condition: str
    is_new: bool = False


@dataclass(frozen=True)
class BaselineComparison(Presented):
    """Changes of a recording against a baseline.

    Attributes:
        changes: of each order and direction, the least probable first
        tests: number of tests, over which false alarms are counted
        resolution: by which two orders differ at least that the blocks separate, in orders of the shaft
        remarks: what was not compared, and why
    """

    changes: tuple[OrderChange, ...]
    tests: float
    resolution: float
    remarks: tuple[str, ...]

    @property
    def alarms(self) -> tuple[OrderChange, ...]:
        """Changes that are alarms."""
        return tuple(each for each in self.changes if each.alarm)


@dataclass(frozen=True, eq=False)
class Baseline:
    """Replicates of a healthy joint: cells of each recording by block, direction and order.

    The motion of a block is its travel [rad]. Its blocks separate two orders that differ by the resolution, in orders of the
    shaft.
    """

    orders: tuple[float, ...]
    travel: float
    resolution: float
    cells: tuple[list[list[list[Cell | None]]], ...]

    def of(self, direction: int, order: int) -> list[list[Cell]]:
        """Return the cells of an order in a direction, by recording."""
        return [[cell for block in one if (cell := block[direction][order]) is not None] for one in self.cells]


def baseline_of(motions: Sequence[JointMotion], orders: Sequence[float]) -> Baseline:
    """Return the replicates of recordings of a healthy joint, in the same column and over the same angle.

    The most important order, per revolution of the shaft, is first: of two that a block does not separate it is kept.
    """
    if not orders:
        raise ValueError("no order to compare: no line was found and no ratio is known; give --gear or --ratio")
    whole = sum(motion.travel for motion in motions)
    lowest = min(orders)
    count = min(MAX_BLOCKS, int(whole / tau * lowest / MIN_BLOCK_PERIODS))
    if count < MIN_BLOCKS:
        raise ValueError(
            f"the baseline is too short: its motion has {whole / tau * lowest:.3g} periods of order {lowest:.4g}; a spread "
            f"needs {MIN_BLOCKS * MIN_BLOCK_PERIODS:g} ({MIN_BLOCKS} blocks of {MIN_BLOCK_PERIODS:g}); record longer"
        )
    travel = whole / count
    blocks = [blocks_of(motion, travel) for motion in motions]
    spans = [
        float(np.ptp(motion.shaft.own.angle[block == number])) / tau
        for motion, block in zip(motions, blocks, strict=True)
        for number in range(int(block.max()) + 1)
    ]
    resolution = BLOCK_RESOLUTIONS / max(float(np.median(spans)), 1e-12)
    kept = apart(orders, resolution)
    cells = tuple(cells_of(motion, kept, block) for motion, block in zip(motions, blocks, strict=True))
    return Baseline(kept, travel, resolution, cells)


def compared(
    baseline: Baseline,
    motion: JointMotion,
    *,
    false_alarm: float = FALSE_ALARM,
    new: Sequence[float] = (),
    searched: float = 1.0,
) -> BaselineComparison:
    """Return the change of each order of a recording against a baseline.

    Args:
        baseline: replicates, of a fit that contains all orders that are compared
        searched: number of orders among which these were found; each counts as so many tests
    """
    false_alarm = arguments.probability("false_alarm", false_alarm)
    block = blocks_of(motion, baseline.travel)
    cells = cells_of(motion, baseline.orders, block)
    pairs, outside, sparse = [], dict[str, list[str]](), set[str]()
    for direction, (name, _) in enumerate(BOTH_DIRECTIONS):
        for k, order in enumerate(baseline.orders):
            own = [cell for each in cells if (cell := each[direction][k]) is not None]
            if not own:
                continue
            healthy = baseline.of(direction, k)
            if sum(map(len, healthy)) < MIN_BLOCKS:
                sparse.add(name)
                continue
            alike, reasons = _alike(healthy, own, motion.run)
            for reason in reasons:
                outside.setdefault(f"{name}: {reason}", []).append(f"{order:.4g}")
            if alike:
                pairs.append((name, order, healthy, alike))
    planned = sum(order not in new for _, order, _, _ in pairs)
    changes = []
    for name, order, healthy, alike in pairs:
        tests = float(planned + len(new)) if order not in new else max(searched, 1.0) * len(BOTH_DIRECTIONS)
        changes.append(_change(name, order, healthy, alike, tests, false_alarm, order in new))
    remarks = [f"{key}; not compared" for key in outside]
    if sparse:
        remarks.append(
            f"{listed(sorted(sparse))}: the baseline has fewer than {MIN_BLOCKS} blocks in this direction; not compared; "
            "record both directions"
        )
    ranked = tuple(sorted(changes, key=lambda each: (each.false_alarm, -abs(each.change) / each.sigma)))
    return BaselineComparison(ranked, float(planned), baseline.resolution, tuple(remarks))


def _alike(healthy: Sequence[Sequence[Cell]], own: Sequence[Cell], run: JointRecording) -> tuple[list[Cell], list[str]]:
    """Return the cells of a recording under conditions that the baseline contains, and why others are left out."""
    healthy_cells = [cell for one in healthy for cell in one]
    speeds, loads = (np.array([getattr(cell, name) for cell in healthy_cells]) for name in ("speed", "load"))
    load_room = MAX_LOAD_SHARE * max(float(np.ptp(loads)), float(np.abs(loads).max()))
    bounds = {
        "speed": (float(speeds.min()) / MAX_SPEED_RATIO, float(speeds.max()) * MAX_SPEED_RATIO),
        "load": (float(loads.min()) - load_room, float(loads.max()) + load_room),
    }
    elsewhere, reason = _elsewhere(healthy_cells, own, run)
    left, reasons = [], [reason] if reason else []
    for cell, is_elsewhere in zip(own, elsewhere, strict=True):
        if not is_elsewhere and all(low <= getattr(cell, name) <= high for name, (low, high) in bounds.items()):
            left.append(cell)
    for name, (low, high) in bounds.items():
        off = [getattr(cell, name) for cell in own if not low <= getattr(cell, name) <= high]
        if off:
            reasons.append(
                f"{len(off)} of {len(own)} blocks have a {name} from {min(off):.3g} to {max(off):.3g}, outside of the "
                f"{low:.3g} to {high:.3g} that the baseline covers"
            )
    return left, reasons


def _elsewhere(healthy_cells: Sequence[Cell], own: Sequence[Cell], run: JointRecording) -> tuple[list[bool], str]:
    """Return True for each cell of a recording at a place that the baseline does not cover, and the reason.

    A place is an angle of the output: lines that stand still beat with those that turn with the output. If the baseline covers
    a revolution of the output without a gap, every place comes again.
    """
    ratio = 1.0 if run.side == "output" else run.ratio
    turns = float(STRAIN_WAVE_RATIOS[0]) if ratio is None else ratio  # of the shaft per revolution of the output, at least
    covered = _joined([(cell.first / turns, cell.last / turns) for cell in healthy_cells])
    if ratio is not None and any(last - first >= tau for first, last in covered):
        return [False] * len(own), ""
    wider = [(low - _margin(low, high), high + _margin(low, high)) for low, high in covered]
    elsewhere = [not any(low <= cell.first / turns and cell.last / turns <= high for low, high in wider) for cell in own]
    off = [cell for cell, is_elsewhere in zip(own, elsewhere, strict=True) if is_elsewhere]
    if not off:
        return elsewhere, ""
    shown = 1.0 if ratio is None else turns
    ends = min(cell.first for cell in off) / shown, max(cell.last for cell in off) / shown
    places = np.round(np.array(covered[:MAX_SHOWN]) * turns / shown, 6) + 0.0  # no rounding of an angle's beginning, no -0
    ranges = " and ".join(f"{first:.3g} to {last:.3g}" for first, last in places.tolist())
    more = f" and {len(covered) - MAX_SHOWN} more" if len(covered) > MAX_SHOWN else ""
    unknown = (
        "; the ratio is not known, by which places of the output come again: give --gear or --ratio" if ratio is None else ""
    )
    return elsewhere, (
        f"{len(off)} of {len(own)} blocks are between {ends[0]:.3g} and {ends[1]:.3g} rad of the "
        f"{'input' if ratio is None else 'output'}, outside of the {ranges}{more} that the baseline covers{unknown}"
    )


def _joined(ranges: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return ranges of the output angle [rad] without the gaps that count as none, in their order."""
    joined: list[tuple[float, float]] = []
    for first, last in sorted(ranges):
        if joined and first - joined[-1][1] <= _margin(first, last):
            joined[-1] = joined[-1][0], max(joined[-1][1], last)
        else:
            joined.append((first, last))
    return joined


def _margin(first: float, last: float) -> float:
    return max(MIN_PLACE_MARGIN, MAX_PLACE_SHARE * (last - first))


def _change(
    name: str, order: float, healthy: Sequence[Sequence[Cell]], own: Sequence[Cell], tests: float, allowed: float, is_new: bool
) -> OrderChange:
    """Return the change of one order, by Student's distribution with the baseline's spread."""
    from scipy.stats import t as student

    condition, expected = _expected(healthy)
    groups = [np.array([cell.amplitude for cell in one]) - expected.of(one) for one in healthy if one]
    replicates = sum(map(len, groups))
    spread, freedom = _spread(groups, expected.terms)
    noise = float(np.mean([cell.sigma**2 for one in healthy for cell in one]))
    own_noise = float(np.mean([cell.sigma**2 for cell in own]))
    mean, amplitude = float(expected.of(own).mean()), float(np.mean([cell.amplitude for cell in own]))
    shared = max(spread**2 - noise, 0.0) + SPREAD_MARGIN * spread**2 * float(np.sqrt(2.0 / freedom))
    fit = max(spread**2, noise) * expected.leverage(own)
    sigma = float(np.sqrt(min(shared, spread**2) + own_noise / len(own) + fit))
    change = amplitude - mean
    reach = sigma * float(student.isf(0.5 * (1.0 - CONFIDENCE_LEVEL), freedom))
    probability = min(1.0, tests * 2.0 * float(student.sf(abs(change) / sigma, freedom)))
    limit = sigma * float(student.isf(0.5 * allowed / tests, freedom))
    return OrderChange(
        order, name, mean, spread, amplitude, change, sigma, change - reach, change + reach, limit,
        sigma * detectable_change(DETECTION_PROBABILITY, allowed / tests, freedom), probability,
        probability < allowed, replicates, len(own), condition, is_new,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Expected:
    """Amplitude of the healthy joint, as a mean or a straight line over a condition."""

    condition: str
    values: Array
    inverse: Array

    @property
    def terms(self) -> int:
        return len(self.values)

    def of(self, cells: Sequence[Cell]) -> Array:
        """Return the amplitude under the conditions of cells, shape (n,)."""
        return np.asarray(_design(self.condition, cells) @ self.values)

    def leverage(self, cells: Sequence[Cell]) -> float:
        """Return the variance of the mean prediction over that of a replicate."""
        mean = _design(self.condition, cells).mean(axis=0)
        return float(mean @ self.inverse @ mean)


def _design(condition: str, cells: Sequence[Cell]) -> Array:
    ones = np.ones(len(cells))
    return np.stack([ones, [abs(getattr(cell, condition)) for cell in cells]] if condition else [ones], axis=1)


def _fitted(condition: str, cells: Sequence[Cell]) -> _Expected:
    design = _design(condition, cells)
    inverse = normal_inverse(design)
    return _Expected(condition, inverse @ (design.T @ np.array([cell.amplitude for cell in cells])), inverse)


def _expected(healthy: Sequence[Sequence[Cell]]) -> tuple[str, _Expected]:
    """Return the condition over which the amplitude changes, and the fit: the one that predicts left-out recordings best,
    of one recording left-out blocks."""
    cells = [cell for one in healthy for cell in one]
    own = [list(one) for one in healthy if one]
    parts = own if len(own) > 1 else [[cell] for cell in cells]  # blocks of a day may share what looks like a condition
    folds = [([cell for other in parts if other is not part for cell in other], part) for part in parts]
    best, least, name = None, np.inf, ""
    for condition in LINE_CONDITIONS if len(cells) >= MIN_BLOCKS_FOR_LINE else ("",):
        fit = _fitted(condition, cells)
        error = 0.0
        for kept, left_out in folds:
            left = np.array([cell.amplitude for cell in left_out]) - _fitted(condition, kept).of(left_out)
            error += float(left @ left)
        if best is None or error < MAX_LEFT_OUT_SHARE * least:
            best, least, name = fit, error, condition
    assert best is not None
    return name, best


def _spread(groups: Sequence[Array], terms: int) -> tuple[float, float]:
    """Return the standard deviation of a replicate and its degrees of freedom.

    Of several recordings it is that between them and within them together (degrees of freedom by Satterthwaite1946).
    """
    values = np.concatenate(groups)
    count, kinds = len(values), len(groups)
    whole = float(np.sqrt((values @ values) / (count - terms))), float(count - terms)
    if kinds == 1:
        return whole
    within = sum(float(((each - each.mean()) ** 2).sum()) for each in groups) / max(count - kinds, 1)
    between = sum(len(each) * float((each.mean() - values.mean()) ** 2) for each in groups) / (kinds - 1)
    size = (count - sum(len(each) ** 2 for each in groups) / count) / (kinds - 1)
    if between <= within:
        return whole
    share = 1.0 / size
    total = share * between + (1.0 - share) * within
    parts = (share * between) ** 2 / (kinds - 1) + ((1.0 - share) * within) ** 2 / max(count - kinds, 1)
    return float(np.sqrt(total)), float(total**2 / max(parts, 1e-300))
