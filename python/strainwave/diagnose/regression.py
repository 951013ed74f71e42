"""Least squares of orders over the angle, and the level of the noise around each order."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.diagnose.motion import SampledMotion
from strainwave.orders.smooth_part import MIN_GRAVITY_SPAN, MIN_SENSE_SHARE, floor_without, orthonormal
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
        level: Array = np.sum((self.noise.T @ series) ** 2, axis=0) / self.freedom
        return level

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
        root = _root(self.factor)
        found: Array = root @ _real(level) @ root
        return found

    def evidence(self, series: Array) -> Array:
        """Return F of all parts of the order together, of each column of the series, shape (k,).

        With several parts this is Hotelling's test: the covariance of the parts is that of their neighbours.
        """
        found = self.estimator @ series
        if len(self.names) == 1:
            square = np.sum(found * np.linalg.solve(self.factor, found), axis=0)
            explained: Array = square / len(found) / np.maximum(self.variance(series), 1e-300)
            return explained
        own = _complex(np.linalg.solve(_root(self.factor), found))
        around = _complex(self._around(series))
        parts, count = len(self.names), around.shape[1]
        level = np.einsum("pkm,qkm->mpq", around, around.conj()) / count
        level = level + 1e-300 * np.eye(parts)
        solved = np.linalg.solve(level, own.T[..., None])[..., 0]
        square = np.sum(own.T.conj() * solved, axis=1).real
        scaled: Array = square * (count - parts + 1) / (count * parts)
        return scaled


def _complex(scores: NDArray[Any]) -> NDArray[np.complex128]:
    """Return sine and cosine of each part as one complex number; the first axis is halved."""
    return scores[0::2] + 1j * scores[1::2]


def _real(level: NDArray[np.complex128]) -> Array:
    """Return the covariance of sines and cosines of a complex one, shape (2 parts, 2 parts)."""
    found = np.zeros((2 * len(level), 2 * len(level)))
    found[0::2, 0::2] = found[1::2, 1::2] = level.real
    found[1::2, 0::2], found[0::2, 1::2] = level.imag, -level.imag
    return found


def _root(matrix: Array) -> Array:
    """Return the symmetric square root of a positive matrix."""
    values, vectors = np.linalg.eigh(matrix)
    root: Array = (vectors * np.sqrt(np.maximum(values, 1e-300))) @ vectors.T
    return root


def smooth_columns(motion: SampledMotion, lowest: float) -> Array:
    """Return columns of what is no order: friction over speed, inertia, load, gravity and a slow trend, shape (n, k).

    Args:
        motion: of the shaft
        lowest: order that the trend must not contain
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
    found = {"constant": np.ones_like(motion.angle)}
    backward = float(np.mean(motion.sense < 0.0))
    if MIN_SENSE_SHARE < backward < 1.0 - MIN_SENSE_SHARE:
        found["friction"] = motion.sense
    if motion.load is not None and float(np.std(motion.load)) > MIN_SPREAD * float(np.sqrt(np.mean(motion.load**2))):
        found["kinematic"] = motion.load
    squared = motion.speed**2
    if float(np.std(squared)) > MIN_SPREAD * float(np.mean(squared)):
        found["inertial"] = squared
    return found


def regressions(motion: SampledMotion, orders: Sequence[float]) -> list[OrderRegression]:
    """Return the regression of each order, all fitted together with the smooth part.

    Args:
        motion: of the shaft
        orders: that the record separates, increasing or not

    Raises:
        ValueError: an order leaves no room for the noise around it
    """
    smooth = smooth_columns(motion, min(orders))
    grows = growths(motion)
    waves = [np.stack([wave * each for each in grows.values() for wave in motion.wave(order)], axis=1) for order in orders]
    single = [np.stack(motion.wave(order), axis=1) for order in orders]
    everything = np.concatenate([*waves, smooth], axis=1)
    white = _whitening(motion.series, everything) if len(grows) > 1 else _unchanged
    inverse, factor, basis = _solved(white(everything))
    mean_inverse, mean_factor, _ = _solved(white(np.concatenate([*single, smooth], axis=1)))
    width, found = 2 * len(grows), []
    for k, order in enumerate(orders):
        own, two = slice(k * width, (k + 1) * width), slice(2 * k, 2 * k + 2)
        scores = _scores(motion, order, orders, basis, grows, white)
        found.append(
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
    return found


def neighbours_of(order: float, orders: Sequence[float], revolutions: float) -> list[float]:
    """Return the orders around one, a line apart each, that have noise alone, without the nearest ones.

    >>> neighbours_of(2.0, [2.0, 2.2], 10.0)[:4]
    [1.7, 2.3, 1.6, 2.4]
    """
    reach = max(MIN_NEIGHBOURS, min(MAX_NEIGHBOUR_LINES, int(NEIGHBOUR_REACH * order * revolutions)))
    found = []
    for k in range(GUARD_LINES + 1, GUARD_LINES + reach + 1):
        for place in (order - k / revolutions, order + k / revolutions):
            near = min((abs(place - other) for other in orders if other != order), default=inf)
            if place > 0.25 * order and near * revolutions > 0.75:
                found.append(round(place, 12))
    return found


def _unchanged(columns: Array) -> Array:
    return columns


def _whitening(series: Array, columns: Array) -> Callable[[Array], Array]:
    """Return the filter that makes noise white, from what no column explains: motion at many speeds sees all its colours.

    The filter is symmetric, so that the product of filtered columns with a filtered series is that of twice filtered columns
    with the series itself.
    """
    found = floor_without(columns, series, np.ones(len(series)))
    level = np.maximum(found.level, found.level.max() / MAX_NOISE_RANGE)
    floor = Floor(found.place, level / level.max(), found.lines)
    return floor.whitened


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
    orthonormal: Array = columns @ (vectors[:, kept] / np.sqrt(values[kept]))
    return orthonormal


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
    found: list[Array] = []
    room = max(2 * len(grows) + 2, MAX_SCORES // (2 * len(grows) * len(motion.angle)))
    for place in neighbours_of(order, orders, motion.revolutions)[:room]:
        block = white(np.stack([wave * each for each in grows.values() for wave in motion.wave(place)], axis=1))
        size = np.linalg.norm(block, axis=0)
        block = block / size
        block = block - basis @ (basis.T @ block)
        for other in found:
            block = block - other @ (other.T @ block)
        squared = block.T @ block
        values, vectors = np.linalg.eigh(squared)
        if values[0] > MIN_INDEPENDENCE:
            found.append(block @ ((vectors / np.sqrt(values)) @ vectors.T))
    if len(found) < 2 * len(grows):
        raise ValueError(
            f"order {order:g} has {len(grows)} parts and {len(found)} neighbours with noise alone: record longer, or leave out "
            "the load column"
        )
    return found


def _solved(columns: Array) -> tuple[Array, Array, Array]:
    """Return the pseudo-inverse, the inverse of the squared columns, and an orthonormal basis of the columns."""
    basis, made = orthonormal(columns)
    return made @ basis.T, made @ made.T, basis
