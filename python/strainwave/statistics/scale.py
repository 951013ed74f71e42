"""Robust standard deviations, which outliers and a smooth signal hardly change."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NORMAL_MAD = 0.6744897501960817  # median of the absolute value of a standard normal variable


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
