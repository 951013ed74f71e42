"""Text of pairs, as `speed: 0.1, current: 131.7` or `speed = 0.1`, in lines or in the blocks of `ros2 topic echo`."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.files.array_table import ArrayTable
from strainwave.files.labels import MAX_COLUMNS, MAX_NAME, Label, is_unit
from strainwave.files.text_layout import CLOCK, MAX_LAYOUT_LINES, MAX_LINE_BYTES, NOT_FINITE, NUMBER, seconds_of_clock
from strainwave.messages import listed

Array = NDArray[np.float64]

MAX_PAIRS_BYTES = 2**26  # of a file of pairs: each number is an object before it is in a column
MIN_SHARE_OF_LINES = 0.8  # of the first lines, that have the form of pairs
MIN_SHARE_OF_RECORDS = 0.5  # of all records, that contain a column
LEAD = "lead"  # number at the beginning of each line
_CLOCK = CLOCK.pattern.replace("?P<", "?P<_")
_BEGIN = re.compile(rf"\s*\[?(?:(?P<clock>{_CLOCK})|(?P<number>{NUMBER.pattern}))\]?(?=[\s,;:|\]])[\s,;:|]*")


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
    begin = _BEGIN.match(line)
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
    found = list[Pair]()
    for piece in line.split(delimiter) if delimiter else [line]:
        signs = len(re.findall(r"[:=]", piece))
        cells = [piece] if signs == 1 else re.sub(r"\s*[:=]\s*", "=", piece).split()
        for cell in cells:
            if signs and (pair := _pair(cell)):
                found.append(pair)
            elif found and signs > 1 and not found[-1].unit and is_unit(cell):
                found[-1] = found[-1]._replace(unit=cell)
    return found


def _pair(cell: str) -> Pair | None:
    """Return the pair in a cell, as `speed: 0.1 rpm`; None if it contains none."""
    names = re.split(r"[:=]", cell)
    if len(names) < 2:
        return None
    name, text = names[-2].strip(" \"'{}()"), names[-1].strip(" \"'{}()")
    if not re.match(r"[^\W\d]", name) or len(name) > MAX_NAME:
        return None
    number = NUMBER.match(text)
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
        begin = _BEGIN.match(line)
        pairs = _pairs(line[begin.end() :] if begin else line)
        if not pairs:
            self.left_out += 1
            return None
        if any(pair.name in self._row for pair in pairs):
            self.end()
        if begin and begin["number"]:
            self._row[LEAD] = float(begin["number"].replace(",", "."))
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
        lead = columns.pop(LEAD, None)
        if any(self.clocks):
            return {"time": seconds_of_clock(self.clocks)}
        if lead is not None and np.isfinite(lead).all() and not np.array_equal(lead, np.round(lead)):
            return {"time": lead - lead[0]}
        return {}
