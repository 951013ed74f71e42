r"""Spectra over an angle and over time, under coloured noise, at any speed.

A line of order n is cos(n theta(t)). With the series y and the covariance C of its noise, the sum

.. math:: S(n) = \sum_t (C^{-1} y)_t \, e^{-j n \theta_t}, \qquad I(n) = \sum_t \frac{1}{P(n \omega_t)}

is the generalised matched filter for it (Kay1998): the square of S over I is exponentially distributed where there is noise
alone, whose power P is that of the frequency at which the order passes; 2 S / I is the amplitude of the line. So a slow
stretch, where the order passes in low and noisy frequencies, counts for less than a fast one. To divide by C costs one Fourier
transform, S another one: the products are summed into narrow bins of the angle. Forward and backward are summed apart, since
ripple of friction changes its sign.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import tau

import numpy as np
from numpy.typing import NDArray

from strainwave.orders.smooth_part import FittedColumns, Shaft
from strainwave.statistics.spectrum import Floor

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

BINS_PER_PERIOD = 16  # of the angle in a period of the highest order: a line loses less than 1 % of its height
LINES_PER_RESOLUTION = 4  # lines of the spectrum for each that is independent
SPEED_BINS = 128  # bins of the speed, for the information of an order
FLOOR_LINES = 100  # independent lines whose median is the floor of one
MEDIAN_VARIANCE = 2.08  # variance of a median of exponential numbers, over that of their mean: 1 / log(2)²
MIN_OWN_INFORMATION = 0.1  # share of a line [1], that columns fitted before must leave for its amplitude
MAX_SPECTRUM_LINES = 2**23  # of a spectrum


@dataclass(frozen=True)
class Spectrum:
    """Evidence and amplitude of each order, or of each frequency, in a series.

    Attributes:
        place: order [1], or frequency [cycles per sample], shape (n,)
        evidence: twice it is chi-squared distributed with 2 `parts` degrees of freedom where there is noise alone, shape (n,)
        amplitude: of a line there, the larger one of those of both directions, shape (n,)
        noise: standard deviation of that amplitude's parts, shape (n,)
        parts: directions that are summed apart, 1 or 2
        floors: number of independent lines that the floor of each line rests on
    """

    place: Array
    evidence: Array
    amplitude: Array
    noise: Array
    parts: int
    floors: float

    def false_alarm(self, evidence: Array | float, tested: float) -> Array:
        """Return the probability that noise alone gives so much anywhere in so many lines: Bonferroni's bound.

        The floor is itself estimated, from few lines: tails of F instead of chi-squared.
        """
        from scipy.special import betainc

        single = betainc(self.floors, self.parts, self.floors / (self.floors + np.asarray(evidence)))
        bounded: Array = np.minimum(1.0, tested * single)
        return bounded

    def evidence_of(self, false_alarm: float, tested: float) -> float:
        """Return the evidence that noise alone gives anywhere in so many lines with this probability."""
        from scipy.special import betaincinv

        return self.floors * (1.0 / float(betaincinv(self.floors, self.parts, false_alarm / tested)) - 1.0)


def order_spectrum_of(
    weighed: Array, weight: Array, floor: Floor, shaft: Shaft, lowest: float, highest: float, fitted: FittedColumns
) -> Spectrum:
    """Return the spectrum over the angle of a shaft.

    Args:
        weighed: series over its floor, shape (n,)
        weight: by which the series was multiplied before, shape (n,)
        floor: of the series
        shaft: over whose angle
        lowest, highest: order
        fitted: columns that were fitted to the series before

    Raises:
        ValueError: the spectrum has too many lines to hold
    """
    angle, span = shaft.angle, float(np.ptp(shaft.angle))
    width = tau / (BINS_PER_PERIOD * highest)
    bins = int(span / width) + 2
    length = _good(max(LINES_PER_RESOLUTION * bins, 64))
    if length > MAX_SPECTRUM_LINES:
        raise ValueError(
            f"a spectrum up to order {highest:g} over {span / tau:.6g} revolutions has {length} lines; take a shorter "
            "stretch, or look for lower orders"
        )
    order: Array = (np.arange(length // 2 + 1) * (tau / (length * width))).astype(np.float64)
    kept = (order >= lowest) & (order <= highest)
    order = order[kept]
    senses = shaft.senses(weight)
    evidence, amplitude, noise = np.zeros(len(order)), np.zeros(len(order)), np.full(len(order), np.inf)
    cells = ((angle - angle.min()) / width).astype(int)
    for each in senses:
        there = shaft.sense == each

        def over_angle(series: Array, there: NDArray[np.bool_] = there) -> Complex:
            binned = np.bincount(cells[there], (series * weight)[there], bins)
            return np.asarray(np.fft.rfft(binned, length)[kept])

        information = _information(order, np.abs(shaft.speed[there]), weight[there], floor)
        taken = fitted.taken((shaft.name, each, lowest, highest), over_angle, float(weight[there] @ weight[there]))
        own, size, sigma = _beside(over_angle(weighed), information, taken)
        evidence += own
        noise = np.where(size > amplitude, sigma, noise)
        amplitude = np.maximum(amplitude, size)
    return _levelled(Spectrum(order, evidence, amplitude, noise, len(senses), 0.0))


def _beside(filtered: Complex, information: Array, taken: tuple[Array, Complex]) -> tuple[Array, Array, Array]:
    """Return evidence, amplitude and its standard deviation of each line, fitted together with columns.

    The series is without what the columns take of it. Of a line they take a share, of one phase more than of another: a speed
    that swings with the order of a gear takes the ripple of one phase. The two parts of the line are solved for beside them.

    Args:
        filtered: amount of each line in the series
        information: of each line without the columns
        taken: by the columns, as of `FittedColumns.taken`
    """
    share, turned = taken
    left = np.maximum(1.0 - share, np.abs(turned) + MIN_OWN_INFORMATION)
    whole = left**2 - np.abs(turned) ** 2
    part = (left * filtered + turned * np.conj(filtered)) / whole / information
    return np.real(np.conj(filtered) * part), 2.0 * np.abs(part), np.sqrt(2.0 / information * left / whole)


def time_spectrum_of(series: Array, weight: Array, floor: Floor, lowest: float, fitted: FittedColumns) -> Spectrum:
    """Return the spectrum over time, from the lowest frequency [cycles per sample] to half the sampling rate."""
    length = _good(LINES_PER_RESOLUTION * len(series))
    place: Array = np.fft.rfftfreq(length).astype(np.float64)
    kept = (place >= lowest) & (place < 0.5)
    place = place[kept]
    squared, level = float(weight @ weight), floor.at(place)

    def over_time(each: Array) -> Complex:
        return np.asarray(np.fft.rfft(each * weight, length)[kept])

    taken = fitted.taken(("time", lowest), over_time, squared)
    return _levelled(Spectrum(place, *_beside(over_time(series) / level, squared / level, taken), 1, 0.0))


def _levelled(spectrum: Spectrum) -> Spectrum:
    """Return a spectrum with the expected median around each line: noise over an angle may differ from that over time."""
    from scipy.ndimage import median_filter
    from scipy.special import gammaincinv

    independent = len(spectrum.evidence) / LINES_PER_RESOLUTION
    around = min(FLOOR_LINES, max(1.0, independent))
    width = max(3, int(around * LINES_PER_RESOLUTION)) | 1
    thinned = max(1, width // 201)
    median = median_filter(spectrum.evidence[::thinned], (width // thinned) | 1, mode="reflect")
    level = np.repeat(median, thinned)[: len(spectrum.evidence)] / float(gammaincinv(spectrum.parts, 0.5))
    level = np.maximum(level, 1.0)  # what the smooth part took out is no lower floor
    return Spectrum(
        spectrum.place,
        spectrum.evidence / level,
        spectrum.amplitude,
        spectrum.noise * np.sqrt(level),
        spectrum.parts,
        max(2.0, around / MEDIAN_VARIANCE * spectrum.parts),
    )


def _information(order: Array, speed: Array, weight: Array, floor: Floor) -> Array:
    """Return I(n), from a histogram of the speed."""
    fastest = float(speed.max()) or 1.0
    cells = np.minimum((speed / fastest * SPEED_BINS).astype(int), SPEED_BINS - 1)
    counts = np.bincount(cells, weight**2, SPEED_BINS)
    middles = (np.arange(SPEED_BINS) + 0.5) * fastest / SPEED_BINS
    used = counts > 0.0
    information = np.zeros(len(order))
    for count, middle in zip(counts[used], middles[used], strict=True):
        information += count / floor.at(order * middle / tau)
    return np.maximum(information, 1e-300)


def _good(length: int) -> int:
    from scipy.fft import next_fast_len

    return int(next_fast_len(length, real=True))


def spread_of(angle: Array, weight: Array) -> float:
    """Return the standard deviation of the angle [rad], samples counted by their weight."""
    share = weight**2 / float(weight @ weight)
    middle = float(share @ angle)
    return float(np.sqrt(share @ (angle - middle) ** 2))
