"""MAT files: version 4 to 7, and 7.3, which is HDF5, by h5py where that is installed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from strainwave.files.array_table import ArrayTable
from strainwave.files.budget import ReadBudget, budget_of, open_regular, read_regular
from strainwave.files.hdf5_table import hdf5_variables
from strainwave.files.labels import read_by_others
from strainwave.files.matlab_variables import HEADER_BYTES, variables_of_version_4, variables_of_version_5
from strainwave.files.table_format import Format
from strainwave.files.variables import IN_THE_NAME, table_of
from strainwave.messages import one_line

VERSION = slice(124, 128)  # of version 5 and later: version and byte order
VERSION_5, VERSION_7_3 = (b"\x00\x01IM", b"\x01\x00MI"), (b"\x00\x02IM", b"\x02\x00MI")


def open_mat(path: str | Path) -> ArrayTable:
    """The series of a MAT file; of a structure its fields, as `data.q`."""
    with read_by_others(path, "MAT"):
        budget = budget_of(path)
    return table_of(one_line(str(path)), _variables(Path(path), budget), budget)


def _variables(path: Path, budget: ReadBudget) -> Iterator[tuple[str, Any]]:
    with read_by_others(path, "MAT"):
        with open_regular(path) as file:
            head = file.read(HEADER_BYTES)
        if head[VERSION] in VERSION_7_3:
            found = list(hdf5_variables(path, "MAT", budget))
        elif head[VERSION] in VERSION_5:
            found = list(variables_of_version_5(read_regular(path), budget))
        elif 0 in head[:4]:
            found = list(variables_of_version_4(read_regular(path), budget))
        else:
            raise ValueError("no MAT file")
    yield from ((name, value) for name, value in found if name and not name.startswith("__"))


ABOUT = (
    "version 4 to 7.3. A series is a variable or a field of a structure, as `data.joint2.q`. A matrix contains several, "
    "`q_1`, `q_2` …. The most frequent length is read; an array or a cell of structures is a recording each, as "
    "`bench.mat(2)`; of a Simulink scope, its signals by their labels. Only MATLAB can read its objects (timetable, "
    "timeseries, Simulink data set): save their values, as `s = struct('t', x.Time, 'q', x.Data)`. Version 7.3 needs h5py: "
    "`pip install 'strainwave[formats]'`."
)
FORMAT: Format = Format((".mat",), open_mat, "MAT", IN_THE_NAME, about=ABOUT)
