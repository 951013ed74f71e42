r"""Lines in a series: found one after the other in spectra over the angle, over time and over the angles of other joints.

A line of order n is cos(n theta(t)). With the series y and the covariance C of its noise, the sum

.. math:: S(n) = \sum_t (C^{-1} y)_t \, e^{-j n \theta_t}, \qquad I(n) = \sum_t \frac{1}{P(n \omega_t)}

is the generalised matched filter for it (Kay1998): the square of S over I is exponentially distributed where there is noise
alone, whose power P is that of the frequency at which the order passes; 2 S / I is the amplitude of the line. So a slow
stretch, where the order passes in low and noisy frequencies, counts for less than a fast one. To divide by C costs one Fourier
transform, S another one: the products are summed into narrow bins of the angle. Forward and backward are summed apart, since
ripple of friction changes its sign.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import hypot, tau
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from strainwave.orders.smooth_part import FittedColumns, Moving, Shaft
from strainwave.presentation import Presented
from strainwave.statistics.linear_fit import normal_inverse, solved
from strainwave.statistics.spectrum import Floor, floor_under

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Kind = Literal["order", "time", "joint", "either"]

MAX_LINES = 16  # lines that are looked for
MIN_EVIDENCE_LEAD = 10.0  # natural logarithm of the likelihood, by which one explanation must be better than another
MIN_EVIDENCE_LEAD_SHARE = 0.05  # the same as a share of the evidence [1]: speeds are never quite constant
MIN_PERIODS = 3.0  # periods in the span, below which an order is a trend
MERGE_PERIODS = 2.0  # periods in the span, by which a weaker line differs at most from a stronger one that it belongs to
MIN_OVERLAP = 0.5  # squared canonical correlation [1], from which two waves are the same line
ORDER_STEPS = 2  # of Gauss and Newton, to which an order converges from a peak
MAX_ORDER_STEP = 0.25  # resolutions
SWIFT_WEIGHT = 0.5  # weight [1] of a sample that counts as moving
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
        return np.asarray(np.minimum(1.0, tested * single))

    def evidence_of(self, false_alarm: float, tested: float) -> float:
        """Return the evidence that noise alone gives anywhere in so many lines with this probability."""
        from scipy.special import betaincinv

        return self.floors * (1.0 / float(betaincinv(self.floors, self.parts, false_alarm / tested)) - 1.0)


def order_spectrum_of(
    weighed: Array, weight: Array, floor: Floor, shaft: Shaft, lowest: float, highest: float, fitted: FittedColumns
) -> Spectrum:
    """Return the spectrum over the angle of a shaft, of a series over its floor from which columns were fitted before."""
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
    for sense in senses:
        there = shaft.sense == sense

        def over_angle(series: Array, there: NDArray[np.bool_] = there) -> Complex:
            binned = np.bincount(cells[there], (series * weight)[there], bins)
            return np.asarray(np.fft.rfft(binned, length)[kept])

        information = _information(order, np.abs(shaft.speed[there]), weight[there], floor)
        taken = fitted.taken((shaft.name, sense, lowest, highest), over_angle, float(weight[there] @ weight[there]))
        own, size, sigma = _beside(over_angle(weighed), information, taken)
        evidence += own
        noise = np.where(size > amplitude, sigma, noise)
        amplitude = np.maximum(amplitude, size)
    return _levelled(Spectrum(order, evidence, amplitude, noise, len(senses), 0.0))


def _beside(filtered: Complex, information: Array, taken: tuple[Array, Complex]) -> tuple[Array, Array, Array]:
    """Return evidence, amplitude and its standard deviation of each line, fitted together with columns.

    The series is without what the columns take of it. Of a line they take a share, of one phase more than of another: a speed
    that swings with the order of a gear takes the ripple of one phase. The two parts of the line are solved for beside them.
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

    def over_time(values: Array) -> Complex:
        return np.asarray(np.fft.rfft(values * weight, length)[kept])

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
    floors = max(2.0, around / MEDIAN_VARIANCE * spectrum.parts)
    return replace(spectrum, evidence=spectrum.evidence / level, noise=spectrum.noise * np.sqrt(level), floors=floors)


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


@dataclass(frozen=True)
class LinePart:
    """Part of a line that grows with something.

    Attributes:
        name: `constant` (cogging), `direction` (friction), `load` (kinematic error), `speed squared` (inertia)
        amplitude: at the root mean square of what it grows with, in the unit of the series
        sigma: its standard deviation
        false_alarm: probability that noise alone gives as much, over all parts of all lines
    """

    name: str
    amplitude: float
    sigma: float
    false_alarm: float


@dataclass(frozen=True)
class SpectrumLine(Presented):
    """A line in the spectrum of a series.

    Attributes:
        kind: `order` repeats with the angle, `time` with the time (mains, a resonance, a beat of the sampling), `joint` with
            the angle of another joint; `either` if the record does not separate the angle from another explanation
        joint: name of the other joint of a `joint` line, else empty
        rivals: other explanations of an `either` line than the angle: `time`, or names of joints
        order: per revolution of the shaft whose angle it is, of a `joint` line per revolution of that joint; of a time line at
            the usual speed
        order_sigma: its standard deviation by noise; a line whose phase changes with the speed, as near a resonance, moves by
            up to a tenth of the resolution more
        frequency: at the usual speed, in cycles per sample while lines are looked for, then in Hz; nan without time and rate
        evidence: logarithm of the likelihood that it adds
        false_alarm: probability that noise alone makes such a line anywhere in the spectra
        wave_forward, wave_backward: complex amplitudes over the angle or over time, of each direction; nan without such motion
        sigma: standard deviation of the amplitude
        per_input: its order per revolution of the input; nan if the ratio is not known
        parts: what it grows with, if the record separates it
    """

    kind: Kind
    joint: str
    rivals: tuple[str, ...]
    order: float
    order_sigma: float
    frequency: float
    evidence: float
    false_alarm: float
    wave_forward: complex = complex("nan")
    wave_backward: complex = complex("nan")
    sigma: float = 0.0
    per_input: float = float("nan")
    parts: tuple[LinePart, ...] = ()

    @property
    def forward(self) -> float:
        """Amplitude forward, in the unit of the series; nan without such motion."""
        return abs(self.wave_forward)

    @property
    def backward(self) -> float:
        """Amplitude backward, in the unit of the series; nan without such motion."""
        return abs(self.wave_backward)

    @property
    def amplitude(self) -> float:
        """Larger amplitude of both directions, in the unit of the series."""
        return float(np.nanmax([self.forward, self.backward]))

    @property
    def phase(self) -> float:
        """Phase where the angle is 0 [rad], as of a cosine, in the direction with the larger amplitude."""
        return float(np.angle(self.wave_backward if self.amplitude > np.nan_to_num(self.forward) else self.wave_forward))


@dataclass(frozen=True)
class LineSearch:
    """Lines, and the spectra that contain them.

    Attributes:
        lines: by evidence
        merged: number of lines close to stronger ones, which they only widen
        orders: spectrum over the angle, with all lines in it
        floor: of the series without the lines
        residual: series less these lines, shape (n,)
        tested: lines of all spectra
    """

    lines: tuple[SpectrumLine, ...]
    merged: int
    orders: Spectrum
    floor: Floor
    residual: Array
    tested: float


@dataclass(frozen=True)
class _Spectra:
    """Spectra over the angle of each shaft, the own one first, and over time; and the floor under them."""

    floor: Floor
    over_angle: tuple[Spectrum, ...]
    over_time: Spectrum

    @property
    def tested(self) -> float:
        return float(sum(len(each.place) for each in (*self.over_angle, self.over_time)))


def find_lines(moving: Moving, lowest: float, highest: float, allowed: float) -> LineSearch:
    """Return all lines of these orders [1] that noise makes with less than the allowed probability, over all lines together."""
    kept: list[SpectrumLine] = []
    left = moving.series
    for _ in range(MAX_LINES):
        spectra = _spectra(moving, left, lowest, highest)
        line = _strongest(moving, spectra)
        if line is None or line.false_alarm > allowed:
            break
        kept.append(line)
        kept, left = refitted(moving, kept, spectra.floor)
    spectra = _spectra(moving, moving.series, lowest, highest, _spectra_floor(moving, left))
    own = [line for place, line in enumerate(kept) if not any(_same(moving, line, other) for other in kept[:place])]
    if own:  # by themselves, as lines close to each other are hardly separated
        for _ in range(ORDER_STEPS):
            own = _with_orders(moving, *refitted(moving, own, spectra.floor), spectra.floor)
        own, left = refitted(moving, own, spectra.floor)
    ranked = tuple(sorted(own, key=lambda each: -each.evidence))
    return LineSearch(ranked, len(kept) - len(own), spectra.over_angle[0], spectra.floor, left, spectra.tested)


def _same(moving: Moving, line: SpectrumLine, stronger: SpectrumLine) -> bool:
    """True if a line only shows that a stronger one varies with speed or load."""
    if "time" in (line.kind, stronger.kind):
        over_time = all(each.kind == "time" or "time" in each.rivals for each in (line, stronger))
        return over_time and abs(line.frequency - stronger.frequency) * len(moving.series) < MERGE_PERIODS
    return line.joint == stronger.joint and abs(line.order - stronger.order) * _shaft(moving, line).revolutions < MERGE_PERIODS


def _shaft(moving: Moving, line: SpectrumLine) -> Shaft:
    return next(each for each in moving.shafts if each.name == line.joint)


def _spectra_floor(moving: Moving, left: Array) -> Floor:
    return floor_under(left * moving.weight, moving.weight)


def _spectra(moving: Moving, left: Array, lowest: float, highest: float, floor: Floor | None = None) -> _Spectra:
    weighted, weight = left * moving.weight, moving.weight
    floor = _spectra_floor(moving, left) if floor is None else floor
    weighed = moving.fitted.left(floor.weighed(weighted))
    over_angle = [order_spectrum_of(weighed, weight, floor, moving.own, lowest, highest, moving.fitted)]
    for other in moving.shafts[1:]:
        slow = MIN_PERIODS / other.revolutions
        over_angle.append(order_spectrum_of(weighed, weight, floor, other, slow, highest, moving.fitted))
    slowest = max(lowest * float(np.quantile(np.abs(moving.own.speed), 0.95)) / tau, MIN_PERIODS / len(left))
    return _Spectra(floor, tuple(over_angle), time_spectrum_of(weighted, weight, floor, slowest, moving.fitted))


def _strongest(moving: Moving, spectra: _Spectra) -> SpectrumLine | None:
    """Return the line that noise makes with the least probability, with what it may repeat with; none without an order."""
    if not len(spectra.over_angle[0].place):
        return None
    peaks = [_peak_line(moving, shaft, each, spectra) for shaft, each in zip(moving.shafts, spectra.over_angle, strict=True)]
    peaks.append(_peak_line(moving, None, spectra.over_time, spectra))
    best = min(peaks, key=lambda line: (line.false_alarm, -line.evidence))
    margin = max(MIN_EVIDENCE_LEAD, MIN_EVIDENCE_LEAD_SHARE * best.evidence)
    near = [each for each in _passing(moving, best, spectra) if best.evidence - each.evidence <= margin]
    joints = {"joint"} & {each.kind for each in (best, *near)}  # any order of another joint may pass at these frequencies
    rivals = [each for each in near if not joints or _overlap(moving, best, each, spectra.floor) > MIN_OVERLAP]
    own = next((each for each in (best, *rivals) if each.kind == "order"), None)
    if own is None:
        return best
    names = tuple(each.joint or "time" for each in (best, *rivals) if each is not own)
    if not names:
        return best
    time = next((each.frequency for each in (best, *rivals) if each.kind == "time"), own.frequency)
    return replace(own, kind="either", rivals=names, frequency=time, evidence=best.evidence, false_alarm=best.false_alarm)


def _peak_line(
    moving: Moving, shaft: Shaft | None, spectrum: Spectrum, spectra: _Spectra, among: NDArray[np.bool_] | None = None
) -> SpectrumLine:
    """Return the highest peak of a spectrum over the angle of a shaft, or over time without one."""
    place, evidence = _peak(spectrum, among)
    alarm = float(spectrum.false_alarm(evidence, spectra.tested))
    along = moving.own if shaft is None else shaft
    _, usual, _ = _speeds(moving, along)
    sigma = 1.0 / (np.sqrt(2.0 * max(evidence, 1e-300)) * max(spread_of(along.angle, moving.weight), 1e-300))
    order, frequency = (tau * place / usual, place) if shaft is None else (place, place * usual / tau)
    kind: Kind = "time" if shaft is None else "joint" if shaft.name else "order"
    return SpectrumLine(kind, "" if shaft is None else shaft.name, (), order, float(sigma), frequency, evidence, alarm)


def _peak(spectrum: Spectrum, among: NDArray[np.bool_] | None = None) -> tuple[float, float]:
    """Return place and evidence of the highest peak, by the parabola through three lines; zeros without any peak."""
    evidence = spectrum.evidence if among is None else np.where(among, spectrum.evidence, 0.0)
    if not len(evidence) or float(evidence.max()) == 0.0:
        return 0.0, 0.0
    at = int(np.argmax(evidence))
    place, height = float(spectrum.place[at]), float(evidence[at])
    if not 0 < at < len(evidence) - 1:
        return place, height
    left, right = float(spectrum.evidence[at - 1]), float(spectrum.evidence[at + 1])
    curvature = left - 2.0 * height + right
    if curvature >= 0.0 or max(left, right) > height:
        return place, height
    shift = 0.5 * (left - right) / curvature
    return place + shift * float(spectrum.place[1] - spectrum.place[0]), height - 0.25 * (left - right) * shift


def _passing(moving: Moving, line: SpectrumLine, spectra: _Spectra) -> list[SpectrumLine]:
    """Return the highest peak of every other spectrum at frequencies at which the line passes."""
    step = 2.0 / len(moving.series)
    low = high = line.frequency
    if line.kind != "time":
        slow, _, fast = _speeds(moving, _shaft(moving, line))
        low, high = line.order * slow / tau, line.order * fast / tau
    low, high = low - step, high + step
    peaks = []
    for shaft, spectrum in zip(moving.shafts, spectra.over_angle, strict=True):
        if line.kind == "time" or shaft.name != line.joint:
            slow, _, fast = _speeds(moving, shaft)
            passed = (spectrum.place >= tau * low / fast) & (spectrum.place <= tau * high / slow)
            peaks.append(_peak_line(moving, shaft, spectrum, spectra, passed))
    if line.kind != "time":
        passed = (spectra.over_time.place >= low) & (spectra.over_time.place <= high)
        peaks.append(_peak_line(moving, None, spectra.over_time, spectra, passed))
    return [peak for peak in peaks if peak.evidence > 0.0]


def _speeds(moving: Moving, shaft: Shaft) -> tuple[float, float, float]:
    """Return a slow, the usual and a fast speed of a shaft while the own one moves [rad per sample]."""
    counting = moving.weight > SWIFT_WEIGHT
    swift = np.abs(shaft.speed[counting] if counting.any() else shaft.speed)
    low, usual, high = (max(float(each), 1e-300) for each in np.quantile(swift, [0.02, 0.5, 0.98]))
    return low, usual, high


def _overlap(moving: Moving, line: SpectrumLine, other: SpectrumLine, floor: Floor) -> float:
    """Return the largest squared canonical correlation of the waves of two lines under the noise."""
    one, two = (np.linalg.qr(floor.coordinates(np.stack(waves(moving, wave), axis=1)))[0] for wave in (line, other))
    return float(np.linalg.norm(one.T @ two, 2) ** 2)


def waves(moving: Moving, line: SpectrumLine) -> list[Array]:
    """Return the shapes of a line: cosine and minus sine over angle or time, each direction by itself."""
    if line.kind == "time":
        phase = tau * line.frequency * np.arange(len(moving.series))
        return [moving.weight * np.cos(phase), -moving.weight * np.sin(phase)]
    shaft = _shaft(moving, line)
    phase = shaft.angle * line.order
    shapes = []
    for sense in shaft.senses(moving.weight):
        there = np.where(shaft.sense == sense, moving.weight, 0.0)
        shapes += [there * np.cos(phase), -there * np.sin(phase)]
    return shapes


def refitted(moving: Moving, lines: Sequence[SpectrumLine], floor: Floor) -> tuple[list[SpectrumLine], Array]:
    """Fit all lines together, and the smooth part with them. Return them with their amplitudes, and the series without them."""
    shapes = [waves(moving, line) for line in lines]
    flat = moving.fitted.left(np.stack([wave for pair in shapes for wave in pair], axis=1))  # Frisch and Waugh (1933)
    values, covariance = weighed_fit(flat, moving.series * moving.weight, floor)
    done, first = [], 0
    left = moving.series.copy()
    for line, shape in zip(lines, shapes, strict=True):
        last = first + len(shape)
        own, sigmas = values[first:last], np.sqrt(np.diag(covariance)[first:last])
        parts = [complex(own[k], own[k + 1]) for k in range(0, len(shape), 2)]
        sigma = max(hypot(sigmas[k], sigmas[k + 1]) / np.sqrt(2.0) for k in range(0, len(shape), 2))
        if line.kind == "time":
            parts = [parts[0], parts[0]]
        elif len(parts) == 1:
            is_forward = _shaft(moving, line).senses(moving.weight) == [1.0]
            parts = [*parts, complex("nan")] if is_forward else [complex("nan"), *parts]
        done.append(replace(line, wave_forward=parts[0], wave_backward=parts[1], sigma=float(sigma)))
        first = last
    with np.errstate(divide="ignore", invalid="ignore"):
        left = np.where(moving.weight > 0.0, left - (flat @ values) / moving.weight, left)
    return done, left


def _with_orders(moving: Moving, lines: Sequence[SpectrumLine], left: Array, floor: Floor) -> list[SpectrumLine]:
    """Return lines with their orders moved by a step of Gauss and Newton: a peak between skirts of its own is not its line."""
    moved = [line for line in lines if line.kind != "time"]
    if not moved:
        return list(lines)
    slopes = []
    for line in moved:
        shaft = _shaft(moving, line)
        size = np.where(shaft.sense > 0.0, np.nan_to_num(line.wave_forward), np.nan_to_num(line.wave_backward))
        slopes.append(moving.weight * np.real(1j * shaft.angle * size * np.exp(1j * line.order * shaft.angle)))
    shapes = np.stack([*slopes, *(wave for line in lines for wave in waves(moving, line))], axis=1)
    steps = weighed_fit(moving.fitted.left(shapes), left * moving.weight, floor)[0][: len(moved)]
    reach = [MAX_ORDER_STEP / _shaft(moving, line).revolutions for line in moved]
    orders = dict(zip(map(id, moved), np.clip(steps, np.negative(reach), reach).tolist(), strict=True))
    return [replace(line, order=line.order + orders.get(id(line), 0.0)) for line in lines]


def weighed_fit(columns: Array, series: Array, floor: Floor) -> tuple[Array, Array]:
    """Fit by least squares under coloured noise. Return coefficients and covariance, shapes (k,) and (k, k)."""
    white = floor.coordinates(columns)
    return solved(white, floor.coordinates(series)), normal_inverse(white)
