"""Tables in which each channel has its own time: pairs of columns, as scopes and recorders of servo drives export them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from strainwave.files.array_table import Grid, GridTable, grid_table
from strainwave.files.labels import Label, Source
from strainwave.files.tables import OpenTable
from strainwave.files.units import convert, measures
from strainwave.identification.reading.names import meaning

Array = NDArray[np.float64]

MIN_PAIRS = 2  # of a time and a channel


def with_own_times(table: OpenTable) -> OpenTable:
    """Return the table with channels of equal times beside one time, if each channel has an increasing time before it.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from strainwave.files.tables import open_table
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "a.csv").write_text("t [ms];Position;t [ms];Torque\\n0;1,5;0;7\\n1;1,6;2;8\\n2;1,7;;\\n")
    ...     table = with_own_times(open_table(Path(folder, "a.csv")))
    >>> [label.name for label in table.labels], [grid.time.tolist() for grid in table.grids]
    (['time', 'Position', 'Torque'], [[0.0, 0.001, 0.002], [0.0, 0.002]])
    """
    labels = [label for label in table.labels if label.text]
    is_time = [(found := meaning(label)) is not None and found.quantity == "time" for label in labels]
    pairs = len(labels) // 2
    if pairs < MIN_PAIRS or len(labels) % 2 or is_time != [True, False] * pairs or isinstance(table, GridTable):
        return table
    units = [_unit_of_time(label) for label in labels[::2]]
    if len({label.name for label in labels[1::2]}) < pairs:
        return table
    numbers, remarks = table.measured([Source(place, label.name, str(place), "1") for place, label in enumerate(labels)])
    grids = list[Grid]()
    for place, unit in zip(range(0, len(labels), 2), units, strict=True):
        time, values = numbers[str(place)], numbers[str(place + 1)]
        rows = np.isfinite(time) & np.isfinite(values)
        time, values, name = convert(time[rows], unit, "s"), values[rows], labels[place + 1].name
        if not len(time) or not (np.diff(time) > 0.0).all():
            return table
        same = next((at for at, grid in enumerate(grids) if np.array_equal(grid.time, time)), None)
        if same is None:
            grids.append(Grid(time, {name: values}))
        else:
            grids[same] = Grid(time, {**grids[same].columns, name: values})
    stated = {label.name: label.unit or "" for label in labels[1::2]}
    return grid_table(table.file, table.title, grids, stated, [*remarks, *table.left_out])


def _unit_of_time(label: Label) -> str:
    return label.unit if label.unit is not None and measures(label.unit, "s") else "s"
