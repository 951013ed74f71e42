"""Use of a gear in a run: the work that it transmits, and the revolutions of its output, both without sign."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def work_in(torque: Array, angle: Array) -> Array:
    """Return the work that a gear transmitted, ∫ |torque| |d angle| [J], by the trapezoidal rule, of shape (…).

    Args:
        torque, angle: of the output [N.m], [rad], shape (…, n); the angle must not wrap

    >>> float(work_in(np.array([10.0, 10.0, -10.0]), np.array([0.0, 0.5, 0.0])))
    10.0
    """
    load = np.abs(torque)
    return np.asarray(np.sum(0.5 * (load[..., 1:] + load[..., :-1]) * np.abs(np.diff(angle)), axis=-1))


def revolutions_in(angle: Array) -> Array:
    """Return the revolutions that a shaft turned, to and fro, of shape (…).

    Args:
        angle: [rad], shape (…, n)
    """
    return np.asarray(np.sum(np.abs(np.diff(angle)), axis=-1) / (2.0 * np.pi))
