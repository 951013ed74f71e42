"""Motions and torques of a drive with their sides: by their names, by their sizes, and by the other columns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import Side
from strainwave.identification.reading.roles import (
    MIN_FACTOR_OF_SIDES,
    Column,
    measured,
    names_of,
    put,
    side_of_motion,
    side_of_torque,
    sides_of_angles,
    sides_of_torques,
)
from strainwave.messages import as_option
from strainwave.questions import QuestionError

Array = NDArray[np.float64]

MAX_REFLECTED = 0.1  # relative difference of a motion of the input from that of the output, if it is divided by the ratio
MAX_REFLECTED_RANGE = 2.0 * np.pi  # rad, rad/s: a motor that moves less, without an encoder of the joint, is counted there


def put_sided(
    found: dict[str, Column], columns: Sequence[Column], torques: Sequence[Column], mapping: FileMapping
) -> tuple[set[Side], list[str]]:
    """Add motions and torques of a log with their sides; return the sides that move, and what determines them."""
    motions, why = _of_both_shafts([*measured(columns, "angle"), *measured(columns, "speed")])
    if not motions:
        raise QuestionError(f"a log needs an angle or a speed; it has {names_of(columns)}")
    sides: set[Side] = set()
    for column in motions:
        side, why_side = side_of_motion(column, (*motions, *torques), found.get("time"), mapping.side)
        sides.add(side)
        why.append(why_side)
        put(found, f"{'reflected' if column.channel.reflected else side}_{column.channel.quantity}", column)
    why += _reflect(found, mapping)
    if len(torques) > 1 and not any(column.by_user or column.channel.side for column in torques):
        raise QuestionError(f"each of {names_of(torques)} may be the torque", sides_of_torques(torques))
    for column in torques:
        side, why_side = side_of_torque(column, sides, mapping.side)
        why.append(why_side)
        put(found, "joint_torque" if side == "output" else "input_torque", column)
    return sides, [each for each in why if each]


def _of_both_shafts(motions: Sequence[Column]) -> tuple[list[Column], list[str]]:
    """Return the motions, with the sides of two whose names contain none by their sizes; and what determines them."""
    found, why = list(motions), list[str]()
    for quantity in ("angle", "speed"):
        both = [column for column in found if column.channel.quantity == quantity]
        is_open = [column.channel.side is None for column in both]
        small, large = sorted(float(np.ptp(column.si)) for column in both) if len(both) == 2 else (0.0, 0.0)
        if len(both) == 2 and (all(is_open) or (any(is_open) and large > MIN_FACTOR_OF_SIDES * small > 0.0)):
            fast, slow, why_side = sides_of_angles(both)
            sides: tuple[tuple[Column, Side], ...] = ((fast, "input"), (slow, "output"))
            for column, side in sides:
                found[found.index(column)] = replace(column, channel=column.channel._replace(side=side))
            why.append(why_side)
        elif len(both) == 2 and any(is_open) and not all(is_open) and _are_apart(both):
            named, other = both if is_open[1] else both[::-1]
            of_other: Side = "output" if named.channel.side == "input" else "input"
            found[found.index(other)] = replace(other, channel=other.channel._replace(side=of_other))
            why.append(f"{other.name} is recorded with {named.name}, from which it differs: it is that of the {of_other}")
    return found, why


def _are_apart(both: Sequence[Column]) -> bool:
    """True for two motions that are alike, but not the same."""
    first, second = (column.si for column in both)
    return bool(np.nanmax(np.abs(first - second)) > 0.0) and abs(_slope(first, second) - 1.0) < MAX_REFLECTED


@np.errstate(all="ignore")
def _slope(motion: Array, other: Array) -> float:
    return abs(float(np.cov(motion, other)[0, 1] / np.var(other, ddof=1)))


@np.errstate(all="ignore")
def _reflect(found: dict[str, Column], mapping: FileMapping) -> list[str]:
    """Rename motions of the input that are as large as those of a joint, as they are divided by the ratio."""
    if abs(abs(mapping.constants.get("ratio", np.inf)) - 1.0) < MAX_REFLECTED:
        return []
    why = []
    for quantity in ("angle", "speed"):
        motor, joint = found.get(f"input_{quantity}"), found.get(f"output_{quantity}")
        if motor is None or joint is None:
            continue
        if not np.ptp(joint.si) > 0.0:
            del found[f"output_{quantity}"]
            why.append(f"{joint.name} never changes, as of an encoder that is not there: it is left out")
            if np.ptp(motor.si) < MAX_REFLECTED_RANGE and not motor.by_user:
                found[f"reflected_{quantity}"] = found.pop(f"input_{quantity}")
                moves = f"{motor.name} moves no further than a joint: it is taken as divided by the ratio"
                why.append(f"{moves}; otherwise add {as_option('column', f'input_{quantity}', motor.name)}")
            continue
        if abs(_slope(motor.si, joint.si) - 1.0) < MAX_REFLECTED:
            found[f"reflected_{quantity}"] = found.pop(f"input_{quantity}")
            why.append(f"{motor.name} moves as far as {joint.name}: it is the {quantity} of the motor divided by the ratio")
    return why
