"""Tables in files of any kind that is known: which columns they have, and their numbers.

Only files are known here, not what a recording must obey; `Recording` asks for the columns it wants.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.files import (
    bag_table,
    hdf5_table,
    json_table,
    matlab_table,
    mdf_table,
    numpy_table,
    parquet_table,
    text_table,
)
from strainwave.files.bag_table import open_bag
from strainwave.files.budget import RefusedFile, open_regular
from strainwave.files.labels import sources_of, unreadable
from strainwave.files.mdf_table import MDF_BEGINNINGS, open_mdf
from strainwave.files.table_format import Format, OpenTable
from strainwave.files.text_layout import NUMBER_CELL
from strainwave.files.text_table import open_text
from strainwave.messages import one_line, quoted

Array = NDArray[np.float64]


def _open_dat(path: str | Path) -> OpenTable:
    """Open a file with a general suffix: MDF by its first letters, else text."""
    try:
        with open_regular(path) as file:
            begin = file.read(8)
    except (OSError, UnicodeError, RefusedFile) as error:
        raise ValueError(unreadable(path, error)) from None
    return open_mdf(path) if begin.startswith(MDF_BEGINNINGS) else open_text(path)


LISTED_FORMATS = (
    text_table.FORMAT,
    parquet_table.FORMAT,
    Format((".dat",), _open_dat, "Text or MDF", "as in files of that format"),
    matlab_table.FORMAT,
    hdf5_table.FORMAT,
    numpy_table.FORMAT,
    json_table.FORMAT,
    mdf_table.FORMAT,
    bag_table.FORMAT,
)
FORMATS = {suffix: each.open for each in LISTED_FORMATS for suffix in each.suffixes}
BEGIN_BYTES = 4096  # of a file with an unknown suffix, by which it is taken for a table of numbers
MIN_ROWS = 5  # of numbers in them
OTHER_SUFFIXES = {  # what to do with other files that people have
    ".pkl": "a pickle may run any program as it is read: save it as .npz, .csv or .parquet",
    ".pickle": "a pickle may run any program as it is read: save it as .npz, .csv or .parquet",
    ".xlsx": "save the sheet as .csv",
    ".xls": "save the sheet as .csv",
    ".ods": "save the sheet as .csv",
    ".tdms": "save it as .csv in LabVIEW or DIAdem, or in Python with npTDMS: "
    "nptdms.TdmsFile.read(PATH).as_dataframe(time_index=True).to_csv('log.csv', index_label='time')",
}


def is_table_of_numbers(path: str | Path) -> bool:
    """True if a file whose suffix is not known begins with several rows of as many numbers."""
    if Path(path).suffix.lower() in {*FORMATS, *OTHER_SUFFIXES}:
        return False
    try:
        with open_regular(path) as file:
            rows = file.read(BEGIN_BYTES).decode("ascii").splitlines()[:-1]
    except (OSError, UnicodeError, RefusedFile):
        return False
    cells = [re.split(r"[\s,;]+", row.strip()) for row in rows]
    is_even = len(rows) >= MIN_ROWS and len({len(row) for row in cells}) == 1
    return is_even and all(NUMBER_CELL.fullmatch(cell) for row in cells for cell in row)


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
        ValueError: the file does not exist, its suffix is not known, or it cannot be read
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
        if not Path(path).exists():
            raise ValueError(one_line(f"{path} does not exist; check its name"))
        what = OTHER_SUFFIXES.get(suffix, f"use {known}")
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
