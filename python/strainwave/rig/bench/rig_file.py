"""Files of rigs: what may be written where, and how a rig is read from TOML and written to it.

What is wrong in a file is refused in one line with file, table and key. docs/how-to/torsion-rig.md shows the format.
"""

from __future__ import annotations

import dataclasses
import difflib
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Annotated, Any

from strainwave.files.entries import NOT_GIVEN, Entry, Form, Quantity, checked, elements, entry_schema, inline, schema
from strainwave.files.gear_file import at, document
from strainwave.files.writing import replacing
from strainwave.messages import listed, one_line, quoted
from strainwave.rig.bench.setup import Camera, Masses, Rig, Value

RIG_FOLDER = Path(__file__).parents[1] / "rigs"  # that come with the package

# Each number with the unit that it has here, in the tables of a file.
NUMBERS: dict[str, dict[str, str]] = {
    "loading": {
        "disk_radius": "m",
        "gravity": "m/s2",
        "cord_tangent": "rad",
        "pulley_torque": "N.m",
        "pulley_share": "1",
        "compliance": "rad/(N.m)",
    },
    "target": {"markers_diameter": "m", "markers_distance": "m"},
}
CAMERA: dict[str, tuple[str, ...]] = {
    "aspect": ("1",),
    "tilt": ("rad",),
    "tilt_direction": ("rad",),
    "distance": ("px",),
    "centre": ("px", "px"),
    "radial": ("1/px2", "1/px4"),
}
_CHOICES = {"side": '"input" or "output"', "cord": '"wound" or "fixed point"'}
_DEFAULTS = {each.name: each.default for each in dataclasses.fields(Rig)}


def rigs() -> list[str]:
    """Return the names of the rigs that come with the package.

    >>> rigs()
    ['couple-rig']
    """
    return sorted(path.stem for path in RIG_FOLDER.glob("*.toml"))


def load(name_or_path: str | Path) -> Rig:
    """Read a rig that comes with the package by its name, or a file by its path.

    Args:
        name_or_path: a name in `rigs()`, or a path: what ends in .toml or has a folder

    Returns:
        The rig, in SI units.

    Raises:
        ValueError: no such name or file, or what is wrong in it, with file, table and key

    >>> load("couple-rig").disk_radius
    Value(value=0.1, sigma=5e-05, source='torsional stiffness article, Table 1: diameter 200 mm; assumed: 0.1 mm on it')
    """
    path = _file(name_or_path)
    with at(f"{path}"):
        return _read(document(path))


def write_rig(rig: Rig, path: str | Path) -> None:
    """Write a file that `load` reads back equal, bit for bit.

    Args:
        rig: the rig
        path: the file, which must end in .toml

    Raises:
        ValueError: the path does not end in .toml
        OSError: the file cannot be written

    >>> import tempfile
    >>> rig = load("couple-rig")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_rig(rig, f"{folder}/mine.toml")
    ...     load(f"{folder}/mine.toml") == rig
    True
    """
    if Path(path).suffix != ".toml":
        raise ValueError(one_line(f"{path}: the file of a rig ends in .toml"))
    content = _text(rig)
    with replacing(path) as file:
        file.write(content.encode())


def _file(name_or_path: str | Path) -> Path:
    path = Path(name_or_path)
    if isinstance(name_or_path, Path) or path.name != name_or_path or path.suffix == ".toml":
        return path
    if name_or_path not in rigs():
        near = difflib.get_close_matches(name_or_path.lower(), rigs())
        hint = f"; near it are {listed(near)}" if near else ""
        there = f"there are {listed(rigs())}, and the path of a file ends in .toml"
        raise ValueError(f"no rig {quoted(name_or_path)} comes with the package{hint}; {there}")
    return RIG_FOLDER / f"{name_or_path}.toml"


# Reading


def _read(content: Mapping[str, Any]) -> Rig:
    head = checked(_head_form(), content)
    members: dict[str, Any] = {key: head[key] for key in ("name", "note")}
    for table, numbers in NUMBERS.items():
        with at(f"[{table}]"):
            given = checked(_table_form(table), head[table])
            members |= {key: given[key] for key in _CHOICES if given.get(key) is not None}
            members |= {key: _value(key, given[key], unit) for key, unit in numbers.items() if given[key] is not None}
    masses = []
    for row, table in enumerate(head["masses"], start=1):
        with at(f"[[masses]] {row}"):
            given = checked(_masses_form(), table)
            mass = _value("mass", given["mass"], "kg")
            masses.append(Masses(mass.value, given["count"], mass.sigma, mass.source))
    members["masses"] = tuple(masses)
    with at("[camera]"):
        given = checked(_camera_form(), head["camera"])
        camera: dict[str, Any] = {"sources": {}}
        for name in [name for name in CAMERA if given[name] is not None]:
            entries, keys = given[name] if isinstance(given[name], list) else [given[name]], _keys(name)
            if len(entries) != len(keys):
                raise ValueError(f"{name} has {len(entries)} numbers; write {_camera_form().examples[name]}")
            entry_units = zip(keys, entries, CAMERA[name], strict=True)
            members_of_camera = {key: _value(key, entry, unit) for key, entry, unit in entry_units}
            values = tuple(number.value for number in members_of_camera.values())
            camera[name] = values if len(values) > 1 else values[0]
            camera["sources"] |= {key: each.source for key, each in members_of_camera.items() if each.source != NOT_GIVEN}
        members["camera"] = Camera(**camera)
    with at("[loading]"):
        return Rig(**members)


def _value(key: str, entry: Mapping[str, Any], unit: str) -> Value:
    with at(f"{key}:"):
        number = Quantity(**entry).to(unit)
        return Value(number.value, number.uncertainty or 0.0, number.source)


def _keys(name: str) -> list[str]:
    count = len(CAMERA[name])
    return [name] if count == 1 else [f"{name}[{index}]" for index in range(count)]


# What may be written where


@cache
def _head_form() -> Form:
    keys: dict[str, Any] = {"name": (str, ...), "note": (str, ""), "loading": (dict[str, Any], ...)}
    keys |= {"masses": (list[dict[str, Any]], []), "target": (dict[str, Any], {}), "camera": (dict[str, Any], {})}
    examples = {"name": 'name = "…"', "note": 'note = "…"', "masses": "[[masses]]"}
    examples |= {key: f"[{key}]" for key in keys if key not in examples}
    return Form("part of a rig file", schema("rig file", keys), examples)


@cache
def _table_form(table: str) -> Form:
    keys: dict[str, Any] = {"side": (str, ...), "cord": (str | None, None)} if table == "loading" else {}
    examples = {key: f"{key} = {choice}" for key, choice in _CHOICES.items() if key in keys}
    for key, unit in NUMBERS[table].items():
        kind = entry_schema(unit, without=("spread",))
        keys[key] = (kind, ...) if key == "disk_radius" else (kind | None, None)
        examples[key] = f"{key} = {_example(unit)}"
    return Form(f"number of [{table}]", schema(table, keys), examples)


@cache
def _masses_form() -> Form:
    keys = {"mass": (entry_schema("kg", without=("spread",)), ...), "count": (int, ...)}
    return Form("number of [[masses]]", schema("masses", keys), {"mass": f"mass = {_example('kg')}", "count": "count = …"})


@cache
def _camera_form() -> Form:
    from pydantic import BeforeValidator

    keys: dict[str, Any] = {}
    examples = {}
    for name, units in CAMERA.items():
        entry = entry_schema(units[0], without=("spread", "uncertainty"))
        kind = entry if len(units) == 1 else Annotated[list[entry], BeforeValidator(elements)]  # type: ignore[valid-type]
        keys[name] = (kind | None, None)
        numbers = ", ".join(map(_example, units))
        examples[name] = f"{name} = {numbers}" if len(units) == 1 else f"{name} = [{numbers}]"
    return Form("number of [camera]", schema("camera", keys), examples)


def _example(unit: str) -> str:
    return f'{{ value = …{"" if unit == "1" else f", unit = {quoted(unit)}"}, source = "…" }}'


# Writing


def _text(rig: Rig) -> str:
    import tomlkit

    written = tomlkit.document()
    written.add("name", rig.name)
    if rig.note:
        written.add("note", rig.note)
    for table, numbers in NUMBERS.items():
        choices = {key: getattr(rig, key) for key in _CHOICES} if table == "loading" else {}
        entries = {
            key: _entry(getattr(rig, key), unit)
            for key, unit in numbers.items()
            if getattr(rig, key) not in (None, _DEFAULTS[key])
        }
        if content := choices | entries:
            written.add(table, content)
    if rig.masses:
        tables = tomlkit.aot()
        for masses in rig.masses:
            row = tomlkit.table()
            row.update({"mass": _entry(Value(masses.mass, masses.sigma, masses.source), "kg"), "count": masses.count})
            tables.append(row)
        written.add("masses", tables)
    if camera := _written_camera(rig.camera):
        written.add("camera", camera)
    return tomlkit.dumps(written)


def _entry(number: Value, unit: str) -> Any:
    return inline(number.value, unit, Entry(number.source, uncertainty=number.sigma or None))


def _written_camera(camera: Camera) -> dict[str, Any]:
    import tomlkit

    written: dict[str, Any] = {}
    for name, units in CAMERA.items():
        value, keys = getattr(camera, name), _keys(name)
        if value == getattr(Camera(), name) and not camera.sources.keys() & set(keys):
            continue
        sources = [Entry(camera.sources.get(key, NOT_GIVEN)) for key in keys]
        if len(units) == 1:
            written[name] = inline(value, units[0], sources[0])
        else:
            written[name] = tomlkit.array().multiline(True)
            for number in map(inline, value, units, sources):
                written[name].append(number)
    return written
