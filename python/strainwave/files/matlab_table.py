"""MAT files: version 4 to 7 by SciPy, 7.3 by h5py, where that is installed; and HDF5 by others."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from strainwave.files.array_table import ArrayTable
from strainwave.files.labels import read_by_others
from strainwave.files.variables import table_of
from strainwave.messages import one_line

HDF5 = 2  # version of MAT files that are HDF5 files: MATLAB 7.3


def open_mat(path: str | Path) -> ArrayTable:
    """The series of a MAT file; of a structure its fields, as `data.q`."""
    return table_of(one_line(str(path)), _variables(Path(path)))


def open_hdf5(path: str | Path) -> ArrayTable:
    """The series of an HDF5 file; of a group its own, as `data.q`."""
    return table_of(one_line(str(path)), _of_hdf5(Path(path), "HDF5"))


def _variables(path: Path) -> Iterator[tuple[str, Any]]:
    from scipy.io import loadmat
    from scipy.io.matlab import matfile_version

    with read_by_others(path, "MAT"):
        version, _ = matfile_version(path, appendmat=False)
        found = loadmat(path, simplify_cells=True, chars_as_strings=True) if version < HDF5 else {}
    if version >= HDF5:
        yield from _of_hdf5(path, "MAT")
    yield from ((name, value) for name, value in found.items() if not name.startswith("__"))


def _of_hdf5(path: Path, kind: str) -> Iterator[tuple[str, Any]]:
    try:
        import h5py
    except ImportError:
        raise ImportError(f"{path.name}: HDF5, as of MAT 7.3, is read by h5py: pip install strainwave[formats]") from None
    with read_by_others(path, kind), h5py.File(path, "r") as opened:
        found = {
            name: {key: each[()] for key, each in value.items() if isinstance(each, h5py.Dataset)}
            if isinstance(value, h5py.Group)
            else value[()]
            for name, value in opened.items()
            if not name.startswith("#")  # MATLAB's own
        }
    yield from found.items()
