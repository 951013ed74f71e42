"""MDF files of measurement systems in vehicles and test benches, versions 3 and 4, by asammdf."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.files.array_table import Grid, GridTable, grid_table
from strainwave.files.labels import read_by_others
from strainwave.messages import one_line

Array = NDArray[np.float64]


def open_mdf(path: str | Path) -> GridTable:
    """The channels of an MDF file that hold numbers, each group of them on a grid of its own."""
    try:
        from asammdf import MDF
    except ImportError:
        raise ImportError(f"{Path(path).name}: MDF files are read by asammdf: pip install strainwave[formats]") from None

    grids: list[Grid] = []
    units: dict[str, str] = {}
    with read_by_others(path, "MDF"), _silent("asammdf"), Path(path).open("rb") as file, MDF(file) as opened:
        for number in range(len(opened.groups)):
            signals = [signal for signal in _signals(opened, number) if len(signal.samples)]
            columns: dict[str, Array] = {}
            for signal in signals:
                name = _unique(signal.name, number, {name for grid in grids for name in grid.columns} | columns.keys())
                columns[name] = _values(signal)
                if signal.unit:
                    units[name] = str(signal.unit)
            if columns:
                grids.append(Grid(np.asarray(signals[0].timestamps, float), columns))
    return grid_table(one_line(str(path)), "", grids, units)


@contextmanager
def _silent(logger: str) -> Iterator[None]:
    """Keeps a library from writing to the terminal what is then said by an error, or does not matter."""
    log, before = logging.getLogger(logger), logging.getLogger(logger).disabled
    log.disabled = True
    try:
        yield
    finally:
        log.disabled = before


def _signals(opened: Any, number: int) -> list[Any]:
    """The channels of a group but for its time."""
    found = []
    master = opened.masters_db.get(number)
    for index, channel in enumerate(opened.groups[number].channels):
        if index != master:
            signal = opened.get(channel.name, group=number, index=index)
            if signal.samples.dtype.kind in "fiub" and signal.samples.ndim == 1:
                found.append(signal)
    return found


def _values(signal: Any) -> Array:
    """The samples, nan where the file says that they are not valid."""
    values = np.array(signal.samples, float)
    if (invalid := signal.invalidation_bits) is not None:
        values[np.asarray(invalid, bool)] = np.nan
    return values


def _unique(name: str, group: int, taken: set[str]) -> str:
    return name if name not in taken else f"{name}.{group}"
