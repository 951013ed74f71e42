"""The values of columns in SI units, with the units that are stated, given or assumed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import Source
from strainwave.files.tables import OpenTable
from strainwave.files.units import convert, counts, measures
from strainwave.identification.reading.channels import ALIASES, CHANNELS, Channel
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.incomplete_units import check_units, with_counts
from strainwave.identification.reading.layout import nameless
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.missing_units import Assumed, missing_units
from strainwave.identification.reading.names import UNITS
from strainwave.identification.reading.whole_rows import whole_rows
from strainwave.messages import as_option, listed, one_line, quoted

Array = NDArray[np.float64]

FEW = 4  # names that are listed where none says anything


def read(table: OpenTable, columns: Sequence[Column], mapping: FileMapping) -> tuple[list[Column], list[str]]:
    """The columns with their values in SI units, and what was said of units and left out."""
    if not table.labels:
        raise ValueError(one_line(f"{table.file} has no columns"))
    if not columns:
        names = [label.text for label in table.labels]
        there = listed(names) if len(names) <= FEW else f"{listed(names[:FEW])} and {len(names) - FEW} more"
        raise ValueError(one_line(f"{table.file}: no name of a column tells what it measures: {there}; {_naming(table)}"))
    sources = [
        Source(column.position, column.name, str(column.position), column.unit or column.channel.unit) for column in columns
    ]
    numbers, left_out = table.measured(sources)
    raw = {column.position: numbers[str(column.position)] for column in columns}
    known, told = _with_units(table, columns, mapping)
    known, counted = with_counts(known, raw)
    told += counted
    check_units([column for column in known if column.own], raw, mapping.constants.get("ratio"))
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
        unit, _, sure, scale = Assumed(column.unit, "", True) if column.unit else assumed[column.position]
        is_open = column.unit is None and not sure
        values = scale * _in_si(table, column, raw[column.position], unit)
        found.append(replace(column, unit=unit, sure=sure, is_open=is_open, values=values))
    remarks = [*left_out, *told]
    empty = [column for column in found if not column.said and not np.isfinite(column.si).any()]
    if empty and len(empty) < len(found):
        remarks.append(f"left out, as no row holds a number: {listed(column.name for column in empty)}")
        found = [column for column in found if column not in empty]
    return whole_rows(table, found, remarks)


def _naming(table: OpenTable) -> str:
    """How to name columns of which neither names nor numbers determine anything."""
    if len([content for content in table.contents if content == "numbers"]) == 1:
        return "of a record at one constant speed say it, as with --column current=1 --constant speed='20 1/min'"
    names = [label.name for label in table.labels]
    if nameless(table):
        return "say which is which, as with --constant rate=HZ --column output_angle=1 --column joint_torque=2"
    return f"say it, as with {as_option('column', 'speed', names[0])}"


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
