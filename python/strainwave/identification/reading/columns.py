"""The columns of a file that seem to measure something, and which of several are taken."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import Source, places_of
from strainwave.files.tables import OpenTable
from strainwave.identification.reading.channels import ALIASES, CHANNELS, Channel
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.motor_effort import one_effort
from strainwave.identification.reading.names import meaning, which_of, words_of
from strainwave.identification.reading.sides import UndecidedError
from strainwave.messages import as_option, listed, one_line, quoted

Array = NDArray[np.float64]


STILL = 0.01  # of how far a joint moves, by which others move less that rest
SEVERAL = ("other_angles", "regressors")  # as what a person names several columns
ALIKE = (("angle", "speed"), ("torque", "current", "voltage"))  # of which a person names what is needed of one joint
MEASURED = {"act", "actual", "meas", "measured", "ist", "istwert", "msr"}  # words of what was measured
FIRST = ("time", "temperature")  # of which the first column is taken, where a file has several


def chosen(table: OpenTable, mapping: FileMapping) -> tuple[list[Column], list[str]]:
    """The columns that mean something, one for each channel: those that a person named, and those whose names tell.

    Where a person says the rate of the rows, a column of time is taken only if the person names it.

    Returns:
        the columns, and what was decided between duplicates
    """
    said = _said(table, mapping)
    told = _of_one_time(_told(table, mapping, said))
    own, remarks = one_effort(told if mapping.joint is not None else _beside(said, told))
    found = said + _of_one_joint(table, own, mapping)
    names = {column.name for column in found}
    return found, [remark for name, remark in remarks if name in names]


def _beside(said: Sequence[Column], told: Sequence[Column]) -> list[Column]:
    """Those columns that stand beside what a person named, without several joints that move, or tell a torque, as that does."""
    named = {place for place, group in enumerate(ALIKE) for column in said if column.channel.quantity in group and column.own}
    return [
        column
        for column in told
        if not any(
            place in named and column.channel.quantity in group and sum(each.channel == column.channel for each in told) > 1
            for place, group in enumerate(ALIKE)
        )
    ]


def _told(table: OpenTable, mapping: FileMapping, said: Sequence[Column] = ()) -> list[Column]:
    """The columns whose names tell, but for channels that a person named."""
    taken = {column.position for column in said}
    told = []
    for position, (label, content) in enumerate(zip(table.labels, table.contents, strict=True)):
        if content == "other" or position in taken:
            continue
        found = meaning(label._replace(unit=None) if label.name in mapping.units else label)
        if found is None or (content == "dates" and found.quantity != "time"):
            continue
        if found.quantity == "time" and "rate" in mapping.constants:
            continue
        sided = found.quantity in ("angle", "speed", "torque") and not found.commanded
        channel = Channel(found.quantity, found.side if sided else None, found.commanded)
        if not any(column.channel == channel and column.own for column in said):
            unit = "s" if content == "dates" else found.unit or label.unit or None
            told.append(Column(position, label, channel, found.which, found.robot, unit=unit, estimated=found.estimated))
    return _numbered_apart(_without_estimates(_of_measured_structure(told)))


def _of_measured_structure(columns: Sequence[Column]) -> list[Column]:
    """The columns; of a channel in several structures those of the ones with names for what was measured, as `rec.act_pos`."""
    measured = {_structure(column) for column in columns if set(words_of(column.name)) & MEASURED}
    channels = {column.channel for column in columns if _structure(column) in measured}
    return [column for column in columns if _structure(column) in measured or column.channel not in channels]


def _structure(column: Column) -> str:
    return re.sub(r"\d+", "", column.name.rpartition(".")[0])


def _without_estimates(columns: Sequence[Column]) -> list[Column]:
    """The columns without estimates of what another one contains."""
    own = {(column.channel, column.which) for column in columns if not column.estimated}
    return [column for column in columns if not column.estimated or (column.channel, column.which) not in own]


def _numbered_apart(columns: Sequence[Column]) -> list[Column]:
    """The columns, without those numbers in their names that all of one channel have: of the robot, and of no joint."""
    groups: dict[Channel, list[list[str]]] = {}
    for column in columns:
        groups.setdefault(column.channel, []).append(column.which.split("."))
    differing = {channel: _differing(group) for channel, group in groups.items()}
    found = []
    for column in columns:
        parts = column.which.split(".")
        own = [parts[place] for place in differing[column.channel]]
        found.append(replace(column, which=".".join(own)) if own else column)
    return found


def _differing(group: Sequence[Sequence[str]]) -> list[int]:
    """Which parts of names of numbers are not the same in all of them; none if the names are not of one form."""
    if len(group) < 2 or not all(len(each) == len(group[0]) and "".join(each).isdigit() for each in group):
        return []
    return [place for place, parts in enumerate(zip(*group, strict=True)) if len(set(parts)) > 1]


def _of_one_time(columns: Sequence[Column]) -> list[Column]:
    """The columns with one time: the first whose name says nothing else, or the first."""
    times = [column for column in columns if column.channel.quantity == "time"]
    taken = next((column for column in times if not column.which), times[0] if times else None)
    return [
        replace(column, which="") if column is taken else column for column in columns if column not in times or column is taken
    ]


def moving_joints(table: OpenTable, mapping: FileMapping) -> list[str]:
    """The joints whose angles change, of a file with several of which a person named none."""
    if mapping.joint is not None or "output_angle" in mapping.columns or "input_angle" in mapping.columns:
        return []
    groups = dict[Channel, dict[str, int]]()
    for column in _told(table, mapping):
        if column.channel.quantity == "angle" and column.channel.measured and column.which:
            angles = groups.setdefault(column.channel, {})
            if column.which in angles:
                return []
            angles[column.which] = column.position
    angles = max(groups.values(), key=len, default={})
    if len(angles) < 2:
        return []
    numbers, _ = table.measured([Source(place, which, which, "1") for which, place in angles.items()])
    finite = {which: values[np.isfinite(values)] for which, values in numbers.items()}
    spans = {which: float(np.ptp(values)) for which, values in finite.items() if values.size}
    least = STILL * max(spans.values(), default=0.0)
    return [which for which, span in spans.items() if span > 0.0 and span >= least]


def _said(table: OpenTable, mapping: FileMapping) -> list[Column]:
    """The columns that a person named."""
    found = []
    each = [(name, wanted) for name, wanted in mapping.columns.items() if name not in SEVERAL]
    for name in SEVERAL:
        each += [(name, wanted.strip()) for wanted in mapping.columns.get(name, "").split(",") if wanted.strip()]
    for name, wanted in each:
        channel = CHANNELS[ALIASES.get(name, name)]
        places = places_of(table.labels, wanted) or _of_joint(table, wanted, mapping.joint)
        if len(places) > 1 and mapping.joint is None and (joints := _numbers_of_joints(table, places)):
            which = f"it holds {len(joints)} joints ({listed(joints)}), as {table.labels[places[0]].name}"
            question = f"{which}; say which with --joint {joints[0]} or --joint all"
            raise UndecidedError(question, (), f"--joint {joints[0]}", FileMapping(joint=joints[0]))
        if len(places) != 1:
            fault = f"has {len(places)} columns" if places else "has no column"
            there = listed(label.name for label in table.labels)
            raise ValueError(one_line(f"{table.file} {fault} {quoted(wanted)} to be the {name}; it has {there}"))
        label = table.labels[places[0]]
        told = meaning(label)
        unit = label.unit or (told.unit if told and told.quantity == channel.quantity else None) or None
        unit = "s" if table.contents[places[0]] == "dates" else unit
        which = (told.which if told else "") or str(places[0] + 1)
        neighbour, regressor = name == "other_angles", name == "regressors"
        unit = channel.unit if name == "regressors" else unit  # of a regressor any unit is that of torque over its share's
        kept = which if neighbour else ""
        found.append(Column(places[0], label, channel, kept, by_user=True, neighbour=neighbour, regressor=regressor, unit=unit))
    return found


def _numbers_of_joints(table: OpenTable, places: Sequence[int]) -> list[str]:
    """The numbers behind the names of columns that are one for each joint; empty if they are not."""
    found = [match[0] if (match := re.search(r"\d+$", table.labels[place].name)) else "" for place in places]
    return found if all(found) and len(set(found)) == len(found) else []


def _of_joint(table: OpenTable, wanted: str, joint: str | None) -> list[int]:
    """Places of the columns of a joint whose name begins so, as `Cur` for `Cur4` or `block3` for `block3_4`; of all if None."""
    number = r"\d+" if joint is None else f"0*{re.escape(which_of(words_of(joint)) or joint)}"
    name = re.compile(rf"{re.escape(wanted)}[_.]?{number}")
    places = [place for place, label in enumerate(table.labels) if name.fullmatch(label.name)]
    return places if joint is not None or len(places) > 1 else []


def _of_one_joint(table: OpenTable, columns: Sequence[Column], mapping: FileMapping) -> list[Column]:
    """One column for each channel: those of the joint that is asked for, or the one whose name says nothing else.

    Where no name says a joint, they are those of the one that is asked for.
    """
    groups: dict[Channel, list[Column]] = {}
    for column in columns:
        groups.setdefault(column.channel, []).append(column)
    several = [group for group in groups.values() if len(group) > 1]
    joints = list(dict.fromkeys(column.which for group in several for column in group if column.which))
    known = joints or list(dict.fromkeys(column.which for column in columns if column.which))
    if mapping.joint is not None and known:
        joint = mapping.joint if mapping.joint in known else which_of(words_of(mapping.joint))  # J3 is joint 3
        if joint not in known:
            raise ValueError(one_line(f"{table.file} has no joint {quoted(mapping.joint)}; it has {listed(known)}"))
        several_joints = len(known) > 1
        own = [
            replace(column, robot=column.robot or (several_joints and column.which == joint))
            for column in columns
            if column.which in ("", joint) or column.which not in known
        ]
        angle = next((column for column in own if column.channel.quantity == "angle" and column.which == joint), None)
        return own + [
            replace(column, neighbour=True)
            for column in columns
            if angle is not None and column.which in known and column.which != joint and column.channel == angle.channel
        ]
    if len(several) == 1 and _are_two_encoders(columns, several[0]):
        return list(columns)
    taken = []
    for group in groups.values():
        plain = [column for column in group if not column.which] if len(group) > 1 else group
        if _may_be_of_both_shafts(plain):
            taken += plain
            continue
        if plain and plain[0].channel.quantity in FIRST:
            plain = plain[:1]
        if len(plain) != 1:
            raise _choice(group, joints)
        taken += plain
    return taken


def _may_be_of_both_shafts(group: Sequence[Column]) -> bool:
    """Whether two angles or two speeds may be those of input and output, which their sizes tell."""
    channel = group[0].channel if group else Channel("time")
    return len(group) == 2 and channel.quantity in ("angle", "speed") and channel.side is None and channel.measured


def _are_two_encoders(columns: Sequence[Column], group: Sequence[Column]) -> bool:
    """Whether two angles are those of input and output: nothing else is measured beside them but time."""
    others = {column.channel.quantity for column in columns} - {"time", "temperature"}
    return len(group) == 2 and others == {"angle"}


def _choice(group: Sequence[Column], joints: Sequence[str]) -> UndecidedError:
    """The question which of several columns is meant."""
    channel = group[0].channel
    name = "command" if channel.commanded else "_".join(filter(None, (channel.side, channel.quantity)))
    side = "output" if channel.side == "output" or group[0].robot or len(joints) > 1 else "input"
    wanted = {"output_torque": "joint_torque", "angle": f"{side}_angle", "speed": f"{side}_speed"}.get(name, name)
    option = as_option("column", wanted, group[0].name)
    if len({column.which for column in group}) == len(group) and len(joints) > 1:
        few = listed(column.name for column in group[:2]) + (" …" if len(group) > 2 else "")
        which = f"it holds {len(joints)} joints ({listed(joints)}), as {few}"
        ways = f"--joint {joints[0]} or --joint all, or name columns, as {option}"
        return UndecidedError(f"{which}; say which with {ways}", (), f"--joint {joints[0]}", FileMapping(joint=joints[0]))
    names = listed(column.name for column in group)
    return UndecidedError(f"each of {names} may be the {name}; say which, as with {option}", (), option)
