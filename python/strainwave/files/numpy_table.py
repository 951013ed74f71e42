"""Files of NumPy: one array, `.npy`, or several by their names, `.npz`."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from math import prod
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.lib import format as numpy_format

from strainwave.files.array_table import IN_THE_NAME, ArrayTable, Unreadable, table_of
from strainwave.files.budget import ReadBudget, RefusedFile, budget_of, open_regular
from strainwave.files.labels import read_by_others
from strainwave.files.table_format import Format
from strainwave.messages import one_line

ZIP_BEGINNING = b"PK"  # first letters of a file of several arrays
PACKED_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # as NumPy writes; zipfile unpacks others without a bound
OBJECT_KINDS = Unreadable("an array of Python objects, which may run any program as it is loaded; save its numbers")


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
    with read_by_others(path, "NumPy"), open_regular(path) as file:
        budget = budget_of(path)
        is_zip = file.read(len(ZIP_BEGINNING)) == ZIP_BEGINNING
        file.seek(0)
        variables = list(_of_zip(file, budget) if is_zip else _of_array("", file, budget.file_bytes, budget))
    return table_of(one_line(str(path)), variables, budget)


def _of_zip(file: BinaryIO, budget: ReadBudget) -> Iterator[tuple[str, Any]]:
    with zipfile.ZipFile(file) as members:
        for member in members.infolist():
            budget.take_node()
            if member.filename.endswith(".npy"):
                if member.compress_type not in PACKED_METHODS:
                    raise RefusedFile(f"{member.filename} is packed in another way than NumPy does")
                with members.open(member) as opened:
                    yield from _of_array(member.filename.removesuffix(".npy"), opened, member.file_size, budget)


def _of_array(name: str, file: Any, file_bytes: int, budget: ReadBudget) -> Iterator[tuple[str, Any]]:
    """Return the arrays of numbers in a file of that many bytes, those of a structured array by its names."""
    version = numpy_format.read_magic(file)
    read_header = numpy_format.read_array_header_1_0 if version == (1, 0) else numpy_format.read_array_header_2_0
    shape, is_transposed, kind = read_header(file)
    if kind.hasobject:
        yield name, OBJECT_KINDS
        return
    size = prod(shape)
    if min(shape, default=0) < 0 or size * kind.itemsize > file_bytes:
        raise RefusedFile(f"{name or 'its array'} claims {size * kind.itemsize} bytes, but has {file_bytes}; it is damaged")
    budget.take_bytes(size * max(kind.itemsize, 1), name or "its array")
    data: Any = np.frombuffer(_whole(file, size * kind.itemsize), kind, size) if kind.itemsize else np.empty(0)
    value = data.reshape(shape[::-1]).T if is_transposed else data.reshape(shape)
    yield from ((f"{name}.{key}" if name else key, value[key]) for key in kind.names) if kind.names else [(name, value)]


def _whole(file: BinaryIO, count: int) -> bytes:
    data = file.read(count)
    if len(data) < count:
        raise RefusedFile(f"ends {count - len(data)} bytes before its last number; it is damaged")
    return data


FORMAT: Format = Format(
    (".npy", ".npz"),
    open_numpy,
    "NumPy",
    IN_THE_NAME,
    about="series, matrices and lengths as in MAT files. Arrays of Python objects are not loaded.",
)
