"""Power over the frequency in segments with Hann windows, and its noise floor without the lines that stand out of it.

Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70-73.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import log

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MIN_BLOCK_LINES = 40  # lines of a block at the lowest frequencies
BLOCK_GROWTH = 0.5  # of the frequency: blocks grow with it, as noise is steep at low frequencies and flat at high ones
MAX_BLOCK_SHARE = 0.03  # of all lines
TAPER_SHARE = 0.05  # of the series, on which the taper rises at each end


def segment_power(series: Array, samples: int, repeated: int) -> tuple[Array, Array]:
    """Return the frequencies [cycles per sample], shape (k,), and the power of each segment less its mean, shape (segments, k).

    The power of a sine over many segments is half the square of its amplitude.

    Args:
        series: shape (n,)
        samples: of a segment, 2 to n
        repeated: samples that a segment has in common with the next

    >>> frequency, power = segment_power(3.0 * np.sin(0.25 * 2.0 * np.pi * np.arange(4000.0)), 400, 200)
    >>> float(frequency[power[0].argmax()]), power.max(axis=1).round(3).tolist()[:2]
    (0.25, [4.5, 4.5])
    """
    segments = np.lib.stride_tricks.sliding_window_view(series, samples)[:: samples - repeated]
    window = hann(samples)
    lines = np.fft.rfft((segments - segments.mean(axis=1, keepdims=True)) * window) / window.sum()
    power = lines.real**2 + lines.imag**2
    power[:, 1 : (samples + 1) // 2] *= 2.0  # a line stands for its mirror image, too
    return np.asarray(np.fft.rfftfreq(samples), np.float64), power


def mean_power(series: Array, samples: int) -> tuple[Array, Array]:
    """Return the frequencies [cycles per sample] and the mean power of segments that overlap by half, both of shape (k,)."""
    frequency, power = segment_power(series, samples, samples // 2)
    return frequency, power.mean(axis=0)


def hann(samples: int) -> Array:
    """Return a Hann window of one period, shape (samples,)."""
    return 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(samples) / samples)


def bandwidth(samples: int) -> float:
    """Return the width of a line of white noise in segments with Hann windows [cycles per sample]: power over its density."""
    window = hann(samples)
    return float(window @ window) / float(window.sum()) ** 2


# ---- Noise floor -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Floor:
    """Power of the noise of a series, in blocks of neighbouring lines.

    Attributes:
        place: middle of each block [cycles per sample], shape (m,)
        level: mean of |DFT|² of the noise over the sum of the squared taper, shape (m,): the variance, where it is white
        lines: in each block, shape (m,)
    """

    place: Array
    level: Array
    lines: Array

    def at(self, frequency: Array) -> Array:
        """Return the level at a frequency [cycles per sample]; frequencies above half the rate are folded back."""
        folded = np.abs(frequency - np.rint(frequency))
        return np.exp(np.interp(folded, self.place, np.log(self.level)))

    def freedom(self, frequency: float) -> float:
        """Return the degrees of freedom of the level at a frequency [cycles per sample].

        The logarithm of the median of m exponential numbers has the variance 1 / (m ln² 2).
        """
        folded = abs(frequency - round(frequency))
        share = float(np.interp(folded, self.place, np.arange(len(self.place))))
        before = int(share)
        after = min(before + 1, len(self.place) - 1)
        rest = share - before
        variance = ((1.0 - rest) ** 2 / self.lines[before] + rest**2 / self.lines[after]) / log(2.0) ** 2
        return 2.0 / float(variance)

    def whitened(self, series: Array) -> Array:
        """Return series over the root of the floor, shape (n,) or (n, k): white, of variance 1, if they are noise."""
        return self._divided(series, 0.5)

    def coordinates(self, series: Array) -> Array:
        """Return whitened series in an orthonormal basis of cosines and sines, shape (m,) or (m, k).

        Their inner products are those of `whitened` (Parseval), without a transform back.
        """
        from scipy.fft import rfft

        count = len(series)
        frequency: Array = np.fft.rfftfreq(count).astype(np.float64)
        lines = rfft(series.T) * np.sqrt(_lines_weight(count) / self.at(frequency))
        return np.concatenate([lines.real, lines.imag], axis=-1).T

    def weighed(self, series: Array) -> Array:
        """Return the series over its floor: its product with a shape is the amount of the shape in it (a matched filter)."""
        return self._divided(series, 1.0)

    def _divided(self, series: Array, power: float) -> Array:
        from scipy.fft import irfft, rfft

        count = len(series)
        frequency: Array = np.fft.rfftfreq(count).astype(np.float64)
        level = self.at(frequency) ** power
        divided: Array = irfft(rfft(series, axis=0) / (level if series.ndim == 1 else level[:, None]), count, axis=0)
        return divided


def _lines_weight(count: int) -> Array:
    """Return the weight of each |DFT|² of a real series in the sum of its squares: a line stands for its mirror image, too."""
    weight = np.full(count // 2 + 1, 2.0 / count)
    weight[0] = 1.0 / count
    if count % 2 == 0:
        weight[-1] = 1.0 / count
    return weight


def floor_of(power: Array, count: int) -> Floor:
    """Return the floor of a periodogram: medians of blocks, each over the median of the exponential distribution.

    A median is not moved by single lines, which a mean would smear over their neighbours.

    Args:
        power: |DFT|² over the sum of the squared taper at 1 / count, 2 / count, … cycles per sample, shape (n,)
        count: samples of the series
    """
    edges = [0]
    widest = max(MIN_BLOCK_LINES, int(MAX_BLOCK_SHARE * len(power)))
    while edges[-1] < len(power):
        width = int(min(max(MIN_BLOCK_LINES, BLOCK_GROWTH * edges[-1]), widest))
        edges.append(edges[-1] + width)
    if len(edges) > 2:
        edges.pop(-2)  # the last block takes what is left
    edges[-1] = len(power)
    blocks = [power[low:high] for low, high in pairwise(edges)]
    level = np.array([float(np.median(block)) for block in blocks]) / log(2.0)
    least = max(float(level.max()) * 1e-12, 1e-300)
    place = (np.array(edges[:-1]) + 0.5 * np.diff(edges) + 0.5) / count
    return Floor(place, np.maximum(level, least), np.diff(edges).astype(float))


def floor_under(series: Array, weight: Array) -> Floor:
    """Return the floor of a series that was multiplied by a weight of 1 or less."""
    power = np.abs(np.fft.rfft(series)[1:]) ** 2 / float(weight @ weight)
    return floor_of(power, len(series))


def taper(count: int) -> Array:
    """Return ones in the middle and cosines down to zero at both ends, shape (count,)."""
    rise = max(1, int(TAPER_SHARE * count))
    shape = np.ones(count)
    shape[:rise] = 0.5 - 0.5 * np.cos(np.pi * (np.arange(rise) + 0.5) / rise)
    shape[-rise:] = shape[:rise][::-1]
    return shape
