"""Positioning of an axis from commanded and measured angles: lost motion, accuracy and repeatability, orders over the angle.

Symbols are those of ISO 230-2:2014: x̄ is the mean deviation at a target, approached in one direction; s its standard deviation.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import nan, tau

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import arguments
from strainwave.presentation import Presented
from strainwave.statistics.linear_fit import amplitudes_of, order_waves, solved
from strainwave.statistics.residuals import chance_of_gain

Array = NDArray[np.float64]

MIN_ROWS = 8  # of positions
MIN_TARGETS = 3  # approached from both sides
APPROACHES_OF_STANDARD = 5  # of each target in each direction
FAR_SHARE = 0.5  # of the longest way since a reversal: beyond it a first estimate takes the lost motion for passed
MAX_ROUNDS = 5  # of the estimate: each leaves out the rows that lie within the lost motion of the one before
MAX_OFF_TARGET = 0.25  # steps, between approaches of one target
MAX_ORDER = 1000  # periods per turn of the axis that are looked for
MIN_TURNS = 0.95  # that the positions span: steps over a whole turn may end one before it
MIN_SAMPLES_PER_PERIOD = 4.0  # of the highest order
MAX_CHANCE = 1e-3  # probability with which noise alone makes a line as large at any of the orders
MAX_LINES = 20
BINS_PER_TURN = 8 * MAX_ORDER  # of the spectrum of deviations: the highest order loses 2.6 % of its amplitude


@dataclass(frozen=True)
class Positioning(Presented):
    """Positioning of an axis. All angles in rad; nan if the record does not determine a number.

    Attributes:
        lost_motion, lost_motion_sigma: mean difference of both approaches (mean reversal value B̄)
        reversal: largest reversal value B of a target
        systematic: bidirectional systematic deviation E
        mean_deviation: range M of the mean of both directions
        repeatability: bidirectional repeatability R
        one_way_repeatability: largest of 4 s
        accuracy: bidirectional accuracy A
        targets: that were approached from both sides
        approaches: of a target in a direction, the fewest
        within: rows that are left out, as they lie within the lost motion behind a reversal
        orders: over a turn, their amplitudes and standard deviations; empty if the range is less than a period
        noise: standard deviation of single deviations about those of their target and direction
    """

    lost_motion: float
    lost_motion_sigma: float
    reversal: float
    systematic: float
    mean_deviation: float
    repeatability: float
    one_way_repeatability: float
    accuracy: float
    targets: int
    approaches: int
    within: int
    orders: tuple[tuple[float, float, float], ...]
    noise: float
    remarks: tuple[str, ...] = ()


def positioning(commanded: ArrayLike, measured: ArrayLike) -> Positioning:
    """Return lost motion, accuracy and repeatability of an axis that was moved in steps.

    Rows behind a reversal count once the command has passed the lost motion. The lost motion is the mean difference of both
    approaches at targets that were approached from both sides, so errors over the angle do not change it.

    Args:
        commanded: angles in the order of the moves [rad], shape (n,)
        measured: angles reached [rad], shape (n,)

    >>> targets = np.concatenate([np.arange(0, 41), np.arange(39, -1, -1), np.arange(1, 41), np.arange(39, -1, -1)]) * 1e-3
    >>> reached = [0.0]
    >>> for target in targets[1:]:
    ...     reached.append(min(max(reached[-1], target - 2e-3), target + 2e-3))
    >>> found = positioning(targets, reached)
    >>> round(found.lost_motion, 6), found.within
    (0.004, 17)
    """
    wanted, reached = arguments.numbers("commanded", commanded), arguments.numbers("measured", measured)
    if wanted.shape != reached.shape or wanted.ndim != 1 or len(wanted) < MIN_ROWS:
        raise ValueError(
            f"positioning needs {MIN_ROWS} or more rows of a commanded and a measured angle; there are {wanted.size}"
        )
    moved = np.diff(wanted, prepend=wanted[0])
    steps = np.abs(moved[moved != 0.0])
    if not len(steps):
        raise ValueError("the commanded angle does not change; command several positions, from both sides")
    sense, way = _approach(moved)
    target = np.round(wanted / (2.0 * MAX_OFF_TARGET * float(np.median(steps)))).astype(np.int64)
    deviation, lost, kept = reached - wanted, 0.0, way > FAR_SHARE * way.max()
    for _ in range(MAX_ROUNDS):
        lost = float(np.mean(_differences(target, sense, deviation, kept) or [nan]))
        last, kept = kept, (sense != 0) & (way > max(lost, 0.0) * (1.0 + 1e-9)) if np.isfinite(lost) else sense != 0
        if np.array_equal(last, kept):
            break
    both = _differences(target, sense, deviation, kept)
    means, spreads, counts = _by_approach(target, sense, deviation, kept)
    degrees = sum(count - 1 for count in counts.values())
    squares = sum((counts[approach] - 1) * spread**2 for approach, spread in spreads.items())
    noise = float(np.sqrt(squares / degrees)) if degrees else nan
    whole = len(both) >= MIN_TARGETS
    few = min(counts.values(), default=0)
    remarks = [] if whole else ["too few targets were approached from both sides: lost motion is not determined"]
    if whole and few < APPROACHES_OF_STANDARD:
        remarks.append(
            f"each target was approached {few} times or more in each direction; ISO 230-2 asks for {APPROACHES_OF_STANDARD}"
        )
    orders, why = _orders(wanted[kept], deviation[kept] - 0.5 * np.nan_to_num(lost) * -sense[kept])
    values, has = list(means.values()), degrees > 0
    upper = max((mean + 2.0 * spreads[each] for each, mean in means.items()), default=nan)
    lower = min((mean - 2.0 * spreads[each] for each, mean in means.items()), default=nan)
    pairs = [(means[place, 1], means[place, -1], place) for place, way_ in means if way_ > 0 and (place, -1) in means]
    middle = [0.5 * (up + down) for up, down, _ in pairs]
    two_way = [2.0 * (spreads[place, 1] + spreads[place, -1]) + abs(up - down) for up, down, place in pairs]
    sigma = float(np.std(both, ddof=1) / np.sqrt(len(both))) if whole else nan
    return Positioning(
        lost if whole else nan,
        max(sigma, noise * np.sqrt(2.0 / max(len(both) * few, 1))) if whole and np.isfinite(noise) else sigma,
        float(np.max(np.abs(both))) if whole else nan,
        float(max(values) - min(values)) if values else nan,
        float(max(middle) - min(middle)) if middle else nan,
        float(max(two_way)) if two_way and has else nan,
        float(4.0 * max(spreads.values())) if has else nan,
        float(upper - lower) if has else nan,
        len(both),
        few,
        int(np.count_nonzero(~kept)),
        orders,
        noise,
        (*remarks, *why),
    )


def _approach(moved: Array) -> tuple[NDArray[np.int64], Array]:
    """Return the direction of each approach, 0 before the first move, and the way since the last reversal [rad]."""
    sense, way = np.zeros(len(moved), np.int64), np.zeros(len(moved))
    for row in range(1, len(moved)):
        now = int(np.sign(moved[row])) or int(sense[row - 1])
        way[row] = abs(moved[row]) + (way[row - 1] if now == sense[row - 1] else 0.0)
        sense[row] = now
    return sense, way


_Approaches = dict[tuple[int, int], float]


def _by_approach(
    target: NDArray[np.int64], sense: NDArray[np.int64], deviation: Array, kept: NDArray[np.bool_]
) -> tuple[_Approaches, _Approaches, dict[tuple[int, int], int]]:
    """Return mean and standard deviation of each target and direction, and the number of its approaches."""
    groups = dict[tuple[int, int], list[float]]()
    for place, way, value in zip(target[kept].tolist(), sense[kept].tolist(), deviation[kept].tolist(), strict=True):
        groups.setdefault((place, way), []).append(value)
    means = {each: float(np.mean(values)) for each, values in groups.items()}
    spreads = {each: float(np.std(values, ddof=1)) if len(values) > 1 else 0.0 for each, values in groups.items()}
    return means, spreads, {each: len(values) for each, values in groups.items()}


def _differences(target: NDArray[np.int64], sense: NDArray[np.int64], deviation: Array, kept: NDArray[np.bool_]) -> list[float]:
    """Return the deviation backward less that forward, at each target that was approached from both sides."""
    means, _, _ = _by_approach(target, sense, deviation, kept)
    return [means[place, -1] - mean for (place, way), mean in means.items() if way > 0 and (place, -1) in means]


def _orders(angle: Array, deviation: Array) -> tuple[tuple[tuple[float, float, float], ...], list[str]]:
    """Return the orders of deviations over the angle of the axis that stand out, and why there are none.

    The largest line of the spectrum of what is left is fitted beside those before, while noise alone makes none as large.
    """
    turns = float(np.ptp(angle)) / tau if len(angle) else 0.0
    positions = len(np.unique(np.round(angle, 9)))
    highest = min(int(positions / (MIN_SAMPLES_PER_PERIOD * turns)), MAX_ORDER) if turns >= MIN_TURNS else 0
    if not highest:
        return (), [
            f"{positions} positions span {turns:.3g} turns: orders over the angle need a turn in four positions or more"
        ]
    possible = np.arange(1, highest + 1)
    place = np.floor(angle / tau * BINS_PER_TURN).astype(np.int64) % BINS_PER_TURN
    orders, columns, left = list[int](), np.ones((len(angle), 1)), deviation - deviation.mean()
    while len(orders) < MAX_LINES and len(angle) > 3 * (columns.shape[1] + 2):
        power = np.abs(np.fft.rfft(np.bincount(place, left, BINS_PER_TURN)))[possible]
        order = int(possible[np.argmax(power)])
        more = np.column_stack([columns, order_waves(angle, [order])])
        rest = deviation - more @ solved(more, deviation)
        chance = chance_of_gain(float(left @ left), float(rest @ rest), 2, len(angle) - more.shape[1])
        if order in orders or chance * len(possible) > MAX_CHANCE:
            break
        orders, columns, left = [*orders, order], more, rest
    amplitudes, _ = amplitudes_of(solved(columns, deviation)[1:])
    sigma = float(np.sqrt(left @ left / (len(angle) - columns.shape[1]) * 2.0 / len(angle)))
    lines = zip(orders, amplitudes.tolist(), strict=True)
    strong = tuple(sorted((float(order), size, sigma) for order, size in lines))
    return strong, [] if strong else [f"no order over the angle stands out of the noise, of those up to {highest} per turn"]
