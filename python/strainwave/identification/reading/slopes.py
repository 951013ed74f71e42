"""Slopes of angles, compared with the speeds in the same record."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

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
