"""The time of a file: one column of several, restarts, and the instants of the rows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.equality import ComparedByFields
from strainwave.files.array_table import Grid, GridTable, grid_table
from strainwave.files.labels import ColumnSource, Content, Label
from strainwave.files.table_format import OpenTable
from strainwave.files.units import convert, measures
from strainwave.identification.reading.names import meaning, words_of
from strainwave.questions import LOG_AT_RATE, Answer, QuestionError
from strainwave.statistics.scale import SIGNIFICANCE_SIGMA

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
                parts = ColumnSource(part, "", "parts of seconds", "1")
                return TableView(table, labels, slice(0, None), seconds=seconds, parts=parts, size=SECOND_PARTS[size])
    return table


@dataclass(frozen=True, eq=False)
class TableView:
    """Some rows of a table, with a time that may be the sum of whole seconds and their parts.

    Args:
        table: as it is in the file
        labels: of the columns
        rows: that are taken
        seconds: position of the whole seconds; -1 if the time is one column
        parts: the column of their parts, which is no channel of its own
        size: of one part [s]
    """

    table: OpenTable
    labels: Sequence[Label]
    rows: slice
    seconds: int = -1
    parts: ColumnSource | None = None
    size: float = 0.0

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
        hidden = -1 if self.parts is None else self.parts.position
        return ["other" if place == hidden else content for place, content in enumerate(self.table.contents)]

    def numbers(self, sources: Sequence[ColumnSource]) -> dict[str, Array]:
        """Return the columns wanted, all of them numbers."""
        return self._taken(self.table.numbers(self._needed(sources)), sources)

    def measured(self, sources: Sequence[ColumnSource]) -> tuple[dict[str, Array], list[str]]:
        """Return the columns wanted, nan in empty cells; and what was left out."""
        numbers, remarks = self.table.measured(self._needed(sources))
        return self._taken(numbers, sources), remarks

    def place(self, row: int) -> str:
        return self.table.place(self.rows.start + row)

    def _needed(self, sources: Sequence[ColumnSource]) -> Sequence[ColumnSource]:
        return sources if self.parts is None else [*sources, self.parts]

    def _taken(self, numbers: Mapping[str, Array], sources: Sequence[ColumnSource]) -> dict[str, Array]:
        columns = {source.name: numbers[source.name] for source in sources}
        if self.parts is not None:
            parts = self.size * numbers[self.parts.name]
            columns |= {each.name: numbers[each.name] + parts for each in sources if each.position == self.seconds}
        return {name: values[self.rows] for name, values in columns.items()}


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
    is_time = [(channel := meaning(label)) is not None and channel.quantity == "time" for label in labels]
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


def runs_in(table: OpenTable) -> list[TableView]:
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
    named = (place for place, label in enumerate(table.labels) if (channel := meaning(label)) and channel.quantity == "time")
    place = next(named, None)
    if place is None or table.contents[place] == "other" or isinstance(table, GridTable):
        return []
    numbers, _ = table.measured([ColumnSource(place, "time", "time", "1")])
    stamps = numbers["time"]
    ends = [0, *restarts(stamps), len(stamps)]
    if len(ends) == 2 or min(np.diff(ends)) < MIN_ROWS_OF_RUN or run_on(stamps)[1]:
        return []
    return [TableView(table, table.labels, slice(int(first), int(end))) for first, end in pairwise(ends)]


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
    joined = list[Grid]()
    for grid in grids:
        same = next((at for at, each in enumerate(joined) if np.array_equal(each.time, grid.time)), len(joined))
        before = joined[same].columns if same < len(joined) else {}
        joined[same : same + 1] = [Grid(grid.time, {**before, **grid.columns})]
    return joined


def seconds_of(time: Array, label: Label) -> Array:
    """Return a column of time [s], by the unit that it states, or in seconds; stamps of Windows by their size."""
    if is_file_time(time):
        return np.asarray((time - FILE_TIMES[0]) * 1e-7)
    return np.asarray(convert(time, label.unit if label.unit is not None and measures(label.unit, "s") else "s", "s"))


def is_file_time(time: Array) -> bool:
    """True for stamps that count tenths of a microsecond since 1601, as Windows does."""
    return bool(len(time) and FILE_TIMES[0] < time.min() and time.max() < FILE_TIMES[1])


# ---- Clock -----------------------------------------------------------------------------------------------------------


Rows = NDArray[np.int64]

MAX_SCATTER = 0.2  # of a step: root mean square of stamps about a regular clock, above which ticks could not be counted
MAX_SCATTER_OF_EXACT = 1e-3  # of a step: such stamps are taken as they are
REPEAT_WINDOW = 0.5  # of a step: a row with the values of the row before it and a stamp so near is a repetition
MAX_SHARED_STAMPS = 0.05  # of the rows: if more share the stamp of the row before, stamps are coarser than the samples
MAX_TIME = 1e12  # s of a log
MAX_TICKS = 1e12  # from the first row to the last
MAX_BEGIN = 1e6  # s: later stamps count from some epoch
MAX_FITS = 5  # of a line to the ticks, until these stay the same


@dataclass(frozen=True, eq=False)
class Clock(ComparedByFields):
    """The instants at which the rows of a log were sampled.

    Args:
        time: of each row that is kept [s], increasing, shape (n,)
        rows: which rows are kept, shape (n,)
        remarks: what was found and done, in words
        began: the stamp from which the time is counted [s]
    """

    time: Array
    rows: Rows
    remarks: tuple[str, ...] = ()
    began: float = 0.0


def regular(rows: int, rate: float) -> Clock:
    """Return the time of rows without stamps that were sampled at a known rate [1/s].

    >>> regular(3, rate=500.0).time
    array([0.   , 0.002, 0.004])
    """
    rate = arguments.number("rate", rate, "Hz", "()", low=0.0)
    remark = f"it has no time: {rate:g} rows in a second, as was given"
    return Clock(np.arange(rows, dtype=float) / rate, np.arange(rows), (remark,))


def clock(stamps: Array, repeated: NDArray[np.bool_] | None = None, angle: Array | None = None) -> Clock:
    """Return the instants of rows, from their time stamps.

    Args:
        stamps: as they were recorded [s], shape (n,)
        repeated: True for a row with the same values as the row before it, shape (n,); no row if not given
        angle: of a shaft, which shows whether the stamps or the samples scatter, shape (n,)

    Raises:
        ValueError: the stamps do not run forward, or are no times

    >>> crooked = clock(np.array([0.0, 0.0101, 0.0199, 0.0401, 0.0499, 0.06]))
    >>> crooked.time.round(3).tolist()
    [0.0, 0.01, 0.02, 0.04, 0.05, 0.06]
    >>> for remark in crooked.remarks:
    ...     print(remark)
    1 row is missing: a gap of 0.02 s after 0.0199 s
    time stamps scatter by 0.0802 ms about a clock of 100.1 Hz, which is taken
    """
    if (largest := float(np.abs(stamps).max())) > MAX_TIME:
        ways = [Answer(f"in {unit}", {"units": {"time": unit}}) for unit in ("ms", "us", "ns")]
        raise QuestionError(f"its time reaches {largest:g} s, which no log lasts", ways)
    rows, remarks = _longest_stretch(stamps)
    step = _step(stamps[rows])
    if repeated is not None:
        again = np.zeros(len(rows), bool)
        again[1:] = repeated[rows[1:]] & (np.abs(np.diff(stamps[rows])) < REPEAT_WINDOW * step)
        if count := int(again.sum()):
            rows = rows[~again]
            remarks.append(f"{_rows(count, 'repeats', 'repeat')} the row before and {_are(count)} left out")
    kept = _regular(stamps[rows], step, None if angle is None else angle[rows]) or _as_they_are(stamps[rows])
    began = float(kept.time[0]) if kept.time[0] > MAX_BEGIN else 0.0
    remarks += ["its time is counted from its first row"] if began else []
    return Clock(kept.time - began, rows[kept.rows], (*remarks, *kept.remarks), began)


def _longest_stretch(stamps: Array) -> tuple[Rows, list[str]]:
    """Return the rows of the longest stretch between restarts of the clock, and what was left out."""
    begins = restarts(stamps)
    ends = np.array([0, *begins, len(stamps)])
    longest = int(np.argmax(np.diff(ends)))
    rows = np.arange(ends[longest], ends[longest + 1])
    if not begins.size:
        return rows, []
    places = ", ".join(str(row) for row in begins[:5]) + (" …" if len(begins) > 5 else "")
    of_several = f"{len(begins) + 1} recordings in one file, of which the longest is taken, rows {rows[0]} to {rows[-1]}"
    return rows, [f"its time begins anew at row {places}: {of_several}"]


def _step(stamps: Array) -> float:
    """Return the usual time from row to row [s]."""
    steps = np.diff(stamps)
    if not len(steps):
        raise ValueError("it has one row; a recording needs more")
    if not (forward := steps[steps > 0.0]).size:
        raise QuestionError("its time does not run forward", [LOG_AT_RATE])
    return float(np.median(forward))


def _regular(stamps: Array, step: float, angle: Array | None) -> Clock | None:
    """Return the time of a regular clock; None if the stamps do not lie about one."""
    if np.ptp(stamps) > MAX_TICKS * step:
        return None
    rows, steps = np.arange(len(stamps)), np.diff(stamps)
    is_coarse, rises = (steps == 0.0).mean() > MAX_SHARED_STAMPS, bool((steps > 0.0).all())
    ticks = rows if is_coarse else np.cumsum([0, *np.round(steps / step).astype(int)])
    for _ in range(MAX_FITS):
        begin, period = _line(ticks, stamps)
        better = ticks if is_coarse or period <= 0.0 else np.round((stamps - begin) / period).astype(int)
        if np.array_equal(better, ticks):
            break
        ticks = better
    time = begin + period * ticks.astype(float)
    scatter = float(np.sqrt(np.mean((stamps - time) ** 2)))
    is_near = np.abs(stamps - time).max() <= step if is_coarse else scatter <= MAX_SCATTER * period
    if not (np.diff(time) > 0.0).all() or not is_near:
        return None
    gaps, of_clock = _gaps(ticks, stamps, period), f"about a clock of {1.0 / period:.4g} Hz"
    if not is_coarse and rises and scatter <= MAX_SCATTER_OF_EXACT * period:
        return Clock(stamps, rows, gaps)
    if not is_coarse and rises and angle is not None and _follows(angle, time, stamps - time):
        why = f"rows were sampled at uneven instants, as the angle shows: by {scatter * 1e3:.3g} ms {of_clock}"
        return Clock(stamps, rows, (*gaps, f"{why}; the stamps are taken"))
    return Clock(time, rows, (*gaps, f"time stamps scatter by {scatter * 1e3:.3g} ms {of_clock}, which is taken"))


def _follows(angle: Array, time: Array, late: Array) -> bool:
    """True if an angle is as much further as a sample is late: second differences contain little of the motion itself."""
    if len(angle) < 5:
        return False
    speed = np.gradient(angle, time)
    smooth = np.convolve(speed, np.ones(5) / 5.0, "same")[1:-1]
    expected, seen = smooth * np.diff(late, 2), np.diff(angle, 2)
    square = float(expected @ expected)
    if square == 0.0:
        return False
    slope = float(expected @ seen) / square
    sigma = float(np.sqrt(np.mean((seen - slope * expected) ** 2) / square))
    return slope > 0.5 + SIGNIFICANCE_SIGMA * sigma


def _line(ticks: Rows, stamps: Array) -> tuple[float, float]:
    """Return begin and period of a clock [s] by least squares."""
    about = ticks - ticks.mean()
    period = float(about @ (stamps - stamps.mean()) / (about @ about))
    return float(stamps.mean() - period * ticks.mean()), period


def _gaps(ticks: Rows, stamps: Array, period: float) -> tuple[str, ...]:
    steps = np.diff(ticks)
    missing = int((steps - 1).sum())
    if not missing:
        return ()
    places, widest = int((steps > 1).sum()), int(np.argmax(steps))
    where = f"a gap of {steps[widest] * period:.3g} s after {stamps[widest]:.6g} s"
    at = "" if places == 1 else f" at {places} places, the longest"
    return (f"{_rows(missing, 'is', 'are')} missing{at}: {where}",)


def _as_they_are(stamps: Array) -> Clock:
    """Return the stamps of a clock that is not regular, without the rows that do not lie behind all before them."""
    latest = np.maximum.accumulate(stamps)
    forward = np.concatenate([[True], stamps[1:] > latest[:-1]])
    remarks = []
    if count := int((~forward).sum()):
        remarks.append(f"{_rows(count, 'does', 'do')} not lie after the row before in time and {_are(count)} left out")
    rows = np.flatnonzero(forward)
    if len(rows) > 2:
        steps = np.diff(stamps[rows])
        low, middle, high = (f"{value * 1e3:.4g}" for value in (steps.min(), np.median(steps), steps.max()))
        remarks.append(f"its clock is not regular: steps from {low} ms to {high} ms, mostly {middle} ms; its stamps are taken")
    return Clock(stamps[rows], rows, tuple(remarks))


def _rows(count: int, verb: str, of_several: str) -> str:
    return f"1 row {verb}" if count == 1 else f"{count} rows {of_several}"


def _are(count: int) -> str:
    return "is" if count == 1 else "are"
