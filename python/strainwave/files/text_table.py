"""Text tables: their header, where they have one, and their numbers, or where they have none."""

from __future__ import annotations

import codecs
import csv
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from strainwave.files.array_table import ArrayTable
from strainwave.files.budget import RefusedFile, read_regular
from strainwave.files.labels import (
    MAX_NAME,
    ColumnSource,
    Content,
    Label,
    check_names,
    labels_of,
    seconds_since_first,
    unreadable,
)
from strainwave.files.table_format import Format
from strainwave.files.text_layout import (
    CLOCK_CELL,
    MAX_LINE_BYTES,
    NOT_FINITE,
    NUMBER_CELL,
    lines_above,
    lists_apart,
    pairs_table,
    scope_header,
    seconds_of_clock,
    sideways,
    with_units,
)
from strainwave.messages import one_line, quoted

if TYPE_CHECKING:
    import pyarrow

Array = NDArray[np.float64]

TITLE_LINE = "# title: "
MAX_REMARK_BYTES = 2**16  # of the beginning of a file, in which remarks are looked at

_DURATION_UNIT = re.compile(rb"(?<=\d) sec(?=[,;\t\n])")  # behind each time of a timetable of MATLAB
_DATE_CELL = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(?::\d\d(?:\.\d{1,9})?)?(?:Z|[+-]\d\d(?::?\d\d)?)?", re.ASCII)
# What programs write for no value.
EMPTY_CELLS = ("", "nan", "NaN", "NAN", "-nan", "null", "NULL", "None", "NA", "N/A", "n/a", "-")
_MAX_CONTENT_ROWS = 1000  # rows that determine the content of a column
MAX_SIDEWAYS_BYTES = 2**22  # of a table with a row for each channel: its cells are texts before they are numbers

_RATIO_LINE = re.compile(
    r"(?im)^[#%;\s]*((?:gear\s*|reduction\s*)?ratio|reduction|(?:über|unter)setzung)\s*[:=]\s*(?:1\s*:\s*)?(\d+(?:\.\d+)?)"
    r"(?:\s*:\s*1)?[ \t,;]*$"
)  # a remark of the ratio of the gear: of the other numbers in remarks none is checked
_BEYOND_ASCII = re.compile(rb"[\x80-\xff]")
# Of names and units in spreadsheets of Western Europe, which save text in Windows-1252.
_LETTERS_OF_WINDOWS = {letter.encode("cp1252") for letter in "°²³·µ´äöüÄÖÜßéèêëàâáíîïóôúùûçñåÅæøÉ"}


def open_text(path: str | Path) -> CsvTable | ArrayTable:
    """Open a text table that has a column for each channel, a row for each, or the name of each in front of its number."""
    file, data = _read_text(path)
    if pairs := pairs_table(file, _blank_comments(data)):
        _check_names(file, [label.name for label in pairs.labels])
        return pairs
    turned = sideways(_blank_comments(data)) if len(data) <= MAX_SIDEWAYS_BYTES else None
    if turned is None:
        return _csv_table(file, data)
    names, series = turned
    _check_names(file, names)
    remark = f"it has a row for each channel: {len(names)} rows of {series.shape[1]} numbers, taken as columns"
    return ArrayTable(file, "", labels_of(names), list(series), [remark])


def open_csv(path: str | Path) -> CsvTable:
    """The header of a text table, and its rows as they stand; without a header the columns are column_1, column_2 …"""
    return _csv_table(*_read_text(path))


def _read_text(path: str | Path) -> tuple[str, bytes]:
    """Return the name of a file as messages have it, and its text."""
    file = one_line(str(path))
    try:
        data = read_regular(path)
    except (OSError, UnicodeError, RefusedFile) as error:
        raise ValueError(unreadable(path, error)) from None
    data = _checked_text(file, data).removeprefix(codecs.BOM_UTF8)
    data = re.sub(rb"(?m)^%", b"#", data) if data[:1] == b"%" or b"\n%" in data else data  # comments of MATLAB, of ROS
    return file, _DURATION_UNIT.sub(b"", data) if b" sec" in data[:MAX_LINE_BYTES] else data


def _csv_table(file: str, data: bytes) -> CsvTable:
    title = re.match(TITLE_LINE.encode() + rb"([^\n]*)", data)
    comment = re.match(rb"(?:(?:#[^\n]*| *)\n)*?#([^\n]*)\n(?!#)", data)
    remarks = b"\n".join(re.findall(rb"(?m)^#[^\n]*", data[:MAX_REMARK_BYTES]))
    data = _blank_comments(data)
    if scope := scope_header(data):
        _check_names(file, [label.text for label in scope.labels])
        line = 1 + data.count(b"\n", 0, scope.end)
        body = memoryview(data)[scope.end :]
        return CsvTable(file, "", scope.delimiter, scope.labels, body, line, line - 1, (), is_scope=True)
    above_it = data[: lines_above(data)]
    ratios = _RATIO_LINE.findall((remarks + b"\n" + above_it).decode(errors="replace"))
    data = re.sub(rb"[^\n]+", b"", above_it) + data[len(above_it) :]
    header = re.match(rb"\n*([^\n]+)(?:\n+([^\n]+))?", data)
    if not header:
        raise ValueError(f"{file} is empty")
    line = 1 + data.count(b"\n", 0, header.start(1))
    if len(header[1]) > MAX_LINE_BYTES:
        raise ValueError(f"{file} line {line} has {len(header[1])} bytes; at most {MAX_LINE_BYTES} can be read")
    first, second = header[1].decode(), (header[2] or b"").decode()
    delimiter = _delimiter(first, second)
    if delimiter == " ":
        data = re.sub(rb" +", b" ", re.sub(rb"(?m)^ +|(?<! ) +$", b"", data))
        header = re.match(rb"\n*([^\n]+)", data)
        assert header is not None
        first = re.sub(r" (?=[\[(])", "", header[1].decode())
    labels = _labels(f"{file} line {line}", first, delimiter)
    begins = header.end(1)
    numeric = [bool(NUMBER_CELL.fullmatch(label.text)) or label.text.casefold() in NOT_FINITE for label in labels]
    above = _labels_above(comment, len(labels), delimiter) if any(numeric) else None
    if above or all(numeric):
        begins = header.start(1)
        labels = above or [Label(f"column_{number}", f"column_{number}", None) for number in range(1, len(labels) + 1)]
    below = re.match(rb"\n*([^\n]+)", memoryview(data)[begins:])
    if below and (with_units_below := with_units(labels, below[1].decode().split(delimiter))):
        end = begins + below.end(1)
        labels, begins, line = with_units_below, end, line + data.count(b"\n", begins, end)
    labels, data = lists_apart(labels, data[begins:], delimiter)
    _check_names(f"{file} line {line}", [label.text for label in labels])
    body = memoryview(data)
    if not re.search(rb"[^\n]", body):
        raise ValueError(f"{file} has a header but no rows")
    title_there = title[1].decode() if title else ""
    singles = {one_line(name): float(value) for name, value in ratios}
    return CsvTable(file, title_there, delimiter, labels, body, line, above_it.count(b"\n"), singles=singles)


def _checked_text(file: str, data: bytes) -> bytes:
    """Return the text in UTF-8, with `\\n` at the end of each line, whatever ended it."""
    try:
        if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
            data = data.decode("utf-16").encode()
        elif not data.isascii():
            data.decode()
    except UnicodeDecodeError as error:
        if not set(_BEYOND_ASCII.findall(data)) <= _LETTERS_OF_WINDOWS:
            line = 1 + len(re.findall(rb"\r\n?|\n", data[: error.start]))
            what = "complete UTF-16" if error.encoding.startswith("utf-16") else "UTF-8"
            where = f"byte {error.start} is 0x{data[error.start]:02x}"
            raise ValueError(f"{file} line {line} is not {what}: {where}; if it is no text, save it as CSV") from None
        data = data.decode("cp1252").encode()
    if b"\0" in data:
        raise ValueError(f"{file} holds a zero byte at {data.index(0)}, which no text does; save it as UTF-8, not as UTF-16")
    return data.replace(b"\r\n", b"\n").replace(b"\r", b"\n") if b"\r" in data else data


def _blank_comments(data: bytes) -> bytes:
    """Empty the lines that hold a comment or spaces; line numbers stay."""
    if data[:1] in (b"#", b" ") or b"\n#" in data or b"\n " in data:
        return re.sub(rb"(?m)^(?:#.*| +)$", b"", data)
    return data


def _delimiter(header: str, row: str) -> str:
    """A tab outside quotes delimits before a semicolon, a semicolon before a comma, and blanks where there is none of them."""
    bare = re.sub(r'"[^"]*"', "", header.strip())
    if found := next((mark for mark in "\t;," if mark in bare), None):
        return found
    cells = row.split() if row else header.split()
    names = re.sub(r"(?<! ) +(?=[\[(])", "", header).split()
    apart = len(cells) > 1 and len(names) == len(cells) and all(NUMBER_CELL.fullmatch(cell) for cell in cells)
    return " " if apart and '"' not in header else ","


def _labels(place: str, text: str, delimiter: str) -> list[Label]:
    try:
        cells = next(csv.reader([text], delimiter=delimiter, skipinitialspace=True, strict=True))
    except csv.Error as error:
        raise ValueError(f"{place}: the header cannot be read: {one_line(str(error))}") from None
    _check_names(place, cells)
    return labels_of([cell.strip() for cell in cells])


def _check_names(place: str, names: Sequence[str]) -> None:
    try:
        check_names(names)
    except RefusedFile as error:
        raise ValueError(f"{place} {error}") from None


def _labels_above(comment: re.Match[bytes] | None, count: int, delimiter: str) -> list[Label] | None:
    """The names that a comment right above the first row gives to its columns, as programs write them that know no header."""
    if comment is None or len(comment[1]) > MAX_NAME or comment[0].startswith(TITLE_LINE.encode()):
        return None
    text = re.sub(r"\s+(?=[\[(])", "", comment[1].decode().strip())
    names = [each.strip() for each in (text.split() if delimiter == " " else text.split(delimiter))]
    if len(names) != count or not all(names) or any(NUMBER_CELL.fullmatch(name) for name in names):
        return None
    return labels_of(names)


@dataclass(frozen=True)
class CsvTable:
    """A text table whose rows are still text; `line` is the line its header stands in, `file` how messages call it.

    `above` lines stand above the header that are no part of the table; of the export of a scope they describe its channels.
    """

    file: str
    title: str
    delimiter: str
    labels: Sequence[Label]
    body: memoryview
    line: int
    above: int = 0
    left_out: Sequence[str] = ()
    is_scope: bool = False
    singles: Mapping[str, float] = field(default_factory=dict)

    def numbers(self, sources: Sequence[ColumnSource]) -> dict[str, Array]:
        """The columns wanted; a cell that is no number is refused with its place."""
        import pyarrow

        if self.above and not self.is_scope:
            raise ValueError(f"{self.file}: {self._of_header()}; delete what stands above it, or begin those lines with #")
        self._check_quotes()
        for mark in "." if self.delimiter == "," else ".,":
            try:
                return self._parse(sources, mark)
            except pyarrow.ArrowInvalid as error:
                reason = f": {one_line(str(error))}"
        raise ValueError(f"{self.file}{self._fault(sources) or reason}")

    @cached_property
    def contents(self) -> list[Content]:
        """Return the content of each column by the cells of the first rows that are not empty."""
        seen: list[list[str]] = [[] for _ in self.labels]
        for line, text in islice(self._rows(), _MAX_CONTENT_ROWS):
            for cells, cell in zip(seen, self._cells(line, text), strict=False):
                cells.append(cell.strip(" \t"))
        return [_content([cell for cell in cells if cell not in EMPTY_CELLS]) for cells in seen]

    def measured(self, sources: Sequence[ColumnSource]) -> tuple[dict[str, Array], list[str]]:
        """The columns wanted, nan where nothing is written, dates as seconds since the first; and what was left out.

        A last row that ends too early is left out: its writer was stopped. So is one without a number, as of units or a sum.
        """
        import pyarrow

        whole, remarks = self._without_torn_end()
        if self.above and not self.is_scope:
            remarks.insert(0, f"{self._of_header()}; what stands above it is left out")
        contents = self.contents
        dates = [source for source in sources if contents[source.position] == "dates"]
        whole._check_quotes()
        for mark in "." if self.delimiter == "," else ".,":
            try:
                return whole._parse(sources, mark, EMPTY_CELLS, dates), remarks
            except pyarrow.ArrowInvalid as error:
                reason = f": {one_line(str(error))}"
        numbers = [source for source in sources if source not in dates]
        raise ValueError(f"{self.file}{whole._fault(numbers, EMPTY_CELLS) or reason}")

    def _of_header(self) -> str:
        return f"its header is line {self.above + 1}"

    def _without_torn_end(self) -> tuple[CsvTable, list[str]]:
        """Return this table without its last row, if only that has fewer cells than the header, or no number."""
        text = self.body.tobytes().rstrip(b"\n")
        start = text.rfind(b"\n") + 1
        before = text[text.rfind(b"\n", 0, max(start - 1, 0)) + 1 : max(start - 1, 0)]
        line = self.line + text.count(b"\n")
        torn = text[start:].decode()
        if before and self._has_no_number(self._cells(line, torn)):
            return replace(self, body=self.body[:start]), [f"its last row, line {line}, has no number: {quoted(torn)}"]
        if not before or len(self._cells(line, torn)) >= len(self.labels) > 1:
            return self, []
        if len(self._cells(line - 1, before.decode())) != len(self.labels) or len(self.labels) == 1:
            return self, []
        remark = f"its last row, line {line}, ends too early and is left out: {quoted(torn)}"
        return replace(self, body=self.body[:start]), [remark]

    def _has_no_number(self, cells: Sequence[str]) -> bool:
        """True for the cells of a row that has a text in each column of numbers."""
        pairs = zip(cells, self.contents, strict=False)
        measured = [cell.strip(" \t") for cell, content in pairs if content == "numbers"]
        is_text = [
            not NUMBER_CELL.fullmatch(cell) and cell not in EMPTY_CELLS and cell.casefold() not in NOT_FINITE
            for cell in measured
        ]
        return len(cells) == len(self.labels) and len(measured) > 1 and all(is_text)

    def texts(self) -> Iterator[tuple[int, list[str]]]:
        """Line and cells of each row, as they stand; a row with another number of cells than the header is refused."""
        self._check_quotes()
        for line, text in self._rows():
            if len(cells := self._cells(line, text)) != len(self.labels):
                raise ValueError(f"{self.file} line {line}: {self._miscounted(cells)}")
            yield line, [cell.strip(" \t") for cell in cells]

    def place(self, row: int) -> str:
        """Return the line of a row of numbers in the file, in words."""
        line, _ = next(islice(self._rows(), row, None))
        return f"line {line}"

    def _check_quotes(self) -> None:
        """A cell whose quotes do not close before its end would swallow what follows it, rows too."""
        if fault := _quotation_fault(self.body, self.delimiter):
            line = self.line + self.body[:fault].tobytes().count(b"\n")
            raise ValueError(f"{self.file} line {line}: a quoted cell must end with its quote, on the same line")

    def _parse(
        self,
        sources: Sequence[ColumnSource],
        decimal_mark: str,
        nothing: Sequence[str] = (),
        dates: Sequence[ColumnSource] = (),
    ) -> dict[str, Array]:
        """The columns as Arrow reads them: nan for what means nothing, seconds for dates."""
        import pyarrow
        from pyarrow import csv as arrow_csv

        keys = {source.name: str(source.position) for source in sources}  # labels may occur twice, positions cannot
        table = arrow_csv.read_csv(
            pyarrow.BufferReader(pyarrow.py_buffer(self.body)),
            read_options=arrow_csv.ReadOptions(
                use_threads=False,  # which the process may end before, and abort: apache/arrow#34314
                block_size=MAX_LINE_BYTES,
                column_names=[str(i) for i in range(len(self.labels))],
            ),
            parse_options=arrow_csv.ParseOptions(delimiter=self.delimiter),
            convert_options=arrow_csv.ConvertOptions(
                include_columns=sorted(set(keys.values())),
                column_types=dict.fromkeys(keys.values(), pyarrow.float64())
                | {str(source.position): self._date_type(source) for source in dates},
                null_values=list(nothing),
                decimal_point=decimal_mark,
            ),
        )
        seconds = {source.name for source in dates}
        columns = {name: table.column(key) for name, key in keys.items()}
        return {name: _seconds(column) if name in seconds else _numbers(column) for name, column in columns.items()}

    def _date_type(self, source: ColumnSource) -> pyarrow.DataType:
        """A time stamp, with the zone, if the first one has one; a text, where it is none that Arrow reads."""
        import pyarrow

        cells = (
            self._cells(line, text)[source.position].strip(" \t") for line, text in islice(self._rows(), _MAX_CONTENT_ROWS)
        )
        written = next(cell for cell in cells if cell not in EMPTY_CELLS)
        if not _DATE_CELL.fullmatch(written):
            return pyarrow.string()
        return pyarrow.timestamp("ns", "UTC" if re.search(r"(?:Z|[+-]\d\d:?\d\d)$", written) else None)

    def _fault(self, sources: Sequence[ColumnSource], nothing: Sequence[str] = ()) -> str | None:
        """The first row or cell that cannot be read."""
        marks = "." if self.delimiter == "," else ".,"
        for line, text in self._rows():
            if (length := len(text.encode())) > MAX_LINE_BYTES:
                return f" line {line} has {length} bytes; at most {MAX_LINE_BYTES} can be read"
            cells = self._cells(line, text)
            if len(cells) != len(self.labels):
                return f" line {line}: {self._miscounted(cells)}"
            for source in sources:
                cell = cells[source.position].strip(" \t")
                number = NUMBER_CELL.fullmatch(cell)
                if cell in nothing or (nothing and cell.casefold() in NOT_FINITE):
                    continue
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


def _content(cells: Sequence[str]) -> Content:
    cells = [cell for cell in cells if cell.casefold() not in NOT_FINITE] or cells
    if cells and all(NUMBER_CELL.fullmatch(cell) for cell in cells):
        return "numbers"
    is_date = cells and any(all(form.fullmatch(cell) for cell in cells) for form in (_DATE_CELL, CLOCK_CELL))
    return "dates" if is_date else "other"


def _numbers(column: pyarrow.ChunkedArray) -> Array:
    """Return the numbers of a column, nan for none. Arrow's own way imports pandas, which takes a quarter of a second."""
    whole = column.combine_chunks()
    valid, values = whole.buffers()
    part = slice(whole.offset, whole.offset + len(whole))
    numbers = np.frombuffer(values, float)[part].copy() if len(whole) else np.empty(0)
    if whole.null_count:
        numbers[np.unpackbits(np.frombuffer(valid, np.uint8), bitorder="little")[part] == 0] = np.nan
    return numbers


def _seconds(column: pyarrow.ChunkedArray) -> Array:
    """Return the seconds of dates or times of day since the first one."""
    import pyarrow

    if pyarrow.types.is_string(column.type):
        return seconds_of_clock(column.to_pylist())
    return seconds_since_first(column.to_numpy())


def _quotation_fault(text: memoryview, delimiter: str) -> int | None:
    """Return the place of the first quote that is not closed before the next delimiter or line end; None if there is none."""
    end = rb"[\n%b]" % re.escape(delimiter.encode())
    other = rb"[^\n%b]" % re.escape(delimiter.encode())
    quoted_cell = rb'(?<!%b)"(?:[^"\n]++|"")*+"(?=%b|\Z)' % (other, end)
    within_a_cell = rb'(?<=%b)"' % other
    sound = re.match(rb'(?:[^"]++|%b|%b)*+' % (quoted_cell, within_a_cell), text)
    return None if sound is None or sound.end() == len(text) else sound.end()


def _not_a_number(text: str, marks: str) -> str:
    if not text:
        return "the cell is empty; every cell must hold a number"
    if NUMBER_CELL.fullmatch(text) and len(marks) == 1:
        return f'{quoted(text)} is not a number with the decimal mark "{marks}"'
    return f"{quoted(text)} is not a number"


FORMAT: Format = Format(
    (".csv", ".txt", ".tsv", ".log"),
    open_text,
    "Text",
    "in the header: `speed [rad/s]` or `speed (rad/s)`",
    "reads back bit for bit",
    "Lines of pairs, as `speed: 0.1, current: 131.7`, and blocks of `ros2 topic echo` are tables too, a row for each record.",
)
