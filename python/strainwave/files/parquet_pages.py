"""What the columns of a Parquet file expand to, by the headers of their pages.

Arrow allocates what these headers claim, and unpacks a page to it, before it compares anything.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Any, BinaryIO

from strainwave.files.budget import MAX_DEPTH, Budget, RefusedFile

if TYPE_CHECKING:
    import pyarrow.parquet

MAX_HEADER = 2**16  # bytes of the header of a page, statistics included
UNPACKED, PACKED, DICTIONARY = 2, 3, 7  # fields of a page header; field 1 of the last is the number of its values
STOP, TRUE, FALSE, BYTE, DOUBLE, TEXT, LIST, SET, MAP, STRUCTURE = 0, 1, 2, 3, 7, 8, 9, 10, 11, 12  # types of Thrift


def check_columns(
    file: BinaryIO, metadata: pyarrow.parquet.FileMetaData, names: Collection[str] | None, budget: Budget
) -> None:
    """Take from the budget what columns expand to: those of these names and what is nested in them, or all.

    Raises:
        RefusedFile: they expand to more than the budget allows, or a page claims what cannot be
        Exception: the file is damaged; any kind
    """
    budget.take_bytes(metadata.serialized_size, "its footer")
    paths = [metadata.schema.column(place).path for place in range(metadata.num_columns)]
    chosen = [place for place, path in enumerate(paths) if names is None or path in names or path.partition(".")[0] in names]
    for number in range(metadata.num_row_groups):
        group = metadata.row_group(number)
        if group.num_rows < 0:
            raise RefusedFile(f"claims {group.num_rows} rows in a row group; it is damaged")
        for place in chosen:
            budget.take_bytes(8 * group.num_rows, f"column {paths[place]}")
            column = group.column(place)
            begin = min(offset for offset in (column.dictionary_page_offset, column.data_page_offset) if offset)
            _check_pages(file, begin, begin + column.total_compressed_size, f"column {paths[place]}", budget)


def _check_pages(file: BinaryIO, place: int, end: int, what: str, budget: Budget) -> None:
    """Take from the budget what the pages between two places expand to."""
    while place < end:
        budget.take_node()
        file.seek(place)
        reader = _Reader(file.read(MAX_HEADER))
        header = reader.structure()
        unpacked, packed, values = header[UNPACKED], header[PACKED], header.get(DICTIONARY, {}).get(1, 0)
        if min(unpacked, packed) < 0 or values > unpacked:
            raise RefusedFile(f"a page of {what} claims {values} values in {unpacked} bytes; it is damaged")
        budget.take_bytes(unpacked, f"a page of {what}")
        place += reader.place + packed


class _Reader:
    """Reads the compact protocol of Thrift."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.place = 0

    def structure(self, depth: int = 0) -> dict[int, Any]:
        """Return the fields of a structure by their numbers."""
        if depth > MAX_DEPTH:
            raise RefusedFile(f"nests structures more than {MAX_DEPTH} deep")
        found: dict[int, Any] = {}
        number = 0
        while (head := self._byte()) != STOP:
            number = number + (head >> 4) if head >> 4 else self._integer()
            found[number] = self._value(head & 15, depth)
        return found

    def _value(self, kind: int, depth: int) -> Any:
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
            return None
        if kind == STRUCTURE:
            return self.structure(depth + 1)
        if kind in (LIST, SET, MAP):
            raise RefusedFile("a page has a list in its header, which Parquet does not define; it is damaged")
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
