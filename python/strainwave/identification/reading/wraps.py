"""Angles of encoders that begin anew with each revolution."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

WHOLE = 0.75  # of a revolution: a jump by more is a wrap
HALF = 0.5  # of a revolution: steps by more, that are no jump by a whole one, do not tell which way the shaft went
CLEAR = 0.9  # of the steps by more than half a revolution that must be wraps, so that an angle is one that wraps
BEYOND = 1.01  # revolutions: an angle that covers more does not wrap


def unwrapped(angle: Array, period: float = 2.0 * np.pi) -> tuple[Array, int]:
    """An angle that runs on, and how often it wrapped; the angle itself where it does not wrap.

    An angle wraps where it stays within one revolution and jumps by nearly a whole one from sample to sample. A shaft that
    turns by more than a quarter of a revolution between samples cannot be told from one that turns back.

    Args:
        angle: in the unit of `period`, shape (n,)
        period: after which it begins anew

    Raises:
        ValueError: the steps are too large to tell which way the shaft went

    >>> unwrapped(np.array([350.0, 358.0, 6.0, 358.0]), 360.0)
    (array([350., 358., 366., 358.]), 2)
    """
    steps = np.diff(angle)
    large = np.abs(steps) > HALF * period
    if not large.any() or not WHOLE * period < np.ptp(angle) <= BEYOND * period:
        return angle, 0
    whole = np.abs(steps) > WHOLE * period
    if whole.sum() < CLEAR * large.sum():
        raise ValueError(
            f"stays within one revolution, and {int(large.sum())} of its steps are more than a half of one: if it begins anew "
            "with each revolution, it cannot be told which way the shaft went; record it more often"
        )
    turns = np.concatenate([[0.0], np.cumsum(np.where(whole, -np.sign(steps), 0.0))])
    return angle + period * turns, int(whole.sum())
