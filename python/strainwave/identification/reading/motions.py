"""Motions that determine the kind of a measurement: at rest, until it breaks away, or steady at one speed after another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave.analysis.branches import turning_points
from strainwave.identification.reading.angles import jumps
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.mapping import FileMapping

Array = NDArray[np.float64]

MIN_RATIO = 2.0  # of a gear
MAX_PRESLIDING = 0.05  # rad of the input: what moves to and fro by less has not slid far, and hardly twists the gear
MAX_SPEED_AT_REST = 0.02  # of the largest speed
MIN_LOAD = 0.1  # of the largest torque
MIN_TIME_AT_REST = 0.5  # of the time under load, while ramps rise
MIN_CORRELATION = 0.9  # of a ramp with time
MOTIONS = 500  # over which a record is divided
MIN_ROWS, MIN_ROWS_OF_RAMP = 100, 10
MAX_CHANGE = 0.05  # of the speed within a stretch
MIN_ROWS_OF_STRETCH = 50  # at one speed
MAX_NOISE = 2.0  # median deviations of the speed between medians of rows beside: 4 standard deviations of these
ROWS_OF_CHANGE = 10  # over which a change is computed


def at_rest(columns: Sequence[Column], mapping: FileMapping) -> str | None:
    """Return the kind of measurement at rest that a torque or current beside one angle looks like; None if it does not."""
    angle, effort = _one(columns, "angle"), _one(columns, "torque") or _one(columns, "current")
    if angle is None or effort is None:
        return None
    is_geared = mapping.constants.get("ratio", np.inf) >= MIN_RATIO  # without a gear, motion of the output twists none
    side = mapping.side or angle.channel.side
    at_output = is_geared and (angle.robot or "output" in (angle.channel.side, mapping.side))
    is_known = side is not None or not is_geared
    if is_known and not at_output and np.ptp(angle.si) <= MAX_PRESLIDING and len(turning_points(angle.si)) >= 2:
        return "presliding"
    time = next((column for column in columns if column.channel.quantity == "time"), None)
    return "breakaway" if time is not None and _ramps(time.si, angle.si, effort.si) else None


def _one(columns: Sequence[Column], quantity: str) -> Column | None:
    """Return the column of a quantity, of the input if there are several; None if it is not one."""
    found = [column for column in columns if column.channel.quantity == quantity and column.channel.measured]
    own = [column for column in found if column.channel.side == "input"] or found
    return own[0] if len(own) == 1 else None


def _ramps(time: Array, angle: Array, effort: Array) -> bool:
    """True if the torque rises while the shaft rests, most of the time under load."""
    if len(time) < MIN_ROWS or not np.isfinite(time + angle + effort).all():
        return False
    apart = max(len(time) // MOTIONS, 1)
    for row in jumps(angle, time):
        angle = np.concatenate([angle[:row], angle[row:] - (angle[row] - angle[row - 1])])
    moved, size = np.abs(angle[apart:] - angle[:-apart]), np.abs(effort[apart:])
    loaded, resting = size > MIN_LOAD * size.max(), moved <= MAX_SPEED_AT_REST * moved.max()
    if not moved.max() > 0.0:
        return False
    ramps = [size[rows] for rows in _runs_of(loaded & resting, MIN_ROWS_OF_RAMP)]
    rising = [
        len(ramp) for ramp in ramps if np.ptp(ramp) > 0.0 and np.corrcoef(np.arange(len(ramp)), ramp)[0, 1] > MIN_CORRELATION
    ]
    return sum(rising) > MIN_TIME_AT_REST * float(loaded.sum())


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
    return _runs_of((change < np.maximum(MAX_CHANGE * np.abs(smooth), noise)) & is_moving, MIN_ROWS_OF_STRETCH)


def averaged(columns: Mapping[str, Column], parts: Sequence[slice]) -> dict[str, Column]:
    """Return columns whose rows are the means of stretches."""
    means = {name: np.array([float(column.si[part].mean()) for part in parts]) for name, column in columns.items()}
    return {name: replace(column, si=means[name]) for name, column in columns.items()}


def _runs_of(wanted: NDArray[np.bool_], min_rows: int) -> list[slice]:
    """Return the stretches of rows that are wanted, those of at least so many rows."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], wanted, [False]]).astype(int)))
    return [slice(int(a), int(b)) for a, b in edges.reshape(-1, 2) if b - a >= min_rows]
