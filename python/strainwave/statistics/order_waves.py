"""Waves of orders over an angle as columns of a linear fit, and the amplitudes and phases of their coefficients.

An order is a number of cycles in each revolution of the angle. The wave of one with amplitude A and phase φ is
A sin(order · angle + φ) = A cos φ sin(order · angle) + A sin φ cos(order · angle).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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
