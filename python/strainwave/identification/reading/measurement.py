"""Measurements in files: which columns each kind has, and how a crooked file becomes one."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from difflib import SequenceMatcher
from pathlib import Path
from typing import Literal

from strainwave import arguments
from strainwave.files.labels import Label, places_of
from strainwave.files.recording import Recording
from strainwave.files.tables import open_table
from strainwave.files.units import convert, measures
from strainwave.identification.reading.channels import CHANNELS
from strainwave.identification.reading.names import COMMANDED, QUANTITY_OF
from strainwave.messages import as_option, listed, one_line, quoted

Kind = Literal["friction", "torsion", "log"]
Units = tuple[str, ...]

# What a twin takes of each kind, and the choices of columns that make it one.
TAKEN: dict[Kind, tuple[str, ...]] = {
    "friction": ("speed", "torque", "temperature"),
    "torsion": ("twist", "torque", "input_angle", "input_torque"),
    "log": ("time", "command", "position", "input_angle", "input_speed", "output_angle", "output_speed", "current"),
}
NEEDED: dict[Kind, tuple[tuple[str, ...], ...]] = {
    "friction": (("speed", "torque"),),
    "torsion": (("twist", "torque"), ("input_angle", "input_torque")),
    "log": (("time", "command"),),
}
ALIASES = {"position": "input_angle"}  # of a drive log: the encoder that closes the loop sits on the motor
SYMBOLS = {symbol: QUANTITY_OF[symbol] for symbol in ("t", "omega", "tau")}  # that many files have instead of a name
OTHER_WORDS = {"command": COMMANDED}  # by which a column is offered, but not taken
COLUMNS: dict[Kind, dict[str, Units]] = {  # each column with the units that are wanted of it
    kind: {name: ("V", "rad") if name == "command" else (CHANNELS[ALIASES.get(name, name)].unit,) for name in names}
    for kind, names in TAKEN.items()
}


def read_measurement(
    kind: Kind, path: str | Path, columns: Mapping[str, str] | None = None, units: Mapping[str, str] | None = None
) -> Recording:
    """Reads the columns that a kind of measurement knows from a CSV or Parquet file; others may hold anything.

    A column of the file is found by its name; if none has exactly this name, by the name in other letters (`Time`,
    `Input Angle`) or by its symbol (`t`, `omega`, `tau`).

    Args:
        kind: friction, torsion or log
        path: the file
        columns: for each name wanted the name in the file, where it differs, or the number of the column, from 1
        units: units of columns whose header has none

    Returns:
        recording with the names of `COLUMNS`; `position` of a log is its `input_angle`

    Raises:
        ValueError: the file lacks a column, a column measures something else, or the file cannot be read; says which,
            and how to name it

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "table.csv")
    ...     _ = path.write_text("Speed [1/min];Moment [Nm];Room\\n10;0,1;A\\n20;0,2;A\\n")
    ...     read_measurement("friction", path, columns={"torque": "Moment"})
    ...     unused_columns("friction", path, columns={"torque": "Moment"})
    <Recording: 2 samples; speed [1/min], torque [N.m]>
    ('Room',)
    """
    present = _labels(path)
    found = _found(kind, path, present, columns)
    _check_needed(kind, path, present, found)
    if extra := (units or {}).keys() - found.keys():
        unread = f"a unit is given for {quoted(min(extra))}, which is not read"
        raise ValueError(one_line(f"{path}: {unread}; read are {listed(found)}"))
    recording = Recording.read(path, found, units)
    for name, unit in recording.units.items():
        _check_unit(kind, f"{path} column {quoted(found[name])}", name, unit)
    return Recording(
        {ALIASES.get(name, name): recording[name] for name in found},
        {ALIASES.get(name, name): recording.unit(name) for name in found},
        title=recording.title,
    )


def read_measurements(
    files: Mapping[Kind, str | Path], columns: Mapping[str, str] | None = None, units: Mapping[str, str] | None = None
) -> dict[Kind, Recording]:
    """Reads several measurements, each as `read_measurement` does.

    Args:
        files: the file of each kind
        columns, units: as in `read_measurement`; each applies to every file that has the column

    Raises:
        ValueError: as `read_measurement`, or no file has a column that is named
    """
    named, given = dict(columns or {}), dict(units or {})
    own_columns = {kind: columns_in(kind, path, named) for kind, path in files.items()}
    own_units = {
        kind: {name: given[name] for name in given.keys() & _found(kind, path, _labels(path), own_columns[kind]).keys()}
        for kind, path in files.items()
    }
    for name in named.keys() - {name for own in own_columns.values() for name in own}:
        raise ValueError(f"no file has a column {quoted(named[name])} that can be the {quoted(name)} of a measurement")
    for name in given.keys() - {name for own in own_units.values() for name in own}:
        raise ValueError(f"a unit is given for {quoted(name)}, but no file has this column")
    return {kind: read_measurement(kind, path, own_columns[kind], own_units[kind]) for kind, path in files.items()}


def columns_in(kind: Kind, path: str | Path, columns: Mapping[str, str]) -> dict[str, str]:
    """Those columns that a measurement of this kind can have, and the file has."""
    present = _labels(path)
    return {name: columns[name] for name in columns.keys() & COLUMNS[kind].keys() if places_of(present, columns[name])}


def unused_columns(kind: Kind, path: str | Path, columns: Mapping[str, str] | None = None) -> tuple[str, ...]:
    """Names of the columns of a file, in its order, that no fit to this kind of measurement uses.

    Args:
        kind, path, columns: as in `read_measurement`

    Raises:
        ValueError: the file cannot be read, or has no column of a name that `columns` gives
    """
    present = _labels(path)
    found = _found(kind, path, present, columns)
    used = {place for name in found for place in places_of(present, found[name])}
    return tuple(label.name for place, label in enumerate(present) if place not in used)


def _labels(path: str | Path) -> Sequence[Label]:
    return open_table(path).labels


def _found(kind: Kind, path: str | Path, present: Sequence[Label], columns: Mapping[str, str] | None) -> dict[str, str]:
    """The columns that a measurement takes from a file, each with its name there."""
    named = dict(columns or {})
    arguments.mapping("columns", named, '{"speed": "Motor Speed"}')
    if extra := named.keys() - COLUMNS[kind].keys():
        raise ValueError(f"a {kind} measurement has no column {quoted(min(extra))}; it has {listed(COLUMNS[kind])}")
    for name, wanted in named.items():
        if not places_of(present, wanted):
            there = listed(label.name for label in present)
            raise ValueError(one_line(f"{path} has no column {quoted(wanted)} to be the {name}; it has {there}"))
    found = {name: named.get(name) or _alike(path, present, name) for name in COLUMNS[kind]}
    return {
        name: name_in_file
        for name, name_in_file in found.items()
        if name_in_file is not None and not found.get(ALIASES.get(name, ""))
    }


def _alike(path: str | Path, present: Sequence[Label], name: str) -> str | None:
    """The name of a column in a file: exactly so, else in other letters, else its symbol; None where there is none."""
    names = dict.fromkeys(label.name for label in present)
    if name in names:
        return name
    in_other_letters = [each for each in names if _plain(each) == name]
    symbols = [each for each in names if SYMBOLS.get(_plain(each)) == name]
    alike = in_other_letters or symbols
    if len(alike) > 1:
        hint = as_option("column", name, alike[0])
        raise ValueError(one_line(f"{path}: each of {listed(alike)} may be the {name}; say which, as with {hint}"))
    return alike[0] if alike else None


def _plain(name: str) -> str:
    return re.sub(r"[\s_-]+", "_", name.casefold())


def _check_needed(kind: Kind, path: str | Path, present: Sequence[Label], found: Mapping[str, str]) -> None:
    missing = min(([name for name in needed if name not in found] for needed in NEEDED[kind]), key=len)
    if missing:
        wanted = " or ".join(" and ".join(needed) for needed in NEEDED[kind])
        needs = f"a {kind} measurement needs columns {wanted}; this file has {listed(label.name for label in present)}"
        taken = {place for wanted in found.values() for place in places_of(present, wanted)}
        free = [label for place, label in enumerate(present) if place not in taken]
        advice = " ".join(_advice(name, COLUMNS[kind][name], free) for name in missing)
        raise ValueError(one_line(f"{path}: {needs}. Name yours like {advice}"))


def _advice(name: str, wanted: Units, free: list[Label]) -> str:
    """How to name a column that is missing, and its unit: one that measures what is wanted, or else is called alike.

    The column is then no longer free.
    """
    if not free:
        return as_option("column", name, "NAME")
    alike = [label for label in free if _stated_unit(label, wanted)] or free
    label = max(alike, key=lambda label: _likeness(name, label.name))
    free.remove(label)
    unit = _stated_unit(label, wanted)
    option = as_option("column", name, label.name)
    return option if unit is None or unit == label.unit else f"{option} {as_option('unit', name, unit)}"


def _likeness(name: str, name_in_file: str) -> float:
    """How much a name in a file looks like a name wanted, or like another word for it."""
    words = (name, *OTHER_WORDS.get(name, ()))
    return max(SequenceMatcher(None, word, _plain(name_in_file)).ratio() for word in words)


def _stated_unit(label: Label, wanted: Units) -> str | None:
    """The unit that a header states, behind the name or as its last word, if it measures what is wanted."""
    for unit in (label.unit, re.split(r"[\s_]", label.name)[-1]):
        if unit is not None and any(measures(unit, each) for each in wanted):
            return unit
    return None


def _check_unit(kind: Kind, column: str, name: str, unit: str) -> None:
    wanted = COLUMNS[kind][name]
    if any(measures(unit, each) for each in wanted):
        return
    remedy = f"correct its unit, or name another column with {as_option('column', name, 'NAME')}"
    try:
        convert(1.0, unit, wanted[0])
    except ValueError as error:
        reason = " or ".join((str(error), *map(quoted, wanted[1:])))
        raise ValueError(one_line(f"{column} cannot be the {name} of a {kind} measurement: {reason}; {remedy}")) from None
