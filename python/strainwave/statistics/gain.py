"""Gain of one model over another, by how it scatters over the blocks of a record."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MIN_GAIN_SIGMA = 2.5  # standard deviations by which the squares that a further part of a model leaves must be smaller
MIN_READING_GAIN_SIGMA = 3.0  # likewise of another reading of columns, which changes the meaning of all numbers
MAX_GAIN = 3.0  # times the upper quartile of the gains of blocks: a larger one counts as that


def sigmas_of_gain(gains: Array) -> float:
    """Return the sum of the gains of blocks over its standard deviation; 0 if they are all alike.

    >>> round(sigmas_of_gain(np.array([1.0, 2.0, 3.0])), 2)
    3.46
    """
    spread = float(np.std(gains, ddof=1) * np.sqrt(len(gains)))
    return float(gains.sum()) / spread if spread > 0.0 else 0.0


def without_single_events(gains: Array) -> Array:
    """Return gains of blocks within limits, so that a single event, as a jolt, decides nothing."""
    limit = MAX_GAIN * float(np.quantile(np.abs(gains), 0.75))
    return np.clip(gains, -limit, limit)
