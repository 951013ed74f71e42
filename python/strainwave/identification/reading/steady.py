"""Friction from records at constant speed: each steady stretch is one point of a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.reading.at_rest import runs_of
from strainwave.identification.reading.column import Column

Array = NDArray[np.float64]

MAX_CHANGE = 0.05  # of the speed within a stretch
MAX_SPEED_AT_REST = 0.02  # of the largest speed
MIN_ROWS = 50  # of a stretch
MAX_NOISE = 2.0  # median deviations of the speed between medians of rows beside: 4 standard deviations of these
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
    return runs_of((change < np.maximum(MAX_CHANGE * np.abs(smooth), noise)) & is_moving, MIN_ROWS)


def averaged(columns: Mapping[str, Column], parts: Sequence[slice]) -> dict[str, Column]:
    """Return columns whose rows are the means of stretches."""
    means = {name: np.array([float(column.si[part].mean()) for part in parts]) for name, column in columns.items()}
    return {name: replace(column, si=means[name]) for name, column in columns.items()}
