"""Times that are spread over columns: whole seconds and their parts, or a time before each channel."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from strainwave.files.array_table import Grid, GridTable, grid_table
from strainwave.files.labels import ColumnSource, Content, Label
from strainwave.files.table_format import OpenTable
from strainwave.files.units import convert, measures
from strainwave.identification.reading.names import meaning, words_of

Array = NDArray[np.float64]

SECOND_WORDS = ("s", "sec", "secs", "second", "seconds")
SECOND_PARTS = {
    **dict.fromkeys(("ns", "nsec", "nsecs", "nanosec", "nanosecs", "nanosecond", "nanoseconds"), 1e-9),
    **dict.fromkeys(("us", "usec", "usecs", "microsec", "microseconds"), 1e-6),
}  # s
FILE_TIMES = (1e17, 1e18)  # of Windows, in tenths of a microsecond since 1601: no log has such times in another unit
MIN_PAIRS = 2  # of a time and a channel
MIN_STEPS_BACK = 10.0  # of a clock that has begun anew
MIN_ROWS_OF_RUN = 20  # of each recording in a file: shorter ones are hiccups of the clock
# After which a counter of a clock, or a time of day, begins anew.
COUNTER_PERIODS = (2.0**16, 2.0**31, 2.0**32, 86_400.0, 86_400e3)
MAX_STEPS_OF_COUNTER = 3.0  # from the last count to the first one


def with_one_time(table: OpenTable) -> OpenTable:
    """Return the table with one column of time, if its times are spread over several.

    Stamps of ROS are whole seconds and nanoseconds. Scopes and recorders of servo drives have a time before each channel:
    channels with equal times become those of one time.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from strainwave.files.tables import open_table
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "log.csv").write_text("stamp.sec,stamp.nanosec,q\\n7,500000000,0.1\\n8,0,0.2\\n")
    ...     numbers, _ = with_one_time(open_table(Path(folder, "log.csv"))).measured([ColumnSource(0, "time", "time", "s")])
    ...     _ = Path(folder, "a.csv").write_text("t [ms];Position;t [ms];Torque\\n0;1,5;0;7\\n1;1,6;2;8\\n2;1,7;;\\n")
    ...     table = with_one_time(open_table(Path(folder, "a.csv")))
    >>> numbers["time"].tolist()
    [7.5, 8.0]
    >>> [label.name for label in table.labels], [grid.time.tolist() for grid in table.grids]
    (['time', 'Position', 'Torque'], [[0.0, 0.001, 0.002], [0.0, 0.002]])
    """
    return _with_own_times(_with_whole_time(table))


def _with_whole_time(table: OpenTable) -> OpenTable:
    """Return the table with the sum of a column of whole seconds and one of their parts, if it has both."""
    labels, ends = list(table.labels), [_end(label) for label in table.labels]
    for seconds, (before, unit) in enumerate(ends):
        for part, (start, size) in enumerate(ends) if unit in SECOND_WORDS else ():
            if start == before and size in SECOND_PARTS and _are_one_time(table, seconds, part, SECOND_PARTS[size]):
                labels[seconds] = Label(f"{labels[seconds].text} and {labels[part].text}", "time", "s")
                return SummedTime(table, labels, seconds, ColumnSource(part, "", "parts of seconds", "1"), SECOND_PARTS[size])
    return table


@dataclass(frozen=True, eq=False)
class SummedTime:
    """A table whose time is the sum of whole seconds and their parts, which are no channel of their own.

    Args:
        table: as it is in the file
        labels: of the columns
        seconds: position of the whole seconds
        parts: the column of their parts
        size: of one part [s]
    """

    table: OpenTable
    labels: Sequence[Label]
    seconds: int
    parts: ColumnSource
    size: float

    @property
    def file(self) -> str:
        return self.table.file

    @property
    def title(self) -> str:
        return self.table.title

    @property
    def left_out(self) -> Sequence[str]:
        return self.table.left_out

    @property
    def contents(self) -> Sequence[Content]:
        return ["other" if place == self.parts.position else content for place, content in enumerate(self.table.contents)]

    def numbers(self, sources: Sequence[ColumnSource]) -> dict[str, Array]:
        """Return the columns wanted, all of them numbers."""
        return self._summed(self.table.numbers([*sources, self.parts]), sources)

    def measured(self, sources: Sequence[ColumnSource]) -> tuple[dict[str, Array], list[str]]:
        """Return the columns wanted, nan in empty cells; and what was left out."""
        numbers, remarks = self.table.measured([*sources, self.parts])
        return self._summed(numbers, sources), remarks

    def place(self, row: int) -> str:
        return self.table.place(row)

    def _summed(self, numbers: Mapping[str, Array], sources: Sequence[ColumnSource]) -> dict[str, Array]:
        parts = {source.name: self.size * numbers[self.parts.name] for source in sources if source.position == self.seconds}
        return {source.name: numbers[source.name] + parts.get(source.name, 0.0) for source in sources}


def _end(label: Label) -> tuple[tuple[str, ...], str]:
    """Return the words of a name, and the last of them or the unit, which names what is counted."""
    words = words_of(label.name) + ([label.unit] if label.unit else [])
    if len(words) > 1 and words[-2] in ("nano", "micro"):
        words[-2:] = [words[-2] + words[-1]]
    return (tuple(words[:-1]), words[-1]) if words else ((), "")


def _are_one_time(table: OpenTable, seconds: int, part: int, size: float) -> bool:
    """True if one column contains whole numbers, and the other one parts of one second."""
    if not table.contents[seconds] == table.contents[part] == "numbers":
        return False
    numbers, _ = table.measured([ColumnSource(place, str(place), str(place), "1") for place in (seconds, part)])
    whole, parts = (values[np.isfinite(values)] for values in (numbers[str(seconds)], numbers[str(part)]))
    return bool(
        whole.size and parts.size and (whole == np.round(whole)).all() and parts.min() >= 0.0 and size * parts.max() < 1.0
    )


def _with_own_times(table: OpenTable) -> OpenTable:
    """Return the table with channels of equal times under one time, if each channel has an increasing time before it."""
    labels = [label for label in table.labels if label.text]
    is_time = [(found := meaning(label)) is not None and found.quantity == "time" for label in labels]
    pairs = len(labels) // 2
    if pairs < MIN_PAIRS or len(labels) % 2 or is_time != [True, False] * pairs or isinstance(table, GridTable):
        return table
    channels = {label.name: label.unit or "" for label in labels[1::2]}
    if len(channels) < pairs:
        return table
    numbers, remarks = table.measured([ColumnSource(place, label.name, str(place), "1") for place, label in enumerate(labels)])
    grids = list[Grid]()
    for place, name in zip(range(0, len(labels), 2), channels, strict=True):
        time, values = numbers[str(place)], numbers[str(place + 1)]
        rows = np.isfinite(time) & np.isfinite(values)
        time, values = seconds_of(time[rows], labels[place]), values[rows]
        if not len(time) or not (np.diff(time) > 0.0).all():
            return table
        grids.append(Grid(time, {name: values}))
    return grid_table(table.file, table.title, merged(grids), channels, [*remarks, *table.left_out])


@dataclass(frozen=True, eq=False)
class TableRows:
    """Some rows of a table, which are a recording of their own.

    Args:
        table: of all rows
        labels: of its columns
        rows: of the recording
    """

    table: OpenTable
    labels: Sequence[Label]
    rows: slice

    @property
    def file(self) -> str:
        return self.table.file

    @property
    def title(self) -> str:
        return self.table.title

    @property
    def left_out(self) -> Sequence[str]:
        return self.table.left_out

    @property
    def contents(self) -> Sequence[Content]:
        return self.table.contents

    def numbers(self, sources: Sequence[ColumnSource]) -> dict[str, Array]:
        """Return the columns wanted, all of them numbers."""
        return {name: values[self.rows] for name, values in self.table.numbers(sources).items()}

    def measured(self, sources: Sequence[ColumnSource]) -> tuple[dict[str, Array], list[str]]:
        """Return the columns wanted, nan in empty cells; and what was left out."""
        numbers, remarks = self.table.measured(sources)
        return {name: values[self.rows] for name, values in numbers.items()}, remarks

    def place(self, row: int) -> str:
        return self.table.place(self.rows.start + row)


def runs_in(table: OpenTable) -> list[TableRows]:
    """Return the recordings in a table whose time begins anew; none if it is one recording.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from strainwave.files.tables import open_table
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     stamps = [0.01 * (row % 50) for row in range(100)]
    ...     _ = Path(folder, "log.csv").write_text("time,q\\n" + "".join(f"{stamp},0.1\\n" for stamp in stamps))
    ...     [run.rows for run in runs_in(open_table(Path(folder, "log.csv")))]
    [slice(0, 50, None), slice(50, 100, None)]
    """
    named = (place for place, label in enumerate(table.labels) if (found := meaning(label)) and found.quantity == "time")
    place = next(named, None)
    if place is None or table.contents[place] == "other" or isinstance(table, GridTable):
        return []
    numbers, _ = table.measured([ColumnSource(place, "time", "time", "1")])
    stamps = numbers["time"]
    ends = [0, *restarts(stamps), len(stamps)]
    if len(ends) == 2 or min(np.diff(ends)) < MIN_ROWS_OF_RUN or run_on(stamps)[1]:
        return []
    return [TableRows(table, table.labels, slice(int(first), int(end))) for first, end in pairwise(ends)]


def restarts(stamps: Array) -> NDArray[np.intp]:
    """Return the rows at which a clock begins anew."""
    steps = np.diff(stamps)
    forward = steps[steps > 0.0]
    return np.flatnonzero(steps < -MIN_STEPS_BACK * float(np.median(forward))) + 1 if forward.size else np.zeros(0, np.intp)


def run_on(stamps: Array) -> tuple[Array, float]:
    """Return the stamps of a counter that begins anew as they run on, and after how much it does; others as they are, and 0.

    >>> run_on(np.array([65530.0, 65533.0, 0.0, 3.0]))
    (array([65530., 65533., 65536., 65539.]), 65536.0)
    """
    steps = np.diff(stamps)
    back, forward = steps[steps < 0.0], steps[steps > 0.0]
    if not back.size or not forward.size:
        return stamps, 0.0
    for period in COUNTER_PERIODS:
        if (period + back > 0.0).all() and (period + back <= MAX_STEPS_OF_COUNTER * np.median(forward)).all():
            return stamps + period * np.concatenate([[0.0], np.cumsum(steps < 0.0)]), period
    return stamps, 0.0


def merged(grids: Sequence[Grid]) -> list[Grid]:
    """Return grids, those of equal times as one."""
    found = list[Grid]()
    for grid in grids:
        same = next((at for at, each in enumerate(found) if np.array_equal(each.time, grid.time)), len(found))
        before = found[same].columns if same < len(found) else {}
        found[same : same + 1] = [Grid(grid.time, {**before, **grid.columns})]
    return found


def seconds_of(time: Array, label: Label) -> Array:
    """Return a column of time [s], by the unit that it states, or in seconds; stamps of Windows by their size."""
    if is_file_time(time):
        return np.asarray((time - FILE_TIMES[0]) * 1e-7)
    return np.asarray(convert(time, label.unit if label.unit is not None and measures(label.unit, "s") else "s", "s"))


def is_file_time(time: Array) -> bool:
    """True for stamps that count tenths of a microsecond since 1601, as Windows does."""
    return bool(len(time) and FILE_TIMES[0] < time.min() and time.max() < FILE_TIMES[1])
