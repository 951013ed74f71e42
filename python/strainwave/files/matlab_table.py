"""MAT files: version 4 to 7 by SciPy, 7.3 by h5py, where that is installed; and HDF5 by others."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from strainwave.files.array_table import ArrayTable
from strainwave.files.labels import read_by_others
from strainwave.files.variables import DEPTH, MANY, Unreadable, table_of
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
    for name, value in found.items():
        if isinstance(value, np.ndarray) and value.dtype.names and "s2" in value.dtype.names:
            first = value.ravel()[0]
            yield _text(first["s0"]) or name, _object(_text(first["s2"]))
        elif not name.startswith("__"):
            yield name, value


def _text(value: Any) -> str:
    return value.decode("latin-1") if isinstance(value, bytes) else str(value)


def _object(kind: str) -> Unreadable:
    """What to do with an object of a class of MATLAB, as a table, a timetable, a timeseries or a Simulink data set."""
    save = "save its numbers instead, as with s = struct('t', x.Time, 'q', x.Data), or write a .csv with writetable"
    return Unreadable(f"an object of MATLAB ({kind}), which MATLAB alone reads: {save}")


def _of_hdf5(path: Path, kind: str) -> Iterator[tuple[str, Any]]:
    try:
        import h5py
    except ImportError:
        raise ImportError(f"{path.name}: HDF5, as of MAT 7.3, is read by h5py: pip install strainwave[formats]") from None
    with read_by_others(path, kind), h5py.File(path, "r") as opened:
        found = _of_group(opened, opened)
    yield from found.items()


def _of_group(opened: Any, group: Any, depth: int = DEPTH) -> dict[str, Any]:
    """What a group holds, by names; what begins with # is MATLAB's own."""
    return {name: _of_node(opened, node, depth) for name, node in group.items() if not name.startswith("#")}


def _of_node(opened: Any, node: Any, depth: int) -> Any:
    import h5py

    if isinstance(node, h5py.Group):
        found = _of_group(opened, node, depth - 1) if depth else {}
        lists = [each for each in found.values() if isinstance(each, list)]
        if found and len(lists) == len(found) and len({len(each) for each in lists}) == 1:  # an array of structures
            return [dict(zip(found, each, strict=True)) for each in zip(*lists, strict=True)]
        return found
    kind = _text(node.attrs.get("MATLAB_class", ""))
    if "MATLAB_object_decode" in node.attrs:
        return _object(kind)
    if kind == "char":
        return "".join(map(chr, np.ravel(node[()])))
    if h5py.check_ref_dtype(node.dtype) is not None:
        return [_of_node(opened, opened[each], depth - 1) for each in np.ravel(node[()])[:MANY] if each] if depth else []
    return node[()]
