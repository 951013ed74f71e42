"""Linear least squares with its covariance, infinite where columns do not separate coefficients, and own shares of columns.

Each column is scaled to length 1. Its own share is the part of it that no other column makes up. A direction in which the
coefficients can change without a change of the prediction has a singular value of nearly zero: the coefficients in it are not
separated, only sums of them are determined (`determined_sum`). The covariance is that of correlated residuals
(`covariance.covariance_of`).
Terms that may act as well, but are not needed, are rivals: with each of them the coefficients differ, and by Akaike's weights
that spread is part of their standard deviation (Buckland, Burnham and Augustin, Biometrics 53 (1997) 603-618, eq. 9).

An order is a number of cycles in each revolution of an angle. Its wave with amplitude A and phase φ is A sin(order · angle + φ)
= A cos φ sin(order · angle) + A sin φ cos(order · angle): two columns of a linear fit.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.equality import ComparedByFields
from strainwave.statistics.covariance import covariance_of
from strainwave.statistics.residuals import correlation_length

Array = NDArray[np.float64]

MIN_SINGULAR_OF_COLUMNS = 1e-8  # of the largest singular value of columns of length 1: a smaller one is rounding


@dataclass(frozen=True, eq=False)
class LinearFit(ComparedByFields):
    """Result of `linear_fit`.

    Attributes:
        values: coefficients, shape (n,); of those that are not separated, the ones of least norm in units of their columns
        covariance: of them, shape (n, n); infinite variance if a coefficient is not separated
        own_share: part of each column that no other column makes up [1], shape (n,)
        residual: target less prediction, shape (samples,)
        freedom: degrees of freedom of the covariance
    """

    values: Array
    covariance: Array
    own_share: Array
    residual: Array
    freedom: float

    @cached_property
    def sigma(self) -> Array:
        """Standard deviation of each coefficient, shape (n,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def rms(self) -> float:
        """Root mean square of the residual."""
        return float(np.sqrt(np.mean(self.residual**2)))


def linear_fit(
    columns: Array,
    target: Array,
    *,
    weights: Array | None = None,
    rivals: Array | None = None,
) -> LinearFit:
    """Return the coefficients of columns by least squares, with their covariance and own shares.

    Args:
        columns: shape (samples, n)
        target: shape (samples,)
        weights: of the samples, as over the standard deviation of their noise, shape (samples,)
        rivals: further columns that may act too, one at a time, shape (samples, m): how far each moves the coefficients is part
            of their standard deviation

    Raises:
        ValueError: no more samples than columns

    >>> speed = np.array([10.0, 10.0, 10.0, -10.0, -10.0, -10.0])
    >>> torque = 0.064 * np.sign(speed) + 1e-4 * np.array([1.0, -1.0, 0.0, 0.0, 1.0, -1.0])
    >>> fit = linear_fit(np.stack([np.sign(speed), speed], axis=1), torque)
    >>> round(float(fit.values @ [1.0, 10.0]), 4), fit.sigma.tolist()  # the sum at this speed, not its terms
    (0.064, [inf, inf])
    """
    if len(target) <= columns.shape[1]:
        raise ValueError(
            f"{len(target)} samples do not determine {columns.shape[1]} coefficients and their standard deviations"
        )
    rows = np.ones(len(target)) if weights is None else weights
    scaled, goal = columns * rows[:, np.newaxis], target * rows
    values = solved(scaled, goal)
    left = goal - scaled @ values
    covariance, freedom = covariance_of(scaled, left[np.newaxis])
    if rivals is not None:
        covariance = covariance + _of_choice(scaled, goal, rivals * rows[:, np.newaxis], values, left)
    return LinearFit(values, covariance, own_share(scaled), target - columns @ values, freedom)


def solved(columns: Array, target: NDArray[Any]) -> NDArray[Any]:
    """Return the coefficients of columns, scaled so that small ones count alike, shape (n,) or (n, k) for k targets.

    They are complex if the target is.
    """
    size = np.linalg.norm(columns, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    coefficients = np.linalg.lstsq(columns / size, target, rcond=MIN_SINGULAR_OF_COLUMNS)[0]
    return np.asarray((coefficients.T / size).T)


def rms_left_out(columns: Array, target: Array, parts: Iterable[NDArray[np.bool_]]) -> float:
    """Return the root mean square of what least squares leave of parts of the samples, each predicted from the others.

    Args:
        columns: shape (samples, n)
        target: shape (samples,)
        parts: True for the samples of a part, shape (samples,)

    >>> time = np.arange(8.0)
    >>> first = time < 4.0
    >>> rms_left_out(np.stack([np.ones(8), time], axis=1), 3.0 * time + 2.0 * first, [~first])
    2.0
    """
    left = [target[part] - columns[part] @ solved(columns[~part], target[~part]) for part in parts]
    return float(np.sqrt(np.mean(np.concatenate(left) ** 2)))


def normal_inverse(columns: Array) -> Array:
    """Return the inverse of A' A of columns A: the covariance of their coefficients for noise of variance 1, shape (n, n).

    Directions that are not separated are left out, as in `solved`.

    >>> normal_inverse(np.array([[2.0, 0.0], [0.0, 0.5]])).tolist()
    [[0.25, 0.0], [0.0, 4.0]]
    """
    size = np.linalg.norm(columns, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    _, singular, directions = np.linalg.svd(columns / size, full_matrices=False)
    live = singular > MIN_SINGULAR_OF_COLUMNS * singular.max(initial=0.0)
    root = directions[live].T / singular[live]
    return np.asarray((root @ root.T) / np.outer(size, size))


def own_share(columns: Array, others: Array | None = None) -> Array:
    """Return the part of each column's length that the other columns, and further ones, do not make up [1], shape (n,).

    >>> own_share(np.array([[1.0, 1.0], [0.0, 1.0]])).round(3).tolist()
    [0.707, 0.707]
    """
    beside = np.zeros((len(columns), 0)) if others is None else others
    shares = []
    for place, column in enumerate(columns.T):
        rest = np.column_stack([np.delete(columns, place, axis=1), beside])
        left = column - rest @ solved(rest, column) if rest.shape[1] else column
        shares.append(float(np.linalg.norm(left)) / max(float(np.linalg.norm(column)), 1e-300))
    return np.array(shares)


def _of_choice(columns: Array, target: Array, rivals: Array, values: Array, left: Array) -> Array:
    """Return the covariance of the coefficients by the choice among models with one rival more, by Akaike's weights.

    Samples count as often as they are independent of each other.
    """
    independent = len(target) / correlation_length(left)
    squares = max(float(left @ left), 1e-300)
    moved, gains = [], []
    for rival in rivals.T:
        more = np.column_stack([columns, rival])
        coefficients = solved(more, target)
        rest = target - more @ coefficients
        moved.append(coefficients[:-1] - values)
        gains.append(0.5 * independent * np.log(squares / max(float(rest @ rest), 1e-300)) - 1.0)
    evidence = np.exp(np.array([0.0, *gains]) - max(0.0, *gains))
    shares = evidence[1:] / evidence.sum()
    steps = np.array(moved)
    return np.asarray((steps.T * shares) @ steps)


# ---- Waves of orders over an angle -----------------------------------------------------------------------------------


def order_waves(angle: Array, orders: Sequence[float]) -> Array:
    """Return the sine and the cosine of each order of an angle [rad], one after the other, shape (n, 2 orders).

    >>> order_waves(np.array([0.0, 0.25 * np.pi]), [2.0, 4.0]).round(9).tolist()
    [[0.0, 1.0, 0.0, 1.0], [1.0, 0.0, 0.0, -1.0]]
    """
    waves = np.empty((len(angle), 2 * len(orders)))
    phases = np.multiply.outer(angle, orders)
    np.sin(phases, out=waves[:, 0::2])
    np.cos(phases, out=waves[:, 1::2])
    return waves


def amplitudes_of(coefficients: Array) -> tuple[Array, Array]:
    """Return amplitude and phase [rad] of each order by the coefficients of `order_waves`, both of shape (orders,).

    >>> [each.round(3).tolist() for each in amplitudes_of(np.array([3.0, 4.0]))]
    [[5.0], [0.927]]
    """
    sine, cosine = coefficients[0::2], coefficients[1::2]
    return np.hypot(sine, cosine), np.arctan2(cosine, sine)
