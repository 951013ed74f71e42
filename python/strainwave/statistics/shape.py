"""Shape of residuals: the part that repeats over an angle, a speed or the order of the samples, and is no noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
MAX_BINS = 24  # parts of the range, with as many samples each: order 8 of a turn has three of them
MIN_PER_BIN = 4  # samples, two of each half
MIN_BINS = 6
BLOCKS = 20  # stretches in the order of the samples; halves take turns, so that slow noise is in either alone


@dataclass(frozen=True)
class Shape:
    """What repeats of a residual over an abscissa.

    Attributes:
        size: root mean square, without what noise adds
        chance: probability that noise, independent in the two halves of the samples, repeats as well
    """

    size: float
    chance: float


def shape(residual: Array, over: Array, *, ordered: bool = False) -> Shape | None:
    """Return the shape of a residual over an abscissa; None if the samples are too few.

    The means of both halves of the samples in each part of the range are compared: a shape is in both, noise in either alone.
    Their mean product is the square of its size without bias, and their correlation is as likely by chance as t = r
    sqrt((n - 2) / (1 - r^2)) of Student's distribution with n - 2 degrees of freedom.

    Args:
        residual: in the order of the samples, shape (n,)
        over: abscissa, shape (n,)
        ordered: True if the abscissa is the order of the samples: every second one is then of a half

    >>> noise = np.random.default_rng(0).normal(size=2000)
    >>> angle = np.linspace(0.0, 100.0, 2000) % 6.28
    >>> found = shape(noise + 0.5 * np.sin(2.0 * angle), angle)
    >>> round(found.size, 2), found.chance < 1e-6, shape(noise, angle).chance > 0.01
    (0.33, True, True)
    """
    from scipy.special import stdtr

    count = len(residual)
    bins = min(MAX_BINS, count // MIN_PER_BIN)
    if bins < MIN_BINS:
        return None
    place = np.empty(count, int)
    place[np.argsort(over, kind="stable")] = np.arange(count) * bins // count
    half = np.arange(count) % 2 if ordered else np.arange(count) * BLOCKS // count % 2
    left = residual - residual.mean()
    sums, counts = (np.bincount(2 * place + half, weights, 2 * bins).reshape(bins, 2) for weights in (left, np.ones(count)))
    both = counts.min(axis=1) > 0
    if both.sum() < MIN_BINS:
        return None
    one, other = (sums[both] / counts[both]).T
    product = float(np.mean(one * other))
    r = float(np.corrcoef(one, other)[0, 1]) if one.std() * other.std() > 0.0 else 0.0
    freedom = int(both.sum()) - 2
    t = r * np.sqrt(freedom / max(1.0 - r**2, 1e-300))
    return Shape(float(np.sqrt(max(product, 0.0))), float(stdtr(freedom, -t)))
