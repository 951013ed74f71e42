"""Features of many runs at once: moments of each signal, and amplitudes of the current at orders of the input angle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOMENT_NAMES = ("mean", "rms", "peak", "kurtosis")
DIRECTION_SIGNS = {"forward": 1.0, "backward": -1.0}
MIN_SPEED_SHARE = 0.02  # of the highest speed of a run: slower samples belong to no direction
MIN_TURNS = 1.5  # of the input in one direction, below which orders from 1 on are not separated from the mean
MIN_SAMPLES_PER_COLUMN = 3  # of the regression
MAX_CONDITION = 1e10  # of the normal equations, beyond which amplitudes have fewer than six digits
NOISY_SIGNALS = ("current", "torque", "input_speed", "tracking_error")  # in the order in which they draw noise
TREND_COLUMNS = 3  # of the regression: mean, slope and curvature over time
MEMBERS_AT_ONCE = 64  # whose matrices fit into a processor's cache


@dataclass(frozen=True)
class FeatureSet:
    """Features and their names.

    Args:
        signals: signals with moments, each with its unit
        orders: of the current over the input angle
        tooth_order: that of the spline that turns, or None; needs `tooth_turns` turns of the input to be separated from order 2
    """

    signals: Mapping[str, str]
    orders: Sequence[float]
    tooth_order: float | None

    @property
    def tooth_turns(self) -> float:
        """Turns after which the tooth order and its neighbour differ by one cycle."""
        if self.tooth_order is None:
            return np.inf
        return 1.0 / max(min(abs(self.tooth_order - order) for order in self.orders), 1e-6)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each feature, by its name."""
        found = {
            f"{signal}_{moment}": "1" if moment == "kurtosis" else unit
            for signal, unit in self.signals.items()
            for moment in MOMENT_NAMES
        }
        if "current" in self.signals:
            found |= dict.fromkeys((_name(order, way) for order in self._all_orders for way in DIRECTION_SIGNS), "A")
        return found

    @property
    def _all_orders(self) -> list[float]:
        return [*self.orders, *([] if self.tooth_order is None else [self.tooth_order])]

    def of(self, series: Mapping[str, Array], input_angle: Array, input_speed: Array) -> dict[str, Array]:
        """Return the features of runs.

        Args:
            series: the signals, each of shape (members, samples)
            input_angle, input_speed: without noise, shape (members, samples)

        Returns:
            each feature, shape (members,); not-a-number where a run does not determine it
        """
        columns: dict[str, Array] = {}
        for signal in self.signals:
            columns |= {f"{signal}_{name}": values for name, values in moments(series[signal]).items()}
        if "current" not in self.signals or not self.orders:
            return columns
        parts = [slice(first, first + MEMBERS_AT_ONCE) for first in range(0, len(input_angle), MEMBERS_AT_ONCE)]
        for way, sign in DIRECTION_SIGNS.items():
            lines = [self._lines(series["current"][part], input_angle[part], sign * input_speed[part]) for part in parts]
            amplitudes = np.concatenate(lines)
            columns |= {_name(order, way): amplitudes[:, place] for place, order in enumerate(self._all_orders)}
        return columns

    def _lines(self, current: Array, angle: Array, speed: Array) -> Array:
        """Amplitudes of all orders in one direction, shape (members, orders)."""
        moving = speed > MIN_SPEED_SHARE * np.abs(speed).max(axis=1, keepdims=True)
        high = np.where(moving, angle, -np.inf).max(axis=1)
        low = np.where(moving, angle, np.inf).min(axis=1)
        turns = np.where(moving.any(axis=1), high - low, 0.0) / (2.0 * np.pi)  # between the extremes of the angle while moving
        columns = TREND_COLUMNS + 2 * len(self._all_orders)
        enough = (turns >= MIN_TURNS) & (moving.sum(axis=1) >= MIN_SAMPLES_PER_COLUMN * columns)
        amplitudes = np.full((len(current), len(self._all_orders)), np.nan)
        long = enough & (turns >= self.tooth_turns)
        short = enough & ~long
        for rows, orders in ((short, self.orders), (long, self._all_orders)):
            if rows.any():
                fitted = order_amplitudes(current[rows], angle[rows], moving[rows], orders)
                amplitudes[np.ix_(rows, np.arange(len(orders)))] = fitted
        return amplitudes


def moments(values: Array) -> dict[str, Array]:
    """Return mean, root mean square, largest absolute value and kurtosis along the last axis.

    The kurtosis is that of the deviation from the mean, 3 for Gaussian values; not-a-number for constant ones.

    >>> {name: float(each[0]) for name, each in moments(np.array([[1.0, -1.0, 1.0, -1.0]])).items()}
    {'mean': 0.0, 'rms': 1.0, 'peak': 1.0, 'kurtosis': 1.0}
    """
    count = values.shape[1]
    mean = values.mean(axis=1)
    deviation = values - mean[:, None]
    squares = deviation * deviation
    variance = squares.sum(axis=1) / count
    with np.errstate(invalid="ignore", divide="ignore"):
        kurtosis = np.einsum("ij,ij->i", squares, squares) / count / variance**2
    constant = variance <= (1e-12 * np.abs(mean)) ** 2
    return {
        "mean": mean,
        "rms": np.sqrt(mean**2 + variance),
        "peak": np.abs(values).max(axis=1),
        "kurtosis": np.where(constant, np.nan, kurtosis),
    }


def order_amplitudes(current: Array, angle: Array, used: NDArray[np.bool_], orders: Sequence[float]) -> Array:
    """Return the amplitude of each order of an angle by least squares, together with a mean and a trend of second degree.

    The speed is no regressor: at a steady command all that varies of it is the ripple itself.

    Args:
        current, angle: shape (members, samples)

    Returns:
        amplitudes, shape (members, orders); not-a-number where the samples do not determine them

    >>> angle = np.linspace(0.0, 20.0, 400)[None]
    >>> current = 0.5 + 0.2 * np.cos(2.0 * angle + 0.3)
    >>> order_amplitudes(current, angle, angle > -1.0, [1.0, 2.0]).round(6).tolist()
    [[0.0, 0.2]]
    """
    basis = _basis(angle, orders)
    basis *= used[:, None, :]
    matrix = basis @ basis.transpose(0, 2, 1)
    scale = 1.0 / np.sqrt(np.maximum(np.einsum("ijj->ij", matrix), 1e-300))
    matrix *= scale[:, :, None] * scale[:, None, :]
    right = (basis @ current[:, :, None])[:, :, 0] * scale
    sizes = np.linalg.eigvalsh(matrix)
    sound = sizes[:, 0] * MAX_CONDITION > sizes[:, -1]
    matrix[~sound] = np.eye(matrix.shape[1])
    solution = np.linalg.solve(matrix, right[:, :, None])[:, :, 0] * scale
    amplitudes: Array = np.hypot(solution[:, TREND_COLUMNS::2], solution[:, TREND_COLUMNS + 1 :: 2])
    amplitudes[~sound] = np.nan
    return amplitudes


def _basis(angle: Array, orders: Sequence[float]) -> Array:
    """Trend, and cosine and sine of each order, shape (members, 3 + 2 orders, samples)."""
    basis = np.empty((len(angle), TREND_COLUMNS + 2 * len(orders), angle.shape[1]))
    instants = np.linspace(-1.0, 1.0, angle.shape[1])
    for degree in range(TREND_COLUMNS):
        basis[:, degree] = instants**degree
    for place, order in enumerate(orders):
        cosine, sine = basis[:, TREND_COLUMNS + 2 * place], basis[:, TREND_COLUMNS + 1 + 2 * place]
        half = next((early for early in range(place) if orders[early] == 0.5 * order), None)
        if half is None:
            np.cos(order * angle, out=cosine)
            np.sin(order * angle, out=sine)
        else:  # of the double angle: two products instead of two calls
            half_cosine, half_sine = basis[:, TREND_COLUMNS + 2 * half], basis[:, TREND_COLUMNS + 1 + 2 * half]
            np.multiply(half_cosine, half_cosine, out=cosine)
            cosine *= 2.0
            cosine -= 1.0
            np.multiply(half_cosine, half_sine, out=sine)
            sine *= 2.0
    return basis


def _name(order: float, way: str) -> str:
    return f"current_order_{order:g}_{way}"


def add_noise(series: dict[str, Array], noise: Mapping[Any, float], seed: int, members: NDArray[np.int64]) -> None:
    """Add white noise to signals of shape (members, samples) in place, a function of seed and member alone.

    It has the standard deviation of each sample, by the name of the signal.
    """
    noisy = [name for name in NOISY_SIGNALS if noise.get(name, 0.0) > 0.0 and name in series]
    for row, member in enumerate(members.tolist() if noisy else []):
        generator = np.random.Generator(np.random.Philox(key=seed, counter=[0, 0, 0, member]))
        for name in noisy:
            series[name][row] += noise[name] * generator.standard_normal(series[name].shape[1])
