"""Least squares of orders over the angle, and the level of the noise around each order."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, pi, tau
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.files.recording import Recording, check_recording
from strainwave.messages import quoted
from strainwave.orders.smooth_part import MIN_GRAVITY_SPAN, MIN_SENSE_SHARE, floor_without, orthonormal
from strainwave.orders.turning import evenly_turning, unwrapped
from strainwave.statistics.spectrum import Floor

Array = NDArray[np.float64]

MAX_NEIGHBOUR_LINES = 16  # on each side of an order, from which the level of its noise is estimated
GUARD_LINES = 2  # next to an order on each side, into which it leaks where load or speed vary
MIN_NEIGHBOURS = 6  # on each side at least, if the orders leave room
NEIGHBOUR_REACH = 0.15  # of an order [1]: within it noise is taken to have one level
TREND_PERIODS = 4  # half periods in the slow trend
MIN_TREND_RATIO = 4.0  # periods of the slowest order in the fastest half period of the trend
MIN_SPREAD = 0.1  # relative spread of load or squared speed [1], from which parts are separated by it
SPEED_SPREAD = 0.01  # relative spread of the speed [1], from which friction over speed is determined
MAX_SCORES = 2**24  # numbers in the columns of all parts of the neighbours
MIN_INDEPENDENCE = 1e-3  # of the square of a neighbour's columns [1], that others must leave
MAX_NOISE_RANGE = 1e6  # largest over least power of the noise
MIN_REVOLUTIONS = 1.0  # of the shaft, below which no order is determined
MIN_SPEED_SHARE = 0.1  # of a fast speed [1]: slower samples are left out, since friction turns over there
MAX_SAMPLES = 2**18  # samples that are fitted, the first ones
MAX_PHASE_STEP = 0.125 * pi  # rad of the highest order between two averaged samples: an amplitude loses 0.7 %
MAX_AVERAGED = 64  # samples in one mean
MAX_RATE = 1e9  # Hz, of samples
MAX_ROUNDING = 1e-6  # revolutions, by which a whole number may be missed


@dataclass(frozen=True, eq=False)
class SampledMotion:
    """A turning shaft and a column, sampled evenly in time.

    Attributes:
        angle: of the shaft [rad], shape (n,)
        series: the column [unit of the column], shape (n,)
        load: load column, or None, shape (n,)
        speed: of the shaft over about a revolution, so that ripple of orders is not in it [rad/s], shape (n,)
        sense: 1 forward, -1 backward, shape (n,)
        step: between samples [s]
        every: neighbours averaged in each sample
        revolutions: of the shaft, end to end
        output_turns: of the output, end to end; nan if the ratio is not known
        ratio: size of the ratio; nan if it is not known
        remarks: what was done, in words
    """

    angle: Array
    series: Array
    load: Array | None
    speed: Array
    sense: Array
    step: float
    every: int
    revolutions: float
    output_turns: float
    ratio: float
    remarks: tuple[str, ...]

    def wave(self, order: float) -> tuple[Array, Array]:
        """Return sine and cosine of an order as the averaged samples have them, each of shape (n,)."""
        phase = order * self.angle
        half = 0.5 * order * self.speed * self.step / self.every
        with np.errstate(invalid="ignore", divide="ignore"):
            kept = np.where(np.abs(half) > 1e-12, np.sin(self.every * half) / (self.every * np.sin(half)), 1.0)
        return kept * np.sin(phase), kept * np.cos(phase)

    @property
    def reverses(self) -> bool:
        """True if the shaft turns both ways."""
        return bool(np.ptp(self.sense) > 0.0)


def motion_of(
    recording: Recording,
    column: str,
    highest: float,
    *,
    load_column: str | None = None,
    angle: str = "input_angle",
    ratio: float | None = None,
    rate: float | None = None,
) -> SampledMotion:
    """Return the shaft with the column, prepared for orders up to the highest; arguments as of `order_lines`.

    A motion of one sense is cut to its last whole revolutions: of the output if it makes one and its angle or the ratio is
    known, else of the shaft. So no whole order leaks into its neighbours. Samples are averaged as far as the highest order
    allows.
    """
    check_recording("recording", recording)
    arguments.text("column", column)
    if rate is not None:
        rate = arguments.number("rate", rate, "Hz", "(]", 0.0, MAX_RATE)
    record = evenly_turning(recording, [angle], [column, *([load_column] if load_column else [])], rate, MAX_SAMPLES)
    turned, series, measured = record.columns[angle], record.columns[column], record.measured
    load = record.columns[load_column] if load_column else None
    turns = float(np.ptp(turned)) / tau
    if turns == 0.0:
        raise ValueError(f"{quoted(angle)} does not change: the shaft rests; record it while it turns")
    if turns < MIN_REVOLUTIONS:
        raise ValueError(
            f"{quoted(angle)} turns {turns:.3g} revolutions; orders need {MIN_REVOLUTIONS:g} or more: turn further"
        )
    size = _ratio(recording, angle, ratio)
    path = float(np.abs(np.diff(turned[:: max(1, len(turned) // 512)])).sum())
    turns_one_way = abs(float(turned[-1] - turned[0])) > 0.98 * path  # but for noise
    cut, remarks = _whole(turned, size) if turns_one_way else (slice(None), [])
    turned, series, measured = turned[cut], series[cut], measured[cut]
    load = None if load is None else load[cut]
    speed = _slow_speed(turned) / record.step
    fast = float(np.quantile(np.abs(speed), 0.95))
    used = measured & (np.abs(speed) > MIN_SPEED_SHARE * fast)
    by_order = int(MAX_PHASE_STEP / max(fast * record.step * highest, 1e-300))
    every = max(1, min(by_order, MAX_AVERAGED, len(turned) // 512))  # keeps the highest order, and enough samples
    remarks = [*record.remarks, *remarks]
    if (resting := float(np.mean(~used))) > 0.01:
        remarks.append(f"{resting:.0%} of the samples are of rest or slow motion, or were filled in, and do not count")
    rows = _means(used.astype(float), every) == 1.0
    series_of = [_means(each, every)[rows] for each in (turned, series, speed)]
    turns = float(np.ptp(turned)) / tau
    return SampledMotion(
        angle=series_of[0],
        series=series_of[1],
        load=None if load is None else _means(load, every)[rows],
        speed=series_of[2],
        sense=np.sign(series_of[2]),
        step=record.step * every,
        every=every,
        revolutions=turns,
        output_turns=turns / size,
        ratio=size,
        remarks=tuple(remarks),
    )


def _ratio(recording: Recording, angle: str, given: float | None) -> float:
    """Return the size of the ratio, from the output angle if none is given; nan if neither is known."""
    if given is not None:
        return abs(arguments.ratio("ratio", given))
    if "output_angle" not in recording or angle == "output_angle":
        return float("nan")
    output = unwrapped("output_angle", recording.values("output_angle", "rad"))
    span = float(np.ptp(output))
    return float(np.ptp(unwrapped(angle, recording.values(angle, "rad")))) / span if span > 0.0 else float("nan")


def _whole(turned: Array, ratio: float) -> tuple[slice, list[str]]:
    """Return the last whole revolutions: of the output if there is one, else of the shaft."""
    turns = abs(float(turned[-1] - turned[0])) / tau
    outputs = int(turns / ratio + MAX_ROUNDING) if ratio == ratio else 0
    period = ratio if outputs >= 1 else 1.0
    span = tau * period * int(turns / period + MAX_ROUNDING)
    left = np.abs(turned - turned[-1])
    first = int(np.searchsorted(-left, -span))
    if outputs >= 1 or ratio != ratio:
        return slice(first, None), []
    return slice(first, None), [f"the output turns {turns / ratio:.2g} revolutions: whole ones of the input are used"]


def _slow_speed(turned: Array) -> Array:
    """Return the speed over about a revolution, twice averaged [rad per sample], shape (n,)."""
    from scipy.ndimage import uniform_filter1d

    speed = np.gradient(turned)
    fast = float(np.quantile(np.abs(speed), 0.9))
    width = int(np.clip(round(tau / max(fast, 1e-300)), 3, max(3, len(turned) // 8))) | 1
    for _ in range(2):
        speed = uniform_filter1d(speed, width, mode="nearest")
    return speed


def _means(series: Array, every: int) -> Array:
    """Return means of so many neighbours each; the rest at the beginning is left out."""
    return np.asarray(series[len(series) % every :].reshape(-1, every).mean(axis=1))


@dataclass(frozen=True, eq=False)
class OrderRegression:
    """Least squares of one order, prepared for any series on the same motion.

    Attributes:
        order: periods per revolution [1]
        names: of its parts
        estimator: coefficients of all sines and cosines of the parts from the series, shape (2 parts, n)
        factor: covariance of the coefficients over the variance of a sample, shape (2 parts, 2 parts)
        mean_estimator: sine and cosine of the whole order alike, shape (2, n)
        mean_factor: covariance of those over the variance, shape (2, 2)
        shape: columns of the parts, shape (n, 2 parts)
        noise: orthonormal columns of the neighbours, free of all that is fitted, shape (n, freedom)
        scores: orthonormal columns of the parts of each neighbour, shape (k, 2 parts, n); none with one part
    """

    order: float
    names: tuple[str, ...]
    estimator: Array
    factor: Array
    mean_estimator: Array
    mean_factor: Array
    shape: Array
    noise: Array
    scores: Array

    @property
    def evidence_freedom(self) -> int:
        """Degrees of freedom of the noise in `evidence`."""
        parts = len(self.names)
        return self.freedom if parts == 1 else 2 * (len(self.scores) - parts + 1)

    @property
    def freedom(self) -> int:
        """Degrees of freedom of the level of the noise."""
        return int(self.noise.shape[1])

    def variance(self, series: Array) -> Array:
        """Return the variance of a sample of white noise that has the level around the order, of each column of the series."""
        return np.asarray(np.sum((self.noise.T @ series) ** 2, axis=0) / self.freedom)

    def _around(self, series: Array) -> Array:
        """Return the coefficients of the parts of each neighbour, shape (2 parts, neighbours, series)."""
        count, parts, rows = self.scores.shape
        around: Array = (self.scores.reshape(-1, rows) @ series).reshape(count, parts, -1)  # one product is faster than many
        return around.transpose(1, 0, 2)

    def covariance(self, series: Array) -> Array:
        """Return the covariance of the coefficients of the parts under the noise around the order, shape (2 parts, 2 parts).

        Noise is coloured over time, and parts see it at other speeds. So neighbours with the same parts measure it.
        """
        if len(self.names) == 1:
            return self.factor * float(self.variance(series[:, None])[0])
        around = _complex(self._around(series[:, None])[..., 0])
        level = (around @ around.conj().T) / (2.0 * around.shape[1])
        real = np.zeros((2 * len(level), 2 * len(level)))  # of sines and cosines
        real[0::2, 0::2] = real[1::2, 1::2] = level.real
        real[1::2, 0::2], real[0::2, 1::2] = level.imag, -level.imag
        root = _root(self.factor)
        return np.asarray(root @ real @ root)

    def evidence(self, series: Array) -> Array:
        """Return F of all parts of the order together, of each column of the series, shape (k,).

        With several parts this is Hotelling's test: the covariance of the parts is that of their neighbours.
        """
        coefficients = self.estimator @ series
        if len(self.names) == 1:
            square = np.sum(coefficients * np.linalg.solve(self.factor, coefficients), axis=0)
            return np.asarray(square / len(coefficients) / np.maximum(self.variance(series), 1e-300))
        own = _complex(np.linalg.solve(_root(self.factor), coefficients))
        around = _complex(self._around(series))
        parts, count = len(self.names), around.shape[1]
        level = np.einsum("pkm,qkm->mpq", around, around.conj()) / count
        level = level + 1e-300 * np.eye(parts)
        solved = np.linalg.solve(level, own.T[..., None])[..., 0]
        square = np.sum(own.T.conj() * solved, axis=1).real
        return np.asarray(square * (count - parts + 1) / (count * parts))


def _complex(scores: NDArray[Any]) -> NDArray[np.complex128]:
    """Return sine and cosine of each part as one complex number; the first axis is halved."""
    return scores[0::2] + 1j * scores[1::2]


def _root(matrix: Array) -> Array:
    """Return the symmetric square root of a positive matrix."""
    values, vectors = np.linalg.eigh(matrix)
    return np.asarray((vectors * np.sqrt(np.maximum(values, 1e-300))) @ vectors.T)


def smooth_columns(motion: SampledMotion, lowest: float) -> Array:
    """Return columns of what is no order: friction over speed, inertia, load, gravity and a slow trend, shape (n, k).

    The trend does not contain the lowest order.
    """
    count = len(motion.angle)
    place = np.linspace(0.0, np.pi, count)
    trends = int(min(TREND_PERIODS, 2.0 * lowest * motion.revolutions / MIN_TREND_RATIO))
    columns = [np.cos(k * place) for k in range(trends + 1)]
    sense = motion.sense if motion.reverses else None
    if sense is not None:
        columns.append(sense)
    swift = np.abs(motion.speed)
    if float(np.std(swift)) > SPEED_SPREAD * float(np.mean(swift)):
        scaled = swift / float(swift.max())
        columns += [scaled, scaled**2, np.gradient(motion.speed)]
        columns += [sense * scaled, sense * scaled**2] if sense is not None else []
    if motion.load is not None and float(np.std(motion.load)) > 0.0:
        columns.append(motion.load)
        columns += [sense * np.abs(motion.load)] if sense is not None else []
    if motion.ratio == motion.ratio and 2.0 * np.pi * motion.output_turns > MIN_GRAVITY_SPAN and motion.ratio * lowest > 2.0:
        columns += [np.sin(motion.angle / motion.ratio), np.cos(motion.angle / motion.ratio)]
    return np.stack(columns, axis=1)


def growths(motion: SampledMotion) -> dict[str, Array]:
    """Return what the parts of an order grow with, as far as the motion separates them; first what does not change.

    Friction ripple turns over with the direction, the kinematic part grows with the load, the inertial part with the square of
    the speed, in (rad/s)².
    """
    grows = {"constant": np.ones_like(motion.angle)}
    backward = float(np.mean(motion.sense < 0.0))
    if MIN_SENSE_SHARE < backward < 1.0 - MIN_SENSE_SHARE:
        grows["friction"] = motion.sense
    if motion.load is not None and float(np.std(motion.load)) > MIN_SPREAD * float(np.sqrt(np.mean(motion.load**2))):
        grows["kinematic"] = motion.load
    squared = motion.speed**2
    if float(np.std(squared)) > MIN_SPREAD * float(np.mean(squared)):
        grows["inertial"] = squared
    return grows


def regressions(motion: SampledMotion, orders: Sequence[float]) -> list[OrderRegression]:
    """Return the regression of each order, all fitted together with the smooth part; the record must separate them."""
    smooth = smooth_columns(motion, min(orders))
    grows = growths(motion)
    waves = [np.stack([wave * each for each in grows.values() for wave in motion.wave(order)], axis=1) for order in orders]
    single = [np.stack(motion.wave(order), axis=1) for order in orders]
    everything = np.concatenate([*waves, smooth], axis=1)
    white: Callable[[Array], Array] = _whitening(motion.series, everything) if len(grows) > 1 else np.asarray
    inverse, factor, basis = _solved(white(everything))
    mean_inverse, mean_factor, _ = _solved(white(np.concatenate([*single, smooth], axis=1)))
    width, fits = 2 * len(grows), []
    for k, order in enumerate(orders):
        own, two = slice(k * width, (k + 1) * width), slice(2 * k, 2 * k + 2)
        scores = _scores(motion, order, orders, basis, grows, white)
        fits.append(
            OrderRegression(
                order=order,
                names=tuple(grows),
                estimator=white(inverse[own].T).T,
                factor=factor[own, own],
                mean_estimator=white(mean_inverse[two].T).T,
                mean_factor=mean_factor[two, two],
                shape=waves[k],
                noise=white(_noise_basis(motion, order, orders, basis, white)),
                scores=np.stack([white(each).T for each in scores]) if scores else np.zeros((0, 2, len(motion.angle))),
            )
        )
    return fits


def neighbours_of(order: float, orders: Sequence[float], revolutions: float) -> list[float]:
    """Return the orders around one, a line apart each, that have noise alone, without the nearest ones.

    >>> neighbours_of(2.0, [2.0, 2.2], 10.0)[:4]
    [1.7, 2.3, 1.6, 2.4]
    """
    reach = max(MIN_NEIGHBOURS, min(MAX_NEIGHBOUR_LINES, int(NEIGHBOUR_REACH * order * revolutions)))
    neighbours = []
    for k in range(GUARD_LINES + 1, GUARD_LINES + reach + 1):
        for place in (order - k / revolutions, order + k / revolutions):
            near = min((abs(place - other) for other in orders if other != order), default=inf)
            if place > 0.25 * order and near * revolutions > 0.75:
                neighbours.append(round(place, 12))
    return neighbours


def _whitening(series: Array, columns: Array) -> Callable[[Array], Array]:
    """Return the filter that makes noise white, from what no column explains: motion at many speeds sees all its colours.

    The filter is symmetric, so that the product of filtered columns with a filtered series is that of twice filtered columns
    with the series itself.
    """
    floor = floor_without(columns, series, np.ones(len(series)))
    level = np.maximum(floor.level, floor.level.max() / MAX_NOISE_RANGE)
    return Floor(floor.place, level / level.max(), floor.lines).whitened


def _noise_basis(
    motion: SampledMotion, order: float, orders: Sequence[float], basis: Array, white: Callable[[Array], Array]
) -> Array:
    """Return orthonormal columns of the neighbours of an order that are orthogonal to all that is fitted."""
    around = neighbours_of(order, orders, motion.revolutions)
    if not around:
        raise ValueError(f"order {order:g} leaves no room for the noise around it: look for fewer orders, or record longer")
    columns = white(np.stack([wave for place in around for wave in motion.wave(place)], axis=1))
    columns = columns - basis @ (basis.T @ columns)
    values, vectors = np.linalg.eigh(columns.T @ columns)
    kept = values > values.max() * 1e-6
    return np.asarray(columns @ (vectors[:, kept] / np.sqrt(values[kept])))


def _scores(
    motion: SampledMotion,
    order: float,
    orders: Sequence[float],
    basis: Array,
    grows: Mapping[str, Array],
    white: Callable[[Array], Array],
) -> list[Array]:
    """Return orthonormal columns of the parts of each neighbour, one neighbour after the other, each of shape (n, 2 parts)."""
    if len(grows) == 1:
        return []
    blocks: list[Array] = []
    room = max(2 * len(grows) + 2, MAX_SCORES // (2 * len(grows) * len(motion.angle)))
    for place in neighbours_of(order, orders, motion.revolutions)[:room]:
        block = white(np.stack([wave * each for each in grows.values() for wave in motion.wave(place)], axis=1))
        size = np.linalg.norm(block, axis=0)
        block = block / size
        block = block - basis @ (basis.T @ block)
        for other in blocks:
            block = block - other @ (other.T @ block)
        squared = block.T @ block
        values, vectors = np.linalg.eigh(squared)
        if values[0] > MIN_INDEPENDENCE:
            blocks.append(block @ ((vectors / np.sqrt(values)) @ vectors.T))
    if len(blocks) < 2 * len(grows):
        raise ValueError(
            f"order {order:g} has {len(grows)} parts and {len(blocks)} neighbours with noise alone: record longer, or leave "
            "out the load column"
        )
    return blocks


def _solved(columns: Array) -> tuple[Array, Array, Array]:
    """Return the pseudo-inverse, the inverse of the squared columns, and an orthonormal basis of the columns."""
    basis, made = orthonormal(columns)
    return made @ basis.T, made @ made.T, basis
