"""The columns of a file that seem to measure something: which of several are taken, and their values in SI units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import Label, Source, places_of
from strainwave.files.tables import OpenTable
from strainwave.files.units import convert, measures
from strainwave.identification.reading.channels import ALIASES, CHANNELS, Channel
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import UNITS, meaning
from strainwave.messages import as_option, listed, one_line, quoted

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Column:
    """A column that seems to be a channel.

    Args:
        position: where it stands in the file, from 0
        label: what the file calls it
        channel: what it measures
        which: what else its name says, as the number of a joint
        robot: whether its name is that of a robot's joint channel
        said: whether a person said what it is
        unit: its unit in the file; None where none is stated
        values: in SI units, once they are read
    """

    position: int
    label: Label
    channel: Channel
    which: str = ""
    robot: bool = False
    said: bool = False
    unit: str | None = None
    values: Array | None = None

    @property
    def si(self) -> Array:
        assert self.values is not None
        return self.values

    @property
    def name(self) -> str:
        return self.label.name


def chosen(table: OpenTable, mapping: FileMapping) -> list[Column]:
    """The columns that mean something, one for each channel: those that a person named, and those whose names tell."""
    said = _said(table, mapping)
    taken = {column.position for column in said}
    told = []
    for position, (label, content) in enumerate(zip(table.labels, table.contents, strict=True)):
        found = meaning(label) if content != "other" and position not in taken else None
        if found is None or (content == "dates") != (content == "dates" and found.quantity == "time"):
            continue
        sided = found.quantity in ("angle", "speed", "torque") and not found.commanded
        channel = Channel(found.quantity, found.side if sided else None, found.commanded)
        if not any(column.channel == channel for column in said):
            unit = "s" if content == "dates" else found.unit
            told.append(Column(position, label, channel, found.which, found.robot, unit=unit))
    return said + _of_one_joint(table, told, mapping)


def _said(table: OpenTable, mapping: FileMapping) -> list[Column]:
    """The columns that a person named."""
    found = []
    for name, wanted in mapping.columns.items():
        channel = CHANNELS[ALIASES.get(name, name)]
        places = places_of(table.labels, wanted)
        if len(places) != 1:
            fault = f"has {len(places)} columns" if places else "has no column"
            there = listed(label.name for label in table.labels)
            raise ValueError(one_line(f"{table.file} {fault} {quoted(wanted)} to be the {name}; it has {there}"))
        label = table.labels[places[0]]
        told = meaning(label)
        unit = label.unit or (told.unit if told and told.quantity == channel.quantity else None)
        unit = "s" if table.contents[places[0]] == "dates" else unit
        found.append(Column(places[0], label, channel, said=True, unit=unit))
    return found


def _of_one_joint(table: OpenTable, columns: Sequence[Column], mapping: FileMapping) -> list[Column]:
    """One column for each channel: those of the joint that is asked for, or the one whose name says nothing else."""
    groups: dict[Channel, list[Column]] = {}
    for column in columns:
        groups.setdefault(column.channel, []).append(column)
    several = [group for group in groups.values() if len(group) > 1]
    joints = list(dict.fromkeys(column.which for group in several for column in group if column.which))
    if mapping.joint is not None:
        if mapping.joint not in (known := joints or [column.which for column in columns if column.which]):
            raise ValueError(one_line(f"{table.file} has no joint {quoted(mapping.joint)}; it has {listed(known)}"))
        return [column for column in columns if column.which in ("", mapping.joint) or column.which not in known]
    taken = []
    for group in groups.values():
        plain = [column for column in group if not column.which] if len(group) > 1 else group
        if len(plain) != 1:
            raise ValueError(one_line(f"{table.file}: {_choice(group, joints)}"))
        taken += plain
    return taken


def _choice(group: Sequence[Column], joints: Sequence[str]) -> str:
    names = listed(column.name for column in group)
    channel = group[0].channel
    name = "command" if channel.commanded else "_".join(filter(None, (channel.side, channel.quantity)))
    option = as_option("column", {"output_torque": "joint_torque"}.get(name, name), group[0].name)
    if len({column.which for column in group}) == len(group) and len(joints) > 1:
        return f"it holds {len(joints)} joints, as {names}; say which with --joint {joints[0]}, or name columns, as {option}"
    return f"each of {names} may be the {name}; say which, as with {option}"


def read(table: OpenTable, columns: Sequence[Column], mapping: FileMapping) -> tuple[list[Column], list[str]]:
    """The columns with their values in SI units, and what was said of units and left out."""
    if not columns:
        there = listed(label.text for label in table.labels)
        hint = as_option("column", "speed", table.labels[0].name)
        raise ValueError(one_line(f"{table.file}: no name of a column tells what it measures: {there}; say it, as with {hint}"))
    sources = [
        Source(column.position, column.name, str(column.position), column.unit or column.channel.unit) for column in columns
    ]
    numbers, remarks = table.measured(sources)
    units = _units_given(table, columns, mapping)
    found, assumed = [], []
    for column in columns:
        values = numbers[str(column.position)]
        unit = units.get(column.position) or column.unit
        if unit is None:
            unit = _assumed(table, column, values)
            assumed.append(f"{column.name} in {unit}")
        found.append(replace(column, unit=unit, values=_in_si(table, column, values, unit)))
    if assumed:
        remarks.append(f"no unit is stated, taken are {', '.join(assumed)}; --unit NAME=UNIT says another one")
    return _whole_rows(table, found, remarks)


def _units_given(table: OpenTable, columns: Sequence[Column], mapping: FileMapping) -> dict[int, str]:
    """The units that a person gave, by the place of the column: for a channel, a quantity, or by the name in the file."""
    found: dict[int, str] = {}
    for name, unit in mapping.units.items():
        channel = CHANNELS.get(ALIASES.get(name, name))
        places = [column.position for column in columns if column.name == name or _is_called(column, channel)]
        if not places:
            there = listed(column.name for column in columns)
            raise ValueError(one_line(f"{table.file}: a unit is given for {quoted(name)}, which is not read; read are {there}"))
        found |= dict.fromkeys(places, unit)
    return found


def _is_called(column: Column, channel: Channel | None) -> bool:
    if channel is None or (channel.quantity, channel.commanded) != (column.channel.quantity, column.channel.commanded):
        return False
    return channel.side is None or column.channel.side in (None, channel.side)


def _assumed(table: OpenTable, column: Column, values: Array) -> str:
    """The unit of numbers that come without one: SI, but for temperatures that are no kelvins, and time as its steps tell."""
    quantity = column.channel.quantity
    if quantity == "temperature":
        return "degC" if np.nanmedian(values) < 200.0 else "K"
    if quantity != "time":
        return UNITS[quantity]
    late = float(np.nanmax(np.abs(values)))
    for least, unit in ((1e17, "ns"), (1e14, "us"), (1e11, "ms"), (1e8, "s")):  # since 1970
        if late > least:
            return unit
    if len(values) > 1 and np.nanmedian(np.abs(np.diff(values))) < 0.2:
        return "s"
    hint = as_option("unit", "time", "ms")
    place = f"{table.file} column {quoted(column.name)}"
    raise ValueError(one_line(f"{place} has no unit, and its steps do not tell it; give it: {hint}"))


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
        remedy = f"correct its unit, or say what it is with {as_option('column', 'NAME', column.name)}"
        raise ValueError(one_line(f"{place} cannot be a {what}: {error}; {remedy}")) from None
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
    rows = "1 row" if lost == 1 else f"{lost} rows"
    remarks.append(f"{rows} without a number in each column are left out, the first at {table.place(int(np.argmin(whole)))}")
    return [replace(column, values=column.si[whole]) for column in columns], remarks
