"""Tables in files of any kind that is known: which columns they have, and their numbers.

Only files are known here, not what a recording must obey; `Recording` asks for the columns it wants.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from strainwave.files.bag_table import open_bag
from strainwave.files.budget import RefusedFile, open_regular
from strainwave.files.hdf5_table import open_hdf5
from strainwave.files.json_table import open_json
from strainwave.files.labels import ColumnSource, Content, Label, sources_of, unreadable
from strainwave.files.matlab_table import open_mat
from strainwave.files.mdf_table import MAGIC, open_mdf
from strainwave.files.numpy_table import open_numpy
from strainwave.files.parquet_table import open_parquet
from strainwave.files.text_layout import NUMBER
from strainwave.files.text_table import open_text
from strainwave.messages import one_line, quoted

Array = NDArray[np.float64]


class OpenTable(Protocol):
    """A file whose columns are known, but not yet read."""

    @property
    def file(self) -> str:
        """Return the name of the file in messages."""

    @property
    def title(self) -> str: ...

    @property
    def labels(self) -> Sequence[Label]: ...

    @property
    def left_out(self) -> Sequence[str]:
        """Parts of the file that are not among the columns, each with the reason."""

    @property
    def contents(self) -> Sequence[Content]:
        """Return the content of each column, by its first rows."""

    def numbers(self, sources: Sequence[ColumnSource]) -> dict[str, Array]:
        """The columns wanted; whatever is no number is refused."""

    def measured(self, sources: Sequence[ColumnSource]) -> tuple[dict[str, Array], list[str]]:
        """The columns wanted, nan where nothing is written, dates as seconds since the first; in words what was left out."""

    def place(self, row: int) -> str:
        """Return the name of a row in messages, counted from 0."""


def _open_dat(path: str | Path) -> OpenTable:
    """Open a file with a general suffix: MDF by its first letters, else text."""
    try:
        with open_regular(path) as file:
            begin = file.read(8)
    except (OSError, UnicodeError, RefusedFile) as error:
        raise ValueError(unreadable(path, error)) from None
    return open_mdf(path) if begin.startswith(MAGIC) else open_text(path)


FORMATS: dict[str, Callable[[str | Path], OpenTable]] = {
    ".csv": open_text,
    ".txt": open_text,
    ".tsv": open_text,
    ".log": open_text,
    ".parquet": open_parquet,
    ".dat": _open_dat,
    ".mat": open_mat,
    ".h5": open_hdf5,
    ".hdf5": open_hdf5,
    ".npy": open_numpy,
    ".npz": open_numpy,
    ".json": open_json,
    ".jsonl": open_json,
    ".mf4": open_mdf,
    ".mdf": open_mdf,
    ".bag": open_bag,
    ".mcap": open_bag,
    ".db3": open_bag,
}
BEGIN_BYTES = 4096  # of a file with an unknown suffix, by which it is taken for a table of numbers
MIN_ROWS = 5  # of numbers in them
INSTEAD = {  # what to do with other files that people have
    ".pkl": "a pickle may run any program as it is read: save it as .npz, .csv or .parquet",
    ".pickle": "a pickle may run any program as it is read: save it as .npz, .csv or .parquet",
    ".xlsx": "save the sheet as .csv",
    ".xls": "save the sheet as .csv",
    ".ods": "save the sheet as .csv",
}


def is_table_of_numbers(path: str | Path) -> bool:
    """True if a file whose suffix is not known begins with several rows of as many numbers."""
    if Path(path).suffix.lower() in {*FORMATS, *INSTEAD}:
        return False
    try:
        with open_regular(path) as file:
            rows = file.read(BEGIN_BYTES).decode("ascii").splitlines()[:-1]
    except (OSError, UnicodeError, RefusedFile):
        return False
    cells = [re.split(r"[\s,;]+", row.strip()) for row in rows]
    is_even = len(rows) >= MIN_ROWS and len({len(row) for row in cells}) == 1
    return is_even and all(NUMBER.fullmatch(cell) for row in cells for cell in row)


class Table(NamedTuple):
    """Columns read from a file, by their wanted names, with their units and the name of each place in messages."""

    columns: dict[str, Array]
    units: dict[str, str]
    labels: dict[str, str]
    title: str
    place: Callable[[int], str]


def open_table(path: str | Path) -> OpenTable:
    """A file by its suffix.

    Raises:
        ValueError: the suffix is not known, or the file cannot be read
    """
    if Path(path).is_dir() and Path(path, "metadata.yaml").is_file():  # a bag of the second version
        return open_bag(path)
    suffix = Path(path).suffix.lower()
    if is_table_of_numbers(path):
        return open_text(path)
    if suffix not in FORMATS:
        *others, last = FORMATS
        known = f"{', '.join(others)} or {last}"
        if Path(path).is_dir():
            raise ValueError(one_line(f"{path} is a folder without a file of measurements; they end in {known}"))
        if not suffix and not Path(path).exists():
            raise ValueError(one_line(f"{path} does not exist; check its name"))
        what = INSTEAD.get(suffix, f"use {known}")
        raise ValueError(one_line(f"{path}: suffix {quoted(suffix)} is not known; {what}"))
    return FORMATS[suffix](path)


def read_table(opened: OpenTable, columns: Mapping[str, str] | None, units: Mapping[str, str] | None) -> Table:
    """The columns wanted of a file; all if none are named."""
    try:
        sources = sources_of(opened.file, opened.labels, columns, units)
    except ValueError as error:
        raise ValueError(one_line("; ".join([str(error), *opened.left_out]))) from None
    numbers = opened.numbers(sources)
    stated = {source.name: source.unit for source in sources}
    return Table(numbers, stated, {source.name: source.label for source in sources}, opened.title, opened.place)
