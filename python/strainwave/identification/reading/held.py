"""Angles that hold each value for several rows, as a bus that is slower than the recorder leaves them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rows = NDArray[np.int64]

MIN_HELD = 3  # rows with one value
MIN_CHANGES = 20  # of the value that show it
MIN_STEPS = 3.0  # smallest steps: an encoder that moves further between renewals is not waiting for its next step
MAX_JITTER = 1  # rows, by which most renewals may come early or late
MIN_REGULAR = 0.8  # of the renewals


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
    ends = np.array([*changes, len(angle)])
    begins = np.concatenate([[max(changes[0] - held * (changes[0] // held), 0)], changes])
    starts = [np.arange(begin, end, held) for begin, end in zip(begins, ends, strict=True)]
    rows = np.concatenate(starts)
    return rows[np.diff(rows, prepend=-held) > held // 2], held
