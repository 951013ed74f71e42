"""Tables in memory: columns, grids in time, and the variables of formats that are read at once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.files.budget import ReadBudget, RefusedFile
from strainwave.files.labels import ColumnSource, Content, Label, check_names, label_of
from strainwave.files.units import measures
from strainwave.messages import listed, one_line, quoted

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ArrayTable:
    """Columns by their names in the file, all of one length; the columns left out, in words; and single numbers.

    Attributes:
        others: series of another length, by their names
        runs: tables of several recordings in the file, of which this one is the longest; empty if it has one
    """

    file: str
    title: str
    labels: Sequence[Label]
    columns: Sequence[Array]
    left_out: Sequence[str] = ()
    singles: Mapping[str, float] = field(default_factory=dict)
    others: Mapping[str, Array] = field(default_factory=dict)
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
        resampled = {}
        for source in sources:
            if not source.position:
                resampled[source.name] = common.time
                continue
            name = self.labels[source.position].text
            grid = next(each for each in grids if name in each.columns)
            values = grid.columns[name]
            resampled[source.name] = values if grid.time is common.time else np.interp(common.time, grid.time, values)
        return resampled


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


# ---- Variables -------------------------------------------------------------------------------------------------------


MAX_MATRIX_COLUMNS = 100  # more columns are no channels
MAX_NESTING = 6  # structures in structures: a bound for the work that a file from outside can cause
IN_THE_NAME = "in the name, if at all, as `speed_rpm`"  # where the unit of a variable stands
NUMBERS_OF_SCOPE = ".signals.values"  # as Simulink saves a scope, with a series of the time


class Unreadable(NamedTuple):
    """A variable of a file that only the program can read that wrote it."""

    what: str


def object_of_matlab(kind: str) -> Unreadable:
    """Return the reason why an object of MATLAB is left out, as a table, a timetable, a timeseries or a Simulink data set."""
    save = "save its numbers instead, as with s = struct('t', x.Time, 'q', x.Data), or write a .csv with writetable"
    return Unreadable(f"an object of MATLAB ({kind}), which MATLAB alone reads: {save}")


def table_of(file: str, variables: Iterable[tuple[str, Any]], budget: ReadBudget) -> ArrayTable:
    """The series that are of the length most of them have.

    A series is a variable, or a field of a structure, as `data.q`; a matrix holds several, `q_1`, `q_2` …, and one without a
    name `column_1`, `column_2` … Arrays of structures that are alike are several runs: the longest is this table, and each is
    one of its `runs`. Of such arrays within structures the longest run is taken. Series of another length are left out with a
    remark.

    Raises:
        ValueError: there is no series of numbers, or the series take more than the budget allows
    """
    variables = list(variables)
    counts = {name: len(value) for name, value in variables if _are_runs(value)}
    if not counts:
        return _table_of_one(file, variables, budget)
    count = max(counts.values())
    runs = [
        _table_of_one(
            f"{file}({number + 1})",
            [(name, value[number] if counts.get(name) == count else value) for name, value in variables],
            budget,
        )
        for number in range(count)
    ]
    longest = max(range(count), key=lambda number: len(runs[number].columns[0]))
    first = next(name for name, number in counts.items() if number == count)
    return replace(runs[longest], left_out=[*runs[longest].left_out, _taken(first, count, longest)], runs=runs)


def _are_runs(value: Any) -> bool:
    """True for several structures that are alike and contain series, as of several runs; signals of a scope are one run."""
    if not isinstance(value, list) or len(value) < 2 or not all(isinstance(each, Mapping) for each in value):
        return False
    if len({tuple(each) for each in value}) > 1 or "values" in value[0]:
        return False
    return all(any(isinstance(part, np.ndarray) and part.size > 1 for part in each.values()) for each in value)


def _table_of_one(file: str, variables: Iterable[tuple[str, Any]], budget: ReadBudget) -> ArrayTable:
    """Return the table of one recording; see `table_of`."""
    series: dict[str, Array] = {}
    singles: dict[str, float] = {}
    left_out: list[str] = []
    try:
        for name, value in variables:
            for part, values in _series(name, value, left_out, budget):
                if values.size == 1:
                    singles[part] = float(values[0])
                else:
                    series[part] = values
        check_names(series)
    except RefusedFile as error:
        raise ValueError(one_line(f"{file}: {error}")) from None
    if not series:
        raise ValueError(one_line("; ".join([f"{file} holds no series of numbers", *left_out])))
    length, _ = max(Counter(len(values) for values in series.values()).items(), key=lambda each: (each[1], each[0]))
    kept = {name: values for name, values in series.items() if len(values) == length}
    others = {name: values for name, values in series.items() if name not in kept}
    lengths = listed(f"{name} ({len(values)})" for name, values in others.items())
    left_out += [f"of another length than {length}, and left out: {lengths}"] if others else []
    return ArrayTable(file, "", [label_of(name) for name in kept], list(kept.values()), left_out, singles, others)


def _series(
    name: str, value: Any, left_out: list[str], budget: ReadBudget, depth: int = MAX_NESTING
) -> Iterator[tuple[str, Array]]:
    """The series that a variable holds."""
    budget.take_node()
    budget.take_bytes(len(name), "the names of its variables")
    if isinstance(value, Unreadable):
        left_out.append(f"{name or 'its array'} is left out: {value.what}")
    elif isinstance(value, Mapping):
        for key, each in value.items() if depth else ():
            yield from _series(f"{name}.{key}" if name else str(key), each, left_out, budget, depth - 1)
    elif isinstance(value, list) or (isinstance(value, np.ndarray) and value.dtype == object):
        if depth:
            values = list(value.ravel()) if isinstance(value, np.ndarray) else value
            yield from _several(name, values, left_out, budget, depth - 1)
    else:
        yield from _matrix(name.removesuffix(NUMBERS_OF_SCOPE), value, budget)


def _several(
    name: str, values: Sequence[Any], left_out: list[str], budget: ReadBudget, depth: int
) -> Iterator[tuple[str, Array]]:
    """The series in a list: of structures that are alike the longest, of signals each by its label, else each by its number."""
    structures = [each for each in values if isinstance(each, Mapping)]
    if len(structures) > 1 and len({tuple(each) for each in structures}) == 1 and "values" not in structures[0]:
        read = [list(_series(name, each, [], budget, depth)) for each in structures]
        longest = max(range(len(read)), key=lambda place: max((len(found) for _, found in read[place]), default=0))
        left_out.append(_taken(name, len(read), longest))
        yield from read[longest]
        return
    for number, each in enumerate(values, start=1):
        if isinstance(each, Mapping) and "values" in each:
            label = each.get("label")
            yield from _matrix(label if isinstance(label, str) and label else f"{name}_{number}", each["values"], budget)
        else:
            yield from _series(name if len(values) == 1 else f"{name}_{number}", each, left_out, budget, depth)


def _taken(name: str, count: int, place: int) -> str:
    taken = f"of which number {place + 1} is taken, the first of the longest"
    return f"{name} holds {count} recordings, {taken}; save each in a file of its own"


def _matrix(name: str, value: Any, budget: ReadBudget) -> Iterator[tuple[str, Array]]:
    """The series that an array of numbers holds."""
    array = np.asarray(value)
    if array.dtype.kind not in "fiub" or array.ndim > 2 or array.size == 0:
        return
    if array.dtype != float:
        budget.take_bytes(8 * array.size, "its numbers")
    matrix = np.atleast_2d(array.astype(float, copy=False))
    columns = matrix.T if matrix.shape[0] < matrix.shape[1] else matrix
    budget.take_bytes(min(columns.shape[1], MAX_MATRIX_COLUMNS) * len(name), "the names of its columns")
    if columns.shape[1] == 1:
        yield name or "column_1", columns[:, 0]
    elif columns.shape[1] <= MAX_MATRIX_COLUMNS:
        yield from ((f"{name or 'column'}_{number}", columns[:, number - 1]) for number in range(1, columns.shape[1] + 1))
