"""Angles as encoders and buses record them: begun anew with each revolution, or held for several rows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rows = NDArray[np.int64]

MIN_WRAP = 0.75  # of a revolution: a larger jump is a wrap
MAX_STEP = 0.5  # of a revolution: larger steps that are no wrap leave the direction open
MIN_SHARE_OF_WRAPS = 0.9  # of the steps by more than half a revolution, of an angle that wraps
MAX_RANGE = 1.01  # revolutions: an angle that covers more does not wrap
MIN_HELD = 3  # rows with one value
MIN_CHANGES = 20  # of the value
MIN_STEPS = 3.0  # smallest steps: an encoder that moves further between renewals is not waiting for its next step
MAX_JITTER = 1  # rows by which most renewals come early or late
MIN_REGULAR = 0.8  # of the renewals


def unwrapped(angle: Array, period: float = 2.0 * np.pi) -> tuple[Array, int]:
    """Return an angle that runs on, and how often it wrapped; the angle itself if it does not wrap.

    An angle wraps if it stays within one revolution and jumps by nearly a whole one from sample to sample. A shaft that
    turns by more than a quarter of a revolution between samples looks like one that turns back.

    Args:
        angle: in the unit of `period`, shape (n,)
        period: after which it begins anew

    Raises:
        ValueError: the steps are so large that they do not show the direction

    >>> unwrapped(np.array([350.0, 358.0, 6.0, 358.0]), 360.0)
    (array([350., 358., 366., 358.]), 2)
    """
    steps = np.diff(angle)
    large = np.abs(steps) > MAX_STEP * period
    if not large.any() or not MIN_WRAP * period < np.ptp(angle) <= MAX_RANGE * period:
        return angle, 0
    whole = np.abs(steps) > MIN_WRAP * period
    if whole.sum() < MIN_SHARE_OF_WRAPS * large.sum():
        raise ValueError(
            f"stays within one revolution, and {int(large.sum())} of its steps are more than a half of one: if it begins anew "
            "with each revolution, these do not show in which direction the shaft went; record it more often"
        )
    turns = np.concatenate([[0.0], np.cumsum(np.where(whole, -np.sign(steps), 0.0))])
    return angle + period * turns, int(whole.sum())


@np.errstate(all="ignore")
def renewed_rows(angle: Array) -> tuple[Rows, int] | None:
    """Return the rows in which an angle was renewed, and for how many rows it is held; None if each row is new.

    Where the shaft rests, rows at the same distance are taken.

    Args:
        angle: of a shaft, shape (n,)

    >>> slow = np.repeat(np.sin(np.arange(100) / 10.0), 15)
    >>> rows, held = renewed_rows(slow)
    >>> held, rows[:4].tolist()
    (15, [0, 15, 30, 45])
    """
    steps = np.diff(angle)
    changes = np.flatnonzero(steps) + 1
    if len(changes) < MIN_CHANGES:
        return None
    sizes = np.abs(steps[changes - 1])
    fast = np.flatnonzero(sizes[1:] > MIN_STEPS * np.quantile(sizes, 0.01)) + 1
    if len(fast) < MIN_CHANGES:
        return None
    intervals = changes[fast] - changes[fast - 1]
    held = int(np.median(intervals))
    if held < MIN_HELD or np.mean(np.abs(intervals - held) <= MAX_JITTER) < MIN_REGULAR:
        return None
    begins = [changes[0] % held, *changes]
    rows = np.concatenate([np.arange(begin, end, held) for begin, end in zip(begins, [*changes, len(angle)], strict=True)])
    return rows[np.diff(rows, prepend=-held) > held // 2], held
