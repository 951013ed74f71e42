"""Stretches of a record: steady at one speed after another, or any that have a property in common."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MAX_SPEED_AT_REST = 0.02  # of the largest speed
MAX_CHANGE = 0.05  # of the speed within a stretch
MIN_ROWS_OF_STRETCH = 50  # at one speed
MAX_NOISE = 2.0  # median deviations of the speed between medians of neighbouring rows: 4 standard deviations of these
ROWS_OF_CHANGE = 10  # over which a change is computed


def stretches(speed: Array) -> list[slice]:
    """Return the rows of each stretch of one speed, without its ends.

    >>> speed = np.repeat([0.0, 0.5, -0.5, 1.0], 200)
    >>> stretches(speed)
    [slice(210, 390, None), slice(410, 590, None), slice(610, 790, None)]
    """
    from scipy import ndimage

    apart = ROWS_OF_CHANGE
    smooth = ndimage.median_filter(speed, 2 * apart + 1, mode="nearest")
    change = np.full(len(speed), np.inf)
    change[apart:-apart] = np.abs(smooth[2 * apart :] - smooth[: -2 * apart])
    noise = MAX_NOISE * float(np.median(np.abs(speed - smooth)))
    is_moving = np.abs(smooth) > MAX_SPEED_AT_REST * np.abs(smooth).max()
    return runs_of((change < np.maximum(MAX_CHANGE * np.abs(smooth), noise)) & is_moving, MIN_ROWS_OF_STRETCH)


def runs_of(wanted: NDArray[np.bool_], min_rows: int) -> list[slice]:
    """Return the stretches of rows that are wanted, those of at least so many rows."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], wanted, [False]]).astype(int)))
    return [slice(int(a), int(b)) for a, b in edges.reshape(-1, 2) if b - a >= min_rows]
