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
from strainwave.files.units import check as check_unit
from strainwave.messages import as_option, listed, one_line, quoted

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


def is_parquet(path: str | Path) -> bool:
    """Whether the suffix of a file says Parquet, else text; one that says neither is refused."""
    suffix = Path(path).suffix.lower()
    if suffix not in (".csv", ".txt", ".tsv", ".parquet"):
        raise ValueError(one_line(f"{path}: suffix {quoted(suffix)} is not known; use .csv, .txt, .tsv or .parquet"))
    return suffix == ".parquet"


def labels(path: str | Path) -> Sequence[Label]:
    """What a file calls its columns, in order."""
    if not is_parquet(path):
        return open_csv(path).labels
    import pyarrow
    from pyarrow.parquet import read_schema

    try:
        return [parquet_label(field) for field in read_schema(path)]
    except (OSError, pyarrow.ArrowException, UnicodeError) as error:
        raise ValueError(unreadable(path, error)) from None


def read_csv(path: str | Path, columns: Mapping[str, str] | None, units: Mapping[str, str] | None) -> Table:
    """The columns wanted of a text table; all if none are named."""
    table = open_csv(path)
    sources = sources_of(table.file, table.labels, columns, units)
    return _table(sources, table.numbers(sources), table.title, table.place)


def read_parquet(path: str | Path, columns: Mapping[str, str] | None, units: Mapping[str, str] | None) -> Table:
    """The columns wanted of a Parquet file; all if none are named."""
    import pyarrow
    from pyarrow.parquet import ParquetFile

    file = one_line(str(path))
    try:
        with ParquetFile(Path(path), page_checksum_verification=True) as opened:
            schema = opened.schema_arrow
            sources = sources_of(file, [parquet_label(field) for field in schema], columns, units)
            wanted = [schema.field(source.position).name for source in sources]
            table = opened.read(columns=wanted, use_threads=False)  # as in `_parse`
            title = (schema.metadata or {}).get(b"title", b"").decode()
    except (OSError, pyarrow.ArrowException, UnicodeError) as error:
        raise ValueError(unreadable(path, error)) from None
    numbers = {source.name: parquet_numbers(file, table, schema.field(source.position)) for source in sources}
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
    file: str, labels: Sequence[Label], columns: Mapping[str, str] | None, units: Mapping[str, str] | None
) -> list[Source]:
    """The columns to read, each found in the file and with its unit."""
    arguments.mapping("columns", {} if columns is None else columns, '{"speed": "Motor Speed"}')
    arguments.mapping("units", {} if units is None else units, '{"speed": "rpm"}')
    if columns is None:
        _check_labels(file, labels)
        chosen = {label.name: index for index, label in enumerate(labels)}
    else:
        chosen = {name: _find(file, labels, wanted) for name, wanted in columns.items()}
    if not chosen:
        raise ValueError(f"{file}: no column to read")
    if extra := (units or {}).keys() - chosen.keys():
        raise ValueError(f"{file}: units names {quoted(min(extra))}, which is not read; there are {listed(chosen)}")
    return [
        Source(index, labels[index].name, name, _unit(file, labels[index], name, (units or {}).get(name)))
        for name, index in chosen.items()
    ]


def _check_labels(file: str, labels: Sequence[Label]) -> None:
    names = [label.name for label in labels]
    for number, name in enumerate(names, start=1):
        if not name:
            raise ValueError(f"{file} column {number} has no name; name it, or pick columns with columns={{...}}")
    for name, count in Counter(names).most_common(1):
        if count > 1:
            raise ValueError(f"{file} has {count} columns named {quoted(name)}; names must differ")


def _find(file: str, labels: Sequence[Label], wanted: str) -> int:
    found = [i for i, label in enumerate(labels) if label.text == wanted]
    found = found or [i for i, label in enumerate(labels) if label.name == wanted]
    if len(found) > 1:
        raise ValueError(f"{file} has {len(found)} columns named {quoted(wanted)}; names must differ")
    if not found:
        raise ValueError(f"{file} has no column {quoted(wanted)}; it has {listed(label.name for label in labels)}")
    return found[0]


def _unit(file: str, label: Label, name: str, given: str | None) -> str:
    """The unit the file states, or the one given where the file states none that is known."""
    column = f"{file} column {quoted(label.name)}"
    if given is not None:
        if label.unit is not None and _is_unit(label.unit) and check_unit(label.unit) != check_unit(given):
            raise ValueError(f"{column} is in {quoted(label.unit)}, but the unit given for it is {quoted(given)}")
        return given
    if label.unit is None:
        hint = f"write it behind the name, as in torque [N.m], or give it with {as_option('unit', name, 'UNIT')}"
        raise ValueError(f"{column} has no unit; {hint}")
    try:
        return check_unit(label.unit)
    except ValueError as error:
        raise ValueError(f"{column}: {error}") from None


def unreadable(path: str | Path, error: Exception) -> str:
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error).partition("\n")[0]
    return one_line(f"{path} cannot be read: {reason}")


def parquet_label(field: pyarrow.Field) -> Label:
    unit = (field.metadata or {}).get(b"unit")
    return _label(field.name) if unit is None else Label(field.name, field.name, unit.decode())


def parquet_numbers(file: str, table: pyarrow.Table, field: pyarrow.Field) -> Array:
    import pyarrow

    column = f"{file} column {quoted(field.name)}"
    if not (pyarrow.types.is_floating(field.type) or pyarrow.types.is_integer(field.type)):
        raise ValueError(f"{column} holds {one_line(str(field.type))}, not numbers")
    try:
        values: Array = table.column(field.name).cast(pyarrow.float64()).to_numpy()
    except pyarrow.ArrowInvalid as error:
        raise ValueError(f"{column}: {one_line(str(error))}") from None
    return values


TITLE = "# title: "

# Sign, digits, one decimal mark (group 1), exponent.
_NUMBER = re.compile(r"[+-]?(?=[.,]?\d)\d*([.,]?)\d*(?:[eE][+-]?\d+)?", re.ASCII)


_LONGEST_LABEL = 1000  # characters of a header cell: a bound for the work that a text from outside can cause

_BLOCK = 2**20  # bytes that Arrow reads at a time; a line must fit into one


def open_csv(path: str | Path) -> CsvTable:
    """The header of a text table, and its rows as they stand."""
    file = one_line(str(path))
    try:
        data = Path(path).read_bytes()
    except (OSError, UnicodeError) as error:
        raise ValueError(unreadable(path, error)) from None
    data = _checked_text(file, data).removeprefix(codecs.BOM_UTF8)
    title = re.match(TITLE.encode() + rb"([^\n]*)", data)
    data = _blank_comments(data)
    header = re.match(rb"\n*([^\n]+)", data)
    if not header:
        raise ValueError(f"{file} is empty")
    line = 1 + data.count(b"\n", 0, header.start(1))
    delimiter, labels = _header(f"{file} line {line}", header[1].decode())
    if all(_NUMBER.fullmatch(label.text) for label in labels):
        raise ValueError(f"{file} line {line} holds numbers; it must name each column and its unit, as in torque [N.m]")
    body = memoryview(data)[header.end() :]
    if not re.search(rb"[^\n]", body):
        raise ValueError(f"{file} has a header but no rows")
    return CsvTable(file, title[1].decode() if title else "", delimiter, labels, body, line)


def _checked_text(file: str, data: bytes) -> bytes:
    """The text, with `\\n` at the end of each line, whatever ended it."""
    try:
        if not data.isascii():
            data.decode()
    except UnicodeDecodeError as error:
        line = 1 + len(re.findall(rb"\r\n?|\n", data[: error.start]))
        raise ValueError(f"{file} line {line} is not UTF-8: byte {error.start} is 0x{data[error.start]:02x}") from None
    if b"\0" in data:
        raise ValueError(f"{file} holds a zero byte at {data.index(0)}, which no text does; save it as UTF-8, not as UTF-16")
    return data.replace(b"\r\n", b"\n").replace(b"\r", b"\n") if b"\r" in data else data


def _blank_comments(data: bytes) -> bytes:
    """Empty the lines that hold a comment or spaces; line numbers stay."""
    if data[:1] in (b"#", b" ") or b"\n#" in data or b"\n " in data:
        return re.sub(rb"(?m)^(?:#.*| +)$", b"", data)
    return data


def _header(place: str, text: str) -> tuple[str, list[Label]]:
    """Delimiter and labels: a tab outside quotes delimits before a semicolon, a semicolon before a comma."""
    bare = re.sub(r'"[^"]*"', "", text.strip())
    delimiter = next((mark for mark in "\t;" if mark in bare), ",")
    try:
        cells = next(csv.reader([text], delimiter=delimiter, skipinitialspace=True, strict=True))
    except csv.Error as error:
        raise ValueError(f"{place}: the header cannot be read: {one_line(str(error))}") from None
    for cell in cells:
        if len(cell) > _LONGEST_LABEL:
            raise ValueError(f"{place}: {quoted(cell)} has {len(cell)} characters; a header cell has at most {_LONGEST_LABEL}")
    return delimiter, [_label(cell.strip()) for cell in cells]


@dataclass(frozen=True)
class CsvTable:
    """A text table whose rows are still text; `line` is the line its header stands in, `file` how messages call it."""

    file: str
    title: str
    delimiter: str
    labels: Sequence[Label]
    body: memoryview
    line: int

    def numbers(self, sources: Sequence[Source]) -> dict[str, Array]:
        """The columns wanted; a cell that is no number is refused with its place."""
        import pyarrow

        self._check_quotes()
        for mark in "." if self.delimiter == "," else ".,":
            try:
                return self._parse(sources, mark)
            except pyarrow.ArrowInvalid as error:
                reason = f": {one_line(str(error))}"
        raise ValueError(f"{self.file}{self._fault(sources) or reason}")

    def texts(self) -> Iterator[tuple[int, list[str]]]:
        """Line and cells of each row, as they stand; a row with another number of cells than the header is refused."""
        self._check_quotes()
        for line, text in self._rows():
            if len(cells := self._cells(line, text)) != len(self.labels):
                raise ValueError(f"{self.file} line {line}: {self._miscounted(cells)}")
            yield line, [cell.strip(" \t") for cell in cells]

    def place(self, row: int) -> str:
        """Where a row of numbers stands in the file."""
        line, _ = next(islice(self._rows(), row, None))
        return f"line {line}"

    def _check_quotes(self) -> None:
        """A cell whose quotes do not close before its end would swallow what follows it, rows too."""
        if fault := _quotation_fault(self.body, self.delimiter):
            line = self.line + self.body[:fault].tobytes().count(b"\n")
            raise ValueError(f"{self.file} line {line}: a quoted cell must end with its quote, on the same line")

    def _parse(self, sources: Sequence[Source], decimal_mark: str) -> dict[str, Array]:
        import pyarrow
        from pyarrow import csv as arrow_csv

        keys = {source.name: str(source.position) for source in sources}  # labels may occur twice, positions cannot
        table = arrow_csv.read_csv(
            pyarrow.BufferReader(pyarrow.py_buffer(self.body)),
            read_options=arrow_csv.ReadOptions(
                use_threads=False,  # which the process may end before, and abort: apache/arrow#34314
                block_size=_BLOCK,
                column_names=[str(i) for i in range(len(self.labels))],
            ),
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
        for line, text in self._rows():
            if (length := len(text.encode())) > _BLOCK:
                return f" line {line} has {length} bytes; at most {_BLOCK} can be read"
            cells = self._cells(line, text)
            if len(cells) != len(self.labels):
                return f" line {line}: {self._miscounted(cells)}"
            for source in sources:
                cell = cells[source.position].strip(" \t")
                number = _NUMBER.fullmatch(cell)
                if not number or number[1] not in marks:
                    return f" line {line}, column {quoted(source.label)}: {_not_a_number(cell, marks)}"
                marks = number[1] or marks
        return None

    def _miscounted(self, cells: Sequence[str]) -> str:
        return f"the number of cells is {len(cells)}; the header has {len(self.labels)}"

    def _rows(self) -> Iterator[tuple[int, str]]:
        """Line and text of each row, one at a time: slow, but it knows where it is."""
        lines = io.TextIOWrapper(io.BytesIO(self.body), encoding="utf-8", newline="\n")
        for line, text in enumerate(lines, start=self.line):
            if text != "\n":
                yield line, text.removesuffix("\n")

    def _cells(self, line: int, text: str) -> list[str]:
        if '"' not in text:
            return text.split(self.delimiter)
        try:
            return next(csv.reader([text], delimiter=self.delimiter))
        except csv.Error as error:
            raise ValueError(f"{self.file} line {line}: {one_line(str(error))}") from None


def _quotation_fault(text: memoryview, delimiter: str) -> int | None:
    """Where the first cell begins that a quote opens, and none closes before the next delimiter or line end."""
    end = rb"[\n%b]" % re.escape(delimiter.encode())
    other = rb"[^\n%b]" % re.escape(delimiter.encode())
    quoted_cell = rb'(?<!%b)"(?:[^"\n]++|"")*+"(?=%b|\Z)' % (other, end)
    within_a_cell = rb'(?<=%b)"' % other
    sound = re.match(rb'(?:[^"]++|%b|%b)*+' % (quoted_cell, within_a_cell), text)
    return None if sound is None or sound.end() == len(text) else sound.end()


def _not_a_number(text: str, marks: str) -> str:
    if not text:
        return "the cell is empty; every cell must hold a number"
    if _NUMBER.fullmatch(text) and len(marks) == 1:
        return f'{quoted(text)} is not a number with the decimal mark "{marks}"'
    return f"{quoted(text)} is not a number"
