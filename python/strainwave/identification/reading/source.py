"""Files of measurements, each opened once; a recording with one file for each quantity is one of them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.files.array_table import ArrayTable, Grid, grid_table
from strainwave.files.folder import FolderFiles, files_below
from strainwave.files.labels import ColumnSource, Label, places_of
from strainwave.files.recording import Recording
from strainwave.files.table_format import OpenTable
from strainwave.files.tables import FORMATS, is_table_of_numbers, open_table
from strainwave.identification.kinds import KINDS
from strainwave.identification.reading.motion import is_slope
from strainwave.identification.reading.names import QUANTITY_OF, SYMBOLS, is_of_joint, meaning
from strainwave.identification.reading.times import merged, runs_in, seconds_of, with_one_time
from strainwave.identification.reading.unnamed import MatrixLayout, layout_of, nameless, rises_evenly
from strainwave.messages import listed, one_line
from strainwave.number_texts import is_number

Array = NDArray[np.float64]

QUANTITY_SUFFIXES = ("d", "dd", "dot", "ddot", "des", "desired", "cmd", "ref", "meas", "act")  # of a quantity in a name
MAX_PARTS = 20  # files of one recording
SETTINGS_SUFFIXES = {".json", ".jsonl"}  # seldom measurements: of a folder they are left out
FILES_OF_RUNS = {".mat", ".npz", ".npy", ".json"}  # that may contain an array of recordings
RESTARTED_SUFFIXES = {".csv", ".txt", ".tsv", ".log"}  # that a recorder may go on writing when it is started again
DUMPED_FILE = "data.log"  # with a count and a stamp in front of each row
BAG_FILE = "metadata.yaml"  # a folder with this file is a recording of ROS


@dataclass(frozen=True, eq=False)
class MeasurementFile:
    """A file of measurements, whose table is opened at the first use and kept.

    Args:
        path: of the file; of several files of one recording the first
        parts: all files of a recording that has one for each quantity, the file of a run; empty for a recording in one file
        recording: in place of the file; then the path is the name by which results call it
        kind: of measurement, if a person gave it
        run: table of one of several recordings in a file; then the path ends with its number, as `bench.mat(2)`
    """

    path: Path
    parts: tuple[MeasurementFile, ...] = ()
    recording: Recording | None = None
    kind: str | None = None
    run: OpenTable | None = None

    @property
    def runs(self) -> list[MeasurementFile]:
        """The recordings in it, each as a file; itself if it has one, or cannot be read."""
        try:
            tables: Sequence[OpenTable] = self.raw.runs if isinstance(self.raw, ArrayTable) else runs_in(self.timed)
        except (ValueError, OSError):
            return [self]
        named = ((self.path.with_name(f"{self.path.name}({number})"), each) for number, each in enumerate(tables, start=1))
        return [replace(self, path=path, parts=(self,), run=table) for path, table in named] or [self]

    @cached_property
    def raw(self) -> OpenTable:
        """The table with the names that the file has.

        Raises:
            ValueError: the file cannot be read
        """
        if self.run is not None:
            return self.run
        if self.recording is not None:
            return _table_of(self.recording, str(self.path))
        return _together(self.parts) if self.parts else open_table(self.path)

    @cached_property
    def timed(self) -> OpenTable:
        """The table with one time."""
        return with_one_time(self.raw)

    @cached_property
    def layout(self) -> MatrixLayout | None:
        """The layout of columns without names; None if they have some, or the numbers determine none."""
        return layout_of(self.timed)

    @property
    def table(self) -> OpenTable:
        """The table with one time, and with the names of its layout if it has no others.

        Raises:
            ValueError: the file cannot be read
        """
        return self.timed if self.layout is None else self.layout.named(self.timed)

    @cached_property
    def names(self) -> set[str]:
        """Names of the columns. Empty if the file cannot be read; `recognise` then reports the error."""
        try:
            return {text for label in self.table.labels for text in (label.text, label.name)}
        except (ValueError, OSError):
            return set()

    def has(self, wanted: str) -> bool:
        """True if the file has a column of this name or number, or several that begin so, one for each joint."""
        if not self.names:
            return False
        return bool(places_of(self.table.labels, wanted)) or any(is_of_joint(name, wanted) for name in self.names)

    @property
    def is_of_one_quantity(self) -> bool:
        """True if its name contains a quantity, and its columns but for a time have no names, or name nothing else.

        Angles of both shafts are a measurement by themselves.
        """
        own = _quantity_in(self.path)
        if own is None or self.path.is_dir() or self.run is not None:
            return False
        try:
            if nameless(self.raw):
                return True
            quantity = QUANTITY_OF.get(own[0].split("_")[0].casefold())
            channels = [meaning(label) for label in self.raw.labels]
        except (ValueError, OSError):
            return False
        if {"input", "output"} <= {channel.side for channel in channels if channel and channel.quantity == quantity}:
            return False
        named = {channel and channel.quantity for channel in channels}
        return quantity is not None and named <= {"time", quantity, None} and ("time" in named or named == {quantity})


class MeasurementFiles(NamedTuple):
    """Files of measurements, and the symbolic links in folders, which are not followed."""

    files: list[MeasurementFile]
    links: list[Path]


Measurement = str | Path | Recording


def measurement_files(
    paths: str | Path | Sequence[str | Path] | Mapping[str, Measurement] | MeasurementFiles,
) -> MeasurementFiles:
    """Return the files that paths stand for: of a folder those that may be measurements, the folder itself if it has none.

    A mapping has the path of a file or a recording by the kind of measurement; a recording is called as its title has it.

    Raises:
        ValueError, OSError: as of `files_below`
    """
    if isinstance(paths, MeasurementFiles):
        return paths
    if isinstance(paths, Mapping):
        return MeasurementFiles([run for kind, each in paths.items() for run in _with_runs(_of_kind(kind, each))], [])
    folders = [_below(Path(path)) for path in ([paths] if isinstance(paths, str | Path) else paths)]
    files = [MeasurementFile(path) for path in dict.fromkeys(file for folder in folders for file in folder.files)]
    files = [run for file in with_parts(files) for run in _with_runs(file)]
    return MeasurementFiles(files, [link for folder in folders for link in folder.links])


def distinct_names(files: Sequence[MeasurementFile]) -> dict[Path, str]:
    """Return a name of each file by its path: its own, or with the folders that distinguish it from files of the same name.

    >>> files = [MeasurementFile(Path(path)) for path in ("a/1/run.csv", "b/1/run.csv", "b/2/rest.csv")]
    >>> list(distinct_names(files).values())
    ['a/1/run.csv', 'b/1/run.csv', 'rest.csv']
    """
    paths = list(dict.fromkeys(file.path for file in files))
    whole = [path.parts for path in paths]
    names = dict[Path, str]()
    for path in paths:
        ends = (path.parts[-count:] for count in range(1, len(path.parts) + 1))
        end = next((end for end in ends if sum(other[-len(end) :] == end for other in whole) == 1), path.parts)
        names[path] = Path(*end).as_posix()
    return names


def _below(path: Path) -> FolderFiles:
    if not path.is_dir() or Path(path, BAG_FILE).is_file():
        return FolderFiles([path], [])
    files, links = files_below(path, FORMATS.keys() - SETTINGS_SUFFIXES, is_table_of_numbers)
    return FolderFiles(files or ([] if links else [path]), links)


def measurement_file(file: str | Path | MeasurementFile) -> MeasurementFile:
    """Return a file of measurements, itself if it is one."""
    return file if isinstance(file, MeasurementFile) else MeasurementFile(Path(file))


def _with_runs(file: MeasurementFile) -> list[MeasurementFile]:
    """Return the recordings in a file: in an array of them, or in a text whose time begins anew."""
    return file.runs if not file.parts and file.path.suffix.lower() in FILES_OF_RUNS | RESTARTED_SUFFIXES else [file]


def _of_kind(kind: str, given: Measurement) -> MeasurementFile:
    if not isinstance(given, Recording):
        return MeasurementFile(Path(given), kind=kind)
    name = given.title.replace("/", "_") or KINDS[kind].title.removeprefix("a ")
    return MeasurementFile(Path(name), recording=given, kind=kind)


def _table_of(recording: Recording, name: str) -> ArrayTable:
    """Return a recording as the table of a file."""
    labels = [Label(each, each, recording.unit(each)) for each in recording.names]
    return ArrayTable(name, recording.title, labels, [recording[each] for each in recording.names])


def with_parts(files: Sequence[MeasurementFile]) -> list[MeasurementFile]:
    """Return the files, with those that are one recording together as one.

    Files are of one recording if their names differ in the quantity alone, as `q_run_1.csv` and `tau_run_1.csv`, and their
    columns have no names, or those of a time and of this quantity at each joint.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     for name in ("t", "q", "tau"):
    ...         np.savetxt(Path(folder, f"{name}_run_1.csv"), np.arange(30.0))
    ...     files = [MeasurementFile(path) for path in sorted(Path(folder).iterdir())]
    ...     [[part.path.name for part in file.parts] for file in with_parts(files)]
    [['q_run_1.csv', 't_run_1.csv', 'tau_run_1.csv']]
    """
    groups = dict[object, list[MeasurementFile]]()
    for file in files:
        key: object = file.path
        if file.is_of_one_quantity:
            key = (_named(file.path).parent, _quantity_in(file.path)[1], file.path.suffix.lower())  # type: ignore[index]
        groups.setdefault(key, []).append(file)
    recordings = list[MeasurementFile]()
    for group in groups.values():
        quantities = [(_quantity_in(file.path) or ("",))[0] for file in group]
        is_one = 1 < len(group) <= MAX_PARTS and len(set(quantities)) == len(group)
        recordings += [replace(group[0], parts=tuple(group))] if is_one else group
    return recordings


def files_of_same_recording(path: Path) -> list[Path]:
    """Return the other files of a file's recording in its folder, by their names."""
    own = _quantity_in(path)
    if own is None or not path.is_file():
        return []
    others = (other for other in path.parent.iterdir() if other.suffix.lower() == path.suffix.lower() and other != path)
    return sorted(other for other in others if (its := _quantity_in(other)) and its[1] == own[1] and its[0] != own[0])


def _named(path: Path) -> Path:
    """Return the path whose name states what a file contains: a dumper of YARP writes `data.log` into a folder of each port."""
    return path.parent if path.name == DUMPED_FILE else path


def _quantity_in(path: Path) -> tuple[str, tuple[str, ...]] | None:
    """Return the quantity that a name contains, as `q_d`, and the other words; None if it contains none."""
    words = [word for word in re.split(r"[_\-. ]+", _named(path).stem) if word]
    for place, word in enumerate(words):
        plain, number = re.fullmatch(r"(.*?)(\d*)", word.casefold()).groups()  # type: ignore[union-attr]
        if plain in QUANTITY_OF or plain in SYMBOLS:
            is_behind = place + 1 < len(words) and words[place + 1].casefold() in QUANTITY_SUFFIXES
            end = place + 1 + is_behind
            return "_".join(words[place:end]), (*words[:place], f"*{number}", *words[end:])
    return None


def _together(parts: Sequence[MeasurementFile]) -> OpenTable:
    """Return the table of a recording with one file for each quantity."""
    read = [_Part.of(part) for part in parts]
    angle = next((part for part in read if part.name == "q"), None)
    for place, part in enumerate(read):
        if part.name == "q_d" and angle is not None and is_slope(part.series, angle.series):
            read[place] = replace(part, name="dq")
    grids = [Grid(part.time, part.columns) for part in read if part.time is not None]
    file = one_line(listed(part.path.name for part in parts))
    if grids and len(grids) == len([part for part in read if part.series]):
        return grid_table(file, "", merged(grids), {name: unit for part in read for name, unit in part.stated.items()})
    rows = [len(part.series[0]) for part in read]
    if len(set(rows)) > 1:
        counts = listed(f"{part.path.name} has {count}" for part, count in zip(parts, rows, strict=True))
        raise ValueError(f"{file}: files of one recording need the same number of rows; {counts}")
    columns, units = dict[str, Array](), dict[str, str]()
    for part in read:
        columns |= part.columns if part.time is None else {"time": part.time, **part.columns}
        units |= part.stated
    return ArrayTable(file, "", [Label(name, name, units.get(name)) for name in columns], list(columns.values()))


@dataclass(frozen=True, eq=False)
class _Part:
    """One file of a recording: the quantity in its name, its series, its time if it has one, and names and units of columns."""

    name: str
    series: list[Array]
    time: Array | None
    names: Sequence[str] = ()
    units: Sequence[str | None] = ()

    @staticmethod
    def of(file: MeasurementFile) -> _Part:
        name = (_quantity_in(file.path) or ("",))[0]
        table = file.timed
        numbers, _ = table.measured([ColumnSource(place, str(place), str(place), "1") for place in range(len(table.labels))])
        series = list(numbers.values())
        if not nameless(file.raw):
            return _Part._named(name, table, series)
        units = [label.unit for label in table.labels]
        if QUANTITY_OF.get(name.casefold()) == "time":
            return _Part("time", series[:1], None, (), units[:1])
        if file.path.name == DUMPED_FILE and len(series) > 2:
            return _Part(name, series[2:], series[1])
        if len(series) > 1 and rises_evenly(series[0]):
            return _Part(name, series[1:], series[0], (), units[1:])
        return _Part(name, series, None, (), units)

    @staticmethod
    def _named(name: str, table: OpenTable, series: list[Array]) -> _Part:
        """Return a file whose columns have names: each begins with the quantity if it does not name it."""
        meanings = [meaning(label) for label in table.labels]
        at = next((place for place, named in enumerate(meanings) if named and named.quantity == "time"), None)
        names = [label.name if named else f"{name}_{label.name}" for label, named in zip(table.labels, meanings, strict=True)]
        units = [label.unit for label in table.labels]
        if at is None or len(series) == 1:
            return _Part(name, series, None, names, units)
        time = seconds_of(series[at], table.labels[at])
        return _Part(name, series[:at] + series[at + 1 :], time, names[:at] + names[at + 1 :], units[:at] + units[at + 1 :])

    @property
    def columns(self) -> dict[str, Array]:
        if self.names or len(self.series) == 1:
            return dict(zip(self.names or [self.name], self.series, strict=True))
        return {f"{self.name}_{number}": values for number, values in enumerate(self.series, start=1)}

    @property
    def stated(self) -> dict[str, str]:
        """The units that its header states, by the names of the columns."""
        return {name: unit for name, unit in zip(self.columns, self.units, strict=False) if unit}


# ---- Files of other formats ------------------------------------------------------------------------------------------


FORMAT_BY_BEGINNING = {
    b"\x89PNG": "a picture (PNG)", b"\xff\xd8\xff": "a picture (JPEG)", b"GIF8": "a picture (GIF)", b"BM": "a picture (BMP)",
    b"%PDF": "a PDF document", b"PK\x03\x04": "a ZIP archive, as spreadsheets are", b"\x1f\x8b": "packed (gzip)",
    b"\xd0\xcf\x11\xe0": "an old Excel or Word file", b"<!DOCTYPE": "a web page", b"<html": "a web page",
}  # fmt: skip
MAX_BYTES_READ = 2048  # of the beginning
TEXT_SUFFIXES = (".csv", ".txt", ".tsv", ".log", ".dat")


def other_format(path: Path) -> str | None:
    """Return what a file with the name of a table is by its first letters, and what to do; None if it may be a table."""
    if path.suffix.lower() not in TEXT_SUFFIXES or not path.is_file():
        return None
    with path.open("rb") as file:
        begin = file.read(MAX_BYTES_READ)
    if separator := _other_separator(begin):
        return f'its columns are separated by "{separator}": separate them by commas, semicolons or tabs'
    format_name = next((what for letters, what in FORMAT_BY_BEGINNING.items() if begin.startswith(letters)), None)
    what = f"its suffix is {path.suffix}, but it is {format_name}"
    return None if format_name is None else f"{what}: export the measurement as CSV with one header line"


def _other_separator(begin: bytes) -> str | None:
    """Return a separator that tables are not read with, if the first two lines have it equally often, the second numbers."""
    lines = [line for line in begin.decode("utf-8", "ignore").splitlines() if line.strip() and not line.startswith("#")][:2]
    if len(lines) < 2 or any(each in line for line in lines for each in ",;\t"):
        return None
    separators = [each for each in "|:^~" if lines[0].count(each) == lines[1].count(each) > 0]
    return next((each for each in separators if all(map(is_number, lines[1].split(each)))), None)
