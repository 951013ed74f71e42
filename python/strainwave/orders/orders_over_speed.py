r"""Orders of a shaft over its speed: complex amplitudes of short stretches of one or several recordings.

In each stretch the column is a polynomial of the angle plus waves of the orders,

.. math:: y = \sum_m c_m \theta^m + \mathrm{Re} \sum_q X_q e^{j q \theta},

all fitted together; amplitudes may change along the stretch. So the ratio of a gear, a drift and a wind-up need not be known,
and an order that is followed does not leak into another one. A stretch has enough revolutions to separate the orders; beyond
that its speed changes by at most a small share.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import tau

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.files.recording import Recording, check_recording
from strainwave.files.units import convert
from strainwave.messages import named
from strainwave.orders.turning import evenly, reach_of, smooth_speed, unwrapped
from strainwave.statistics.linear_fit import order_waves
from strainwave.statistics.runs import runs_of
from strainwave.typeset import number

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MIN_TURNS = 2.0  # of a stretch: order 1 and a drift are separated
MAX_TURNS = 8.0  # of a stretch, that orders close to each other ask for
MAX_SPEED_CHANGE = 0.004  # of the speed in a stretch of more turns than it needs: a fifth of a peak of 1 % damping
MAX_STRETCHES = 400  # of all recordings
MIN_RECORDINGS_OF_ONE = 12  # recordings, from which one at constant speed is one stretch
MIN_STRETCHES_OF_RECORDING = 4  # of a recording at constant speed, as its noise is found from them
TREND_POWERS = 3  # of the angle in a stretch: constant, rate, and a change of the rate
MAX_WAVE_STEP = 0.8 * np.pi  # rad of an order between samples
WAVE_COLUMNS = 4  # of an order in a stretch: both parts, and their change
MAX_WHOLE_ORDER = 32
MIN_ORDER = 0.3  # of the shaft: slower ones are drifts
MAX_LOOKED_FOR = 64  # order, up to which a spectrum is searched if none are named
MAX_SEARCHED_STEP = 0.4 * np.pi  # rad of an order between samples, as the spectrum interpolates
SEGMENT_TURNS = 32.0  # of a segment of the spectrum over the angle: resolves orders to 1/16
MIN_SEGMENTS = 3
MIN_SEGMENT_TURNS = 3.0
MIN_LINE_POWER = 8.0  # over the noise: a median of few lines is no exact floor
MIN_PEAK_POWER = 14.0  # over the noise, of the changes of a whole order in three stretches: noise has it once in 10^6
MIN_SEGMENT_SHARE = 0.05  # of the segments, that a line that is no whole order stands out of: mains do in few
MAX_LINES = 24
MAX_FROM_WHOLE = 1.5 / SEGMENT_TURNS  # by which a line of that spectrum lies beside its whole order
FALSE_ALARM = 1e-4  # probability that noise makes a line of the spectrum
ORDER_RESOLUTION_SHARE = 0.25  # standard deviation of the order of a line over the resolution of the whole record


@dataclass(frozen=True)
class Turning:
    """A recording in which the shaft turns one way, evenly in time.

    Attributes:
        time: [s], shape (n,)
        angle: of the shaft, counted so that it increases [rad], shape (n,)
        speed: of it [rad/s], shape (n,)
        series: the column, shape (n,)
        per_input: revolutions of the output per one of the shaft, without sign; 0 if there is no angle of the output
        remarks: what was done to the recording
    """

    time: Array
    angle: Array
    speed: Array
    series: Array
    per_input: float
    remarks: tuple[str, ...]

    @property
    def path(self) -> Array:
        """Largest angle so far: noise of an encoder turns back [rad], shape (n,)."""
        return np.asarray(np.maximum.accumulate(self.angle))

    @property
    def turns(self) -> float:
        """Revolutions of the shaft."""
        return float(self.angle[-1] - self.angle[0]) / tau


@dataclass(frozen=True)
class OrdersOverSpeed:
    """Complex amplitudes of orders in stretches.

    Attributes:
        orders: of the shaft [1], shape (q,)
        speed: mean of each stretch [rad/s], shape (k,)
        amplitude: of X exp(j order angle), shape (q, k)
        sigma: standard deviation of an amplitude, if the noise of its stretch were white, shape (k,)
        output: mean angle of the output in each stretch, by the angle of the shaft [rad], shape (k,); zeros if it is not known
        stretches: first and one past the last sample of each, and the number of its recording, shape (k, 3)
        recordings: that turn one way
        remarks: what was left out
    """

    orders: Array
    speed: Array
    amplitude: Complex
    sigma: Array
    output: Array
    stretches: NDArray[np.int_]
    recordings: tuple[Turning, ...]
    remarks: tuple[str, ...]


def turning_one_way(recording: Recording, column: str, angle: str) -> Turning:
    """Return the longest part of a recording in which the shaft turns one way."""
    record = evenly(recording, [column, angle])
    if not record.timed:
        raise ValueError("the recording has no time: speeds need it")
    turned = unwrapped(angle, convert(record.columns[angle], recording.unit(angle), "rad"))
    speed = smooth_speed(turned, reach_of(len(turned))) / record.step
    sense = 1.0 if turned[-1] >= turned[0] else -1.0
    runs = runs_of(sense * speed > 1e-3 * float(np.abs(speed).max()))
    if not runs:
        raise ValueError(f"{angle} does not turn")
    part = max(runs, key=lambda run: run.stop - run.start)
    remarks = record.remarks
    if (used := part.stop - part.start) < 0.95 * len(turned):
        remarks += (f"{number(used * record.step, 3)} s are used, in which {angle} turns one way without a stop",)
    time = record.start + record.step * np.arange(part.start, part.stop)
    series = record.columns[column][part]
    per_input = 0.0
    if column == "output_angle":
        series = convert(unwrapped(column, convert(series, recording.unit(column), "rad")), "rad", recording.unit(column))
        turns = convert(series[[0, -1]], recording.unit(column), "rad")
        per_input = float(abs((turns[1] - turns[0]) / (turned[part][-1] - turned[part][0])))
    return Turning(np.asarray(time), sense * turned[part], sense * speed[part], series, per_input, remarks)


def turning_of(recordings: Recording | Sequence[Recording], column: str, angle: str) -> tuple[list[Turning], str]:
    """Return the parts of one or several recordings in which the shaft turns one way, and the unit of the column."""
    given = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if not given:
        raise ValueError("recordings has none; give one run-up, or several at constant speeds")
    for recording in given:
        check_recording("recordings", recording)
    names = arguments.text("column", column), arguments.text("angle", angle)
    return [turning_one_way(recording, *names) for recording in given], given[0].unit(column)


def orders_over_speed(recordings: Sequence[Turning], orders: Sequence[float], beside: Sequence[float] = ()) -> OrdersOverSpeed:
    """Return the amplitudes of orders in stretches of recordings, fitted together with those of others beside them."""
    own, slow = _sampled(orders, recordings)
    others = _sampled(beside, recordings)[0]
    separate = [order for order in own if all(abs(order - other) > 1.0 / MAX_TURNS for other in others)]
    chosen, remarks = _separated(separate)
    wanted = len(chosen)
    chosen += _separated(others)[0]
    if near := [number(order, 5) for order in own if order not in separate]:
        remarks.append(
            f"not followed: {named('order', near)}, as orders that are no whole ones lie within {1.0 / MAX_TURNS:g} of them"
        )
    gap = min((high - low for low, high in pairwise([0.0, *sorted(chosen)])), default=1.0)
    turns = min(max(MIN_TURNS, 1.0 / gap), MAX_TURNS)
    rows: list[tuple[float, Complex, float, tuple[int, int, int]]] = []
    for place, recording in enumerate(recordings):
        for start, stop in _stretches(recording, turns, len(chosen), len(recordings)):
            stretch = _amplitudes(recording, start, stop, chosen)
            if stretch is not None:
                mean = float(recording.speed[start:stop].mean())
                rows.append((mean, stretch[0][:wanted], stretch[1], (start, stop, place)))
    amplitude = np.array([row[1] for row in rows], complex).reshape(len(rows), wanted).T
    stretches = np.array([row[3] for row in rows], int).reshape(-1, 3)
    speed, sigma = (np.array([row[k] for row in rows]) for k in (0, 2))
    output = np.array([of.per_input * float(of.angle[a:b].mean()) for a, b, of in _named(stretches, recordings)])
    return OrdersOverSpeed(
        np.array(chosen[:wanted]), speed, amplitude, sigma, output, stretches, tuple(recordings), (*remarks, *slow)
    )


def _named(stretches: NDArray[np.int_], recordings: Sequence[Turning]) -> Iterator[tuple[int, int, Turning]]:
    for start, stop, place in stretches.tolist():
        yield start, stop, recordings[place]


def _separated(orders: Sequence[float]) -> tuple[list[float], list[str]]:
    """Return the orders, the more important first, that stretches separate; and remarks on the others."""
    kept: list[float] = []
    dropped = []
    for order in orders:
        near = [other for other in kept if abs(other - order) < 1.0 / MAX_TURNS]
        if near:
            dropped.append(f"{number(order, 5)} (within {number(1.0 / MAX_TURNS, 3)} of {number(near[0], 5)})")
        else:
            kept.append(order)
    return kept, [f"not followed by themselves: {named('order', dropped)}"] if dropped else []


def _sampled(orders: Sequence[float], recordings: Sequence[Turning]) -> tuple[list[float], list[str]]:
    """Return the orders that the samples can follow at some speed, and remarks on the others."""
    top = max(MAX_WAVE_STEP / max(float(np.quantile(np.diff(each.angle), 0.05)), 1e-300) for each in recordings)
    fast = [number(order, 5) for order in orders if order >= top]
    remarks = [f"the samples are too slow to follow {named('order', fast)}"] if fast else []
    return [order for order in orders if order < top], remarks


def _stretches(recording: Turning, turns: float, orders: int, recordings: int) -> Iterator[tuple[int, int]]:
    """Yield first and one past the last sample of stretches, one after the other."""
    angle, speed = recording.path, recording.speed
    turns = max(turns, recording.turns / (MAX_STRETCHES // recordings))
    fewest = MIN_STRETCHES_OF_RECORDING if recordings < MIN_RECORDINGS_OF_ONE else 1
    widest = max(recording.turns / fewest, turns) * tau
    samples = 2 * (TREND_POWERS + WAVE_COLUMNS * orders)
    start, end = 0, len(angle) - 1
    while start < end:
        stop = max(int(np.searchsorted(angle, angle[start] + turns * tau)), start + samples)
        if stop > end:
            return
        reach = min(int(np.searchsorted(angle, angle[start] + widest)), end)
        changed = np.abs(speed[stop:reach] / speed[start] - 1.0) > MAX_SPEED_CHANGE
        stop = stop + int(np.argmax(changed)) if changed.any() else max(stop, reach)
        yield start, stop
        start = stop


def _amplitudes(recording: Turning, start: int, stop: int, orders: Sequence[float]) -> tuple[Complex, float] | None:
    """Return the amplitudes of a stretch, nan for orders that its samples cannot follow, and their standard deviation."""
    angle = recording.angle[start:stop]
    slow = np.array(orders) * float(np.quantile(np.diff(angle), 0.9)) < MAX_WAVE_STEP
    along = (angle - angle.mean()) / max(float(np.ptp(angle)), 1e-300)
    waves = order_waves(angle, np.array(orders)[slow].tolist())
    columns = np.concatenate([along[:, None] ** np.arange(TREND_POWERS), waves, along[:, None] * waves], axis=1)
    if len(angle) < 2 * columns.shape[1]:
        return None
    values, _, rank, _ = np.linalg.lstsq(columns, recording.series[start:stop], rcond=1e-9)
    if rank < columns.shape[1]:
        return None
    amplitudes = np.full(len(orders), complex("nan"))
    of_middle = values[TREND_POWERS : TREND_POWERS + waves.shape[1]]
    sine, cosine = of_middle[0::2], of_middle[1::2]
    amplitudes[slow] = cosine - 1j * sine
    left = recording.series[start:stop] - columns @ values
    noise = max(float(np.sqrt(left @ left / (len(angle) - columns.shape[1]))), _rounding(recording.series))
    return amplitudes, noise * float(np.sqrt(2.0 / len(angle)))


def _rounding(series: Array) -> float:
    """Return the least noise of a column: numbers are rounded."""
    return float(np.finfo(float).eps * np.abs(series).max() + 1e-300)


# ---- Orders that stand out -------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class OrderLine:
    """An order that stands out.

    Attributes:
        order: of the shaft [1]
        sigma: its standard deviation; 0 of a whole number
        power: over the noise, of the changes of a whole order over the speed, else of the line
    """

    order: float
    sigma: float
    power: float


def whole_orders(recordings: Sequence[Turning]) -> list[OrderLine]:
    """Return the whole orders whose amplitudes change over the speed, those that change most first."""
    step = float(np.median([np.quantile(np.diff(each.angle), 0.9) for each in recordings]))
    top = int(min(MAX_WHOLE_ORDER, MAX_WAVE_STEP / step, 0.25 * MAX_TURNS * tau / step / WAVE_COLUMNS))
    spectrum = orders_over_speed(recordings, [float(order) for order in range(1, top + 1)])
    lines = []
    for order, amplitude in zip(spectrum.orders.tolist(), spectrum.amplitude, strict=True):
        shown = np.isfinite(amplitude)
        if shown.sum() > 2:
            left = amplitude[shown] - np.mean(amplitude[shown])
            over_noise = np.abs(left / np.maximum(spectrum.sigma[shown], 1e-300)) ** 2
            often = np.sort(over_noise)[-MIN_SEGMENTS:].min()  # an order may show near a resonance alone
            power = float(np.mean(over_noise)) if often > MIN_PEAK_POWER else 0.0
            lines.append(OrderLine(order, 0.0, power))
    return sorted((line for line in lines if line.power > 0.0), key=lambda line: -line.power)


def uneven_orders(recordings: Sequence[Turning]) -> list[OrderLine]:
    """Return the orders that are no whole ones and stand out of the spectra over the angle, the strongest first."""
    turns = min(SEGMENT_TURNS, min(each.turns for each in recordings) / max(MIN_SEGMENTS / len(recordings), 1.0))
    if turns < MIN_SEGMENT_TURNS:
        return []
    spectra = np.array([spectrum for each in recordings for spectrum in _segments(each, turns)])
    order = np.arange(spectra.shape[1]) / turns
    return _lines(order, spectra, turns, max(recordings, key=lambda each: each.turns))


def _segments(recording: Turning, turns: float) -> Iterator[Array]:
    """Yield powers over the order of segments that overlap by half, over their noise; nan where samples are too far apart."""
    from scipy.interpolate import Akima1DInterpolator
    from scipy.ndimage import median_filter

    per_turn = 4 * MAX_LOOKED_FOR
    count, lines = int(turns * per_turn), int(MAX_LOOKED_FOR * turns)
    path = np.arange(int(recording.turns * per_turn)) * (tau / per_turn) + recording.angle[0]
    ahead = np.diff(recording.path, prepend=-np.inf) > 0.0  # samples of an encoder may repeat
    series = Akima1DInterpolator(recording.angle[ahead], recording.series[ahead])(path)
    steps = np.interp(path, recording.angle[ahead][1:], np.diff(recording.angle[ahead]))
    window = np.hanning(count + 1)[:-1]
    least = _rounding(series) ** 2 * float(window @ window)
    along = np.linspace(-1.0, 1.0, count)
    trend = np.linalg.qr(along[:, None] ** np.arange(TREND_POWERS))[0]
    for start in range(0, len(series) - count + 1, max(count // 2, 1)):
        part = series[start : start + count]
        part = part - trend @ (trend.T @ part)
        power = np.abs(np.fft.rfft(window * part))[:lines] ** 2
        sampled = min(int(MAX_SEARCHED_STEP / float(steps[start : start + count].max()) * turns), lines)
        excess = np.full(lines, np.nan)
        if sampled > int(turns):
            floor = median_filter(power[:sampled], int(turns) | 1, mode="nearest") / np.log(2.0)
            excess[:sampled] = power[:sampled] / np.maximum(floor, least)
        yield excess


def _lines(order: Array, excess: Array, turns: float, whole: Turning) -> list[OrderLine]:
    """Return the lines of spectra over their noise, so that an order that shows near a resonance alone stands out, too."""
    from scipy.special import gammainccinv

    shown = np.isfinite(excess)
    counts = shown.sum(axis=0)
    mean = np.where(shown, excess, 0.0).sum(axis=0) / np.maximum(counts, 1)
    often = np.where(shown, excess > MIN_LINE_POWER, False).sum(axis=0)
    independent = np.maximum(0.5 * counts, 1.0)  # segments overlap by half
    needed = np.maximum(gammainccinv(independent, FALSE_ALARM / len(order)) / independent, MIN_LINE_POWER)
    inner = slice(2, len(order) - 1)
    peaks = np.flatnonzero((mean > needed)[inner] & (mean[inner] >= mean[1:-2]) & (mean[inner] > mean[3:])) + 2
    found: list[OrderLine] = []
    for k in sorted(peaks.tolist(), key=lambda k: -mean[k]):
        near = float(order[k])
        if near < MIN_ORDER or any(abs(near - other.order) < 2.5 / turns for other in found):
            continue
        if often[k] >= max(MIN_SEGMENTS, MIN_SEGMENT_SHARE * counts[k]):
            found.append(OrderLine(*_refined(whole, near, turns), float(mean[k])))
    return [line for line in found if abs(line.order - round(line.order)) > MAX_FROM_WHOLE * SEGMENT_TURNS / turns][:MAX_LINES]


def _refined(recording: Turning, near: float, turns: float) -> tuple[float, float]:
    """Return the order of the highest line of the whole recording near another one, and its standard deviation."""
    tried = near + np.arange(-1.0 / turns, 1.0 / turns, 0.2 / recording.turns)
    series = recording.series - np.interp(recording.angle, *_slow(recording))
    window = np.hanning(len(series))
    sums = np.array([abs(np.sum(window * series * np.exp(-1j * order * recording.angle))) for order in tried])
    return float(tried[int(np.argmax(sums))]), ORDER_RESOLUTION_SHARE / recording.turns


def _slow(recording: Turning) -> tuple[Array, Array]:
    """Return means over turns of the angle and of the column."""
    place = ((recording.angle - recording.angle[0]) / tau).astype(int)
    counts = np.maximum(np.bincount(place), 1)
    return np.bincount(place, recording.angle) / counts, np.bincount(place, recording.series) / counts
