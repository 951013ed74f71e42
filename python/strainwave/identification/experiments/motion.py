"""The motion of a drive from its measured angle: smoothed, differentiated, with its rests.

Torque and all that is compared with it pass the same filter without phase shift. A filter common to both sides of a linear
equation does not bias it (Gautier, "Dynamic identification of robots with power model", ICRA 1997; Janot,
Vandanjon & Gautier, IEEE Trans. Control Syst. Technol. 22 (2014) 132-145).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from strainwave.equality import ComparedByFields
from strainwave.statistics.linear_fit import solved
from strainwave.statistics.spectrum import bandwidth, mean_power

Array = NDArray[np.float64]

REST_SIGMA = 3.0  # standard deviations; positions that differ by less are equal
MAX_NOISE_SHARE = 1e-3  # of the power of the filtered acceleration
MAX_NOISE_OF_OWN = 5e-3  # of the part of it that the angle does not make up: by as much inertia and gravity come out too small
MAX_CUTOFF_SHARE = 0.1  # of the sample rate
MIN_NARROWING = 0.6  # of the cut-off: a band hardly narrower changes more by what the model lacks than by noise
PASS_BAND_SHARE = 0.4  # of the cut-off: 2/5, the literature's rule
SPEED_CUTOFF_FACTOR = 4.0  # over the cut-off of the acceleration: reversals must be known to milliseconds
FILTER_SAMPLES = 20  # samples compared, each side: there the response of the filter is below 1e-9 of its peak
END_SAMPLES = 5  # samples of the decimated series that the ends of the filters spoil, each side
MAX_GAP_STEPS = 2.5  # steps: a longer time without a row is a gap
MIN_SLOW_SHARE = 0.5  # of the power of the acceleration, that lies below a vibration (assumed)
MAX_FULL_BAND_ROWS = 8_000  # that a fit in the full band compares
MIN_SAMPLES = 200  # of a log of a motion


@dataclass(frozen=True, eq=False)
class Motion(ComparedByFields):
    """Motion of a shaft, on a regular grid.

    Attributes:
        time: of the grid [s], shape (n,)
        angle, speed, acceleration: of the shaft, smoothed [rad, rad/s, rad/s2], shape (n,)
        known: False at rest, in a gap and at the ends, shape (n,)
        turning: True so near to a reversal that friction turns over, shape (n,)
        resting: True if it does not move beyond the noise of the angle, shape (n,)
        every: one of so many samples of the grid is compared
        cutoff: of the filter on the angle [Hz]; the pass band ends at 0.4 of it; infinite for the full band
        wind_up: angle of the output less that of the shaft over the ratio [rad], shape (n,); None if it was not measured
    """

    time: Array
    angle: Array
    speed: Array
    acceleration: Array
    known: NDArray[np.bool_]
    turning: NDArray[np.bool_]
    resting: NDArray[np.bool_]
    every: int
    cutoff: float
    wind_up: Array | None = None

    def output_angle(self, ratio: float) -> Array:
        """Return the angle of the output [rad], shape (n,): that of a rigid gear if the output was not measured."""
        return self.angle / ratio if self.wind_up is None else self.angle / ratio + self.wind_up

    @cached_property
    def step(self) -> float:
        """Step of the grid [s]."""
        return float(self.time[-1] - self.time[0]) / (len(self.time) - 1)

    @cached_property
    def rows(self) -> NDArray[np.intp]:
        """Samples of the grid that are compared."""
        rows: NDArray[np.intp] = np.arange(0, len(self.time), self.every)
        return rows[self.compared[rows]]

    @cached_property
    def compared(self) -> NDArray[np.bool_]:
        """Samples that take part in a comparison in the pass band, shape (n,)."""
        compared: NDArray[np.bool_] = self.known & ~self.turning
        return compared

    @cached_property
    def _response(self) -> Array:
        """Response of the filter by the place of a sample between two compared ones, and by their distance."""
        half = (FILTER_SAMPLES + 1) * self.every
        impulse = np.zeros(2 * half + 1)
        impulse[half] = 1.0
        response = _low_passed(impulse, PASS_BAND_SHARE * self.cutoff, self.step)
        distance = self.every * np.arange(-FILTER_SAMPLES, FILTER_SAMPLES + 1)[:, np.newaxis] - np.arange(self.every)
        return np.ascontiguousarray(response[half + distance])

    def below(self, frequency: float) -> Motion:
        """Return the same, compared far below a vibration of this frequency [Hz], and not for one period behind a reversal.

        Friction that turns over makes a load ring on its spring. That ring averages out over time, but not over the rest of it
        if the reversal itself takes no part.

        Raises:
            ValueError: too little of the motion is as slow as that
        """
        turned = self.time[1:][np.diff(np.sign(self.speed)) != 0.0]
        last = np.concatenate(([-np.inf], turned))[np.searchsorted(turned, self.time, "right")]
        cutoff = min(self.cutoff, frequency)
        every = max(self.every, _every(cutoff, self.step))
        known = self.known & (self.time - last > 1.0 / frequency)
        known[: END_SAMPLES * every] = known[-END_SAMPLES * every :] = False
        left = replace(self, known=known, every=every, cutoff=cutoff)
        if not left._is_slow(self.acceleration):
            raise ValueError(f"the shaft moves about as fast as a vibration of {frequency:.3g} Hz; record a slower motion")
        return left

    def _is_slow(self, acceleration: Array) -> bool:
        """True if half the power of an acceleration lies in the pass band; False if no sample is left to compare."""
        if not len(self.rows):  # a filter longer than the record would need memory without end
            return False
        slow, whole = self.filtered(acceleration), acceleration[self.compared]
        return bool(np.mean(slow**2) >= MIN_SLOW_SHARE * np.mean(whole**2))

    def at_speed(self, speed: Array) -> Motion:
        """Return the same with a speed that was measured, and its rate as acceleration, shape (n,)."""
        smooth, quick = (
            _low_passed(speed, min(cutoff, 0.4 / self.step), self.step)
            for cutoff in (self.cutoff, SPEED_CUTOFF_FACTOR * self.cutoff)
        )
        return replace(self, speed=quick, acceleration=_rate(smooth, self.step))

    def unfiltered(self) -> Motion:
        """Return the same, compared in the full band at one of as many samples as a fit may take."""
        return replace(self, every=-(-len(self.time) // MAX_FULL_BAND_ROWS), cutoff=np.inf)

    def in_full_band(self) -> Motion:
        """Return the same, compared in the full band, near reversals, too."""
        return replace(self.unfiltered(), turning=np.zeros_like(self.turning))

    def filtered(self, series: Array) -> Array:
        """Return series on the grid in the pass band, at the samples compared: shape (…, n) becomes (…, rows).

        A filter of Butterworth, fourth order, forward and backward. One of `every` samples is wanted: its response is summed
        until it has decayed, in place of the recursion over all samples. In the full band all passes.
        """
        if np.isinf(self.cutoff):
            return np.asarray(series[..., self.rows])
        blocks = -(-len(self.time) // self.every)
        padded = np.zeros((*series.shape[:-1], blocks * self.every))
        padded[..., : len(self.time)] = np.where(self.compared, series, 0.0)
        shares = (self._response @ padded.reshape(-1, self.every).T).reshape(len(self._response), *series.shape[:-1], blocks)
        smooth = np.zeros((*series.shape[:-1], blocks + 2 * FILTER_SAMPLES))
        for distance, share in enumerate(shares):
            smooth[..., distance : distance + blocks] += share
        return smooth[..., FILTER_SAMPLES + self.rows // self.every]


def motion_of(
    time: Array, angle: Array, cutoff: float | None = None, slid: float = 0.0, highest: float = MAX_CUTOFF_SHARE
) -> Motion:
    """Return the motion of a shaft from its angle at instants that rise, with gaps and no other order in them.

    Args:
        time: [s], shape (n,), rising
        angle: [rad], shape (n,)
        cutoff: of the filter on the angle [Hz]; by default the highest at which the noise of the angle is a negligible share of
            the acceleration, and of the part of it that no gravity makes up; at most `highest`
        highest: cut-off over the sampling rate, by default
        slid: angle over which friction turns over at a reversal [rad]: samples nearer to one are not compared

    Raises:
        ValueError: too few samples, or an angle whose noise hides the motion
    """
    from scipy.interpolate import Akima1DInterpolator

    if len(time) < MIN_SAMPLES:
        raise ValueError(
            f"the log has {len(time)} samples; at least {MIN_SAMPLES} determine a motion: record longer, or faster"
        )
    step = float(np.median(np.diff(time)))
    grid = np.arange(0.0, float(time[-1] - time[0]) + 0.5 * step, step) + float(time[0])
    regular = np.asarray(Akima1DInterpolator(time, angle, extrapolate=True)(grid))
    frequency, power, of_noise, noise = spectra(regular, step)
    if cutoff is None:
        cutoff = widest_cutoff(frequency, power, of_noise, 1.0 / step, highest)
        of_own = MAX_NOISE_OF_OWN * _own_share(_low_passed(regular, cutoff, step), step)
        if of_own < MAX_NOISE_SHARE:  # in the full band, in which noise up to the cut-off counts
            wide = widest_cutoff(frequency, power, of_noise, 1.0 / step, highest / PASS_BAND_SHARE, of_own)
            narrow = PASS_BAND_SHARE * wide
            cutoff = narrow if narrow < MIN_NARROWING * cutoff else cutoff
    every = _every(cutoff, step)
    smooth = _low_passed(regular, cutoff, step)
    quick = _low_passed(regular, min(SPEED_CUTOFF_FACTOR * cutoff, 0.4 / step), step)
    speed, acceleration = _rate(quick, step), _second_rate(smooth, step)
    stands = standing(regular, every, noise)
    known = ~stands & ~in_gap(time, grid, step, every)
    known[: END_SAMPLES * every] = known[-END_SAMPLES * every :] = False
    turning = _turning(regular, speed, slid) | near_rest(regular, every, noise)
    return Motion(grid, smooth, speed, acceleration, known, turning, stands, every, cutoff)


def _own_share(angle: Array, step: float) -> float:
    """Return the part of the power of an acceleration that no cubic of its angle makes up, as gravity nearly is [1]."""
    acceleration, inner = _second_rate(angle, step), slice(2, -2)
    columns = np.vander((angle - angle.mean()) / max(float(np.ptp(angle)), 1e-300), 4)[inner]
    own = acceleration[inner] - columns @ solved(columns, acceleration[inner])
    return float(own @ own) / max(float(acceleration @ acceleration), 1e-300)


def _low_passed(series: Array, cutoff: float, step: float) -> Array:
    """Return a series through a Butterworth filter of fourth order, forward and backward; its cut-off is in Hz.

    The line through both ends passes. What is left is zero there, and continued as an odd function.
    """
    line = np.linspace(series[0], series[-1], len(series))
    odd = np.concatenate([series - line, (line - series)[-2:0:-1]])
    gain = 1.0 / (1.0 + (np.tan(np.pi * np.fft.rfftfreq(len(odd))) / np.tan(np.pi * cutoff * step)) ** 8)
    return line + np.fft.irfft(np.fft.rfft(odd) * gain, len(odd))[: len(series)]


def _every(cutoff: float, step: float) -> int:
    """Return the samples for each that is compared: at twice the pass band residuals of noise are white."""
    return max(1, round(1.0 / (step * 2.0 * PASS_BAND_SHARE * cutoff)))


def integrated(rate: Array, time: Array) -> Array:
    """Return the integral of a rate from its first instant on by trapezoids, shape (n,)."""
    return np.append(0.0, np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time)))


def _rate(series: Array, step: float) -> Array:
    """Return the derivative by differences of fourth order: those of second order lose 1 % if a period has 25 samples."""
    rate = np.gradient(series, step)
    rate[2:-2] = (8.0 * (series[3:-1] - series[1:-3]) - (series[4:] - series[:-4])) / (12.0 * step)
    return rate


def _second_rate(series: Array, step: float) -> Array:
    """Return the second derivative by differences of fourth order; zero at the two samples of each end."""
    rate = np.zeros_like(series)
    rate[2:-2] = 16.0 * (series[3:-1] + series[1:-3]) - (series[4:] + series[:-4]) - 30.0 * series[2:-2]
    return rate / (12.0 * step**2)


def _turning(angle: Array, speed: Array, slid: float) -> NDArray[np.bool_]:
    """Return True for samples so near to a reversal that friction turns over there, shape (n,)."""
    from scipy import ndimage

    turns = np.flatnonzero(np.diff(np.sign(speed)) != 0.0)
    if slid == 0.0 or len(turns) == 0:
        return np.zeros(len(angle), bool)
    after = np.searchsorted(turns, np.arange(len(angle)))
    near = np.zeros(len(angle), bool)
    for place in (after - 1, after):
        turn = turns[np.clip(place, 0, len(turns) - 1)]
        near |= (np.abs(angle - angle[turn]) < slid) & (place >= 0) & (place < len(turns))
    return ndimage.binary_dilation(near)


def in_gap(time: Array, grid: Array, step: float, reach: int = 0) -> NDArray[np.bool_]:
    """Return True for samples of a grid within a gap of the instants, or within `reach` samples of one, shape (n,)."""
    from scipy import ndimage

    after = np.clip(np.searchsorted(time, grid), 1, len(time) - 1)
    within = time[after] - time[after - 1] > MAX_GAP_STEPS * step
    return ndimage.maximum_filter1d(within, 2 * reach + 1)


def spectra(position: Array, step: float) -> tuple[Array, Array, Array, float]:
    """Return the contributions of motion and noise to the acceleration.

    Above a quarter of the sample rate the position is taken to contain white noise alone; single lines do not change the median
    over that range. The spectrum is estimated from the speed, which is flat enough not to leak over the decades between motion
    and noise.

    Returns:
        frequency [Hz]; spectral density of the acceleration, and its part due to the noise [rad2/s4/Hz], all of shape
        (n,); standard deviation of the noise of the position [rad]
    """
    samples = len(position) // 8
    frequency, power = mean_power(np.diff(position) / step, samples)
    frequency, speed = frequency / step, power * step / bandwidth(samples)
    gain = (2 * np.sin(np.pi * frequency * step) / step) ** 2
    upper = frequency > 0.25 / step
    density = float(np.median(speed[upper] / gain[upper]))
    return frequency, gain * speed, gain**2 * density, float(np.sqrt(density / (2 * step)))


def widest_cutoff(
    frequency: Array,
    acceleration: Array,
    noise: Array,
    rate: float,
    share: float = MAX_CUTOFF_SHARE,
    max_noise: float = MAX_NOISE_SHARE,
) -> float:
    """Return the highest cut-off at which noise is a negligible share of the acceleration [Hz], at most a share of the rate."""
    highest = share * rate
    within = frequency <= PASS_BAND_SHARE * highest
    clean = np.cumsum(noise[within]) <= max_noise * np.cumsum(acceleration[within])
    if clean[-1]:
        return highest
    edge = float(frequency[within][clean][-1]) if clean.any() else 0.0
    if edge == 0.0:
        raise ValueError(
            "the shaft does not move beyond the noise of its angle: record a larger motion, or see whether the angle is that "
            "of this joint"
        )
    return edge / PASS_BAND_SHARE


def standing(position: Array, reach: int, noise: float) -> NDArray[np.bool_]:
    """Return True for samples of a shaft at rest: within `reach` samples around one it moves by no more than the noise."""
    from scipy import ndimage

    width = 2 * reach + 1
    moved = ndimage.maximum_filter1d(position, width) - ndimage.minimum_filter1d(position, width)
    stands: NDArray[np.bool_] = ndimage.maximum_filter1d(moved <= 2.0 * REST_SIGMA * noise, width)
    return stands


def near_rest(position: Array, reach: int, noise: float) -> NDArray[np.bool_]:
    """Return True for samples at rest or at a reversal, and those so close that the position filter mixes the two.

    A sample rests if the positions `reach` samples earlier and later are equal within the noise. This finds the middle of each
    stop; widening it by `reach` restores the stop, and by as much again covers the response of the filter.
    """
    from scipy import ndimage

    padded = np.pad(position, reach, mode="edge")
    resting = np.abs(padded[2 * reach :] - padded[: -2 * reach]) <= REST_SIGMA * np.sqrt(2) * noise
    return ndimage.maximum_filter1d(resting, 4 * reach + 1)
