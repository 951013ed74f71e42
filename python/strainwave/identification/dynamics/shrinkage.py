"""Shares of many terms in a torque, shrunk towards zero as far as the record does not tell them.

The shares are normal about zero, with a scatter that is expected of each, but for two unknown factors. That is ridge regression
(HoerlKennard1970), whose factors the record itself tells by its evidence (MacKay1992).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOST = 40  # combinations of terms that are unknowns
TOLD = 0.5  # of a combination's share, that the record must tell rather than what was expected
GRAVITY = (10.0, 30.0, 100.0)  # share of gravity over that of energy: 9.81 m/s2 over the length of an arm, or more
NOISE = np.logspace(-6.0, 5.0, 34)  # power of the noise over that of a term, among which the evidence decides
TOGETHER = 3.0  # samples of the pass band that hang together (assumed)
RIGID = 3  # columns of what a joint has by itself: inertia and gravity


@dataclass(frozen=True)
class Told:
    """What some rows tell of the terms.

    Attributes:
        shares: most probable ones, shape (t,)
        combinations: of terms that the rows tell, the surest first, a column each, shape (t, k)
        rest: what is left of the shares beside these combinations, shape (t,)
        scatter: that shares were expected to have, over the noise of a sample, shape (t,)
    """

    shares: Array
    combinations: Array
    rest: Array
    scatter: Array


@dataclass(frozen=True, eq=False)
class Shrunk:
    """All terms, with shares that are normal about zero.

    Attributes:
        torque: shape (n,)
        base: columns of what every joint has, shape (n, b)
        columns: of the terms, shape (n, t)
        expected: relative scatter of their shares, shape (t,)
        is_energy: which of them are of the energy, the others of gravity, shape (t,)
    """

    torque: Array
    base: Array
    columns: Array
    expected: Array
    is_energy: NDArray[np.bool_]

    def beside_base(self, columns: Array) -> Shrunk:
        """The same torque by the base and columns that are as sure as it, and no terms."""
        none = self.columns[:, :0]
        return Shrunk(self.torque, np.column_stack([self.base, columns]), none, self.expected[:0], self.is_energy[:0])

    def told(self, rows: NDArray[np.bool_]) -> Told:
        """What rows tell, with the scatter of the shares that their evidence speaks for most."""
        torque, without_base = _without(self.base[rows], self.torque[rows])
        found = []
        for gravity in GRAVITY:
            scatter = self.expected * np.where(self.is_energy, 1.0, gravity)
            left, sizes, right = np.linalg.svd(without_base(self.columns[rows] * scatter), full_matrices=False)
            seen = left.T @ torque
            beside = float(torque @ torque - seen @ seen)
            evidence = [_evidence(seen, sizes, beside, noise, len(torque)) for noise in NOISE]
            best = int(np.argmax(evidence))
            found.append((evidence[best], NOISE[best], scatter, seen, sizes, right))
        _, noise, scatter, seen, sizes, right = max(found, key=lambda each: each[0])
        gain = sizes**2 / (sizes**2 + noise)
        directions = scatter[:, np.newaxis] * right.T
        along = gain * seen / np.maximum(sizes, 1e-300)
        free = np.flatnonzero(gain > TOLD)[:MOST]
        held = np.delete(np.arange(len(sizes)), free)
        return Told(directions @ along, directions[:, free], directions[:, held] @ along[held], scatter / np.sqrt(noise))

    def error(self, rows: NDArray[np.bool_], checks: Sequence[NDArray[np.bool_]], scatter: Array) -> float:
        """Error of each part that checks, by what the other rows tell, over how much the torque varies.

        Args:
            rows: all of them
            checks: parts of these
            scatter: of the shares over the noise, shape (t,)
        """
        left = []
        for check in checks:
            train = rows & ~check
            torque, without_base = _without(self.base[train], self.torque[train])
            scaled = without_base(self.columns[train] * scatter)
            along = np.linalg.solve(scaled @ scaled.T + np.eye(len(torque)), torque)
            by_terms = self.columns @ (scatter * (scaled.T @ along))
            by_itself = self.base[check] @ shares_of(self.base[train], (self.torque - by_terms)[train])
            left.append(self.torque[check] - by_terms[check] - by_itself)
        return float(np.sqrt(np.mean(np.concatenate(left) ** 2)) / np.std(self.torque))

    def transmitted(self, rows: NDArray[np.bool_]) -> Array:
        """Size of the torque without friction, of which some is lost, shape (n,)."""
        by_terms = self.columns @ self.told(rows).shares
        own = shares_of(self.base[rows], (self.torque - by_terms)[rows])
        return np.asarray(np.abs(self.base[:, :RIGID] @ own[:RIGID] + by_terms))


def _without(base: Array, torque: Array) -> tuple[Array, Callable[[Array], Array]]:
    """What a base does not explain of a torque, and the function that takes the base out of columns."""
    orthogonal, _ = np.linalg.qr(base)

    def without(columns: Array) -> Array:
        found: Array = columns - orthogonal @ (orthogonal.T @ columns)
        return found

    return without(torque), without


def _evidence(seen: Array, sizes: Array, beside: float, noise: float, rows: int) -> float:
    """Logarithm of the probability of a torque, but for a constant, with the most probable power of its noise.

    Args:
        seen: the torque along each combination, shape (k,)
        sizes: of the combinations, shape (k,)
        beside: square of the torque that no combination makes
        noise: power of the noise over that of a share
        rows: samples
    """
    square = (float(np.sum(seen**2 * noise / (sizes**2 + noise))) + beside) / TOGETHER
    counted = rows / TOGETHER
    return float(-0.5 * (counted * np.log(square / counted) + np.sum(np.log1p(sizes**2 / noise))))


def shares_of(columns: Array, torque: Array) -> Array:
    """By least squares."""
    size = np.linalg.norm(columns, axis=0)
    size[size == 0.0] = 1.0
    found: Array = np.linalg.lstsq(columns / size, torque, rcond=1e-8)[0] / size
    return found
