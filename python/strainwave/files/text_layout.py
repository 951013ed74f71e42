"""Layouts of texts: lines above a header, scope exports, a row for each channel, lists in cells, pairs of name and number."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from datetime import date
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.files.array_table import ArrayTable
from strainwave.files.labels import MAX_COLUMNS, MAX_NAME, Label, is_unit
from strainwave.messages import listed

Array = NDArray[np.float64]

NUMBER_CELL = re.compile(
    r"[+-]?(?=[.,]?\d)\d*+([.,]?)\d*+(?:[eE][+-]?\d++)?", re.ASCII
)  # sign, digits, one decimal mark (group 1), exponent
CLOCK_CELL = re.compile(  # a time of day, or with a date as controllers and loggers write it
    r"(?:(?P<day>\d{4}[-/]\d\d[-/]\d\d|\d\d\.\d\d\.\d{4})[ T])?(?P<h>\d\d?):(?P<m>\d\d):(?P<s>\d\d(?:[.,]\d{1,9})?)", re.ASCII
)
SECONDS_PER_DAY = 86400.0  # s
MAX_LAYOUT_LINES = 100  # lines that determine the layout of a table
MAX_LINE_BYTES = 2**20  # which is what Arrow reads at a time; a line must fit into it
SCOPE_KEYS = ("data-type", "sampletime[ms]", "symbolname", "unit")  # first cells of the rows of a scope of TwinCAT
NOT_FINITE = ("inf", "+inf", "-inf", "nan", "-nan")  # in small letters, as numbers in a table without names
MAX_CHANNELS = 200  # rows of a table that lies on its side
MIN_SAMPLES = 200  # cells of each of its rows
MIN_LONGER = 5  # times, by which its rows are longer than it has rows
_NO_UNIT = ("", "-", "1", "(None)", "None")
_NO_NUMBER = ("NA", "N/A")  # no newton times or per ampere, but what programs write for no value
_LIST_CELL = re.compile(rb"""["']?(?:array\((?:'d', *)?)?[\[(](\s*(?:[-+.\d']|nan)[^\[\]()"\n]*)[\])]{1,2}["']?""")


def lines_above(data: bytes) -> int:
    """Return the bytes above the header of a table, where recorders write remarks; 0 if the header is the first line.

    >>> lines_above(b"Recorder: X\\n\\ntime,torque\\n0,1\\n1,2\\n")
    13
    """
    begin = data if len(data) <= MAX_LINE_BYTES else data[: data.rfind(b"\n", 0, MAX_LINE_BYTES) + 1]
    lines = [(match.start(), match[0].decode()) for match in islice(re.finditer(rb"[^\n]+", begin), MAX_LAYOUT_LINES)]
    for mark in "\t;,":
        cells = [[cell.strip(' "') for cell in text.split(mark)] for _, text in lines]
        usual = len(cells[-1]) if cells else 0
        if usual < 2:
            continue
        if len(cells[0]) == usual:
            return 0
        for place, names in enumerate(cells[:-1]):
            below = [each for each in cells[place + 1 : place + 3] if len(each) == usual]
            if (
                len(names) == usual
                and all(cell and not NUMBER_CELL.fullmatch(cell) and cell.casefold() not in NOT_FINITE for cell in names)
                and any(NUMBER_CELL.fullmatch(each[0]) or NUMBER_CELL.fullmatch(each[1]) for each in below)
            ):
                return lines[place][0]
    return 0


class ScopeHeader(NamedTuple):
    """Header of a scope export that stands in several rows: the labels of the columns, and the byte behind its last row."""

    labels: list[Label]
    end: int
    delimiter: str


def scope_header(data: bytes) -> ScopeHeader | None:
    """Return the header of an export in which each row describes all channels by one key, as the scope of TwinCAT writes it.

    The first column is the time of all channels, or each channel has its own time before it.

    >>> rows = b"Name\\tPos\\tTorque\\nSampleTime[ms]\\t1\\t1\\nUnit\\t\\xc2\\xb0 (Angle)\\t(None)\\n0\\t0,5\\t7\\n"
    >>> [label.text for label in scope_header(rows).labels]
    ['time [ms]', 'Pos [°]', 'Torque']
    """
    begin = data if len(data) <= MAX_LINE_BYTES else data[: data.rfind(b"\n", 0, MAX_LINE_BYTES) + 1]
    lines = [(match.start(), match[0].decode()) for match in islice(re.finditer(rb"[^\n]+", begin), MAX_LAYOUT_LINES)]
    for mark in "\t;,":
        rows = [[cell.strip(' "') for cell in text.split(mark)] for _, text in lines]
        keys = [row[0].casefold() for row in rows]
        first = next((place for place, row in enumerate(rows) if len(row) > 1 and NUMBER_CELL.fullmatch(row[0])), None)
        if first is None or "name" not in keys[:first]:
            continue
        at = first - 1 - keys[:first][::-1].index("name")
        described = dict(zip(keys[at:first], rows[at:first], strict=True))
        if described.keys() & set(SCOPE_KEYS):
            return ScopeHeader(_labels_of_scope(described, len(rows[first])), lines[first][0], mark)
    return None


def _labels_of_scope(described: dict[str, list[str]], count: int) -> list[Label]:
    """Return the labels of the columns of a scope from the rows that describe them, by their keys."""
    names, units = described["name"], described.get("unit", [])
    each_timed = "name" in [cell.casefold() for cell in names[2::2]] or (count > 2 and len(names) == count and not names[2])
    unit_of_time = "ms" if "sampletime[ms]" in described else None
    labels = []
    for place in range(count):
        if place == 0 or (each_timed and place % 2 == 0):
            labels.append(Label(f"time [{unit_of_time}]" if unit_of_time else "time", "time", unit_of_time))
            continue
        name = names[place] if place < len(names) else ""
        unit = re.sub(r"\s*\([^()]*\)$", "", units[place]) if place < len(units) else ""
        stated = unit not in _NO_UNIT and (is_unit(unit) or unit.strip() in "%‰")
        labels.append(Label(f"{name} [{unit}]", name, unit) if stated else Label(name, name, None))
    return labels


def sideways(data: bytes) -> tuple[list[str], Array] | None:
    """Return names and series of a table of numbers with a row for each channel; None if it has a column for each.

    A row may begin with the name of its channel; without names they are `column_1`, `column_2` …

    >>> rows = b"\\n".join(b" ".join([name] + [b"%d" % each for each in range(300)]) for name in (b"t", b"q"))
    >>> names, series = sideways(rows)
    >>> names, series.shape
    (['t', 'q'], (2, 300))
    """
    if data.count(b"\n", 0, MAX_CHANNELS * MAX_LINE_BYTES) > MAX_CHANNELS:
        return None
    lines = [line for line in data.split(b"\n") if line.strip()]
    mark = next((mark for mark in (b"\t", b";", b",") if lines and mark in lines[0]), None)
    rows = [[cell.strip() for cell in line.split(mark)] if mark else line.split() for line in lines]
    if not rows or len(rows) > MAX_CHANNELS or len(rows[0]) < max(MIN_SAMPLES, MIN_LONGER * len(rows)):
        return None
    if any(len(row) != len(rows[0]) for row in rows):
        return None
    named = [not _is_numeric(row[0]) for row in rows]
    if any(named) != all(named):
        return None
    cells = [row[1:] if all(named) else row for row in rows]
    if mark != b",":
        cells = [[cell.replace(b",", b".") for cell in row] for row in cells]
    if not all(_is_numeric(cell) for row in cells for cell in row):
        return None
    names = [row[0].decode().strip('"') for row in rows] if all(named) else [f"column_{n}" for n in range(1, len(rows) + 1)]
    return names, np.array([[float(cell) for cell in row] for row in cells])


def _is_numeric(cell: bytes) -> bool:
    text = cell.decode()
    return bool(NUMBER_CELL.fullmatch(text)) or text.casefold() in NOT_FINITE


def with_units(labels: Sequence[Label], cells: Sequence[str]) -> list[Label] | None:
    """The labels with the units in the row below them; None where that holds anything else."""
    units = [re.fullmatch(r"[\[(]?([^\[\]()]*)[\])]?", cell.strip(' "')) for cell in cells]
    texts = [match[1] if match else "?" for match in units]
    if len(texts) != len(labels) or not all(text in _NO_UNIT or is_unit(text) for text in texts) or set(texts) <= {*_NO_UNIT}:
        return None
    if any(label.unit or text in _NO_NUMBER for label, text in zip(labels, texts, strict=True) if text not in _NO_UNIT):
        return None
    return [
        label if text in _NO_UNIT else Label(f"{label.text} [{text}]", label.name, label.unit or text)
        for label, text in zip(labels, texts, strict=True)
    ]


def lists_apart(labels: Sequence[Label], body: bytes, delimiter: str) -> tuple[list[Label], bytes]:
    """Labels and rows with a column for each number of cells that hold lists, as `"[0.1, 0.2]"`.

    >>> labels, body = lists_apart([Label("t", "t", None), Label("q", "q", None)], b'0,"[0.1, 0.2]"\\n', ",")
    >>> [label.name for label in labels], body
    (['t', 'q_1', 'q_2'], b'0,0.1,0.2\\n')
    """
    first = re.search(rb"[^\n]+", body)
    if first is None or not _LIST_CELL.search(first[0]):
        return list(labels), body
    counts = [len(_items(match[1])) for match in _LIST_CELL.finditer(first[0])]
    cells = _LIST_CELL.sub(b"\0", first[0]).split(delimiter.encode())
    if not counts or len(cells) != len(labels):
        return list(labels), body
    left, apart = iter(counts), list[Label]()
    for label, cell in zip(labels, cells, strict=True):
        if cell.strip() != b"\0":
            apart.append(label)
            continue
        for number in range(1, next(left) + 1):
            name = f"{label.name}_{number}"
            apart.append(Label(name, name, label.unit))
    return apart, _LIST_CELL.sub(lambda match: delimiter.encode().join(_items(match[1])), body)


def _items(text: bytes) -> list[bytes]:
    return re.split(rb"[,;\s]+", text.strip())


def seconds_of_clock(texts: Sequence[str | None]) -> Array:
    """Times of day as seconds since the first that is written, over midnight too; nan where there is none.

    >>> seconds_of_clock(["23:59:59,5", None, "00:00:00.25"]).tolist()
    [0.0, nan, 0.75]
    """
    found = np.full(len(texts), np.nan)
    for row, text in enumerate(texts):
        if text is not None and (match := CLOCK_CELL.fullmatch(text.strip())):
            seconds = 3600.0 * int(match["h"]) + 60.0 * int(match["m"]) + float(match["s"].replace(",", "."))
            found[row] = SECONDS_PER_DAY * _day(match["day"]) + seconds
    there = np.isfinite(found)
    if there.any():
        later = np.cumsum(
            np.where(np.diff(found[there], prepend=found[there][0]) < -0.5 * SECONDS_PER_DAY, SECONDS_PER_DAY, 0.0)
        )
        found[there] += later - found[there][0]
    return found


def _day(text: str | None) -> int:
    if text is None:
        return 0
    numbers = [int(part) for part in re.split(r"[-/.]", text)]
    try:
        return date(*(numbers if numbers[0] > 31 else numbers[::-1])).toordinal()
    except ValueError:
        return 0


# ---- Pairs of a name and a number ------------------------------------------------------------------------------------


MAX_PAIRS_BYTES = 2**26  # of a file of pairs: each number is an object before it is in a column
MIN_SHARE_OF_LINES = 0.8  # of the first lines, that have the form of pairs
MIN_SHARE_OF_RECORDS = 0.5  # of all records, that contain a column
LEAD_NAME = "lead"  # number at the beginning of each line
_CLOCK_PATTERN = CLOCK_CELL.pattern.replace("?P<", "?P<_")
_LINE_BEGIN = re.compile(rf"\s*\[?(?:(?P<clock>{_CLOCK_PATTERN})|(?P<number>{NUMBER_CELL.pattern}))\]?(?=[\s,;:|\]])[\s,;:|]*")


class Pair(NamedTuple):
    """A name, its number, and the unit behind it; empty if there is none."""

    name: str
    value: float
    unit: str = ""


def pairs_table(file: str, data: bytes) -> ArrayTable | None:
    """Return the table of a text of pairs, a row for each record; None if the text has another layout.

    A record ends at a line `---`, or before a name that it contains already.

    >>> table = pairs_table("drive.log", b"1, spd:0.1, i:131.7 mA\\n2, spd:1.0, i:154.9 mA\\n")
    >>> [label.text for label in table.labels], table.columns[1]
    (['spd', 'i [mA]'], array([131.7, 154.9]))
    """
    if len(data) > MAX_PAIRS_BYTES or not _has_pairs(data):
        return None
    records = _Records(separated=bool(re.search(rb"(?m)^---$", data)))
    for line in _lines(data):
        records.read(line)
    records.end()
    return records.table(file)


def _lines(data: bytes) -> Iterator[str]:
    return (match[0].decode() for match in re.finditer(rb"[^\n]+", data))


def _has_pairs(data: bytes) -> bool:
    """True if the first lines have the form of pairs, and a name comes again."""
    begin = data if len(data) <= MAX_LINE_BYTES else data[: data.rfind(b"\n", 0, MAX_LINE_BYTES) + 1]
    lines = list(islice(_lines(begin), MAX_LAYOUT_LINES))
    found = [_pairs(_without_begin(line)) for line in lines]
    formed = [bool(pairs) or _is_of_block(line) for line, pairs in zip(lines, found, strict=True)]
    names = Counter(pair.name for pairs in found for pair in pairs)
    comes_again = any(count > 1 for count in names.values()) or lines.count("---") > 1
    return bool(names) and comes_again and sum(formed) >= MIN_SHARE_OF_LINES * len(lines)


def _is_of_block(line: str) -> bool:
    """True for a line of a block that contains no number of its own: its end, a key, a list, an item or a text."""
    return line == "---" or re.match(r" *(?:- |\w+:(?: |$))", line) is not None


def _without_begin(line: str) -> str:
    begin = _LINE_BEGIN.match(line)
    return line[begin.end() :] if begin else line


def _pairs(line: str) -> list[Pair]:
    """Return the pairs of a line.

    >>> _pairs('motor speed: 3.2 rpm, "i": 1'), _pairs("speed = 1 rad/s torque = .5")
    ([Pair(name='motor speed', value=3.2, unit='rpm'), Pair(name='i', value=1.0, unit='')], \
[Pair(name='speed', value=1.0, unit='rad/s'), Pair(name='torque', value=0.5, unit='')])
    """
    if ":" not in line and "=" not in line:
        return []
    delimiter = next((mark for mark in "\t;|," if mark in line), None)
    pairs = list[Pair]()
    for piece in line.split(delimiter) if delimiter else [line]:
        signs = len(re.findall(r"[:=]", piece))
        cells = [piece] if signs == 1 else re.sub(r"\s*[:=]\s*", "=", piece).split()
        for cell in cells:
            if signs and (pair := _pair(cell)):
                pairs.append(pair)
            elif pairs and signs > 1 and not pairs[-1].unit and is_unit(cell):
                pairs[-1] = pairs[-1]._replace(unit=cell)
    return pairs


def _pair(cell: str) -> Pair | None:
    """Return the pair in a cell, as `speed: 0.1 rpm`; None if it contains none."""
    names = re.split(r"[:=]", cell)
    if len(names) < 2:
        return None
    name, text = names[-2].strip(" \"'{}()"), names[-1].strip(" \"'{}()")
    if not re.match(r"[^\W\d]", name) or len(name) > MAX_NAME:
        return None
    number = NUMBER_CELL.match(text)
    unit = text[number.end() :].strip(" []()") if number else ""
    if number is None or (unit and not is_unit(unit)):
        return Pair(name, np.nan) if text.casefold() in NOT_FINITE else None
    return Pair(name, float(number[0].replace(",", ".")), unit)


@dataclass
class _Records:
    """Records of pairs, as they are read line by line."""

    separated: bool
    rows: list[dict[str, float]] = field(default_factory=list)
    clocks: list[str | None] = field(default_factory=list)
    units: dict[str, str] = field(default_factory=dict)
    left_out: int = 0
    _row: dict[str, float] = field(default_factory=dict)
    _clock: str | None = None
    _keys: list[tuple[int, str]] = field(default_factory=list)  # of a block, with their indentation
    _items: int = 0

    def read(self, line: str) -> None:
        """Take the pairs of a line."""
        if self.separated:
            return self._read_block(line)
        begin = _LINE_BEGIN.match(line)
        pairs = _pairs(line[begin.end() :] if begin else line)
        if not pairs:
            self.left_out += 1
            return None
        if any(pair.name in self._row for pair in pairs):
            self.end()
        if begin and begin["number"]:
            self._row[LEAD_NAME] = float(begin["number"].replace(",", "."))
        self._clock = self._clock or (begin["clock"] if begin else None)
        for pair in pairs:
            self._take(pair.name, pair)
        return None

    def _read_block(self, line: str) -> None:
        """Take a line of a block, whose names are those of the keys above it, as `header.stamp.sec`."""
        if line.strip() == "---":
            return self.end()
        match = re.match(r"( *)(?:(\w+) *:|-) *(.*)", line)
        if match is None:
            self.left_out += 1
            return None
        indent, key, text = len(match[1]), match[2], match[3]
        if key is None:
            self._items += 1
            if self._keys and (pair := _pair(f"item={text}")):
                self._take(f"{self._path()}_{self._items}", pair)
            return None
        self._keys = [each for each in self._keys if each[0] < indent] + [(indent, key)]
        self._items = 0
        cells = re.split(r"[,\s]+", text.strip("[] ")) if text.startswith("[") else [text]
        for number, cell in enumerate(cells, start=1):
            if pair := _pair(f"item={cell}"):
                self._take(f"{self._path()}_{number}" if text.startswith("[") else self._path(), pair)
        return None

    def _path(self) -> str:
        return ".".join(key for _, key in self._keys)

    def _take(self, name: str, pair: Pair) -> None:
        self._row[name] = pair.value
        if pair.unit:
            self.units.setdefault(name, pair.unit)

    def end(self) -> None:
        """End a record, if it contains a number."""
        if self._row:
            self.rows.append(self._row)
            self.clocks.append(self._clock)
        self._row, self._clock, self._keys, self._items = {}, None, [], 0

    def table(self, file: str) -> ArrayTable:
        """Return the columns that most records contain, and in words what is left out."""
        counts = Counter(name for row in self.rows for name in row)
        names = [name for name, count in counts.items() if count >= MIN_SHARE_OF_RECORDS * len(self.rows)][:MAX_COLUMNS]
        columns = {name: np.array([row.get(name, np.nan) for row in self.rows]) for name in names}
        times, seldom = self._time(columns), [name for name in counts if name not in names]
        left_out = [f"it contains pairs of a name and a number: {len(self.rows)} records"]
        left_out += [f"{self.left_out} of its lines contain none, and are left out"] if self.left_out else []
        left_out += [f"in less than half of the records, and left out: {listed(seldom[:5])}"] if seldom else []
        labels = [Label(name, name, "s") for name in times]
        labels += [Label(f"{name} [{unit}]" if (unit := self.units.get(name)) else name, name, unit) for name in columns]
        return ArrayTable(file, "", labels, [*times.values(), *columns.values()], left_out)

    def _time(self, columns: dict[str, Array]) -> dict[str, Array]:
        """Return the time of the records: of clocks, or of numbers in front that count no lines."""
        lead = columns.pop(LEAD_NAME, None)
        if any(self.clocks):
            return {"time": seconds_of_clock(self.clocks)}
        if lead is not None and np.isfinite(lead).all() and not np.array_equal(lead, np.round(lead)):
            return {"time": lead - lead[0]}
        return {}
