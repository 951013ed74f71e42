"""The joints of a file: those that move, and the one that is asked for or named."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from strainwave.files.labels import ColumnSource
from strainwave.files.table_format import OpenTable
from strainwave.identification.reading.columns import by_name, which_joint
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import Channel, joint_in, which_of, words_of
from strainwave.identification.reading.source import MeasurementFile, measurement_file
from strainwave.messages import listed, one_line

if TYPE_CHECKING:
    from strainwave.identification.reading.recognise import Recognised

MIN_SHARE_OF_MOTION = 0.01  # of how far the joint moves that moves most: others that move by less rest


def moving_joints(table: OpenTable, mapping: FileMapping) -> list[str]:
    """Return the joints whose angles change, of a file with several of which a person named none."""
    spans = spans_of_joints(table, mapping)
    least = MIN_SHARE_OF_MOTION * max(spans.values(), default=0.0)
    return [which for which, span in spans.items() if span > 0.0 and span >= least]


def spans_of_joints(table: OpenTable, mapping: FileMapping) -> dict[str, float]:
    """Return how far each joint moves, in its unit in the file, of a file with several of which a person named none."""
    if mapping.joint is not None or "output_angle" in mapping.columns or "input_angle" in mapping.columns:
        return {}
    groups = dict[Channel, dict[str, int]]()
    for column in by_name(table, mapping):
        if column.channel.quantity == "angle" and column.channel.measured and column.which:
            angles = groups.setdefault(column.channel, {})
            if column.which in angles:
                return {}
            angles[column.which] = column.position
    angles = max(groups.values(), key=len, default={})
    if len(angles) < 2:
        return {}
    numbers, _ = table.measured([ColumnSource(place, which, which, "1") for which, place in angles.items()])
    return {which: float(np.ptp(there)) for which, each in numbers.items() if (there := each[np.isfinite(each)]).size}


def numbered_joint(table: OpenTable) -> list[str]:
    """Return the number of the joint that all angles have in their names, as q7; empty if they have none, or several."""
    joints = {column.which for column in by_name(table, FileMapping()) if column.channel.quantity == "angle"}
    return sorted(joints) if len(joints) == 1 and all(joint.isdigit() for joint in joints) else []


def joints_of(file: str | Path | MeasurementFile, mapping: FileMapping | None = None) -> tuple[str, ...]:
    """Return the joints that move in a file, by their names in it; the one that its columns or its own name contain.

    Args:
        file, mapping: as of `recognise`

    Raises:
        ValueError: the file cannot be read
    """
    source = measurement_file(file)
    moving, named = moving_joints(source.table, mapping or FileMapping()), joint_in(source.path)
    if named and (named in moving or not moving):
        return (named,)
    return tuple(moving or numbered_joint(source.table))


def check_one_joint(files: Sequence[Recognised]) -> None:
    """Refuse files of several joints, as each joint has a gear of its own.

    Raises:
        ValueError: the names of files or columns contain several numbers of joints
    """
    joints = dict[str, str]()
    for file in files:
        if file.joint.isdigit():
            joints.setdefault(file.joint, file.path.name)
    if len(joints) > 1:
        which = listed(f"{name} of joint {joint}" for joint, name in joints.items())
        raise which_joint(one_line(f"each joint has a gear of its own, but {which}"), sorted(joints))


def with_joint(source: MeasurementFile, mapping: FileMapping) -> tuple[FileMapping, list[str]]:
    """Return the mapping, with the joint in the name of the file, or the one that alone moves; and what determines it.

    Raises:
        ValueError: another joint is asked for than the one in the name of the file
    """
    moving, named = moving_joints(source.table, mapping), joint_in(source.path)
    of_another = mapping.joint is not None and named and (which_of(words_of(mapping.joint)) or mapping.joint) != named
    if of_another and not moving_joints(source.table, FileMapping()):
        raise ValueError(one_line(f"{source.table.file}: by its name it is of joint {named}, and not of joint {mapping.joint}"))
    if named in moving and len(moving) > 1:
        others = [joint for joint in moving if joint != named]
        return replace(mapping, joint=named), [
            f"joint {named} is taken, which its name contains, while {listed(others)} move too; "
            f"otherwise add --joint {others[0]}"
        ]
    if len(moving) == 1:
        return replace(mapping, joint=moving[0]), [f"joint {moving[0]} alone moves, and is taken"]
    return mapping, []
