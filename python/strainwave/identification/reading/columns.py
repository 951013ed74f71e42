"""The columns of a file that seem to measure something: which of several are taken, and their values in SI units."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import Source, places_of
from strainwave.files.tables import OpenTable
from strainwave.files.units import convert, counts, measures
from strainwave.identification.reading.apparent import apparent
from strainwave.identification.reading.channels import ALIASES, CHANNELS, Channel
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.missing_units import Assumed, missing_units
from strainwave.identification.reading.names import UNITS, meaning, which_of, words_of
from strainwave.messages import as_option, listed, one_line, quoted

Array = NDArray[np.float64]


FEW = 4  # names that are listed where none says anything
STILL = 0.01  # of how far a joint moves, by which others move less that rest
SEVERAL = ("other_angles", "regressors")  # as what a person names several columns
ALIKE = (("angle", "speed"), ("torque", "current", "voltage"))  # of which a person names what is needed of one joint
FIRST = ("time", "temperature")  # of which the first column is taken, where a file has several


def chosen(table: OpenTable, mapping: FileMapping) -> list[Column]:
    """The columns that mean something, one for each channel: those that a person named, and those whose names tell.

    Where a person says the rate of the rows, a column of time is taken only if the person names it.
    """
    said = _said(table, mapping)
    told = _of_one_time(_told(table, mapping, said))
    return said + _of_one_joint(table, told if mapping.joint is not None else _beside(said, told), mapping)


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
            told.append(Column(position, label, channel, found.which, found.robot, unit=unit))
    return _numbered_apart(told)


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
    angles: dict[str, int] = {}
    for column in _told(table, mapping):
        if column.channel.quantity == "angle" and column.channel.measured and column.which:
            if column.which in angles:
                return []
            angles[column.which] = column.position
    if len(angles) < 2:
        return []
    numbers, _ = table.measured([Source(place, which, which, "1") for which, place in angles.items()])
    spans = {
        which: float(np.nanmax(values) - np.nanmin(values)) for which, values in numbers.items() if np.isfinite(values).any()
    }
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
        places = places_of(table.labels, wanted)
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
        found.append(Column(places[0], label, channel, kept, said=True, neighbour=neighbour, regressor=regressor, unit=unit))
    return found


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
            raise ValueError(one_line(f"{table.file}: {_choice(group, joints)}"))
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


def _choice(group: Sequence[Column], joints: Sequence[str]) -> str:
    names = listed(column.name for column in group)
    channel = group[0].channel
    name = "command" if channel.commanded else "_".join(filter(None, (channel.side, channel.quantity)))
    side = "output" if channel.side == "output" or group[0].robot or len(joints) > 1 else "input"
    wanted = {"output_torque": "joint_torque", "angle": f"{side}_angle", "speed": f"{side}_speed"}.get(name, name)
    option = as_option("column", wanted, group[0].name)
    if len({column.which for column in group}) == len(group) and len(joints) > 1:
        which = f"it holds {len(joints)} joints ({listed(joints)}), as {names}"
        return f"{which}; say which with --joint {joints[0]}, or name columns, as {option}"
    return f"each of {names} may be the {name}; say which, as with {option}"


def read(table: OpenTable, columns: Sequence[Column], mapping: FileMapping) -> tuple[list[Column], list[str]]:
    """The columns with their values in SI units, and what was said of units and left out."""
    if not columns:
        names = [label.text for label in table.labels]
        there = listed(names) if len(names) <= FEW else f"{listed(names[:FEW])} and {len(names) - FEW} more"
        seen = apparent(table) or f"say it, as with {as_option('column', 'speed', names[0])}"
        raise ValueError(one_line(f"{table.file}: no name of a column tells what it measures: {there}; {seen}"))
    sources = [
        Source(column.position, column.name, str(column.position), column.unit or column.channel.unit) for column in columns
    ]
    numbers, left_out = table.measured(sources)
    raw = {column.position: numbers[str(column.position)] for column in columns}
    known, told = _with_units(table, columns, mapping)
    try:
        assumed = missing_units([_with_side(column, mapping) for column in known if column.own], raw)
    except ValueError as error:
        raise ValueError(one_line(f"{table.file} {error}")) from None
    known = _as_the_joint(known, assumed)
    if assumed:
        taken = ", ".join(f"{c.name} in {assumed[c.position].told}" for c in known if c.position in assumed)
        told.append(f"no unit is stated: {taken}; --unit NAME=UNIT says another one")
    found = []
    for column in known:
        unit, sure = (column.unit, True) if column.unit else (assumed[column.position].unit, assumed[column.position].sure)
        found.append(replace(column, unit=unit, sure=sure, values=_in_si(table, column, raw[column.position], unit)))
    remarks = [*left_out, *told]
    empty = [column for column in found if not column.said and not np.isfinite(column.si).any()]
    if empty and len(empty) < len(found):
        remarks.append(f"left out, as no row holds a number: {listed(column.name for column in empty)}")
        found = [column for column in found if column not in empty]
    return _whole_rows(table, found, remarks)


def _with_side(column: Column, mapping: FileMapping) -> Column:
    """The column with the side that a person said of the file, where its name says none."""
    side = column.channel.side or (mapping.side if column.channel.quantity in ("angle", "speed") else None)
    return replace(column, channel=column.channel._replace(side=side))


def _as_the_joint(columns: Sequence[Column], assumed: Mapping[int, Assumed]) -> list[Column]:
    """The columns, with angles of other joints in the unit of the one that is asked for."""
    own = next((c for c in columns if c.own and c.channel.quantity == "angle" and not c.channel.commanded), None)
    unit = UNITS["angle"] if own is None else own.unit or assumed[own.position].unit
    return [replace(c, unit=c.unit or unit) if c.neighbour else c for c in columns]


def _with_units(table: OpenTable, columns: Sequence[Column], mapping: FileMapping) -> tuple[list[Column], list[str]]:
    """The columns with the units that a person gave, for a channel, a quantity, or by the name in the file."""
    found, remarks = list(columns), []
    for name, unit in mapping.units.items():
        channel = CHANNELS.get(ALIASES.get(name, name))
        places = [place for place, column in enumerate(columns) if column.name == name or _is_called(column, channel)]
        if not places:
            there = listed(column.name for column in columns)
            raise ValueError(one_line(f"{table.file}: a unit is given for {quoted(name)}, which is not read; read are {there}"))
        for place in places:
            stated = found[place].unit
            if stated is not None and stated != unit:
                remarks.append(f"{found[place].name} is stated in {stated}, and taken in {unit}, as was said")
            found[place] = replace(found[place], unit=unit)
    return found, remarks


def _is_called(column: Column, channel: Channel | None) -> bool:
    if channel is None or channel._replace(side=None) != column.channel._replace(side=None):
        return False
    return channel.side is None or column.channel.side in (None, channel.side)


def _in_si(table: OpenTable, column: Column, values: Array, unit: str) -> Array:
    wanted = column.channel.unit
    if column.channel.commanded and measures(unit, "V"):
        wanted = "V"
    there = ~np.isnan(values)
    try:
        found = np.full(len(values), np.nan)
        found[there] = convert(values[there], unit, wanted)
    except ValueError as error:
        what = "command" if column.channel.commanded else column.channel.quantity
        place = f"{table.file} column {quoted(column.name)}"
        hint = as_option("unit", column.name, "counts/16384" if counts(unit) else column.channel.unit)
        remedy = f"give its unit, with {hint}"
        raise ValueError(one_line(f"{place} cannot be the {what}: {error}; {remedy}")) from None
    return found


def _whole_rows(table: OpenTable, columns: Sequence[Column], remarks: list[str]) -> tuple[list[Column], list[str]]:
    """The rows in which each column holds a number."""
    whole = np.all([np.isfinite(column.si) for column in columns], axis=0)
    if whole.all():
        return list(columns), remarks
    if not whole.any():
        empty = listed(column.name for column in columns if not np.isfinite(column.si).any()) or "no single column"
        raise ValueError(one_line(f"{table.file}: no row holds a number in each of its columns; all are missing in {empty}"))
    lost = int((~whole).sum())
    rows = "1 row without a number in each column is" if lost == 1 else f"{lost} rows without a number in each column are"
    remarks.append(f"{rows} left out, the first at {table.place(int(np.argmin(whole)))}")
    return [replace(column, values=column.si[whole]) for column in columns], remarks
