"""Whether a shaft was hardly moved or not at all while its torque changed: presliding loops and ramps until it breaks away."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave.analysis.branches import turning_points
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.mapping import FileMapping

Array = NDArray[np.float64]

MIN_RATIO = 2.0  # of a gear
SMALL = 0.05  # rad of the input: what moves to and fro by less has not slid far, and hardly twists the gear
RESTING = 0.02  # of the fastest motion: what is slower rests
LOADED = 0.1  # of the largest torque
MOSTLY = 0.5  # of the time under load in which a shaft rests while a ramp rises
RISING = 0.9  # correlation of a ramp with time
ROWS = 500  # over which a motion is looked for


def at_rest(columns: Sequence[Column], mapping: FileMapping) -> str | None:
    """A kind of measurement at rest, if a torque or current beside one angle looks like one."""
    angle, effort = _one(columns, ("angle",), mapping), _one(columns, ("torque", "current"), mapping)
    if angle is None or effort is None:
        return None
    geared = mapping.constants.get("ratio", np.inf) >= MIN_RATIO  # without a gear, motion of the output twists none
    output = geared and (angle.robot or angle.channel.side == "output" or mapping.side == "output")
    known = angle.channel.side or mapping.side or (None if geared else "output")
    if known is not None and not output and np.ptp(angle.si) <= SMALL and len(turning_points(angle.si)) >= 2:
        return "presliding"
    time = next((column for column in columns if column.channel.quantity == "time"), None)
    return "breakaway" if time is not None and _ramps(time.si, angle.si, effort.si) else None


def _one(columns: Sequence[Column], quantities: Sequence[str], mapping: FileMapping) -> Column | None:
    """The column of a quantity, of the input if there are several."""
    for quantity in quantities:
        found = [column for column in columns if column.channel.quantity == quantity and column.channel.measured]
        own = [column for column in found if column.channel.side == "input"] or found
        if len(own) == 1:
            return own[0]
    return None


def _ramps(time: Array, angle: Array, effort: Array) -> bool:
    """Whether the torque rises while the shaft rests, most of the time under load."""
    if len(time) < 2 * ROWS // 10 or not np.isfinite(time + angle + effort).all():
        return False
    apart = max(len(time) // ROWS, 1)
    moved = np.abs(angle[apart:] - angle[:-apart])
    size = np.abs(effort[apart:])
    loaded, resting = size > LOADED * size.max(), moved <= RESTING * moved.max()
    if not moved.max() > 0.0 or np.mean(resting[loaded]) < MOSTLY:
        return False
    edges = np.flatnonzero(np.diff(np.concatenate([[False], loaded & resting, [False]]).astype(int))).reshape(-1, 2)
    stretches = [slice(int(a), int(b)) for a, b in edges if b - a >= ROWS // 50]
    rises = [float(np.corrcoef(np.arange(len(size[each])), size[each])[0, 1]) for each in stretches if np.ptp(size[each]) > 0.0]
    return bool(rises) and float(np.median(rises)) > RISING
