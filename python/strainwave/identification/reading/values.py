"""The values of columns in SI units, with the units that are stated, given or assumed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from difflib import get_close_matches

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import ColumnSource, is_unit
from strainwave.files.table_format import OpenTable
from strainwave.files.units import convert, counts, is_share
from strainwave.identification.reading import unnamed
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import CHANNEL_ALIASES, CHANNELS, UNITS, Channel, meaning
from strainwave.identification.reading.roles import Column
from strainwave.identification.reading.times import run_on
from strainwave.identification.reading.units import Assumed, check_units, units_of, with_counts, with_registers
from strainwave.messages import as_option, listed, one_line, quoted, unquoted
from strainwave.questions import Answer, QuestionError

Array = NDArray[np.float64]

MIN_WHOLE = 0.5  # of the rows of the slowest channel: with fewer whole rows the channels were sampled at other instants
OTHER_UNITS: dict[str, tuple[str, str]] = {
    "time": ("ms", "s"),
    "angle": ("deg", "rad"),
    "twist": ("deg", "rad"),
    "speed": ("rpm", "rad/s"),
    "torque": ("mN.m", "N.m"),
    "current": ("mA", "A"),
    "voltage": ("mV", "V"),
    "temperature": ("K", "degC"),
    "vibration": ("mm/s2", "m/s2"),
}  # usual ones, of which an example differs from the unit that is taken
# Units for which another one may be meant, of the quantities that a measurement needs.
NEARLY_KNOWN = {name: (*OTHER_UNITS[name], *more) for name, more in (
    ("time", ("us",)), ("angle", ("rev",)), ("speed", ("deg/s", "rev/s")), ("torque", ()), ("current", ()),
)}  # fmt: skip
MAX_LISTED = 4  # names, if none is known


def values_of(table: OpenTable, columns: Sequence[Column], mapping: FileMapping) -> tuple[list[Column], list[str]]:
    """Return the columns with their values in SI units, and remarks of units and of what was left out."""
    if not table.labels:
        raise ValueError(one_line(f"{table.file} has no columns"))
    if not columns:
        names = [label.text for label in table.labels]
        there = (
            listed(names) if len(names) <= MAX_LISTED else f"{listed(names[:MAX_LISTED])} and {len(names) - MAX_LISTED} more"
        )
        raise QuestionError(one_line(f"no column has a name that is known: {there}"), unnamed.answers(table, [], mapping.kind))
    sources = [ColumnSource(each.position, each.name, str(each.position), each.unit or each.channel.unit) for each in columns]
    numbers, left_out = table.measured(sources)
    read = [replace(each, raw=numbers[str(each.position)]) for each in columns]
    read, run_over = _with_time_that_runs_on(read)
    with_unit, remarks = _with_units(table, read, mapping)
    with_unit, of_recorder = with_registers(with_unit)
    with_unit, counted = with_counts(with_unit)
    own = [_with_side(column, mapping) for column in with_unit if column.own]
    check_units(own, mapping.constants.get("ratio"))
    try:
        units = units_of(own)
    except QuestionError:
        raise
    except ValueError as error:
        raise ValueError(one_line(f"{table.file} {error}")) from None
    assumed = ", ".join(f"{c.name} in {' '.join(filter(None, units[c.position][:2]))}" for c in own if c.unit is None)
    remarks = [*left_out, *remarks, *run_over, *of_recorder, *counted]
    if assumed:
        column = next(c for c in own if c.unit is None)
        other = next(unit for unit in OTHER_UNITS[column.channel.quantity] if unit != units[column.position].unit)
        remark = f"no unit is stated: {assumed}; otherwise add its unit, as {as_option('unit', column.label.name, other)}"
        remarks.append(remark)
    angle = next((c for c in own if c.channel.quantity == "angle" and not c.channel.commanded), None)
    neighbour = Assumed(UNITS["angle"] if angle is None else units[angle.position].unit, sure=True)  # in that of the joint
    converted = [
        _in_si(table, c, units[c.position] if c.own else neighbour._replace(unit=c.unit or neighbour.unit)) for c in with_unit
    ]
    empty = [column for column in converted if not column.by_user and not np.isfinite(column.si).any()]
    if empty and len(empty) < len(converted):
        remarks.append(f"left out, as no row contains a number: {listed(column.name for column in empty)}")
        converted = [column for column in converted if column not in empty]
    return _whole_rows(table, converted, remarks)


def misspelt_units(table: OpenTable, mapping: FileMapping) -> QuestionError | None:
    """Return the question which units a header means by those that are not known, but nearly; None if it has none such."""
    meant, words = dict[str, str](), list[str]()
    for label in table.labels:
        named = meaning(label._replace(unit=None))
        if named is None or label.unit is None or label.name in mapping.units or named.quantity not in NEARLY_KNOWN:
            continue
        near = get_close_matches(label.unit, NEARLY_KNOWN[named.quantity], 1)
        if near and not (is_unit(label.unit) or counts(label.unit) or is_share(label.unit)):
            meant[label.name] = near[0]
            words.append(f"unit {quoted(label.unit)} of {unquoted(label.name)} is not known; did you mean {near[0]}?")
    return QuestionError(" ".join(words), [Answer(listed(meant.values()), {"units": meant})]) if meant else None


def _with_time_that_runs_on(columns: Sequence[Column]) -> tuple[list[Column], list[str]]:
    """Return the columns, with the time of a counter that begins anew as it runs on; and a remark."""
    running, remarks = list(columns), []
    for place, column in enumerate(columns):
        if column.channel.quantity == "time":
            stamps, period = run_on(column.raw)
            running[place] = replace(column, raw=stamps)
            remarks += [f"{column.name} begins anew after {period:g}: it is taken to run on"] if period else []
    return running, remarks


def _with_side(column: Column, mapping: FileMapping) -> Column:
    """Return a column with the side that a person gave of the file, if its name contains none."""
    side = column.channel.side or (mapping.side if column.channel.quantity in ("angle", "speed") else None)
    return replace(column, channel=column.channel._replace(side=side))


def _with_units(table: OpenTable, columns: Sequence[Column], mapping: FileMapping) -> tuple[list[Column], list[str]]:
    """Return the columns with the units that a person gave for a channel, a quantity or a name in the file; and remarks."""
    with_unit, remarks = list(columns), []
    for name, unit in mapping.units.items():
        channel = CHANNELS.get(CHANNEL_ALIASES.get(name, name))
        places = [
            place
            for place, column in enumerate(columns)
            if name in (column.name, column.label.name) or _is_called(column, channel)
        ]
        if not places and not any(name in (label.name, label.text) for label in table.labels):
            there = listed(column.name for column in columns)
            raise ValueError(one_line(f"{table.file}: a unit is given for {quoted(name)}, which is not read; read are {there}"))
        for place in places:
            stated = with_unit[place].unit
            if stated is not None and stated != unit:
                remarks.append(f"{with_unit[place].name} is stated in {stated}, and taken in {unit}, as --unit has it")
            with_unit[place] = replace(with_unit[place], unit=unit)
    return with_unit, remarks


def _is_called(column: Column, channel: Channel | None) -> bool:
    if channel is None or channel._replace(side=None) != column.channel._replace(side=None):
        return False
    return channel.side is None or column.channel.side in (None, channel.side)


def _in_si(table: OpenTable, column: Column, unit: Assumed) -> Column:
    """Return a column with its unit and its values in SI units."""
    in_unit, there = replace(column, unit=unit.unit, sure=unit.sure), ~np.isnan(column.raw)
    values = np.full(len(column.raw), np.nan)
    try:
        values[there] = unit.scale * convert(column.raw[there], unit.unit, in_unit.si_unit)
    except ValueError as error:
        what = "command" if column.channel.commanded else column.channel.quantity
        usual = "counts/16384" if counts(unit.unit) else column.channel.unit
        numbers = {column.label.name: "counts of a revolution"} if counts(unit.unit) else {}
        ways = [Answer(f"it is in {column.channel.unit}", {"units": {column.label.name: usual}}, numbers)]
        raise QuestionError(f"column {quoted(column.name)} cannot be the {what}: {error}", ways) from None
    return replace(in_unit, si=values)


# ---- Whole rows ------------------------------------------------------------------------------------------------------


def _whole_rows(table: OpenTable, columns: Sequence[Column], remarks: list[str]) -> tuple[list[Column], list[str]]:
    """Return the rows in which each column has a number, or those of the slowest channel; and remarks."""
    whole = np.all([np.isfinite(column.si) for column in columns], axis=0)
    if whole.all():
        return list(columns), remarks
    if (resampled := _resampled(columns)) is not None:
        return resampled[0], [*remarks, resampled[1]]
    if not whole.any():
        empty = listed(column.name for column in columns if not np.isfinite(column.si).any()) or "no single column"
        raise ValueError(one_line(f"{table.file}: no row has a number in each of its columns; all are missing in {empty}"))
    lost = int((~whole).sum())
    rows = "1 row without a number in each column is" if lost == 1 else f"{lost} rows without a number in each column are"
    remarks.append(f"{rows} left out, the first at {table.place(int(np.argmin(whole)))}")
    return [replace(column, si=column.si[whole]) for column in columns], remarks


def _resampled(columns: Sequence[Column]) -> tuple[list[Column], str] | None:
    """Return the columns at the instants of the slowest but for temperatures, by linear interpolation; and a remark.

    None if most rows of this one are whole, or there is no time.
    """
    time = next((column.si for column in columns if column.channel.quantity == "time"), None)
    others = [column for column in columns if column.channel.quantity not in ("time", "temperature")]
    if time is None or not others:
        return None
    stamped = np.isfinite(time)
    there = {column.position: np.isfinite(column.si) & stamped for column in columns}
    slowest = min(others, key=lambda column: int(there[column.position].sum()))
    rows = there[slowest.position].copy()
    whole = np.all(list(there.values()), axis=0)
    if whole.sum() > MIN_WHOLE * rows.sum() or not all(each.sum() > 1 for each in there.values()):
        return None
    for column in others:
        own = time[there[column.position]]
        rows &= (time >= own.min()) & (time <= own.max())
    if not rows.any():
        return None
    resampled, moved = [], []
    for column in columns:
        finite = there[column.position]
        if (finite & rows).sum() == rows.sum():
            resampled.append(replace(column, si=column.si[rows]))
            continue
        moved.append(column.name)
        order = np.argsort(time[finite], kind="stable")
        resampled.append(replace(column, si=np.interp(time[rows], time[finite][order], column.si[finite][order])))
    remark = f"rows are of several channels: at the {int(rows.sum())} rows of {slowest.name}"
    return resampled, f"{remark}, {listed(moved)} is taken by linear interpolation"
