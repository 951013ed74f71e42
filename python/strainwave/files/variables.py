"""Tables from named variables, as MATLAB, NumPy and JSON hold them: series, matrices of several series, single numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.files.array_table import ArrayTable
from strainwave.files.labels import label_of
from strainwave.messages import listed

Array = NDArray[np.float64]

MANY = 100  # columns of a matrix: more are no channels


def table_of(file: str, variables: Iterable[tuple[str, Any]]) -> ArrayTable:
    """The series that are of the length most of them have.

    A series is a variable, or a field of a structure, as `data.q`; a matrix holds several, `q_1`, `q_2` …, and one without a
    name `column_1`, `column_2` … Series of another length are told of and left out.

    Raises:
        ValueError: there is no series of numbers
    """
    series: dict[str, Array] = {}
    singles: dict[str, float] = {}
    for name, value in variables:
        for part, values in _series(name, value):
            if values.size == 1:
                singles[part] = float(values[0])
            else:
                series[part] = values
    if not series:
        raise ValueError(f"{file} holds no series of numbers")
    length, _ = max(Counter(len(values) for values in series.values()).items(), key=lambda each: (each[1], each[0]))
    kept = {name: values for name, values in series.items() if len(values) == length}
    others = [f"{name} ({len(values)})" for name, values in series.items() if len(values) != length]
    left_out = [f"of another length than {length}, and left out: {listed(others)}"] if others else []
    return ArrayTable(file, "", [label_of(name) for name in kept], list(kept.values()), left_out, singles)


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
        yield name or "column_1", columns[:, 0]
    elif columns.shape[1] <= MANY:
        yield from ((f"{name or 'column'}_{number}", columns[:, number - 1]) for number in range(1, columns.shape[1] + 1))
