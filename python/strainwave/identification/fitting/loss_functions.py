"""Costs of residuals in a fit: their square, or one that outliers pull little."""

from __future__ import annotations

from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from strainwave.statistics.scale import robust_sigma

Array = NDArray[np.float64]
LossName = Literal["linear", "soft_l1"]


class Loss(Protocol):
    """Cost of residuals, in units of their standard deviation; a fit minimises half of `cost(residual**2)`."""

    def sigma(self, residual: Array) -> Array:
        """Return the standard deviation of the noise, shape (channels, 1), from residuals, shape (channels, n)."""
        ...

    def cost(self, squares: Array) -> Array:
        """Return the cost over the square of a residual, and its first and second derivative, shape (3, n)."""
        ...


class Squared:
    """The square itself: best where noise is normal."""

    def sigma(self, residual: Array) -> Array:
        return np.asarray(np.sqrt(np.mean(residual**2, axis=1, keepdims=True)))

    def cost(self, squares: Array) -> Array:
        return np.stack((squares, np.ones_like(squares), np.zeros_like(squares)))


class SoftL1:
    """Like the square for residuals within their standard deviation, like the absolute value far beyond: outliers pull little.

    Cost 2 (sqrt(1 + z) - 1): Charbonnier et al., IEEE Trans. Image Process. 6 (1997) 298-311. The standard deviation is that of
    normal noise with the same median absolute value, which outliers hardly change (Hampel 1974).
    """

    def sigma(self, residual: Array) -> Array:
        return robust_sigma(residual, axis=1)[:, np.newaxis]

    def cost(self, squares: Array) -> Array:
        root = np.sqrt(1.0 + squares)
        return np.stack((2.0 * (root - 1.0), 1.0 / root, -0.5 / root**3))


LOSSES: dict[LossName, Loss] = {"linear": Squared(), "soft_l1": SoftL1()}


def slope(loss: Loss, residual: Array) -> Array:
    """Return the derivative of half the cost by the residual."""
    return np.asarray(residual * loss.cost(residual**2)[1])


def curvature(loss: Loss, residual: Array) -> Array:
    """Return the second derivative of half the cost by the residual."""
    _, first, second = loss.cost(residual**2)
    return np.asarray(first + 2.0 * residual**2 * second)
