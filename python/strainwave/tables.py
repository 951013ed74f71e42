"""Tables in text and Parquet files: which columns they have, and their numbers, or where they have none.

Only files are known here, not what a recording must obey; `Recording` asks for the columns it wants.
"""

from __future__ import annotations

import codecs
import csv
import io
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.units import check as check_unit

if TYPE_CHECKING:
    import pyarrow

Array = NDArray[np.float64]


class Table(NamedTuple):
    """What was read: columns by the name wanted, their units, and how to speak of a place in the file."""

    columns: dict[str, Array]
    units: dict[str, str]
    labels: dict[str, str]
    title: str
    place: Callable[[int], str]


def header(path: str | Path) -> tuple[str, ...]:
    """Names of the columns in a file, without their units."""
    if Path(path).suffix.lower() != ".parquet":
        return tuple(label.name for label in open_csv(path).labels)
    import pyarrow
    from pyarrow.parquet import read_schema

    try:
        return tuple(parquet_label(field).name for field in read_schema(path))
    except (OSError, pyarrow.ArrowException) as error:
        raise ValueError(unreadable(path, error)) from None


def read_csv(path: str | Path, columns: Mapping[str, str] | None, units: Mapping[str, str] | None) -> Table:
    """The columns wanted of a text table; all if none are named."""
    table = open_csv(path)
    sources = sources_of(path, table.labels, columns, units)
    return _table(sources, table.numbers(sources), table.title, table.place)


def read_parquet(path: str | Path, columns: Mapping[str, str] | None, units: Mapping[str, str] | None) -> Table:
    """The columns wanted of a Parquet file; all if none are named."""
    import pyarrow
    from pyarrow.parquet import ParquetFile

    try:
        with ParquetFile(path, page_checksum_verification=True) as file:
            schema = file.schema_arrow
            sources = sources_of(path, [parquet_label(field) for field in schema], columns, units)
            table = file.read(columns=[schema.field(source.position).name for source in sources])
            title = (schema.metadata or {}).get(b"title", b"").decode()
    except (OSError, pyarrow.ArrowException, UnicodeDecodeError) as error:
        raise ValueError(unreadable(path, error)) from None
    numbers = {source.name: parquet_numbers(path, table, schema.field(source.position)) for source in sources}
    return _table(sources, numbers, title, "row {}".format)


def _table(sources: Sequence[Source], numbers: dict[str, Array], title: str, place: Callable[[int], str]) -> Table:
    units = {source.name: source.unit for source in sources}
    return Table(numbers, units, {source.name: source.label for source in sources}, title, place)


class Label(NamedTuple):
    """What a file calls a column: its text, and what this says of name and unit."""

    text: str
    name: str
    unit: str | None


class Source(NamedTuple):
    """A column to read: where it stands, its name in the file and in the recording, and its unit."""

    position: int
    label: str
    name: str
    unit: str


def _label(text: str) -> Label:
    """Split `speed [rad/s]` or `speed (rad/s)`. Round brackets around no unit are a part of the name."""
    if square := re.fullmatch(r"(.*\S)\s*\[([^\[\]]*)\]", text):
        return Label(text, square[1], square[2])
    brackets = re.fullmatch(r"(.*\S)\s*\(((?:[^()]|\([^()]*\))*)\)", text)
    if brackets and _is_unit(brackets[2]):
        return Label(text, brackets[1], brackets[2])
    return Label(text, text, None)


def _is_unit(text: str) -> bool:
    try:
        check_unit(text)
    except ValueError:
        return False
    return True


def sources_of(
    path: str | Path, labels: Sequence[Label], columns: Mapping[str, str] | None, units: Mapping[str, str] | None
) -> list[Source]:
    """The columns to read, each found in the file and with its unit."""
    arguments.mapping("columns", {} if columns is None else columns, '{"speed": "Motor Speed"}')
    arguments.mapping("units", {} if units is None else units, '{"speed": "rpm"}')
    if columns is None:
        _check_labels(path, labels)
        chosen = {label.name: index for index, label in enumerate(labels)}
    else:
        chosen = {name: _find(path, labels, wanted) for name, wanted in columns.items()}
    if not chosen:
        raise ValueError(f"{path}: no column to read")
    if extra := (units or {}).keys() - chosen.keys():
        raise ValueError(f'{path}: units names "{min(extra)}", which is not read; there are {", ".join(chosen)}')
    return [
        Source(index, labels[index].name, name, _unit(path, labels[index], name, (units or {}).get(name)))
        for name, index in chosen.items()
    ]


def _check_labels(path: str | Path, labels: Sequence[Label]) -> None:
    for number, (name, count) in enumerate(Counter(label.name for label in labels).items(), start=1):
        if not name:
            raise ValueError(f"{path} column {number} has no name; name it, or pick columns with columns={{...}}")
        if count > 1:
            raise ValueError(f'{path} has {count} columns named "{name}"; names must differ')


def _find(path: str | Path, labels: Sequence[Label], wanted: str) -> int:
    found = [i for i, label in enumerate(labels) if label.text == wanted]
    found = found or [i for i, label in enumerate(labels) if label.name == wanted]
    if len(found) > 1:
        raise ValueError(f'{path} has {len(found)} columns named "{wanted}"; names must differ')
    if not found:
        raise ValueError(f'{path} has no column "{wanted}"; it has {", ".join(label.name for label in labels)}')
    return found[0]


def _unit(path: str | Path, label: Label, name: str, given: str | None) -> str:
    """The unit the file states, or the one given where the file states none that is known."""
    if given is not None:
        if label.unit is not None and _is_unit(label.unit) and check_unit(label.unit) != check_unit(given):
            raise ValueError(f'{path} column "{label.name}" is in "{label.unit}", but units says "{given}"')
        return given
    if label.unit is None:
        hint = f'write it behind the name, as in torque [N.m], or give it apart as units={{"{name}": …}}'
        raise ValueError(f'{path} column "{label.name}" has no unit; {hint}')
    try:
        return check_unit(label.unit)
    except ValueError as error:
        raise ValueError(f'{path} column "{label.name}": {error}') from None


def unreadable(path: str | Path, error: Exception) -> str:
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error).partition("\n")[0]
    return f"{path} cannot be read: {reason}"


def parquet_label(field: pyarrow.Field) -> Label:
    unit = (field.metadata or {}).get(b"unit")
    return _label(field.name) if unit is None else Label(field.name, field.name, unit.decode())


def parquet_numbers(path: str | Path, table: pyarrow.Table, field: pyarrow.Field) -> Array:
    import pyarrow

    if not (pyarrow.types.is_floating(field.type) or pyarrow.types.is_integer(field.type)):
        raise ValueError(f'{path} column "{field.name}" holds {field.type}, not numbers')
    try:
        values: Array = table.column(field.name).cast(pyarrow.float64()).to_numpy()
    except pyarrow.ArrowInvalid as error:
        raise ValueError(f'{path} column "{field.name}": {error}') from None
    return values


TITLE = "# title: "

# Sign, digits, one decimal mark (group 1), exponent.
_NUMBER = re.compile(r"[+-]?(?=[.,]?\d)\d*([.,]?)\d*(?:[eE][+-]?\d+)?", re.ASCII)


def open_csv(path: str | Path) -> CsvTable:
    """The header of a text table, and its rows as they stand."""
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise ValueError(unreadable(path, error)) from None
    data = _checked_text(path, data).removeprefix(codecs.BOM_UTF8)
    title = re.match(TITLE.encode() + rb"([^\r\n]*)", data)
    data = _blank_comments(data)
    header = re.match(rb"[\r\n]*([^\r\n]+)", data)
    if not header:
        raise ValueError(f"{path} is empty")
    line = 1 + data.count(b"\n", 0, header.start(1))
    delimiter, labels = _header(header[1].decode())
    if all(_NUMBER.fullmatch(label.text) for label in labels):
        raise ValueError(f"{path} line {line} holds numbers; it must name each column and its unit, as in torque [N.m]")
    body = memoryview(data)[header.end() :]
    if not re.search(rb"[^\r\n]", body):
        raise ValueError(f"{path} has a header but no rows")
    return CsvTable(path, title[1].decode() if title else "", delimiter, labels, body, line)


def _checked_text(path: str | Path, data: bytes) -> bytes:
    try:
        if not data.isascii():
            data.decode()
    except UnicodeDecodeError as error:
        line = 1 + data.count(b"\n", 0, error.start)
        raise ValueError(f"{path} line {line} is not UTF-8: byte {error.start} is 0x{data[error.start]:02x}") from None
    return data


def _blank_comments(data: bytes) -> bytes:
    """Empty the lines that hold a comment or spaces; line numbers stay."""
    if data[:1] in (b"#", b" ") or b"\n#" in data or b"\n " in data:
        return re.sub(rb"(?m)^(?:#.*|[ \r]+)$", b"", data)
    return data


def _header(text: str) -> tuple[str, list[Label]]:
    """Delimiter and labels: a tab outside quotes delimits before a semicolon, a semicolon before a comma."""
    bare = re.sub(r'"[^"]*"', "", text.strip())
    delimiter = next((mark for mark in "\t;" if mark in bare), ",")
    cells = next(csv.reader([text], delimiter=delimiter, skipinitialspace=True))
    return delimiter, [_label(cell.strip()) for cell in cells]


@dataclass(frozen=True)
class CsvTable:
    """A text table whose rows are still text; `line` is the line its header stands in."""

    path: str | Path
    title: str
    delimiter: str
    labels: Sequence[Label]
    body: memoryview
    line: int

    def numbers(self, sources: Sequence[Source]) -> dict[str, Array]:
        """The columns wanted; a cell that is no number is refused with its place."""
        import pyarrow

        for mark in "." if self.delimiter == "," else ".,":
            try:
                return self._parse(sources, mark)
            except pyarrow.ArrowInvalid as error:
                reason = f": {error}"
        raise ValueError(f"{self.path}{self._fault(sources) or reason}")

    def place(self, row: int) -> str:
        """Where a row of numbers stands in the file."""
        line, _ = next(islice(self._rows(), row, None))
        return f"line {line}"

    def _parse(self, sources: Sequence[Source], decimal_mark: str) -> dict[str, Array]:
        import pyarrow
        from pyarrow import csv as arrow_csv

        keys = {source.name: str(source.position) for source in sources}  # labels may occur twice, positions cannot
        table = arrow_csv.read_csv(
            pyarrow.BufferReader(pyarrow.py_buffer(self.body)),
            read_options=arrow_csv.ReadOptions(column_names=[str(i) for i in range(len(self.labels))]),
            parse_options=arrow_csv.ParseOptions(delimiter=self.delimiter),
            convert_options=arrow_csv.ConvertOptions(
                include_columns=sorted(set(keys.values())),
                column_types=dict.fromkeys(keys.values(), pyarrow.float64()),
                null_values=[],
                decimal_point=decimal_mark,
            ),
        )
        return {name: table.column(key).to_numpy() for name, key in keys.items()}

    def _fault(self, sources: Sequence[Source]) -> str | None:
        """The first row or cell that cannot be read."""
        marks = "." if self.delimiter == "," else ".,"
        for line, cells in self._rows():
            if len(cells) != len(self.labels):
                return f" line {line}: the number of cells is {len(cells)}; the header has {len(self.labels)}"
            for source in sources:
                text = cells[source.position].strip()
                number = _NUMBER.fullmatch(text)
                if not number or number[1] not in marks:
                    return f' line {line}, column "{source.label}": {_not_a_number(text, marks)}'
                marks = number[1] or marks
        return None

    def _rows(self) -> Iterator[tuple[int, list[str]]]:
        """Line and cells of each row, one at a time: slow, but it knows where it is."""
        lines = io.TextIOWrapper(io.BytesIO(self.body), encoding="utf-8")
        for line, text in enumerate(lines, start=self.line):
            if text != "\n":
                yield line, self._cells(line, text.removesuffix("\n"))

    def _cells(self, line: int, text: str) -> list[str]:
        if '"' not in text:
            return text.split(self.delimiter)
        try:
            return next(csv.reader([text], delimiter=self.delimiter, strict=True))
        except csv.Error as error:
            raise ValueError(f"{self.path} line {line}: {error}") from None


def _not_a_number(text: str, marks: str) -> str:
    if not text:
        return "the cell is empty; every cell must hold a number"
    if _NUMBER.fullmatch(text) and len(marks) == 1:
        return f'"{text}" is not a number with the decimal mark "{marks}"'
    return f'"{text}" is not a number'
