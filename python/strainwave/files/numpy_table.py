"""Files of NumPy: one array, `.npy`, or several by their names, `.npz`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from strainwave.files.array_table import ArrayTable
from strainwave.files.labels import read_by_others
from strainwave.files.variables import table_of
from strainwave.messages import one_line


def open_numpy(path: str | Path) -> ArrayTable:
    """The series of arrays of numbers; arrays of Python objects are not loaded, as doing so may run what they hold.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "arm.npz")
    ...     np.savez(path, time=np.arange(5) * 0.01, q=np.zeros((5, 2)), fs=100.0)
    ...     table = open_numpy(path)
    >>> [label.name for label in table.labels], table.singles
    (['time', 'q_1', 'q_2'], {'fs': 100.0})
    """
    with read_by_others(path, "NumPy"):
        variables = list(_variables(np.load(path, allow_pickle=False)))
    return table_of(one_line(str(path)), variables)


def _variables(loaded: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(loaded, np.ndarray):
        names = loaded.dtype.names
        yield from [("", loaded)] if names is None else ((name, loaded[name]) for name in names)
        return
    with loaded:
        for name in loaded.files:
            try:
                value = loaded[name]
            except ValueError:  # objects
                continue
            yield from ((f"{name}.{key}", value[key]) for key in value.dtype.names) if value.dtype.names else [(name, value)]
