"""Paths that go forth and back: where they truly turn, though they are noisy, and what is left of a long one."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from strainwave.statistics.scale import noise_sigma

Array = NDArray[np.float64]

MAX_PATH_SAMPLES = 2_000  # of a quasi-static path: more add only noise, which their means contain too
MIN_REVERSAL_SIGMA = 6.0  # standard deviations of the noise
PRESLIDING_SHARE = 0.02  # of the span [1]: bristles bend by milliradians at the input before they slip (assumed)
MIN_REVERSAL_SHARE = 0.02  # of the span [1]: smaller reversals do not belong to the test
MAX_REVERSAL_SHARE = 0.25  # of the span [1]: larger reversals count, even if few samples make the path look like noise


def turning_points(path: Array) -> list[int]:
    """Samples at which a path turns back by more than its noise; those of its ends are none.

    >>> turning_points(np.array([0.0, 1.0, 0.999, 2.0, 1.0, 0.0]))
    [3]
    """
    span = float(np.ptp(path))
    least = min(max(MIN_REVERSAL_SIGMA * noise_sigma(path), MIN_REVERSAL_SHARE * span), MAX_REVERSAL_SHARE * span)
    turns: list[int] = []
    low = high = 0
    sense = 0
    for i, value in enumerate(path.tolist()):
        if value > path[high]:
            high = i
        if value < path[low]:
            low = i
        if sense >= 0 and value < path[high] - least:
            if sense > 0:
                turns.append(high)
            sense, low = -1, i
        elif sense <= 0 and value > path[low] + least:
            if sense < 0:
                turns.append(low)
            sense, high = 1, i
    return turns


def monotone(path: Array) -> Array:
    """The path with each branch running one way: what noise takes back, is left out.

    >>> monotone(np.array([0.0, 1.0, 0.999, 2.0, 1.0, 1.001, 0.0])).tolist()
    [0.0, 1.0, 1.0, 2.0, 1.0, 1.0, 0.0]
    """
    ends = [0, *turning_points(path), len(path) - 1]
    clean = path.copy()
    for first, last in pairwise(ends):
        branch = slice(first, last + 1)
        onwards = np.maximum if path[last] > path[first] else np.minimum
        clean[branch] = onwards.accumulate(path[branch])
    return clean


def slid(path: Array) -> NDArray[np.bool_]:
    """Samples that are no less than a share of the span behind the last reversal, or behind the beginning.

    A reversal itself is none: it lies between samples, and that at the farthest may be before it or behind (`still_slides`).

    >>> slid(np.array([0.0, 0.5, 1.0, 0.99, 0.5, 0.0])).tolist()
    [False, True, False, False, True, True]
    """
    turns = turning_points(path)
    begun = np.zeros(len(path), int)
    begun[turns] = turns
    begun = np.maximum.accumulate(begun)  # the reversal before each sample
    return np.asarray(np.abs(path - path[begun]) >= PRESLIDING_SHARE * np.ptp(path))


def still_slides(path: Array, torque: Array, turn: int) -> bool:
    """True if the sample at a reversal belongs to the way there: its torque rose at least half as steeply as before.

    Behind the reversal, friction has turned over, and the torque has fallen.

    >>> still_slides(np.array([0.0, 1.0, 2.0, 1.0]), np.array([5.0, 6.0, 7.0, 1.0]), 2)
    True
    >>> still_slides(np.array([0.0, 1.0, 2.0, 1.0]), np.array([5.0, 6.0, 4.0, 1.0]), 2)
    False
    """
    if turn < 2:
        return False
    before, way = np.diff(path[turn - 2 : turn + 1])
    risen, last = np.diff(torque[turn - 2 : turn + 1])
    return bool(before * way > 0.0 and last / way >= 0.5 * risen / before)


def thinned(*series: Array, samples: int = MAX_PATH_SAMPLES) -> tuple[Array, ...]:
    """Long series as the means of equal stretches; short ones as they are.

    >>> thinned(np.arange(6.0), samples=3)[0].tolist()
    [0.5, 2.5, 4.5]
    """
    n = len(series[0])
    if n <= samples:
        return series
    starts = np.linspace(0, n, samples + 1).astype(int)
    return tuple(np.add.reduceat(values, starts[:-1]) / np.diff(starts) for values in series)
