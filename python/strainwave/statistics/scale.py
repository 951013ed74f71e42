"""Standard deviations: robust ones, intervals of estimated ones (Student 1908), and the gain of a model in its own."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NORMAL_MAD = 0.6744897501960817  # median of the absolute value of a standard normal variable
ONE_SIGMA = 0.6826894921370859  # share of a normal distribution within one standard deviation
SIGNIFICANCE_SIGMA = 3.0  # standard deviations: numbers that are farther apart differ
MIN_GAIN_SIGMA = 2.5  # standard deviations by which the squares that a further part of a model leaves must be smaller
MIN_READING_GAIN_SIGMA = 3.0  # likewise of another reading of columns, which changes the meaning of all numbers
MAX_GAIN = 3.0  # times the upper quartile of the gains of blocks: a larger one counts as that


def robust_sigma(values: Array, axis: int | None = None) -> Array:
    """Return the standard deviation of normal noise with the same median absolute value (Hampel 1974).

    >>> float(robust_sigma(np.array([-0.67449, 0.67449, 0.67449, 1e6, -0.1])).round(4))
    1.0
    """
    return np.asarray(np.median(np.abs(values), axis=axis) / NORMAL_MAD)


def noise_sigma(values: Array) -> float:
    """Return the standard deviation of white noise on a smooth series, by the median of its second differences.

    >>> time = np.linspace(0.0, 1.0, 2001)
    >>> round(noise_sigma(np.sin(time) + 0.1 * np.random.default_rng(0).normal(size=2001)), 2)
    0.1
    """
    return float(robust_sigma(np.diff(values, 2)) / np.sqrt(6.0)) if len(values) > 2 else 0.0


def student(confidence: float, freedom: float) -> float:
    """Return half the width of the interval that contains Student's variable with this probability.

    >>> round(student(0.95, 4.0), 3)
    2.776
    """
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.5 + 0.5 * confidence))


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
