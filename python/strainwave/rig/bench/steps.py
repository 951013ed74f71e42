"""The steps of a torsion test, and its record `steps.csv`, a row for each step.

What is wrong in a record is refused in one line with file, line and column; nothing is repaired. docs/how-to/torsion-rig.md
shows the format.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from math import degrees
from pathlib import Path
from typing import Any

from strainwave import arguments
from strainwave.files.folder import inside
from strainwave.files.gear_file import at
from strainwave.files.labels import Label
from strainwave.files.text_table import open_csv
from strainwave.files.units import convert
from strainwave.files.writing import replacing
from strainwave.messages import listed, quoted, shortened
from strainwave.number_texts import number_in
from strainwave.rig.loop import not_negative, positive, signed

MAX_NAME = 200  # characters of a name of a photograph or a specimen


@dataclass(frozen=True)
class Step:
    """A step of a test: masses on the pans, and the shaft at rest.

    Args:
        number: in the order made, from 1
        mass_positive: total on the pair of pans that turns the shaft positively [kg]
        mass_negative: total on the other pair [kg]
        image: file name of the photograph, relative to the folder of the test; None if the angle was read otherwise
        angle: read otherwise [rad], or None
        torque: measured otherwise, instead of masses [N.m], or None
        time: since the test began [s], or None
        temperature: of the gear [K], or None
        position: how far the flexspline was turned in its mount [rad]
        unit: which specimen

    Raises:
        ValueError: a mass is negative, a number is not finite, or a text has spaces around it or more than one line

    >>> Step(2, mass_positive=0.3).mass_positive
    0.3
    >>> Step(3, mass_positive=-0.3)
    Traceback (most recent call last):
    ValueError: mass_positive = -0.3 kg must lie in [0, 1e+12]
    """

    number: int
    mass_positive: float = 0.0
    mass_negative: float = 0.0
    image: str | None = None
    angle: float | None = None
    torque: float | None = None
    time: float | None = None
    temperature: float | None = None
    position: float = 0.0
    unit: str = ""

    @property
    def place(self) -> tuple[float, str]:
        """Position of the flexspline [rad], and specimen."""
        return self.position, self.unit

    def __post_init__(self) -> None:
        arguments.whole("number", self.number, low=1)
        for name in ("mass_positive", "mass_negative"):
            not_negative(name, getattr(self, name), "kg")
        signed("position", self.position, "rad")
        _check_name("unit", self.unit)
        if self.image is not None:
            _check_name("image", self.image)
        for name, unit in (("angle", "rad"), ("torque", "N.m"), ("time", "s")):
            if (value := getattr(self, name)) is not None:
                signed(name, value, unit)
        if self.temperature is not None:
            positive("temperature", self.temperature, "K")


def by_place(steps: Sequence[Step]) -> dict[tuple[float, str], list[Step]]:
    """Return the steps of each position and specimen, in the order made."""
    places: dict[tuple[float, str], list[Step]] = {}
    for step in steps:
        places.setdefault(step.place, []).append(step)
    return places


def place_words(place: tuple[float, str]) -> str:
    """Return a position of the flexspline and a specimen in words."""
    position, unit = place
    return f"{f'unit {unit}, ' if unit else ''}flexspline at {degrees(position):.6g} degrees"


def _check_name(name: str, text: str) -> None:
    if text != arguments.text(name, text).strip() or not text.isprintable() or len(text) > MAX_NAME:
        limits = f"of at most {MAX_NAME} characters"
        raise ValueError(f"{name} = {shortened(text)} must be one line of text without spaces around it, {limits}")


FILE = "steps.csv"
MASSES = ("mass_positive", "mass_negative")
TEXTS = ("image", "unit")
# Each number of a step with its unit in a step, and the unit in which it is written.
UNITS = {
    "mass_positive": ("kg", "kg"),
    "mass_negative": ("kg", "kg"),
    "angle": ("rad", "rad"),
    "torque": ("N.m", "N.m"),
    "time": ("s", "s"),
    "temperature": ("K", "degC"),
    "position": ("rad", "deg"),
}
DEFAULTS = {field.name: field.default for field in fields(Step)}
COLUMNS = tuple(DEFAULTS)
HEADER = {name: f"{name} [{UNITS[name][1]}]" if name in UNITS else name for name in COLUMNS}


def read_steps(path: str | Path) -> list[Step]:
    """Read the steps of a test.

    A cell may be empty where a step has no such thing; a mass only where the torque was measured otherwise.

    Args:
        path: `steps.csv`, or the folder of the test that holds it

    Returns:
        The steps in their order, in SI units.

    Raises:
        ValueError: the file cannot be read, a column is not known or missing, or a cell is wrong, with its line

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "steps.csv")
    ...     _ = path.write_text("number,mass_positive [g],image\\n1,350,a.png\\n2,300,b.png\\n")
    ...     [(round(step.mass_positive, 6), step.image) for step in read_steps(path)]
    [(0.35, 'a.png'), (0.3, 'b.png')]
    """
    table = open_csv(_file(path))
    with at(table.file):
        labels = _labels(table.labels)
    steps: list[Step] = []
    for line, cells in table.texts():
        with at(f"{table.file} line {line}"):
            steps.append(_read_row(dict(zip(labels, cells, strict=True)), labels, table.delimiter))
            _check_order(steps[-2:])
    return steps


def write_steps(steps: Sequence[Step], path: str | Path) -> None:
    """Write the steps of a test, with the columns that are used; `read_steps` reads them back.

    Args:
        steps: the steps
        path: `steps.csv`, or the folder of the test

    Raises:
        ValueError: there are no steps, or their numbers do not increase
        OSError: the file cannot be written

    >>> import pathlib, tempfile
    >>> import strainwave as sw
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     sw.rig.write_steps([sw.rig.Step(1, mass_positive=0.35, image="001.png")], folder)
    ...     print(pathlib.Path(folder, "steps.csv").read_text(), end="")
    number,mass_positive [kg],mass_negative [kg],image
    1,0.35,0.0,001.png
    """
    if not steps:
        raise ValueError("there are no steps to write")
    for pair in pairwise(steps):
        _check_order(pair)
    used = [name for name in COLUMNS if any(getattr(step, name) != DEFAULTS[name] for step in steps)]
    if any(step.torque is None for step in steps):
        used = [name for name in COLUMNS if name in (*used, *MASSES)]
    with replacing(_file(path)) as file:
        file.write("".join([_row([HEADER[name] for name in used]), *(_written(step, used) for step in steps)]).encode())


def append_step(step: Step, path: str | Path) -> None:
    """Add a step to the record of a test. A new record is begun if there is none.

    The file is complete at any moment: a new file with all steps is written next to it and then replaces it.

    Args:
        step: the step
        path: `steps.csv`, or the folder of the test

    Raises:
        ValueError: the record cannot be read, has no column for what the step has, or ends with a step of this number or later
        OSError: the file cannot be written

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     append_step(Step(1, mass_positive=0.35, image="001.png"), folder)
    ...     append_step(Step(2, mass_positive=0.3, image="002.png"), folder)
    ...     len(read_steps(folder))
    2
    """
    file = _file(path)
    if not file.exists():
        with replacing(file) as draft:
            draft.write((_row(HEADER.values()) + _written(step, COLUMNS)).encode())
        return
    table, before = open_csv(file), read_steps(file)
    with at(table.file):
        _check_order((before[-1], step))
        labels = _labels(table.labels)
        needed = [name for name in COLUMNS if getattr(step, name) != DEFAULTS[name]]
        if step.torque is None and not labels.keys() & {*MASSES}:
            needed = [name for name in COLUMNS if name in (*needed, *MASSES)]
        if missing := [name for name in needed if name not in labels]:
            raise ValueError(
                f"has no column {missing[0]}, which step {step.number} has; add {HEADER[missing[0]]} to its header"
            )
    with replacing(file) as draft:
        content = file.read_bytes()
        draft.write(content if content.endswith(b"\n") else content + b"\n")
        draft.write(_written(step, list(labels), labels, table.delimiter).encode())


def _file(path: str | Path) -> Path:
    return inside(Path(path), FILE) if Path(path).is_dir() else Path(path)


def photograph_of(step: Step, folder: Path) -> Path:
    """The path of the photograph of a step, which lies in the folder of the test.

    Raises:
        ValueError: it lies elsewhere
    """
    with at(f"{folder / FILE} step {step.number} image:"):
        return inside(folder, str(step.image))


# Reading


def _labels(labels: Sequence[Label]) -> dict[str, Label]:
    """Return the columns by name; refuse unknown, repeated and missing ones."""
    named = {label.name: label for label in labels}
    if unknown := [label.name for label in labels if label.name not in COLUMNS]:
        raise ValueError(f"has a column {quoted(unknown[0])}; the steps of a test have {listed(COLUMNS)}")
    if len(named) < len(labels):
        twice = next(name for name in named if [label.name for label in labels].count(name) > 1)
        raise ValueError(f"has two columns {quoted(twice)}; names must differ")
    for name, label in named.items():
        if name in UNITS and label.unit is None:
            raise ValueError(f"column {quoted(name)} has no unit; write {HEADER[name]}")
        if name in UNITS:
            with at(f"column {quoted(name)}:"):
                convert(1.0, str(label.unit), UNITS[name][0])
    if "number" not in named:
        raise ValueError("has no column number, which counts the steps in the order made, from 1")
    if not named.keys() & {*MASSES, "torque"}:
        raise ValueError(f"has no masses; write {HEADER['mass_positive']} and {HEADER['mass_negative']}, or {HEADER['torque']}")
    return named


def _read_row(cells: Mapping[str, str], labels: Mapping[str, Label], delimiter: str) -> Step:
    members: dict[str, Any] = {}
    for name, cell in cells.items():
        with at(f"column {quoted(name)}:"):
            if name == "number":
                if not re.fullmatch(r"[0-9]{1,9}", cell):
                    raise ValueError(f"{quoted(cell)} must be a whole number, from 1 to 999999999")
                members[name] = int(cell)
            elif name in TEXTS:
                members |= {name: cell} if cell else {}
            elif cell:
                number = number_in(cell if delimiter == "," else cell.replace(",", "."))
                members[name] = convert(number, str(labels[name].unit), UNITS[name][0])
            else:
                _check_empty(name, cells)
    return Step(**members)


def _check_empty(name: str, cells: Mapping[str, str]) -> None:
    if name in MASSES and not cells.get("torque"):
        raise ValueError("is empty; write 0 where nothing lies on the pans")
    if name == "torque" and not cells.keys() & {*MASSES}:
        raise ValueError("is empty, and there are no masses")


def _check_order(steps: Sequence[Step]) -> None:
    if len(steps) == 2 and steps[1].number <= steps[0].number:
        order = "numbers count the steps in the order made"
        raise ValueError(f"step {steps[1].number} stands after step {steps[0].number}; {order}")


# Writing


def _written(step: Step, names: Sequence[str], labels: Mapping[str, Label] | None = None, delimiter: str = ",") -> str:
    """Return the row of a step, in the units of the header or the usual ones."""
    cells = []
    for name in names:
        value = getattr(step, name)
        if name in UNITS and value is not None:
            unit = str(labels[name].unit) if labels else UNITS[name][1]
            cells.append(_shortest(value, UNITS[name][0], unit))
        else:
            cells.append("" if value is None else str(value))
    return _row(cells, delimiter)


def _shortest(value: float, unit: str, written: str) -> str:
    """Return a number in another unit, in the fewest digits that are read back the same."""
    if unit == written:
        return repr(float(value))
    converted = convert(float(value), unit, written)
    texts = [f"{converted:.{digits}g}" for digits in range(6, 18)]
    return next((text for text in texts if convert(float(text), written, unit) == value), texts[-1])


def _row(cells: Any, delimiter: str = ",") -> str:
    text = io.StringIO()
    csv.writer(text, delimiter=delimiter, lineterminator="\n").writerow(cells)
    return text.getvalue()
