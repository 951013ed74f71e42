"""Parquet files, by pyarrow: their pages are checked before it reads them."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from strainwave.files.budget import MAX_DEPTH, ReadBudget, RefusedFile, budget_of, open_regular
from strainwave.files.labels import (
    ColumnSource,
    Content,
    Label,
    check_names,
    label_of,
    read_by_others,
    seconds_since_first,
    unreadable,
)
from strainwave.files.table_format import Format
from strainwave.messages import one_line, quoted

if TYPE_CHECKING:
    import pyarrow

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
        fields: dict[int, Any] = {}
        number = 0
        while (head := self._byte()) != STOP:
            number = number + (head >> 4) if head >> 4 else self._integer()
            fields[number] = self._value(head & 15, depth)
        return fields

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
        number = shift = 0
        while (byte := self._byte()) & 0x80:
            number |= (byte & 0x7F) << shift
            shift += 7
        return number | byte << shift

    def _integer(self) -> int:
        unsigned = self._unsigned()
        return unsigned >> 1 ^ -(unsigned & 1)


# ---- The table -------------------------------------------------------------------------------------------------------


Array = NDArray[np.float64]


def open_parquet(path: str | Path) -> ParquetTable:
    """The schema of a Parquet file."""
    import pyarrow
    from pyarrow.parquet import read_schema

    try:
        with open_regular(path) as file:
            schema = read_schema(file)
        check_names(schema.names)
        title = (schema.metadata or {}).get(b"title", b"").decode()
        labels = [_label(field) for field in schema]
    except (OSError, pyarrow.ArrowException, UnicodeError, RefusedFile) as error:
        raise ValueError(unreadable(path, error)) from None
    return ParquetTable(one_line(str(path)), title, labels, Path(path), schema)


@dataclass(frozen=True)
class ParquetTable:
    """A Parquet file whose columns are still on the disk."""

    file: str
    title: str
    labels: Sequence[Label]
    path: Path
    schema: pyarrow.Schema
    left_out: Sequence[str] = ()

    @property
    def contents(self) -> list[Content]:
        return [_content(field.type) for field in self.schema]

    def numbers(self, sources: Sequence[ColumnSource]) -> dict[str, Array]:
        """The columns wanted, which must be numbers."""
        table = self._read(sources, ("numbers",))
        return {source.name: self._numbers(table, source.position) for source in sources}

    def measured(self, sources: Sequence[ColumnSource]) -> tuple[dict[str, Array], list[str]]:
        """The columns wanted, nan where nothing is written, dates as seconds; and what was left out."""
        table = self._read(sources, ("numbers", "dates"))
        contents = self.contents
        dates = {source.position for source in sources if contents[source.position] == "dates"}
        return {
            source.name: _seconds(table, self.schema.field(source.position))
            if source.position in dates
            else self._numbers(table, source.position)
            for source in sources
        }, []

    def place(self, row: int) -> str:
        return f"row {row}"

    def _read(self, sources: Sequence[ColumnSource], allowed: Sequence[Content]) -> pyarrow.Table:
        wanted = [self.schema.field(source.position) for source in sources]
        for field in wanted:
            if (count := len(self.schema.get_all_field_indices(field.name))) > 1:
                raise ValueError(f"{self.file} has {count} columns named {quoted(field.name)}; names must differ")
            if _content(field.type) not in allowed:
                raise ValueError(f"{self.file} column {quoted(field.name)} holds {one_line(str(field.type))}, not numbers")
        return read_columns(self.path, [field.name for field in wanted])

    def _numbers(self, table: pyarrow.Table, position: int) -> Array:
        import pyarrow

        field = self.schema.field(position)
        try:
            values: Array = table.column(field.name).cast(pyarrow.float64()).to_numpy()
        except pyarrow.ArrowInvalid as error:
            raise ValueError(f"{self.file} column {quoted(field.name)}: {one_line(str(error))}") from None
        return values


def read_columns(path: Path, names: Sequence[str] | None = None) -> pyarrow.Table:
    """Return columns of a Parquet file; all if none are named.

    Raises:
        ValueError: the file is damaged, or would expand to more than it may
    """
    from pyarrow.parquet import ParquetFile

    with read_by_others(path, "Parquet"), open_regular(path) as file:
        check_columns(file, names, budget_of(path))
        with ParquetFile(path, page_checksum_verification=True) as opened:
            return opened.read(columns=names, use_threads=False)  # threads: apache/arrow#34314


def _label(field: pyarrow.Field) -> Label:
    unit = (field.metadata or {}).get(b"unit")
    return label_of(field.name) if unit is None else Label(field.name, field.name, unit.decode())


def _content(kind: pyarrow.DataType) -> Content:
    import pyarrow

    if pyarrow.types.is_floating(kind) or pyarrow.types.is_integer(kind):
        return "numbers"
    return "dates" if pyarrow.types.is_timestamp(kind) else "other"


def _seconds(table: pyarrow.Table, field: pyarrow.Field) -> Array:
    """Time stamps as seconds since the first one."""
    import pyarrow

    whole = table.column(field.name).cast(pyarrow.timestamp("ns", field.type.tz)).to_numpy()
    return seconds_since_first(whole)


FORMAT: Format = Format(
    (".parquet",),
    open_parquet,
    "Parquet",
    "in the metadata `unit` of the field, else in its name as in text",
    "float64, with checksums",
)
