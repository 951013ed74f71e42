"""The elements of a MAT file of version 4 or 5, checked before SciPy reads them.

SciPy believes what the elements claim: it allocates before it reads, unpacks without a bound, and calls itself for each cell in
a cell until the process ends. So each claim is compared with what the file contains, and packed elements are unpacked here.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from math import prod
from typing import NamedTuple

from strainwave.files.budget import Budget, RefusedFile

HEADER = 128  # bytes, version 5
MATRIX, COMPRESSED = 14, 15  # types of elements
CELL, STRUCTURE, OBJECT, TEXT, SPARSE, FUNCTION, OPAQUE = 1, 2, 3, 4, 5, 16, 17  # classes of arrays; the others hold numbers
COMPLEX = 0x800  # flag
BYTES_OF_ENTRY = 8  # that an entry of an array takes in memory
ITEM_BYTES = {0: 8, 1: 4, 2: 4, 3: 2, 4: 2, 5: 1}  # of a number in version 4, by the digit for its type
LARGEST_TYPE = 5000  # in version 4; a number beyond it has the other byte order


class _Element(NamedTuple):
    kind: int
    content: memoryview


def checked_version_4(data: bytes, budget: Budget) -> bytes:
    """Return a file of version 4 whose matrices are as large as they claim.

    Raises:
        RefusedFile: they are not, or would take more than the budget allows
    """
    place = 0
    order = "<" if struct.unpack_from("<i", data)[0] in range(LARGEST_TYPE) else ">"
    while place < len(data):
        budget.take_node()
        kind, rows, columns, imaginary, name = struct.unpack_from(f"{order}5i", data, place)
        if min(rows, columns, name) < 0 or kind // 10 % 10 not in ITEM_BYTES:
            raise RefusedFile("has a matrix of an unknown type or a negative size; it is damaged")
        budget.take_bytes(rows * columns * BYTES_OF_ENTRY, "a matrix")
        place += 20 + name + rows * columns * ITEM_BYTES[kind // 10 % 10] * (2 if imaginary else 1)
    if place > len(data):
        raise RefusedFile(f"claims {place} bytes, but has {len(data)}; it is damaged")
    return data


def checked_version_5(data: bytes, budget: Budget) -> bytes:
    """Return a file of version 5 with all elements unpacked and as large as they claim.

    Raises:
        RefusedFile: an element is not, is nested too deep, or would take more than the budget allows
    """
    order = "<" if data[126:128] == b"IM" else ">"
    parts = [data[:HEADER]]
    for element in _elements(memoryview(data)[HEADER:], order, is_padded=False):
        if element.kind == COMPRESSED:
            unpacked = memoryview(_unpacked(element.content, budget))
        else:
            unpacked = memoryview(struct.pack(f"{order}2I", element.kind, len(element.content)) + bytes(element.content))
        (inner,) = _elements(unpacked, order, is_padded=False)
        if inner.kind != MATRIX:
            raise RefusedFile(f"has an element of type {inner.kind} where a matrix stands; it is damaged")
        _check_matrix(inner.content, order, budget)
        parts.append(bytes(unpacked))
    return b"".join(parts)


def _unpacked(content: memoryview, budget: Budget) -> bytes:
    inflater = zlib.decompressobj()
    found = inflater.decompress(content, budget.allowed_bytes + 1)
    budget.take_bytes(len(found), "a packed variable")
    return found


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


def _check_matrix(content: memoryview, order: str, budget: Budget) -> None:
    """Compare what a matrix and all in it claim with what they contain."""
    waiting = [(content, 0)]
    while waiting:
        content, depth = waiting.pop()
        budget.take_node(depth)
        if not len(content):
            continue
        flags, *parts = _elements(content, order)
        (word,) = struct.unpack_from(f"{order}I", flags.content)
        inside = parts[3:] if word & 0xFF == OPAQUE else _check_array(word, parts, order, budget)
        for part in inside:
            if part.kind != MATRIX:
                raise RefusedFile(f"has an element of type {part.kind} where a matrix stands; it is damaged")
            waiting.append((part.content, depth + 1))
        if word & 0xFF == OPAQUE and len(inside) != 1:
            raise RefusedFile("has an object without content; it is damaged")


def _check_array(word: int, parts: list[_Element], order: str, budget: Budget) -> list[_Element]:
    """Check the number of parts of an array; return those that are arrays themselves."""
    kind = word & 0xFF
    dimensions, _, *rest = parts
    size = prod(struct.unpack(f"{order}{len(dimensions.content) // 4}i", dimensions.content))
    if size < 0:
        raise RefusedFile("has an array of a negative size; it is damaged")
    if kind != SPARSE:
        budget.take_bytes(size * BYTES_OF_ENTRY, "an array")
    if kind == FUNCTION:
        expected, first = 1, 0
    elif kind == CELL:
        expected, first = size, 0
    elif kind in (STRUCTURE, OBJECT):
        first = 2 if kind == STRUCTURE else 3
        length, names = rest[first - 2 : first]
        fields = len(names.content) // max(int.from_bytes(length.content, "little" if order == "<" else "big"), 1)
        expected = first + size * fields
    else:
        first = expected = (3 if kind == SPARSE else 1) + (1 if word & COMPLEX else 0)
    if len(rest) != expected:
        raise RefusedFile(f"has an array of {len(rest)} parts where it claims {expected}; it is damaged")
    return rest[first:]
