"""Parquet files: what they call their columns, and their numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from strainwave.files.budget import RefusedFile, budget_of, open_regular
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
from strainwave.files.parquet_pages import check_columns
from strainwave.files.table_format import Format
from strainwave.messages import one_line, quoted

if TYPE_CHECKING:
    import pyarrow

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
