"""Correlation of residuals, and the part of them that repeats over an angle, a speed or their order, and is no noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MIN_SAMPLES_PER_ORDER = 10  # of an autoregression (assumed)
MAX_SHAPE_BINS = 24  # parts of the range, with as many samples each: order 8 of a turn has three of them
MIN_SAMPLES_PER_BIN = 4  # samples, two of each half
MIN_SHAPE_BINS = 6
ALTERNATING_STRETCHES = 20  # stretches in the order of the samples; halves take turns, so that slow noise is in either alone


def autoregression(series: Array) -> Array:
    """Return the coefficients 1, a1, …, ak of the autoregression x[t] + a1 x[t-1] + … + ak x[t-k] = white noise of a series.

    Coefficients by Burg, "Maximum entropy spectral analysis" (1975), which are stable; the order by the criterion of Schwarz
    (1978), up to ten times the decimal logarithm of the number of samples.

    >>> random = np.random.default_rng(0).normal(size=2000)
    >>> slow = np.zeros(2000)
    >>> for t in range(1, 2000):
    ...     slow[t] = 0.9 * slow[t - 1] + random[t]
    >>> [round(float(a), 1) for a in autoregression(slow)], len(autoregression(random))
    ([1.0, -0.9], 1)
    """
    n = len(series)
    ahead, back = series.copy(), series.copy()
    coefficients, power = np.ones(1), float(np.mean(series**2))
    best, least = coefficients, np.inf
    for order in range(min(int(10.0 * np.log10(max(n, 1))), n // MIN_SAMPLES_PER_ORDER) + 1):
        if power <= 0.0:
            break
        criterion = n * np.log(power) + np.log(n) * order
        if criterion < least:
            best, least = coefficients, criterion
        ahead, back = ahead[1:], back[:-1]
        both = float(ahead @ ahead + back @ back)
        if both == 0.0:
            break
        reflection = -2.0 * float(ahead @ back) / both
        ahead, back = ahead + reflection * back, back + reflection * ahead
        longer = np.append(coefficients, 0.0)
        coefficients, power = longer + reflection * longer[::-1], power * (1.0 - reflection**2)
    return best


def spectrum(series: Array, length: int) -> Array:
    """Return the power of a series at the frequencies of a transform of even length, by its autoregression; their mean is 1.

    The frequencies above half the sampling rate mirror those below; the mean is over all.
    """
    power = 1.0 / np.abs(np.fft.rfft(autoregression(series), length)) ** 2
    both_sides = 2.0 * power.sum() - power[0] - power[-1]
    return np.asarray(power * (length / both_sides))


def andrews_lags(series: Array) -> int:
    """Return the lags over which a Bartlett kernel sums, for an autoregression of first order.

    Andrews, Econometrica 59 (1991) 817-858, equation 6.2 and section 6.4.
    """
    power = float(series @ series)
    if len(series) < 2 or power == 0.0:
        return 0
    correlation = min(max(float(series[1:] @ series[:-1]) / power, -0.99), 0.99)
    strength = 4.0 * correlation**2 / (1.0 - correlation**2) ** 2
    return min(int(1.1447 * np.cbrt(strength * len(series))), len(series) // 4)


def whitened(series: Array, coefficients: Array) -> Array:
    """Return series less what an autoregression predicts from the samples before, shape (n, k).

    >>> whitened(np.array([[1.0], [0.5], [0.25]]), np.array([1.0, -0.5])).ravel().tolist()
    [1.0, 0.0, 0.0]
    """
    white = series.copy()
    for lag, coefficient in enumerate(coefficients[1:], 1):
        white[lag:] += coefficient * series[:-lag]
    return white


def is_white(residual: Array) -> bool:
    """True if an autoregression finds no memory in a residual, shape (n,)."""
    return len(autoregression(residual - residual.mean())) == 1


def correlation_length(residual: Array) -> float:
    """Return the integrated autocorrelation time in samples, over Sokal's window; 1 if an autoregression finds white noise.

    Sokal, "Monte Carlo methods in statistical mechanics" (1997), section 3.
    """
    if is_white(residual):
        return 1.0
    centred = residual - residual.mean()
    power = np.abs(np.fft.rfft(centred, 2 * len(centred))) ** 2
    if power.sum() == 0.0:
        return 1.0
    correlation = np.fft.irfft(power)[: len(centred)]
    time = 2.0 * np.cumsum(correlation / correlation[0]) - 1.0
    window = np.arange(len(time)) >= 5.0 * time
    return float(max(1.0, time[np.argmax(window)] if window.any() else time[-1]))


def rms(values: Array) -> float:
    """Return the root mean square of values."""
    return float(np.sqrt(np.mean(values**2)))


def chance_of_gain(before: float, left: float, more: int, freedom: float) -> float:
    """Return the probability that `more` unknowns shrink the sum of squares of white residuals as much by chance (F test).

    >>> round(chance_of_gain(4.0, 2.0, 1, 10), 4), chance_of_gain(4.0, 4.0, 1, 10)
    (0.0101, 1.0)
    """
    from scipy.special import fdtrc

    if freedom <= 0.0 or before <= left:
        return 1.0
    return float(fdtrc(more, freedom, (before - left) / more * freedom / left)) if left > 0.0 else 0.0


# ---- Shape -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Shape:
    """Repeating part of a residual over an abscissa.

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
    bins = min(MAX_SHAPE_BINS, count // MIN_SAMPLES_PER_BIN)
    if bins < MIN_SHAPE_BINS:
        return None
    place = np.empty(count, int)
    place[np.argsort(over, kind="stable")] = np.arange(count) * bins // count
    half = np.arange(count) % 2 if ordered else np.arange(count) * ALTERNATING_STRETCHES // count % 2
    left = residual - residual.mean()
    sums, counts = (np.bincount(2 * place + half, weights, 2 * bins).reshape(bins, 2) for weights in (left, np.ones(count)))
    both = counts.min(axis=1) > 0
    if both.sum() < MIN_SHAPE_BINS:
        return None
    one, other = (sums[both] / counts[both]).T
    product = float(np.mean(one * other))
    r = float(np.corrcoef(one, other)[0, 1]) if one.std() * other.std() > 0.0 else 0.0
    freedom = int(both.sum()) - 2
    t = r * np.sqrt(freedom / max(1.0 - r**2, 1e-300))
    return Shape(float(np.sqrt(max(product, 0.0))), float(stdtr(freedom, -t)))
