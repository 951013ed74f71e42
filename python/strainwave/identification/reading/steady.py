"""Friction from records at constant speed: each steady stretch is one point of a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.reading.column import Column

Array = NDArray[np.float64]

STEADY = 0.05  # of the speed, by which it changes at most within a stretch
REST = 0.02  # of the largest speed: what is slower rests
LEAST = 50  # rows of a stretch
NOISE = 2.0  # median deviations of the speed, by which medians of rows beside may differ (4 standard deviations of theirs)
BESIDE = 10  # rows over which a change is looked for


def stretches(speed: Array) -> list[slice]:
    """The rows of each stretch of one speed, without its ends.

    >>> speed = np.repeat([0.0, 0.5, -0.5, 1.0], 200)
    >>> stretches(speed)
    [slice(210, 390, None), slice(410, 590, None), slice(610, 790, None)]
    """
    from scipy import ndimage

    smooth = ndimage.median_filter(speed, 2 * BESIDE + 1, mode="nearest")
    change = np.zeros(len(speed))
    change[BESIDE:-BESIDE] = np.abs(smooth[2 * BESIDE :] - smooth[: -2 * BESIDE])
    change[:BESIDE] = change[-BESIDE:] = np.inf
    noise = NOISE * float(np.median(np.abs(speed - smooth)))
    steady = (change < np.maximum(STEADY * np.abs(smooth), noise)) & (np.abs(smooth) > REST * np.abs(smooth).max())
    edges = np.flatnonzero(np.diff(np.concatenate([[False], steady, [False]]).astype(int)))
    return [slice(int(a), int(b)) for a, b in edges.reshape(-1, 2) if b - a >= LEAST]


def averaged(columns: Mapping[str, Column], parts: Sequence[slice]) -> dict[str, Column]:
    """Columns whose rows are the means of stretches."""
    return {
        name: replace(column, si=np.array([float(column.si[part].mean()) for part in parts]))
        for name, column in columns.items()
    }
