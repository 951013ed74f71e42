"""Size in memory of the columns of a Parquet file, by its footer and the headers of their pages.

Arrow allocates what these headers claim, and unpacks a page to it, before it compares anything. The footer is not asked for by
Arrow either: an error in it ends the process.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any, BinaryIO

from strainwave.files.budget import MAX_DEPTH, ReadBudget, RefusedFile

TAIL_BYTES = 8  # at the end of the file: length of the footer, and PAR1
MAX_HEADER = 2**16  # bytes of the header of a page, statistics included
ROW_GROUPS_FIELD = 4  # number of the footer's field with the row groups
COLUMNS, ROWS = 1, 3  # of a row group
OTHER_FILE, COLUMN = 1, 3  # of a column in it
PATH, SIZE, PAGE, DICTIONARY_PAGE = 3, 7, 9, 11  # of its description: name by name, bytes, and where its pages begin
UNPACKED, PACKED, DICTIONARY = 2, 3, 7  # of the header of a page; field 1 of the last is the number of its values
STOP, TRUE, FALSE, BYTE, DOUBLE, TEXT, LIST, SET, MAP, STRUCTURE = 0, 1, 2, 3, 7, 8, 9, 10, 11, 12  # types of Thrift


def check_columns(file: BinaryIO, names: Collection[str] | None, budget: ReadBudget) -> None:
    """Take from the budget what columns expand to: those of these names and what is nested in them, or all.

    Raises:
        RefusedFile: they expand to more than the budget allows, or a page claims what cannot be
        Exception: the file is damaged; any kind
    """
    file.seek(-TAIL_BYTES, 2)
    length = int.from_bytes(file.read(4), "little")
    file.seek(-TAIL_BYTES - length, 2)
    for group in _ThriftReader(file.read(length)).structure()[ROW_GROUPS_FIELD]:
        for chunk in group[COLUMNS]:
            if OTHER_FILE in chunk:
                raise RefusedFile("has a column in another file")
            column = chunk[COLUMN]
            path = b".".join(column[PATH]).decode()
            if names is None or path in names or path.partition(".")[0] in names:
                if min(group[ROWS], column[SIZE]) < 0:
                    raise RefusedFile(f"claims {group[ROWS]} rows in {column[SIZE]} bytes; it is damaged")
                budget.take_bytes(8 * group[ROWS], f"column {path}")
                begin = min((column[page] for page in (PAGE, DICTIONARY_PAGE) if column.get(page)), default=0)
                _check_pages(file, begin, begin + column[SIZE], f"column {path}", budget)


def _check_pages(file: BinaryIO, place: int, end: int, what: str, budget: ReadBudget) -> None:
    """Take from the budget what the pages between two places expand to."""
    while place < end:
        budget.take_node()
        file.seek(place)
        reader = _ThriftReader(file.read(MAX_HEADER))
        header = reader.structure()
        unpacked, packed, values = header[UNPACKED], header[PACKED], header.get(DICTIONARY, {}).get(1, 0)
        if min(unpacked, packed) < 0 or values > unpacked:
            raise RefusedFile(f"a page of {what} claims {values} values in {unpacked} bytes; it is damaged")
        budget.take_bytes(unpacked, f"a page of {what}")
        place += reader.place + packed


class _ThriftReader:
    """Reads the compact protocol of Thrift."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.place = 0

    def structure(self, depth: int = 0) -> dict[int, Any]:
        """Return the fields of a structure by their numbers."""
        found: dict[int, Any] = {}
        number = 0
        while (head := self._byte()) != STOP:
            number = number + (head >> 4) if head >> 4 else self._integer()
            found[number] = self._value(head & 15, depth)
        return found

    def _value(self, kind: int, depth: int) -> Any:
        if depth > MAX_DEPTH:
            raise RefusedFile(f"nests structures more than {MAX_DEPTH} deep")
        if kind in (TRUE, FALSE):
            return kind == TRUE
        if kind == BYTE:
            return self._byte()
        if kind == DOUBLE:
            self.place += 8
            return None
        if kind == TEXT:
            length = self._unsigned()
            self.place += length
            return self.data[self.place - length : self.place]
        if kind == STRUCTURE:
            return self.structure(depth + 1)
        if kind in (LIST, SET):
            head = self._byte()
            count = head >> 4 if head >> 4 < 15 else self._unsigned()
            return [self._value(BYTE if head & 15 in (TRUE, FALSE) else head & 15, depth + 1) for _ in range(count)]
        if kind == MAP:
            raise RefusedFile("has a map in its footer, which Parquet does not define; it is damaged")
        return self._integer()

    def _byte(self) -> int:
        self.place += 1
        return self.data[self.place - 1]

    def _unsigned(self) -> int:
        found = shift = 0
        while (byte := self._byte()) & 0x80:
            found |= (byte & 0x7F) << shift
            shift += 7
        return found | byte << shift

    def _integer(self) -> int:
        unsigned = self._unsigned()
        return unsigned >> 1 ^ -(unsigned & 1)
