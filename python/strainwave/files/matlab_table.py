"""MAT files: version 4 to 7 by SciPy, 7.3 by h5py, where that is installed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.files.array_table import ArrayTable
from strainwave.files.labels import label_of, read_by_others
from strainwave.messages import listed, one_line

Array = NDArray[np.float64]

MANY = 100  # columns of a matrix: more are no channels


def open_mat(path: str | Path) -> ArrayTable:
    """The series of a MAT file that are of the length most of them have.

    A series is a variable, or a field of a structure, as `data.q`; a matrix holds several, `q_1`, `q_2` … Single numbers, and
    series of another length, are told of and left out.
    """
    file = one_line(str(path))
    series: dict[str, Array] = {}
    numbers: dict[str, float] = {}
    for name, value in _variables(Path(path)):
        for part, values in _series(name, value):
            if values.size == 1:
                numbers[part] = float(values[0])
            else:
                series[part] = values
    if not series:
        raise ValueError(f"{file} holds no series of numbers")
    length, _ = max(Counter(len(values) for values in series.values()).items(), key=lambda each: (each[1], each[0]))
    kept = {name: values for name, values in series.items() if len(values) == length}
    left_out = []
    if others := [f"{name} ({len(values)})" for name, values in series.items() if len(values) != length]:
        left_out.append(f"of another length than {length}, and left out: {listed(others)}")
    if numbers:
        left_out.append(f"single numbers, not used: {listed(f'{name} = {value:g}' for name, value in numbers.items())}")
    labels = [label_of(name) for name in kept]
    return ArrayTable(file, "", labels, list(kept.values()), left_out)


def _variables(path: Path) -> Iterator[tuple[str, Any]]:
    from scipy.io import loadmat

    try:
        with read_by_others(path, "MAT"):
            found = loadmat(path, simplify_cells=True, chars_as_strings=True)
    except NotImplementedError:  # version 7.3
        yield from _of_hdf5(path)
        return
    yield from ((name, value) for name, value in found.items() if not name.startswith("__"))


def _of_hdf5(path: Path) -> Iterator[tuple[str, Any]]:
    try:
        import h5py
    except ImportError:
        raise ImportError(f"{path.name}: MAT files of version 7.3 are read by h5py: pip install strainwave[formats]") from None
    with read_by_others(path, "MAT"), h5py.File(path, "r") as opened:
        found = {
            name: {key: each[()] for key, each in value.items() if isinstance(each, h5py.Dataset)}
            if isinstance(value, h5py.Group)
            else value[()]
            for name, value in opened.items()
            if not name.startswith("#")  # MATLAB's own
        }
    yield from found.items()


def _series(name: str, value: Any, depth: int = 1) -> Iterator[tuple[str, Array]]:
    """The series that a variable holds."""
    if isinstance(value, Mapping):
        if depth:
            for key, each in value.items():
                yield from _series(f"{name}.{key}", each, depth - 1)
        return
    array = np.asarray(value)
    if array.dtype.kind not in "fiub" or array.ndim > 2 or array.size == 0:
        return
    matrix = np.atleast_2d(array.astype(float))
    columns = matrix.T if matrix.shape[0] < matrix.shape[1] else matrix
    if columns.shape[1] == 1:
        yield name, columns[:, 0]
    elif columns.shape[1] <= MANY:
        yield from ((f"{name}_{number}", columns[:, number - 1]) for number in range(1, columns.shape[1] + 1))
