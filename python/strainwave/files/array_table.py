"""Columns that are in memory already, as formats give them that are read at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import ColumnSource, Content, Label
from strainwave.files.units import measures
from strainwave.messages import listed, one_line, quoted

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ArrayTable:
    """Columns by their names in the file, all of one length; the columns left out, in words; and single numbers.

    Attributes:
        runs: tables of several recordings in the file, of which this one is the longest; empty if it has one
    """

    file: str
    title: str
    labels: Sequence[Label]
    columns: Sequence[Array]
    left_out: Sequence[str] = ()
    singles: Mapping[str, float] = field(default_factory=dict)
    runs: Sequence[ArrayTable] = ()

    @property
    def contents(self) -> list[Content]:
        return ["numbers" for _ in self.labels]

    def numbers(self, sources: Sequence[ColumnSource]) -> dict[str, Array]:
        """The columns wanted."""
        return {source.name: self.columns[source.position] for source in sources}

    def measured(self, sources: Sequence[ColumnSource]) -> tuple[dict[str, Array], list[str]]:
        """The columns wanted, nan where nothing is written; and what was left out."""
        return self.numbers(sources), list(self.left_out)

    def place(self, row: int) -> str:
        return f"row {row}"


@dataclass(frozen=True, eq=False)
class Grid:
    """Channels that were sampled at the same instants.

    Args:
        time: of the samples [s], shape (n,)
        columns: by their names, each of shape (n,)
    """

    time: Array
    columns: Mapping[str, Array]


@dataclass(frozen=True, eq=False)
class GridTable:
    """Channels of several grids in time; the first label is the time, which is that of the grid of what is wanted.

    Channels of several grids are put on the slowest of them, but for temperatures, by linear interpolation; see `measured`.
    """

    file: str
    title: str
    labels: Sequence[Label]
    grids: Sequence[Grid]
    left_out: Sequence[str] = ()

    @property
    def contents(self) -> list[Content]:
        return ["numbers" for _ in self.labels]

    def numbers(self, sources: Sequence[ColumnSource]) -> dict[str, Array]:
        """The columns wanted, which must be of one grid."""
        grids = self._grids(sources)
        if len(grids) > 1:
            wanted = self._wanted(sources)
            pair = " and ".join(quoted(next(name for name in grid.columns if name in wanted)) for grid in grids[:2])
            raise ValueError(f"{self.file}: {pair} were sampled at other instants; read them one by one")
        return self._on(grids[0], grids[:1], sources)

    def measured(self, sources: Sequence[ColumnSource]) -> tuple[dict[str, Array], list[str]]:
        """The columns wanted on the slowest of their grids; and what was done."""
        grids = self._grids(sources)
        if len(grids) == 1:
            return self._on(grids[0], grids, sources), list(self.left_out)
        slowest = max(self._grids([each for each in sources if not measures(each.unit, "K")]), key=_step)
        begin, end = max(grid.time[0] for grid in grids), min(grid.time[-1] for grid in grids)
        rows = slice(*np.searchsorted(slowest.time, [begin, np.nextafter(end, np.inf)]))
        if not len(slowest.time[rows]):
            raise ValueError(f"{self.file}: the channels wanted were not sampled at the same time")
        common = Grid(slowest.time[rows], {name: values[rows] for name, values in slowest.columns.items()})
        others = [grid for grid in grids if grid is not slowest]
        wanted = self._wanted(sources)
        moved = listed(name for grid in others for name in grid.columns if name in wanted)
        rate = f"{1.0 / _step(slowest):.4g} Hz"
        remark = f"sampled at other instants, and put on the {rate} of the others by linear interpolation: {moved}"
        return self._on(common, [common, *others], sources), [remark, *self.left_out]

    def place(self, row: int) -> str:
        return f"sample {row}"

    def _wanted(self, sources: Sequence[ColumnSource]) -> list[str]:
        return [self.labels[source.position].text for source in sources if source.position]

    def _grids(self, sources: Sequence[ColumnSource]) -> list[Grid]:
        """The grids of what is wanted; the first one where that is the time alone."""
        wanted = self._wanted(sources)
        return [grid for grid in self.grids if any(name in grid.columns for name in wanted)] or [self.grids[0]]

    def _on(self, common: Grid, grids: Sequence[Grid], sources: Sequence[ColumnSource]) -> dict[str, Array]:
        """Return the columns of some sources at the instants of a grid."""
        found = {}
        for source in sources:
            if not source.position:
                found[source.name] = common.time
                continue
            name = self.labels[source.position].text
            grid = next(each for each in grids if name in each.columns)
            values = grid.columns[name]
            found[source.name] = values if grid.time is common.time else np.interp(common.time, grid.time, values)
        return found


def _step(grid: Grid) -> float:
    return float(np.median(np.diff(grid.time))) if len(grid.time) > 1 else np.inf


def grid_table(
    file: str, title: str, grids: Sequence[Grid], units: Mapping[str, str], left_out: Sequence[str] = ()
) -> GridTable:
    """The table of grids, whose names differ; and in words what of the file was left out."""
    if not grids:
        raise ValueError(one_line("; ".join([f"{file} holds no series of numbers", *left_out])))
    names = [name for grid in grids for name in grid.columns]
    labels = [Label("time", "time", "s"), *(Label(name, name, units.get(name) or None) for name in names)]
    return GridTable(file, title, labels, grids, [one_line(each) for each in left_out])
