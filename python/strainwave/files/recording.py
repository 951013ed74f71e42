"""Recordings: measured or simulated series with units, read from and written to CSV and Parquet.

Whatever comes in is checked once, here: equal lengths, finite numbers, known units, time that runs forward. Nothing is
repaired; what is wrong is refused in one line that names the place.
"""

from __future__ import annotations

from collections.abc import Iterator, KeysView, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import arguments, typeset
from strainwave.files.labels import Label, label_of
from strainwave.files.units import check as check_unit, convert
from strainwave.files.writing import replacing
from strainwave.messages import listed, one_line, quoted, shortened
from strainwave.presentation import MAX_REPR, PLAIN_DIGITS, Pictured, Row

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

    from strainwave.files.tables import Table

Array = NDArray[np.float64]


LISTED_COLUMNS = 5  # in one line, and in the picture of a notebook
GENERATED_TITLE = "simulation"  # first word of the titles that simulations give their recordings


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Recording(Pictured):
    """Named series of equal length, each with its unit.

    Args:
        columns: the values of each series, in order, shape (n,), n >= 1, or a table of pandas; copied unless they are read-only
            already
        units: the unit of each series, as `strainwave.files.units.check` knows it; by default those of a table of pandas, in
            its names, as `torque [N.m]`, or as `to_frame` writes them
        title: what was recorded, one line

    A column called `time` must strictly increase. Rows are counted from 0.

    Raises:
        ValueError: lengths differ, a value is not finite, a unit is missing or not known, or time does not increase.

    >>> recording = Recording({"time": [0.0, 0.1], "speed": [0.0, 30.0]}, {"time": "s", "speed": "rpm"})
    >>> recording
    <Recording: 2 samples from 0 s to 0.1 s; time [s], speed [rpm]>
    >>> recording.values("speed", "rad/s")
    array([0.        , 3.14159265])
    """

    columns: Mapping[str, Array]
    units: Mapping[str, str]
    title: str

    def __init__(
        self,
        columns: Mapping[str, ArrayLike] | pandas.DataFrame,
        units: Mapping[str, str] | None = None,
        title: str = "",
    ) -> None:
        if hasattr(columns, "attrs"):  # of pandas
            columns, units = _of_frame(columns, units)
        elif units is None:
            raise TypeError('units must be given: the unit of each column, as {"time": "s"}')
        _check_names(columns, units)
        if arguments.text("title", title) and not title.isprintable():
            raise ValueError(f"title {shortened(title)} must be one line of text")
        frozen = {name: _frozen(name, values) for name, values in columns.items()}
        (first, length), *others = ((name, len(values)) for name, values in frozen.items())
        if other := next((each for each in others if each[1] != length), None):
            raise ValueError(f"column {quoted(other[0])} has {other[1]} samples, column {quoted(first)} has {length}")
        standard_units = {name: _known(name, units[name]) for name in columns}
        if fault := _first_fault(frozen, standard_units):
            raise ValueError(f"column {quoted(fault.column)} row {fault.row}: {fault.reason}")
        self._hold(frozen, standard_units, title)

    def _hold(self, columns: Mapping[str, Array], units: Mapping[str, str], title: str) -> None:
        """Keeps what is known to be in order: read-only series, units in their standard spelling."""
        object.__setattr__(self, "columns", MappingProxyType(columns))
        object.__setattr__(self, "units", MappingProxyType(units))
        object.__setattr__(self, "title", title)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, in order."""
        return tuple(self.columns)

    @property
    def time(self) -> Array:
        """The column `time` [s], shape (n,)."""
        return self.values("time", "s")

    def __getitem__(self, name: str) -> Array:
        """Values of a column in its own unit, shape (n,), read-only."""
        if arguments.text("the name of a column", name) not in self.columns:
            raise ValueError(f"no column {quoted(name)}; there are {listed(self.names)}")
        return self.columns[name]

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name in self.columns

    def __len__(self) -> int:
        return len(next(iter(self.columns.values())))

    def keys(self) -> KeysView[str]:
        """Names of the columns, so that ``dict(recording)`` is a dictionary of them.

        >>> import strainwave as sw
        >>> run = sw.Recording({"time": [0.0, 0.1], "torque": [1.0, 2.0]}, {"time": "s", "torque": "N.m"})
        >>> list(dict(run))
        ['time', 'torque']
        """
        return self.columns.keys()

    def __iter__(self) -> Iterator[tuple[float, ...]]:
        """The samples, one after the other, each a named tuple: what ``pandas.DataFrame(recording)`` makes rows of."""
        sample = type("Sample", (tuple,), {"_fields": self.names})
        for row in zip(*(values.tolist() for values in self.columns.values()), strict=True):
            yield sample(row)

    def __eq__(self, other: object) -> bool:
        """Same title, columns in the same order, same units, and every value the same."""
        if not isinstance(other, Recording):
            return NotImplemented
        if (self.title, self.names, self.units) != (other.title, other.names, other.units):
            return False
        return all(np.array_equal(self[name], other[name]) for name in self.names)

    def __reduce__(self) -> tuple[type[Recording], tuple[dict[str, Array], dict[str, str], str]]:
        return Recording, (dict(self.columns), dict(self.units), self.title)

    def _headline(self) -> str:
        span = f" from {self.time[0]:g} s to {self.time[-1]:g} s" if "time" in self else ""
        title = f'"{self.title}": ' if self._heading else ""
        lines = [f"{title}{len(self)} samples{span}; {self._series(shown)}" for shown in range(LISTED_COLUMNS, 0, -1)]
        room = MAX_REPR - len(f"<{type(self).__name__}: >")
        return next((line for line in lines if len(line) <= room), lines[-1])

    def _series(self, shown: int) -> str:
        """Return the first columns with their units, and the count of the others."""
        series = ", ".join(f"{name} [{self.units[name]}]" for name in self.names[:shown])
        more = len(self.names) - shown
        return f"{series} and {more} more" if more > 0 else series

    def _picture(self) -> Figure | None:
        """Return the figure of the first columns that change."""
        changing = [name for name in self.names if name != "time" and np.ptp(self[name]) > 0.0]
        return self.plot(changing[:LISTED_COLUMNS], self.names[0]) if changing else None

    def _rows(self) -> Iterator[Row]:
        for name, values in self.columns.items():
            mean = typeset.number(float(np.mean(values)), PLAIN_DIGITS)
            yield Row(name, (float(values.min()), float(values.max())), self.unit(name), note=f"mean {mean}")

    def unit(self, name: str) -> str:
        """Return the unit of a column.

        Raises:
            ValueError: there is no such column
        """
        self[name]  # refuses a name that is not there
        return self.units[name]

    def values(self, name: str, unit: str) -> Array:
        """Return the values of a column in another unit, shape (n,).

        Args:
            name: of the column
            unit: of the values, as "deg/s"

        Raises:
            ValueError: there is no such column, or its unit cannot be converted to this one

        >>> Recording({"speed": [0.0, 30.0]}, {"speed": "rpm"}).values("speed", "deg/s")
        array([  0., 180.])
        """
        values = self[name]
        try:
            return convert(values, self.unit(name), unit)
        except ValueError as error:
            raise ValueError(f"column {quoted(name)}: {error}") from None

    def select(self, names: Sequence[str]) -> Recording:
        """Return a recording of the named columns, in the order given.

        Raises:
            ValueError: there is no such column

        >>> Recording({"time": [0.0], "speed": [1.0], "torque": [2.0]}, {"time": "s", "speed": "rpm", "torque": "N.m"}).select(
        ...     ["time", "torque"]
        ... ).names
        ('time', 'torque')
        """
        names = arguments.names("names", names)
        return Recording({name: self[name] for name in names}, {name: self.unit(name) for name in names}, self.title)

    def between(self, start: float, stop: float) -> Recording:
        """Return a recording of the samples with start <= time <= stop.

        Args:
            start, stop: ends of the interval [s]; the time of the samples stays as it is

        Raises:
            ValueError: there is no column `time`, or no sample in the interval

        >>> Recording({"time": [0.0, 0.1, 0.2]}, {"time": "s"}).between(0.05, 0.2).time
        array([0.1, 0.2])
        """
        start, stop = (arguments.number(*end, "s", "[]") for end in (("start", start), ("stop", stop)))
        time = self.time
        first, last = np.searchsorted(time, start, "left"), np.searchsorted(time, stop, "right")
        if not first < last:
            ends = f"time runs from {time[0]:g} s to {time[-1]:g} s"
            raise ValueError(f"no sample between {start:g} s and {stop:g} s; {ends}")
        return Recording({name: self[name][first:last] for name in self.names}, self.units, self.title)

    def with_column(self, name: str, values: ArrayLike, unit: str) -> Recording:
        """Return a recording with a column added, or replaced if there is one of this name.

        Args:
            name: of the column
            values: one for each sample, shape (n,)
            unit: of the values

        Raises:
            ValueError: the length differs, a value is not finite, or the unit is not known

        >>> recording = Recording({"torque": [2.0, 3.0]}, {"torque": "N.m"})
        >>> recording.with_column("speed", [10.0, 20.0], "rad/s").units["speed"]
        'rad/s'
        """
        arguments.text("the name of a column", name)
        return Recording({**self.columns, name: values}, {**self.units, name: unit}, self.title)

    def to_csv(self, path: str | Path) -> None:
        """Write a CSV file, header `name [unit]`, that `from_csv` reads back bit for bit.

        Raises:
            OSError: the file cannot be written

        >>> import tempfile
        >>> recording = Recording({"torque": [0.1, 0.2]}, {"torque": "N.m"})
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     recording.to_csv(f"{folder}/run.csv")
        ...     Recording.from_csv(f"{folder}/run.csv") == recording
        True
        """
        import pyarrow
        from pyarrow.csv import write_csv

        from strainwave.files.text_table import TITLE_LINE

        table = pyarrow.table({f"{name} [{unit}]": self[name] for name, unit in self.units.items()})
        with replacing(path) as file:
            if self.title:
                file.write(f"{TITLE_LINE}{self.title}\n".encode())
            write_csv(table, file)

    def to_frame(self) -> pandas.DataFrame:
        """The columns as a table of pandas, units in its ``attrs["units"]``.

        Raises:
            ImportError: pandas is not installed
        """
        try:
            import pandas
        except ImportError:
            raise ImportError("to_frame needs pandas, which is not installed; dict(recording) needs nothing") from None
        frame = pandas.DataFrame(dict(self.columns))
        frame.attrs["units"] = dict(self.units)
        return frame

    def to_parquet(self, path: str | Path) -> None:
        """Write a Parquet file: zstd, byte-stream-split, checksums, the unit in the metadata of each field.

        Raises:
            OSError: the file cannot be written

        >>> import tempfile
        >>> import strainwave as sw
        >>> run = sw.Recording({"time": [0.0, 0.1], "torque": [1.0, 2.0]}, {"time": "s", "torque": "N.m"})
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     run.to_parquet(f"{folder}/run.parquet")
        ...     sw.Recording.from_parquet(f"{folder}/run.parquet") == run
        True
        """
        import pyarrow
        from pyarrow.parquet import write_table

        fields = [pyarrow.field(name, pyarrow.float64(), metadata={"unit": self.units[name]}) for name in self.names]
        schema = pyarrow.schema(fields, metadata={"title": self.title})
        table = pyarrow.table(dict(self.columns), schema=schema)
        with replacing(path) as file:
            write_table(
                table,
                file,
                compression="zstd",
                use_dictionary=False,
                use_byte_stream_split=True,
                write_page_checksum=True,
            )

    @staticmethod
    def read(path: str | Path, columns: Mapping[str, str] | None = None, units: Mapping[str, str] | None = None) -> Recording:
        """Read a file of any format, by its suffix.

        Args:
            path: the file: text as `from_csv` reads it, Parquet, MAT, HDF5, NumPy, JSON, MDF, or a bag of ROS
            columns: for each name wanted, the name in the file; all columns, if not given
            units: unit of each column, by the name wanted, if the file has none

        Raises:
            ValueError: the file cannot be read, its suffix is not known, or a number, a unit or the time in it is wrong

        >>> import tempfile
        >>> import strainwave as sw
        >>> run = sw.Recording({"time": [0.0, 0.1], "torque": [1.0, 2.0]}, {"time": "s", "torque": "N.m"})
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     run.to_csv(f"{folder}/run.csv")
        ...     sw.Recording.read(f"{folder}/run.csv", columns={"time": "time", "load": "torque"})
        <Recording: 2 samples from 0 s to 0.1 s; time [s], load [N.m]>
        """
        from strainwave.files.tables import open_table, read_table

        return recording_of(path, read_table(open_table(path), columns, units))

    @staticmethod
    def header(path: str | Path) -> tuple[str, ...]:
        """Names of the columns in a file, without their units.

        Raises:
            ValueError: the file cannot be read, or its suffix is not known.

        >>> import tempfile
        >>> import strainwave as sw
        >>> run = sw.Recording({"time": [0.0, 0.1], "speed": [0.0, 900.0]}, {"time": "s", "speed": "rpm"})
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     run.to_csv(f"{folder}/run.csv")
        ...     sw.Recording.header(f"{folder}/run.csv")
        ('time', 'speed')
        """
        from strainwave.files.tables import open_table

        return tuple(label.name for label in open_table(path).labels)

    @staticmethod
    def from_csv(
        path: str | Path, columns: Mapping[str, str] | None = None, units: Mapping[str, str] | None = None
    ) -> Recording:
        """Read a text table in UTF-8 whose header names each column and its unit: `speed [rad/s]` or `speed (rpm)`.

        Cells are separated by tab, semicolon or comma, whichever of them the header contains first in this order; with
        the former two the decimal mark may be a comma. Blank lines and lines that start with `#` are skipped.

        Args:
            path: the file
            columns: for each name wanted, the name in the file's header. Only these columns are read and checked;
                without it all are, and must be numbers.
            units: unit of each column, by the name wanted, where the header has none

        Raises:
            ValueError: the file cannot be read, or a row, a number, a unit or the time in it is wrong, with its line.

        >>> import pathlib, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     path = pathlib.Path(folder, "table.csv")
        ...     _ = path.write_text("Time (ms); Motor Speed\\n0,0; 1,5\\n0,5; 2,5\\n")
        ...     Recording.from_csv(path, columns={"time": "Time", "speed": "Motor Speed"}, units={"speed": "rpm"})
        <Recording: 2 samples from 0 s to 0.0005 s; time [ms], speed [rpm]>
        """
        from strainwave.files.tables import read_table
        from strainwave.files.text_table import open_csv

        return recording_of(path, read_table(open_csv(path), columns, units))

    @staticmethod
    def from_parquet(
        path: str | Path, columns: Mapping[str, str] | None = None, units: Mapping[str, str] | None = None
    ) -> Recording:
        """Read a Parquet file; units come from its field metadata, its column names (as in `from_csv`) or `units`.

        Args:
            path, columns, units: as of `from_csv`

        Raises:
            ValueError: as `from_csv`
        """
        from strainwave.files.parquet_table import open_parquet
        from strainwave.files.tables import read_table

        return recording_of(path, read_table(open_parquet(path), columns, units))

    def plot(self, names: Sequence[str] | None = None, against: str = "time") -> Figure:
        """Return a figure of columns over another one, in panels below each other on one axis.

        Columns of one unit share a panel. A curve that is more than twenty times smaller than another one has its own panel.

        Args:
            names: the columns to draw; if not given, all but `against` that change by more than rounding (a billionth of the
                largest value of their unit)
            against: the column on the x axis

        Returns:
            a matplotlib figure; `.savefig` writes it. Its title is that of the recording, or names the columns. A curve of more
            than 20 000 samples is drawn by the extremes of short stretches, so that every peak stays visible

        Raises:
            ValueError: a column is missing, there is no column to draw, or a value lies beyond 1e300
            TypeError: a name is no text

        >>> import strainwave as sw
        >>> run = sw.Recording({"time": [0.0, 0.1], "torque": [1.0, 2.0]}, {"time": "s", "torque": "N.m"})
        >>> run.plot().get_suptitle()
        'Torque over time'
        """
        from strainwave.files.plots import recording_figure

        self[arguments.text("against", against)]
        for name in () if names is None else arguments.names("names", names):
            self[name]
        return recording_figure(self.columns, self.units, names, against, self._heading)

    @property
    def _heading(self) -> str:
        """Title of a figure; empty if the names of its columns say more than the recording's own title."""
        return "" if self.title.startswith(GENERATED_TITLE) else self.title


def check_recording(name: str, value: object) -> None:
    """Refuse what is no recording."""
    if not isinstance(value, Recording):
        raise TypeError(f"{name} must be a Recording, as Recording.read(...) gives one, not {shortened(value)}")


class _Fault(NamedTuple):
    """A fault of a value: its column, its row and the reason."""

    column: str
    row: int
    reason: str


def _of_frame(frame: Any, units: Mapping[str, str] | None) -> tuple[dict[str, Array], Mapping[str, str]]:
    """Return the columns of a table of pandas, and their units."""
    labels = [label_of(name) if isinstance(name, str) else Label(name, name, None) for name in frame.columns]
    if units is None:
        units = {label.name: label.unit for label in labels if label.unit is not None} | frame.attrs.get("units", {})
    return {label.text if label.text in units else label.name: frame[label.text].to_numpy() for label in labels}, units


def _check_names(columns: Mapping[str, ArrayLike], units: Mapping[str, str]) -> None:
    arguments.mapping("columns", columns, '{"time": [0.0, 0.1]}')
    arguments.mapping("units", units, '{"time": "s"}')
    if not columns:
        raise ValueError("a recording needs at least one column")
    for name in columns:
        if not arguments.text("the name of a column", name) or name != name.strip() or not name.isprintable():
            raise ValueError(f"column name {shortened(name)} must be printable text without spaces around it")
        if name not in units:
            hint = f'pass units={{{quoted(name)}: "N.m"}}, or "1" for a plain number'
            raise ValueError(f"column {quoted(name)} has no unit; {hint}")
    if extra := units.keys() - columns.keys():
        raise ValueError(f"units names {quoted(min(extra))}, which is not a column; there are {listed(columns)}")


def _frozen(name: str, values: ArrayLike) -> Array:
    """The values as read-only float64, copied only where someone else could still change them."""
    array = arguments.numbers(f"column {quoted(name)}", values)
    if array.ndim != 1 or array.size == 0:
        raise ValueError(f"column {quoted(name)} must be one series of at least one sample; its shape is {array.shape}")
    if array.flags.c_contiguous and _is_frozen(array):
        return array
    copy = np.array(array)
    copy.setflags(write=False)
    return copy


def _is_frozen(array: NDArray[np.generic]) -> bool:
    owner = array.base
    return not array.flags.writeable and (owner is None or (isinstance(owner, np.ndarray) and _is_frozen(owner)))


def _known(name: str, unit: str) -> str:
    """Standard spelling of a column's unit."""
    try:
        if name == "time":
            convert(1.0, unit, "s")
        return check_unit(unit)
    except ValueError as error:
        raise ValueError(f"column {quoted(name)}: {error}") from None


@np.errstate(all="ignore")
def _first_fault(columns: Mapping[str, Array], units: Mapping[str, str]) -> _Fault | None:
    """The first value that is not finite, else the first time that does not increase."""
    for name, values in columns.items():
        if isfinite(np.dot(values, values)):  # as all its terms then are, found in one go
            continue
        finite = np.isfinite(values)
        if not finite.all():
            row = int(np.argmin(finite))
            return _Fault(name, row, f"{values[row]} is not finite")
    return _time_fault(columns["time"], units["time"]) if "time" in columns else None


def _time_fault(time: Array, unit: str) -> _Fault | None:
    """The first time that does not increase, in seconds too, where others that are near each other become one."""
    try:
        seconds = convert(time, unit, "s")
    except ValueError as error:
        return _Fault("time", int(np.argmax(np.abs(time))), str(error))
    forward = seconds[1:] > seconds[:-1]
    if forward.all():
        return None
    row = int(np.argmin(forward)) + 1
    now, before = (f"{time[i]} {unit}" for i in (row, row - 1))
    where = " in seconds" if time[row] > time[row - 1] else ""
    return _Fault("time", row, f"{now} does not lie after {before}{where}; time must increase")


def recording_of(path: str | Path, table: Table) -> Recording:
    """Return the recording of a table.

    Raises:
        ValueError: what is wrong with it, in terms of the file
    """
    try:
        units = {name: _known(name, unit) for name, unit in table.units.items()}
        if not (fault := _first_fault(table.columns, units)):
            return Recording(table.columns, units, table.title)
    except ValueError as error:
        raise ValueError(one_line(f"{path}: {error}")) from None
    where = f"{path} {table.place(fault.row)}, column {quoted(table.labels[fault.column])}"
    raise ValueError(one_line(f"{where}: {fault.reason}"))
