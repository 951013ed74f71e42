"""MAT files: version 4 to 7 by SciPy, 7.3, which is HDF5, by h5py where that is installed."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from strainwave.files.array_table import ArrayTable
from strainwave.files.budget import Budget, budget_of, open_regular, read_regular
from strainwave.files.hdf5_table import hdf5_variables
from strainwave.files.labels import read_by_others
from strainwave.files.matlab_elements import checked_version_4, checked_version_5
from strainwave.files.variables import object_of_matlab, table_of
from strainwave.messages import one_line

VERSION_4, HDF5 = 0, 2  # versions of MAT files as SciPy counts them


def open_mat(path: str | Path) -> ArrayTable:
    """The series of a MAT file; of a structure its fields, as `data.q`."""
    with read_by_others(path, "MAT"):
        budget = budget_of(path)
    return table_of(one_line(str(path)), _variables(Path(path), budget), budget)


def _variables(path: Path, budget: Budget) -> Iterator[tuple[str, Any]]:
    from scipy.io import loadmat
    from scipy.io.matlab import matfile_version

    with read_by_others(path, "MAT"):
        content: Any
        with open_regular(path) as content:
            version, _ = matfile_version(content, appendmat=False)
        found = {}
        if version < HDF5:
            check = checked_version_4 if version == VERSION_4 else checked_version_5
            content = io.BytesIO(check(read_regular(path), budget))
            found = loadmat(content, simplify_cells=True, chars_as_strings=True)
    if version >= HDF5:
        yield from hdf5_variables(path, "MAT", budget)
    for name, value in found.items():
        if isinstance(value, np.ndarray) and value.dtype.names and "s2" in value.dtype.names:
            first = value.ravel()[0]
            yield _text(first["s0"]) or name, object_of_matlab(_text(first["s2"]))
        elif not name.startswith("__"):
            yield name, value


def _text(value: Any) -> str:
    return value.decode("latin-1") if isinstance(value, bytes) else str(value)
