"""What a torsion test leaves beside its report: loops, the angle of each photograph, and every number found."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from io import StringIO
from math import degrees, isfinite
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from strainwave.rig.loop import Loop
from strainwave.rig.vision.angle import Angles

ANGLE_COLUMNS = ("image", "sha256", "angle [rad]", "angle_sigma [rad]", "fault", "warnings")
MARKER_COLUMNS = {
    "x": "px",
    "y": "px",
    "radius": "px",
    "sigma": "px",
    "residual": "px",
    "contrast": "",
    "blur": "px",
    "arc": "",
}


def loop_names(loops: Sequence[Loop]) -> list[str]:
    """A name for each loop, as its files have it: unit, position and, where several are alike, a number.

    >>> turned = [Loop([0.0, 0.1], [0.0, 0.1], side="input", name="a", position=p) for p in (0.0, 1.0471975511965976, 0.0)]
    >>> loop_names(turned)
    ['loop-0deg-1', 'loop-60deg', 'loop-0deg-2']
    """
    plain = [f"loop-{_file_part(loop.unit)}{degrees(loop.position):.6g}deg" for loop in loops]
    names = []
    for place, name in enumerate(plain):
        names.append(f"{name}-{plain[: place + 1].count(name)}" if plain.count(name) > 1 else name)
    return names


def _file_part(text: str) -> str:
    """A text as part of a file's name."""
    kept = "".join(each if each.isalnum() or each in "._" else "-" for each in text)
    return f"{kept.strip('-.')}-" if kept.strip("-.") else ""


def loop_files(loops: Sequence[Loop]) -> dict[str, bytes]:
    """Each loop as CSV and as Parquet, as `strainwave twin --torsion` reads them."""
    made = {}
    with TemporaryDirectory() as folder:
        for name, loop in zip(loop_names(loops), loops, strict=True):
            recording = loop.recording()
            for path, write in (
                (Path(folder, f"{name}.csv"), recording.to_csv),
                (Path(folder, f"{name}.parquet"), recording.to_parquet),
            ):
                write(path)
                made[path.name] = path.read_bytes()
    return made


def angles_csv(angles: Sequence[Angles]) -> str:
    """What each photograph told, a row for each: its angle, both markers, and what is wrong with it."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    units = {name: f" [{unit}]" if unit else "" for name, unit in MARKER_COLUMNS.items()}
    markers = [f"marker_{number}_{name}{units[name]}" for number in (1, 2) for name in MARKER_COLUMNS]
    writer.writerow([*ANGLE_COLUMNS, *markers])
    for each in angles:
        told = {frame.name: (angle, sigma) for frame, angle, sigma in zip(each.useful, each.angle, each.sigma, strict=True)}
        for frame in each.frames:
            angle, sigma = told.get(frame.name, ("", ""))
            row = [frame.name, frame.sha256, angle, sigma, frame.fault, "; ".join(frame.warnings)]
            pair = frame.markers or ()
            writer.writerow([*row, *(getattr(marker, name) for marker in pair for name in MARKER_COLUMNS)])
    return text.getvalue()


def results_json(found: Mapping[str, Any]) -> str:
    """Every number found, as JSON: SI units unless a unit stands beside; null where there is no number."""
    return json.dumps(plain(found), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def plain(value: Any) -> Any:
    """A value of dataclasses, arrays and numbers in the types that JSON has.

    >>> plain({"a": np.array([1.0, np.nan]), "b": (True, Path("x"))})
    {'a': [1.0, None], 'b': [True, 'x']}
    """
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {str(key): plain(each) for key, each in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, list | tuple | set | frozenset):
        return [plain(each) for each in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float):
        return value if isfinite(value) else None
    return value if value is None or isinstance(value, bool | int | str) else str(value)
