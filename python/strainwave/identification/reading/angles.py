"""Angles as encoders and buses record them: begun anew with each revolution, or held for several rows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rows = NDArray[np.int64]

MIN_WRAP = 0.75  # of a revolution: a larger jump is a wrap
MAX_CLEAR_STEP = 0.5  # of a revolution: larger steps that are no wrap leave the direction open
MIN_SHARE_OF_WRAPS = 0.9  # of the steps by more than half a revolution, of an angle that wraps
MAX_RANGE = 1.01  # revolutions: an angle that covers more does not wrap
MIN_JUMP = 0.01  # of the range of an angle: smaller steps are none from one recording to another
MIN_FACTOR_OF_JUMP = 5.0  # of the fastest motion, and of the neighbouring steps: no shaft moves so for one row
MAX_JUMPS = 10  # of a record: the fastest motion is that of the rows after these
MIN_HELD = 3  # rows with one value
MIN_CHANGES = 20  # of the value
MIN_STEPS_OF_MOTION = 3.0  # smallest steps: an encoder that moves further between renewals is not waiting for its next step
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
    large = np.abs(steps) > MAX_CLEAR_STEP * period
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
def jumps(angle: Array, time: Array, speed: Array | None = None) -> Rows:
    """Return the rows behind a jump of an angle to another place, further than a shaft moves from row to row.

    An angle that comes back within a row is an outlier, and no jump.

    Args:
        angle: of a shaft that runs on, shape (n,)
        time: of each row, shape (n,)
        speed: as it was measured, shape (n,); that of the angle if not given

    >>> angle = np.concatenate([np.sin(np.arange(100) / 10.0), 5.0 + np.sin(np.arange(50) / 10.0)])
    >>> jumps(angle, np.arange(150.0)).tolist()
    [100]
    """
    steps, elapsed = np.diff(angle), np.diff(time)
    rates = np.abs(steps) / np.where(elapsed > 0.0, elapsed, np.inf)
    if len(steps) < MIN_CHANGES + MAX_JUMPS or not rates.max() > 0.0:
        return np.zeros(0, np.int64)
    fastest = float(np.sort(rates)[-1 - MAX_JUMPS]) if speed is None else float(np.nanmax(np.abs(speed)))
    neighbours = np.maximum(np.concatenate([[0.0], rates[:-1]]), np.concatenate([rates[1:], [0.0]]))
    is_alone = rates > MIN_FACTOR_OF_JUMP * np.maximum(neighbours, fastest)
    return np.flatnonzero(is_alone & (np.abs(steps) > MIN_JUMP * np.ptp(angle))) + 1


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
    fast = np.flatnonzero(sizes[1:] > MIN_STEPS_OF_MOTION * np.quantile(sizes, 0.01)) + 1
    if len(fast) < MIN_CHANGES:
        return None
    intervals = changes[fast] - changes[fast - 1]
    held = int(np.median(intervals))
    if held < MIN_HELD or np.mean(np.abs(intervals - held) <= MAX_JITTER) < MIN_REGULAR:
        return None
    begins = [changes[0] % held, *changes]
    rows = np.concatenate([np.arange(begin, end, held) for begin, end in zip(begins, [*changes, len(angle)], strict=True)])
    return rows[np.diff(rows, prepend=-held) > held // 2], held
