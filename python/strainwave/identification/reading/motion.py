"""Motions as files have them: angles that begin anew, jump or are held, their slopes, and stretches at one speed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave.statistics.runs import runs_of

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
MIN_STEADY_SHARE = 0.5  # of the rows, that stretches of one speed fill; a record that has less is a log
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


# ---- Slopes ----------------------------------------------------------------------------------------------------------


PARTS_OF_RECORD = (5000, 200)  # of a record over which slopes are taken, the finest first: encoders have steps
MAX_SLOPE_STEP = 0.5  # of the range of an angle: a larger one is a revolution begun anew, and has no slope
MIN_SLOPES = 20  # a correlation of fewer may be chance
MIN_CORRELATION = 0.95  # of a speed and of the slope of its angle
MAX_OFF_SPEED = 0.15  # relative difference of a speed from the slope of its angle, in units that fit
MIN_EXPLAINED = 0.5  # of the squares of slopes and speeds: with less in common, one is not the other in another unit


@np.errstate(all="ignore")
def slopes_and_speeds(angle: Array, speed: Array, time: Array, parts: int) -> tuple[Array, Array]:
    """Return the slopes of an angle over this part of a record, and the speeds in the middle of each.

    Rows that do not lie after each other in time have none, and steps of an angle that begins anew with each revolution.

    Args:
        angle, speed, time: of a record, shape (n,) each
        parts: in how many the record is divided
    """
    apart = max(2, len(time) // parts)
    if len(time) <= apart:
        return np.zeros(0), np.zeros(0)
    elapsed, moved = time[apart:] - time[:-apart], angle[apart:] - angle[:-apart]
    middle = speed[apart // 2 : len(speed) - apart + apart // 2]
    sound = (elapsed > 0.0) & (np.abs(moved) < MAX_SLOPE_STEP * (np.nanmax(angle) - np.nanmin(angle))) & np.isfinite(middle)
    return moved[sound] / elapsed[sound], middle[sound]


@np.errstate(all="ignore")
def correlation(angle: Array, speed: Array, time: Array, parts: int) -> float:
    """Return the correlation of a speed with the slope of an angle [1]; 0 if one of them rests."""
    slopes, speeds = slopes_and_speeds(angle, speed, time, parts)
    if len(slopes) < MIN_SLOPES or not np.std(slopes) > 0.0 or not np.std(speeds) > 0.0:
        return 0.0
    return float(np.corrcoef(slopes, speeds)[0, 1])


@np.errstate(all="ignore")
def speed_per_slope(angle: Array, speed: Array, time: Array) -> float:
    """Return the speed per unit of the slope of an angle, by least squares; 0 if nothing moves, or they are not related."""
    for parts in PARTS_OF_RECORD:
        slopes, speeds = slopes_and_speeds(angle, speed, time, parts)
        square, product, largest = slopes @ slopes, slopes @ speeds, speeds @ speeds
        if 0.0 < square < np.inf and product**2 > MIN_EXPLAINED * square * largest:
            return float(product / square)
    return 0.0


def is_slope(speeds: Sequence[Array], angles: Sequence[Array]) -> bool:
    """True if series are the slopes of others over rows, of those that move."""
    pairs = [
        (angle, speed) for angle, speed in zip(angles, speeds, strict=False) if len(angle) == len(speed) and np.ptp(angle) > 0.0
    ]
    alike = [correlation(angle, speed, np.arange(len(angle), dtype=float), PARTS_OF_RECORD[0]) for angle, speed in pairs]
    return bool(alike) and float(np.median(alike)) > MIN_CORRELATION


# ---- Stretches -------------------------------------------------------------------------------------------------------


MAX_SPEED_AT_REST = 0.02  # of the largest speed
MAX_CHANGE = 0.05  # of the speed within a stretch
MIN_ROWS_OF_STRETCH = 50  # at one speed
MAX_NOISE = 2.0  # median deviations of the speed between medians of neighbouring rows: 4 standard deviations of these
ROWS_OF_CHANGE = 10  # over which a change is computed


def stretches(speed: Array) -> list[slice]:
    """Return the rows of each stretch of one speed, without its ends.

    >>> speed = np.repeat([0.0, 0.5, -0.5, 1.0], 200)
    >>> stretches(speed)
    [slice(210, 390, None), slice(410, 590, None), slice(610, 790, None)]
    """
    from scipy import ndimage

    apart = ROWS_OF_CHANGE
    smooth = ndimage.median_filter(speed, 2 * apart + 1, mode="nearest")
    change = np.full(len(speed), np.inf)
    change[apart:-apart] = np.abs(smooth[2 * apart :] - smooth[: -2 * apart])
    noise = MAX_NOISE * float(np.median(np.abs(speed - smooth)))
    is_moving = np.abs(smooth) > MAX_SPEED_AT_REST * np.abs(smooth).max()
    return runs_of((change < np.maximum(MAX_CHANGE * np.abs(smooth), noise)) & is_moving, MIN_ROWS_OF_STRETCH)


def fills_record(parts: Sequence[slice], rows: int) -> bool:
    """True for stretches that make up half of the rows of a record or more."""
    return bool(sum(part.stop - part.start for part in parts) >= MIN_STEADY_SHARE * rows)


def turns_steadily(angle: Array, speed: Array) -> bool:
    """True for a shaft that turns once or more in each of the stretches of one speed that a record consists of.

    >>> angle = np.concatenate([np.linspace(0.0, 20.0, 400), np.linspace(20.0, 0.0, 400)])
    >>> speed = np.repeat([2.0, -2.0], 400)
    >>> turns_steadily(angle, speed), turns_steadily(0.01 * angle, speed)
    (True, False)
    """
    parts = stretches(speed)
    ways = [abs(float(angle[part.stop - 1] - angle[part.start])) for part in parts]
    return fills_record(parts, len(speed)) and bool(min(ways) > 2.0 * np.pi)
