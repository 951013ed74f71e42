"""Lines in a series: found one after the other in the spectra over angle and over time, each told from the other kind."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import hypot, tau
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from strainwave.orders.floor import Floor, floor_under
from strainwave.orders.scan import Spectrum, order_spectrum_of, spread_of, time_spectrum_of
from strainwave.orders.smooth_part import Moving

Array = NDArray[np.float64]
Kind = Literal["order", "time", "either"]

MOST = 16  # lines that are looked for
DECIDED = 10.0  # natural logarithm of the likelihood, by which one kind must be better than the other
DECIDED_SHARE = 0.05  # of the evidence, by which it must be so at the least: speeds are never quite constant
LOWEST = 3.0  # lines of resolution, below which an order is a trend
BESIDE = 2.0  # lines of resolution, within which a weaker line belongs to a stronger one


@dataclass(frozen=True)
class Line:
    """A line, as it was found.

    Attributes:
        kind: whether it follows the angle or the time; `either` where the speed is too constant to tell
        order: periods per revolution; of a time line that at its typical speed
        order_sigma: its standard deviation
        frequency: cycles per sample; of an order line that at its typical speed
        evidence: logarithm of the likelihood that it adds
        false_alarm: probability that noise alone makes such a line anywhere in the spectra
        forward, backward: complex amplitudes over the angle or over time; nan where there is no such motion
        sigma: standard deviation of their real and imaginary parts, the larger one of both
    """

    kind: Kind
    order: float
    order_sigma: float
    frequency: float
    evidence: float
    false_alarm: float
    forward: complex
    backward: complex
    sigma: float

    @property
    def amplitude(self) -> float:
        """The larger one of both directions."""
        return float(np.nanmax([abs(self.forward), abs(self.backward)]))


@dataclass(frozen=True)
class Found:
    """Lines, and the spectra in which they stand.

    Attributes:
        lines: by evidence
        beside: lines that were found beside stronger ones, which they only widen
        orders: spectrum over the angle, with all lines in it
        times: spectrum over time, with all lines in it
        floor: of the series without the lines
        residual: series less these lines, shape (n,)
        tested: lines of both spectra
    """

    lines: tuple[Line, ...]
    beside: int
    orders: Spectrum
    times: Spectrum
    floor: Floor
    residual: Array
    tested: float


def find_lines(moving: Moving, lowest: float, highest: float, allowed: float) -> Found:
    """All lines that noise would make with less than the allowed probability.

    Args:
        moving: the series and the shaft
        lowest, highest: order [1]
        allowed: probability of a false alarm, over all lines tested together
    """
    kept: list[Line] = []
    left = moving.series
    tested = 0.0
    for _ in range(MOST):
        floor, orders, times = _spectra(moving, left, lowest, highest)
        tested = float(len(orders.place) + len(times.place))
        line = _strongest(moving, orders, times, tested)
        if line is None or line.false_alarm > allowed:
            break
        kept.append(line)
        kept, left = refitted(moving, kept, floor)
    floor, orders, times = _spectra(moving, moving.series, lowest, highest, floor)
    own = [line for place, line in enumerate(kept) if not any(_beside(moving, line, other) for other in kept[:place])]
    if own:  # by themselves, as lines beside each other are hardly told apart
        own, left = refitted(moving, own, floor)
    return Found(tuple(sorted(own, key=lambda each: -each.evidence)), len(kept) - len(own), orders, times, floor, left, tested)


def _beside(moving: Moving, line: Line, stronger: Line) -> bool:
    """Whether a line only tells that another one, found before it, varies with speed or load."""
    if line.kind == "time" or stronger.kind == "time":
        return line.kind == stronger.kind and abs(line.frequency - stronger.frequency) * len(moving.angle) < BESIDE
    return abs(line.order - stronger.order) * float(np.ptp(moving.angle)) / tau < BESIDE


def _spectra(
    moving: Moving, left: Array, lowest: float, highest: float, floor: Floor | None = None
) -> tuple[Floor, Spectrum, Spectrum]:
    weighted = left * moving.weight
    floor = floor_under(weighted, moving.weight) if floor is None else floor
    weighed = floor.weighed(weighted)
    orders = order_spectrum_of(weighed, moving.weight, floor, moving.angle, moving.speed, moving.sense, lowest, highest)
    slowest = max(lowest * float(np.quantile(np.abs(moving.speed), 0.95)) / tau, LOWEST / len(left))
    return floor, orders, time_spectrum_of(weighted, moving.weight, floor, slowest)


def _strongest(moving: Moving, orders: Spectrum, times: Spectrum, tested: float) -> Line | None:
    """The line of the spectra that noise makes with the least probability."""
    if not len(orders.place):
        return None
    (order, in_order), (frequency, in_time) = _peak(orders), _peak(times)
    alarm_order, alarm_time = float(orders.false_alarm(in_order, tested)), float(times.false_alarm(in_time, tested))
    swift = np.abs(moving.speed[moving.weight > 0.5])
    swift = swift if len(swift) else np.abs(moving.speed)
    low, middle, high = (max(float(each), 1e-300) for each in np.quantile(swift, [0.02, 0.5, 0.98]))
    step = 2.0 / len(moving.angle)
    of_angle = (alarm_order, -in_order) <= (alarm_time, -in_time)
    evidence, alarm = (in_order, alarm_order) if of_angle else (in_time, alarm_time)
    if of_angle:
        passed = (times.place >= order * low / tau - step) & (times.place <= order * high / tau + step)
        frequency, other = _peak(times, passed)
    else:
        passed = (orders.place >= tau * (frequency - step) / high) & (orders.place <= tau * (frequency + step) / low)
        order, other = _peak(orders, passed)
    kind: Kind = "order" if of_angle else "time"
    if evidence - other <= max(DECIDED, DECIDED_SHARE * evidence):
        kind = "either"
    elif of_angle:
        frequency = order * middle / tau
    else:
        order = tau * frequency / middle
    sigma = 1.0 / (np.sqrt(2.0 * evidence) * max(spread_of(moving.angle, moving.weight), 1e-300))
    return Line(kind, order, float(sigma), frequency, evidence, alarm, complex("nan"), complex("nan"), 0.0)


def _peak(spectrum: Spectrum, among: NDArray[np.bool_] | None = None) -> tuple[float, float]:
    """Place and evidence of the highest peak, between lines, by the parabola through three; nothing where there are none."""
    evidence = spectrum.evidence if among is None else np.where(among, spectrum.evidence, 0.0)
    if not len(evidence) or float(evidence.max()) == 0.0:
        return 0.0, 0.0
    at = int(np.argmax(evidence))
    place, height = float(spectrum.place[at]), float(evidence[at])
    if not 0 < at < len(evidence) - 1:
        return place, height
    left, right = float(spectrum.evidence[at - 1]), float(spectrum.evidence[at + 1])
    bend = left - 2.0 * height + right
    if bend >= 0.0 or max(left, right) > height:
        return place, height
    shift = 0.5 * (left - right) / bend
    return place + shift * float(spectrum.place[1] - spectrum.place[0]), height - 0.25 * (left - right) * shift


def waves(moving: Moving, line: Line) -> list[Array]:
    """What a line may look like: cosine and minus sine over angle or time, each direction by itself."""
    phase = moving.angle * line.order if line.kind != "time" else tau * line.frequency * np.arange(len(moving.angle))
    shapes = []
    for sense in _senses(moving) if line.kind != "time" else (0.0,):
        there = moving.weight if sense == 0.0 else np.where(moving.sense == sense, moving.weight, 0.0)
        shapes += [there * np.cos(phase), -there * np.sin(phase)]
    return shapes


def _senses(moving: Moving) -> list[float]:
    return [each for each in (1.0, -1.0) if np.any(moving.sense == each)]


def refitted(moving: Moving, lines: list[Line], floor: Floor) -> tuple[list[Line], Array]:
    """All lines fitted together, with their amplitudes; and what is left of the series."""
    shapes = [waves(moving, line) for line in lines]
    flat = np.stack([wave for each in shapes for wave in each], axis=1)
    values, covariance = weighed_fit(flat, moving.series * moving.weight, floor)
    done, first = [], 0
    left = moving.series.copy()
    for line, each in zip(lines, shapes, strict=True):
        last = first + len(each)
        found, sigmas = values[first:last], np.sqrt(np.diag(covariance)[first:last])
        parts = [complex(found[k], found[k + 1]) for k in range(0, len(each), 2)]
        sigma = max(hypot(sigmas[k], sigmas[k + 1]) / np.sqrt(2.0) for k in range(0, len(each), 2))
        if line.kind == "time":
            parts = [parts[0], parts[0]]
        elif len(parts) == 1:
            parts = [*parts, complex("nan")] if _senses(moving) == [1.0] else [complex("nan"), *parts]
        done.append(replace(line, forward=parts[0], backward=parts[1], sigma=float(sigma)))
        first = last
    with np.errstate(divide="ignore", invalid="ignore"):
        left = np.where(moving.weight > 0.0, left - (flat @ values) / moving.weight, left)
    return done, left


def weighed_fit(columns: Array, series: Array, floor: Floor) -> tuple[Array, Array]:
    """Least squares under coloured noise: coefficients and their covariance, shapes (k,) and (k, k)."""
    white = np.stack([floor.whitened(column) for column in columns.T], axis=1)
    size = np.linalg.norm(white, axis=0)
    size[size == 0.0] = 1.0
    inverse = np.asarray(np.linalg.pinv((white / size).T @ (white / size), rcond=1e-10)) / np.outer(size, size)
    values: Array = inverse @ (white.T @ floor.whitened(series))
    return values, inverse
