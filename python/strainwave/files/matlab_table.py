"""MAT files: version 4 to 7 from their bytes, and 7.3, which is HDF5, by h5py where that is installed."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator, Sequence
from math import prod
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from strainwave.files.array_table import IN_THE_NAME, ArrayTable, object_of_matlab, table_of
from strainwave.files.budget import ReadBudget, RefusedFile, budget_of, open_regular, read_regular
from strainwave.files.hdf5_table import hdf5_variables
from strainwave.files.labels import read_by_others
from strainwave.files.table_format import Format
from strainwave.messages import one_line

HEADER_BYTES = 128  # bytes, version 5
MATRIX, COMPRESSED = 14, 15  # types of elements
NUMBER_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}  # types of elements
TEXT_TYPES = {16: "utf-8", 17: "utf-16", 18: "utf-32"}  # types of elements; the others contain a letter in each number
CELL, STRUCTURE, OBJECT, TEXT, SPARSE, FUNCTION, OPAQUE = 1, 2, 3, 4, 5, 16, 17  # classes of arrays
LAST_CLASS = 17  # the other ones contain numbers
COMPLEX_FLAG = 0x800  # flag
NUMBERS_OF_VERSION_4 = {0: "f8", 1: "f4", 2: "i4", 3: "i2", 4: "u2", 5: "u1"}  # by the third digit of the type
LARGEST_TYPE = 5000  # in version 4; a number beyond it has the other byte order
BYTES_OF_VALUE = 64  # that a cell or field takes in memory as Python has it


class _Element(NamedTuple):
    kind: int
    content: memoryview


def variables_of_version_4(data: bytes, budget: ReadBudget) -> Iterator[tuple[str, Any]]:
    """Return the real matrices of a file of version 4 by their names.

    Raises:
        RefusedFile: the file claims more than it contains
    """
    place = 0
    order = "<" if struct.unpack_from("<i", data)[0] in range(LARGEST_TYPE) else ">"
    while place < len(data):
        budget.take_node()
        kind, rows, columns, imaginary, length = struct.unpack_from(f"{order}5i", data, place)
        number = NUMBERS_OF_VERSION_4.get(kind // 10 % 10)
        if min(rows, columns, length) < 0 or number is None:
            raise RefusedFile("has a matrix of an unknown type or a negative size; it is damaged")
        begin = place + 20 + length
        place = begin + rows * columns * np.dtype(number).itemsize * (2 if imaginary else 1)
        if place > len(data):
            raise RefusedFile(f"claims {place} bytes, but has {len(data)}; it is damaged")
        if not imaginary and kind % 10 == 0:  # no text, not sparse
            values = np.frombuffer(data, f"{order}{number}", rows * columns, begin)
            yield _text(data[begin - length : begin]), values.reshape(rows, columns, order="F")


def variables_of_version_5(data: bytes, budget: ReadBudget) -> Iterator[tuple[str, Any]]:
    """Return the variables of a file of version 5 by their names: structures as mappings, cells as lists.

    Raises:
        RefusedFile: the file claims more than it contains, nests too deep, or would take more than the budget allows
    """
    order = "<" if data[126:128] == b"IM" else ">"
    for element in _elements(memoryview(data)[HEADER_BYTES:], order, is_padded=False):
        if element.kind == COMPRESSED:
            (element,) = _elements(_unpacked(element.content, budget), order, is_padded=False)
        yield _array(element, order, budget, 0)


def _unpacked(content: memoryview, budget: ReadBudget) -> memoryview:
    inflater = zlib.decompressobj()
    unpacked = inflater.decompress(content, budget.allowed_bytes + 1)
    budget.take_bytes(len(unpacked), "a packed variable")
    return memoryview(unpacked)


def _elements(content: memoryview, order: str, is_padded: bool = True) -> Iterator[_Element]:
    """Return the elements in the content of another one, each padded to eight bytes but for the outermost ones."""
    place = 0
    while place < len(content):
        (word,) = struct.unpack_from(f"{order}I", content, place)
        if word >> 16:  # a short one, with its content in the second half of the tag
            kind, length, begin, end = word & 0xFFFF, word >> 16, place + 4, place + 8
        else:
            kind, length = word, struct.unpack_from(f"{order}I", content, place + 4)[0]
            begin, end = place + 8, place + 8 + length + (-length % 8 if is_padded else 0)
        if begin + length > len(content) or length > end - begin:
            raise RefusedFile(f"an element claims {length} bytes, more than what contains it; it is damaged")
        yield _Element(kind, content[begin : begin + length])
        place = end


def _array(element: _Element, order: str, budget: ReadBudget, depth: int) -> tuple[str, Any]:
    """Return name and content of an array; an empty array of numbers for what contains no series."""
    budget.take_node(depth)
    budget.take_bytes(BYTES_OF_VALUE, "its cells and fields")
    if element.kind != MATRIX:
        raise RefusedFile(f"has an element of type {element.kind} where a matrix stands; it is damaged")
    if not len(element.content):
        return "", np.array([])
    flags, *parts = _elements(element.content, order)
    (word,) = struct.unpack_from(f"{order}I", flags.content)
    kind = word & 0xFF
    if kind == OPAQUE:
        name, _, kind_of_object = (_text(part.content) for part in parts[:3])
        return name, object_of_matlab(kind_of_object)
    dimensions, named, *rest = parts
    shape = struct.unpack(f"{order}{len(dimensions.content) // 4}i", dimensions.content)
    name = _text(named.content)
    if min(shape, default=0) < 0 or kind > LAST_CLASS:
        raise RefusedFile("has an array of an unknown class or a negative size; it is damaged")
    if kind in (SPARSE, FUNCTION) or (word & COMPLEX_FLAG and kind > SPARSE):
        return name, np.array([])
    if kind == TEXT:
        return name, "".join(_letters(part, order) for part in rest[:1])
    if kind not in (CELL, STRUCTURE, OBJECT):
        return name, _numbers(rest, shape, order)
    fields, rest = ([""], rest) if kind == CELL else _fields(rest[1:] if kind == OBJECT else rest, order)
    if len(rest) != prod(shape) * len(fields):
        raise RefusedFile(f"has an array of {len(rest)} parts where it claims {prod(shape) * len(fields)}; it is damaged")
    values = [_array(part, order, budget, depth + 1)[1] for part in rest]
    if kind == CELL:
        return name, values
    places = range(0, len(values), max(len(fields), 1))
    structures = [dict(zip(fields, values[place : place + len(fields)], strict=True)) for place in places]
    return name, structures[0] if len(structures) == 1 else structures


def _fields(parts: Sequence[_Element], order: str) -> tuple[list[str], list[_Element]]:
    """Return the names of the fields of a structure, and its other parts."""
    width, names, *rest = parts
    (length,) = struct.unpack(f"{order}i", width.content)
    if length < 1:
        raise RefusedFile(f"has names of {length} letters; it is damaged")
    return [_text(names.content[place : place + length]) for place in range(0, len(names.content), length)], rest


def _numbers(parts: Sequence[_Element], shape: Sequence[int], order: str) -> Any:
    """Return the real part of an array of numbers."""
    number = NUMBER_TYPES.get(parts[0].kind)
    if number is None:
        raise RefusedFile(f"has numbers of the type {parts[0].kind}, which MATLAB does not define; it is damaged")
    values = np.frombuffer(parts[0].content, f"{order}{number}")
    if len(values) != prod(shape):
        raise RefusedFile(f"has an array of {len(values)} numbers where it claims {prod(shape)}; it is damaged")
    return np.squeeze(values.reshape(shape, order="F"))


def _letters(part: _Element, order: str) -> str:
    """Return the letters of a text, which may be numbers of any type."""
    if part.kind in TEXT_TYPES:
        ending = "" if part.kind == min(TEXT_TYPES) else "-le" if order == "<" else "-be"
        return bytes(part.content).decode(TEXT_TYPES[part.kind] + ending, "replace")
    values = np.frombuffer(part.content, f"{order}{NUMBER_TYPES.get(part.kind, 'u1')}")
    return "".join(chr(value) for value in values.tolist() if value in range(0x110000))


def _text(content: memoryview | bytes) -> str:
    return bytes(content).partition(b"\0")[0].decode("latin-1")


# ---- The table -------------------------------------------------------------------------------------------------------


VERSION_BYTES = slice(124, 128)  # of version 5 and later: version and byte order
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
        if head[VERSION_BYTES] in VERSION_7_3:
            variables = list(hdf5_variables(path, "MAT", budget))
        elif head[VERSION_BYTES] in VERSION_5:
            variables = list(variables_of_version_5(read_regular(path), budget))
        elif 0 in head[:4]:
            variables = list(variables_of_version_4(read_regular(path), budget))
        else:
            raise ValueError("no MAT file")
    yield from ((name, value) for name, value in variables if name and not name.startswith("__"))


FORMAT: Format = Format(
    (".mat",),
    open_mat,
    "MAT",
    IN_THE_NAME,
    about=(
        "version 4 to 7.3. A series is a variable or a field of a structure, as `data.joint2.q`. A matrix contains several, "
        "`q_1`, `q_2` …. The most frequent length is read; an array or a cell of structures is a recording each, as "
        "`bench.mat(2)`; of a Simulink scope, its signals by their labels. Only MATLAB can read its objects (timetable, "
        "timeseries, Simulink data set): save their values, as `s = struct('t', x.Time, 'q', x.Data)`. Version 7.3 needs h5py: "
        "`pip install 'strainwave[formats]'`."
    ),
)
