"""The noise floor of a series over its frequencies, told from what stands out of it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import log

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NARROWEST = 40  # lines of a block at the lowest frequencies
WIDENING = 0.5  # of the frequency: blocks grow with it, as noise is steep at low frequencies and flat at high ones
WIDEST = 0.03  # of all lines
EDGE = 0.05  # of the series, on which the taper rises at each end


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
        """The level at a frequency [cycles per sample], of any size: what is sampled too seldom is folded back."""
        folded = np.abs(frequency - np.rint(frequency))
        return np.exp(np.interp(folded, self.place, np.log(self.level)))

    def whitened(self, series: Array) -> Array:
        """The series over the root of its floor: white, of variance 1, where it is noise."""
        return self._divided(series, 0.5)

    def weighed(self, series: Array) -> Array:
        """The series over its floor: its product with a shape tells how much of the shape is in it (a matched filter)."""
        return self._divided(series, 1.0)

    def _divided(self, series: Array, power: float) -> Array:
        count = len(series)
        frequency: Array = np.fft.rfftfreq(count).astype(np.float64)
        spectrum = np.fft.rfft(series) / self.at(frequency) ** power
        divided: Array = np.fft.irfft(spectrum, count)
        return divided


def floor_of(power: Array, count: int) -> Floor:
    """The floor of a periodogram: medians of blocks, each over the median of the exponential distribution.

    A median does not see single lines that stand out, which a mean would smear over their neighbours.

    Args:
        power: |DFT|² over the sum of the squared taper at 1 / count, 2 / count, … cycles per sample, shape (n,)
        count: samples of the series
    """
    edges = [0]
    widest = max(NARROWEST, int(WIDEST * len(power)))
    while edges[-1] < len(power):
        width = int(min(max(NARROWEST, WIDENING * edges[-1]), widest))
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
    """The floor of a series that was multiplied by a weight, which is 1 or less."""
    power = np.abs(np.fft.rfft(series)[1:]) ** 2 / float(weight @ weight)
    return floor_of(power, len(series))


def taper(count: int) -> Array:
    """One in the middle, cosines down to zero at both ends, shape (count,)."""
    rise = max(1, int(EDGE * count))
    shape = np.ones(count)
    shape[:rise] = 0.5 - 0.5 * np.cos(np.pi * (np.arange(rise) + 0.5) / rise)
    shape[-rise:] = shape[:rise][::-1]
    return shape
