"""Measurements in files: which columns each kind has, and how a crooked file becomes one."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Literal

from strainwave.recording import Recording

Kind = Literal["friction", "torsion", "log"]

# What each kind may hold, and the choices of columns that make it one.
COLUMNS: dict[Kind, tuple[str, ...]] = {
    "friction": ("speed", "torque"),
    "torsion": ("twist", "torque", "input_angle", "input_torque"),
    "log": ("time", "command", "position", "input_angle", "input_speed", "output_angle", "output_speed", "current"),
}
NEEDED: dict[Kind, tuple[tuple[str, ...], ...]] = {
    "friction": (("speed", "torque"),),
    "torsion": (("twist", "torque"), ("input_angle", "input_torque")),
    "log": (("time", "command"),),
}
ALIASES = {"position": "input_angle"}  # of a drive log: the encoder that closes the loop sits on the motor


def read_measurement(
    kind: Kind, path: str | Path, columns: Mapping[str, str] | None = None, units: Mapping[str, str] | None = None
) -> Recording:
    """Reads the columns that a kind of measurement knows from a CSV or Parquet file; others may hold anything.

    Args:
        kind: friction, torsion or log
        path: the file
        columns: for each name wanted the name in the file, where it differs
        units: units of columns whose header has none

    Returns:
        recording with the names of `COLUMNS`; `position` of a log is its `input_angle`

    Raises:
        ValueError: the file lacks a column, or cannot be read; says which, and how to name it
    """
    named = dict(columns or {})
    present = Recording.header(path)
    found = {name: named.get(name, name) for name in COLUMNS[kind] if named.get(name, name) in present}
    if not any(set(needed) <= set(found) for needed in NEEDED[kind]):
        wanted = " or ".join(" and ".join(needed) for needed in NEEDED[kind])
        raise ValueError(
            f"{path}: a {kind} measurement needs columns {wanted}; this file has {', '.join(present)}. "
            f"Name yours like --column {COLUMNS[kind][0]}='{present[0]}'"
        )
    recording = Recording.read(path, found, {name: unit for name, unit in (units or {}).items() if name in found})
    known = {name: ALIASES.get(name, name) if ALIASES.get(name) not in found else name for name in recording.names}
    return Recording(
        {known[name]: recording[name] for name in recording.names},
        {known[name]: recording.unit(name) for name in recording.names},
        title=recording.title,
    )
