"""Correlation of residuals: their spectrum and their correlation length."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
MIN_SAMPLES_PER_ORDER = 10  # of an autoregression (assumed)


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


def correlation_length(residual: Array) -> float:
    """Return the integrated autocorrelation time in samples, over Sokal's window; 1 if an autoregression finds white noise.

    Sokal, "Monte Carlo methods in statistical mechanics" (1997), section 3.
    """
    centred = residual - residual.mean()
    if len(autoregression(centred)) == 1:
        return 1.0
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
