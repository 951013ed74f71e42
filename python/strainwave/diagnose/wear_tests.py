"""Tests of one gear from files, for `wear_life`: a table with a row for each, or the gear that `identify` wrote of each."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from pathlib import Path

from strainwave import arguments
from strainwave.diagnose.wear import QUANTITY_UNITS, resolution_of
from strainwave.files import units
from strainwave.files.entries import numbers_of
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.messages import listed, quoted
from strainwave.number_texts import is_number, number_in

MEASURED = "identified from"  # begins the source of a number that a file determines by itself
PATHS = {  # of the numbers of a gear that are a quantity
    "play": re.compile(r"gear\.stiffness\.clearance"),
    "amplitude": re.compile(r"gear\.kinematic_error\.(law\.)*amplitude\[\d+\]"),
    "friction": re.compile(r"gear\.friction_(input|mesh)\.(law\.)*coulomb"),
    "stiffness": re.compile(r"gear\.stiffness\.(law\.)*(k|k1|k2|k3|a1)"),
}


@dataclass(frozen=True)
class WearTests:
    """Tests of one gear.

    Attributes:
        work: that the gear had transmitted before each test [J], shape (n,)
        values: of each test, by the name of the quantity, shape (n,)
        names: number of the gear that stands for each quantity, or its column
        resolution: of the values of each quantity, by the last digit that was written
        sigma: root mean square of the standard deviations that the gears state of each quantity; empty of a table
    """

    work: tuple[float, ...]
    values: dict[str, tuple[float, ...]]
    names: dict[str, str]
    resolution: dict[str, float]
    sigma: dict[str, float]


def read_wear_tests(
    files: Sequence[Path], quantities: Sequence[str], work: str | None = None, work_per_hour: float | None = None
) -> WearTests:
    """Return the tests of one gear from a table, or from a gear file of each test.

    Args:
        files: one table with columns called as the quantities, and work [J], or time [h] if the work per hour is given; or gear
            files in the order of the tests
        quantities: play, amplitude, friction, stiffness
        work: that the gear had transmitted before each test, as "0, 1e6, 2e6" [J], if the table lacks it, or of gear files
        work_per_hour: of the duty [J]

    Raises:
        ValueError: a quantity is not known, not in the table, or not identified in a gear file; the work or a file is missing
            or given twice; or there are several tables
    """
    if unknown := [name for name in quantities if name not in QUANTITY_UNITS]:
        raise ValueError(f"--limit {unknown[0]}: wear has the quantities {listed(QUANTITY_UNITS)}")
    tables = [file for file in files if not file.is_dir() and file.suffix.lower() != ".toml"]
    if tables and len(files) > 1:
        raise ValueError(f"{tables[0]} is a table, and one of {len(files)} files; give one table, or a gear file of each test")
    if tables:
        values, done, resolution = _of_table(files[0], quantities, work is None, work_per_hour)
        names, sigma = {name: f"column {name}" for name in quantities}, dict[str, float]()
    else:
        values, names, sigma = _of_gears(files, quantities)
        done, resolution = (), {name: resolution_of(values[name]) for name in quantities}
    if work is not None:
        done = tuple(number_in(text.strip()) for text in work.split(","))
    if not done:
        raise ValueError("gear files do not contain the work of the gear; give that before each test, as --work 0,1e6,2e6")
    count = len(next(iter(values.values())))
    if len(done) != count:
        raise ValueError(f"--work has {len(done)} numbers for {count} tests; give one for each, as 0,1e6,2e6")
    return WearTests(done, values, names, resolution, sigma)


def limits_in(texts: Sequence[str]) -> dict[str, float]:
    """Return the value at which each quantity is worn out, in SI units.

    Raises:
        ValueError: a name is none of the quantities or given twice, or a value no number of its unit

    >>> limits_in(["play=0.3 mrad", "stiffness=15e3"])
    {'play': 0.0003, 'stiffness': 15000.0}
    """
    limits = {}
    for text in texts:
        name, _, value = text.partition("=")
        if name not in QUANTITY_UNITS or not value:
            raise ValueError(f"--limit {text}: write NAME=VALUE, as play=4e-4; names are {listed(QUANTITY_UNITS)}")
        if name in limits:
            raise ValueError(f"--limit {name} is given twice; give one")
        limits[name] = positive_number(f"--limit {name}", value, QUANTITY_UNITS[name])
    return limits


def positive_number(name: str, text: str, unit: str) -> float:
    """Return the number of an option: in a unit, or with its own."""
    return arguments.number(name, number_in(text) if is_number(text) else text, unit, low=0.0)


def _of_table(
    file: Path, quantities: Sequence[str], reads_work: bool, work_per_hour: float | None
) -> tuple[dict[str, tuple[float, ...]], tuple[float, ...], dict[str, float]]:
    """Return the values of each quantity, the work before each test, and the resolution of the values.

    The work is empty if it is not read.
    """
    columns = Recording.header(file)
    by = next((name for name in ("work", "time") if name in columns), "")
    if missing := [name for name in quantities if name not in columns]:
        raise ValueError(f"{file.name} has no column {quoted(missing[0])}; it has {listed(map(quoted, columns))}")
    if by == "work" and not reads_work:
        raise ValueError(f"{file.name} has a column work, and --work is given, too; leave one out")
    wanted = [*quantities, *([by] if reads_work and by else [])]
    table = Recording.read(file, {name: name for name in wanted})
    values = {name: tuple(table.values(name, QUANTITY_UNITS[name]).tolist()) for name in quantities}
    resolution = {
        name: units.convert(resolution_of(table[name].tolist()), table.unit(name), QUANTITY_UNITS[name]) for name in quantities
    }
    if not reads_work:
        return values, (), resolution
    if by == "work":
        return values, tuple(table.values("work", "J").tolist()), resolution
    if by == "time" and work_per_hour is not None:
        return values, tuple((work_per_hour * table.values("time", "h")).tolist()), resolution
    option = "--work-per-hour of the duty" if by else "--work before each test, as 0,1e6,2e6"
    raise ValueError(f"{file.name} has no column work [J]; give {option}")


def _of_gears(
    files: Sequence[Path], quantities: Sequence[str]
) -> tuple[dict[str, tuple[float, ...]], dict[str, str], dict[str, float]]:
    """Return the values of each quantity that all gears determine, the name of its number, and its standard deviation."""
    if twice := [str(file) for place, file in enumerate(files) if file in files[:place]]:
        raise ValueError(f"{twice[0]} is given twice; give the gear file of each test once")
    gears = [GearSet.read(file) for file in files]
    values, names, sigma = {}, {}, {}
    for quantity in quantities:
        measured = [_measured(of_gear, quantity) for of_gear in gears]
        common = [name for name in measured[0] if all(name in of_gear for of_gear in measured)]
        if not common:
            lacking = [str(file) for file, of_gear in zip(files, measured, strict=True) if not of_gear]
            raise ValueError(
                f"no number is the {quantity} of all gears" + (f": {listed(lacking)} identified none" if lacking else "")
            )
        name = min(common, key=lambda name: sum(of_gear[name][1] for of_gear in measured))
        values[quantity], names[quantity] = tuple(of_gear[name][0] for of_gear in measured), name
        squares = [(of_gear[name][0] * of_gear[name][1]) ** 2 for of_gear in measured]
        sigma[quantity] = sqrt(sum(squares) / len(squares))
    return values, names, sigma


def _measured(gear_set: GearSet, quantity: str) -> dict[str, tuple[float, float]]:
    """Return the numbers of a gear that files determined and that are a quantity: value and relative standard deviation."""
    numbers = {path: value for path, value, _ in numbers_of("gear", gear_set.gear)}
    measured = {}
    for path, value in numbers.items():
        entry = gear_set.sources.get(path)
        if entry is None or not entry.source.startswith(MEASURED) or not PATHS[quantity].fullmatch(path):
            continue
        order = numbers.get(path.replace("amplitude", "order"), 0.0)
        name = f"amplitude of order {order:.4g}" if quantity == "amplitude" else path
        measured[name] = value, (entry.uncertainty or 0.0) / max(abs(value), 1e-300)
    return measured
