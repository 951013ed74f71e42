"""Layouts of text tables: lines above the header, units below it, lists in one cell, times of day."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import date
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import Label, is_unit

Array = NDArray[np.float64]

NUMBER = re.compile(
    r"[+-]?(?=[.,]?\d)\d*+([.,]?)\d*+(?:[eE][+-]?\d++)?", re.ASCII
)  # sign, digits, one decimal mark (group 1), exponent
CLOCK = re.compile(  # a time of day, or with a date as controllers and loggers write it
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
_LIST = re.compile(rb"""["']?(?:array\((?:'d', *)?)?[\[(](\s*(?:[-+.\d']|nan)[^\[\]()"\n]*)[\])]{1,2}["']?""")


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
                and all(map(_is_name, names))
                and any(NUMBER.fullmatch(each[0]) or NUMBER.fullmatch(each[1]) for each in below)
            ):
                return lines[place][0]
    return 0


def _is_name(cell: str) -> bool:
    return bool(cell) and not NUMBER.fullmatch(cell) and cell.casefold() not in NOT_FINITE


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
        first = next((place for place, row in enumerate(rows) if len(row) > 1 and NUMBER.fullmatch(row[0])), None)
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
    found = []
    for place in range(count):
        if place == 0 or (each_timed and place % 2 == 0):
            found.append(Label(f"time [{unit_of_time}]" if unit_of_time else "time", "time", unit_of_time))
            continue
        name = names[place] if place < len(names) else ""
        unit = re.sub(r"\s*\([^()]*\)$", "", units[place]) if place < len(units) else ""
        stated = unit not in _NO_UNIT and (is_unit(unit) or unit.strip() in "%‰")
        found.append(Label(f"{name} [{unit}]", name, unit) if stated else Label(name, name, None))
    return found


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
    return bool(NUMBER.fullmatch(text)) or text.casefold() in NOT_FINITE


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
    if first is None or not _LIST.search(first[0]):
        return list(labels), body
    counts = [len(_items(match[1])) for match in _LIST.finditer(first[0])]
    cells = _LIST.sub(b"\0", first[0]).split(delimiter.encode())
    if not counts or len(cells) != len(labels):
        return list(labels), body
    left, found = iter(counts), list[Label]()
    for label, cell in zip(labels, cells, strict=True):
        if cell.strip() != b"\0":
            found.append(label)
            continue
        for number in range(1, next(left) + 1):
            name = f"{label.name}_{number}"
            found.append(Label(name, name, label.unit))
    return found, _LIST.sub(lambda match: delimiter.encode().join(_items(match[1])), body)


def _items(text: bytes) -> list[bytes]:
    return re.split(rb"[,;\s]+", text.strip())


def seconds_of_clock(texts: Sequence[str | None]) -> Array:
    """Times of day as seconds since the first that is written, over midnight too; nan where there is none.

    >>> seconds_of_clock(["23:59:59,5", None, "00:00:00.25"]).tolist()
    [0.0, nan, 0.75]
    """
    found = np.full(len(texts), np.nan)
    for row, text in enumerate(texts):
        if text is not None and (match := CLOCK.fullmatch(text.strip())):
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
