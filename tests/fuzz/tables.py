"""Text tables and Parquet files that are not as they should be."""

from __future__ import annotations

import codecs
import csv
import io
import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pyarrow.parquet
import strainwave as sw
from numpy.random import Generator
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import recognise

from tests.fuzz.laws import Case, described, finite
from tests.fuzz.mutation import NUMBERS, encoded, mutated, mutated_bytes, picked

WORDS = (
    "time [s]", "time", "speed [rad/s]", "speed (rpm)", "torque [N.m]", "torque (Nm)", "twist [deg]", "[s]", "[]", "[1]", "()",
    "[N.m", "# title: a run", "#", "# comment", "time [s]\n", '"a, b" [rad]', "0.1,0.2", "1;2", '"1"', '"1,5"', '"', " 1",
    "1 ",
)  # fmt: skip
_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?", re.ASCII)
COLUMNS: dict[str, tuple[str, ...]] = {
    "run": ("time [s]", "command [V]", "position [rad]"),
    "friction": ("speed [rad/s]", "torque [N.m]"),
    "torsion": ("twist [deg]", "torque [N.m]"),
}


def _text(kind: str, random: Generator) -> str:
    """A table as it should be."""
    names, delimiter = COLUMNS[kind], picked(random, (",", ",", ";", "\t"))
    mark = "," if delimiter != "," and random.random() < 0.5 else "."
    rows = int(random.integers(1, 9))
    table = np.column_stack([np.arange(1.0, rows + 1.0), *(random.normal(size=rows) for _ in names[1:])])
    lines = [delimiter.join(names), *(delimiter.join(f"{x:.{random.integers(1, 17)}g}" for x in row) for row in table)]
    title = "# title: measured\n" if random.random() < 0.2 else ""
    return title + "\n".join([lines[0], *(line.replace(".", mark) for line in lines[1:])]) + "\n"


def csv_case(random: Generator, folder: Path) -> Case:
    held = picked(random, tuple(COLUMNS))
    data = encoded(mutated(_text(held, random), random, WORDS), random)
    path = folder / f"table{picked(random, ('.csv', '.txt', '.tsv'))}"
    path.write_bytes(data)
    kind = picked(random, (None, held))

    def check(recording: sw.Recording) -> None:
        check_round_trip(recording, folder)
        if kind is None:
            check_against_csv(recording, data)

    return Case(f"{kind or 'table'} {described(data)}", lambda: _read(path, kind), check)


def parquet_case(random: Generator, folder: Path) -> Case:
    path = folder / "table.parquet"
    what = "odd"
    if random.random() < 0.3:
        table = _odd_table(random)
        pyarrow.parquet.write_table(table, path)
        what = f"odd: {table.schema.to_string(show_field_metadata=False)}"
    else:
        data = mutated_bytes(_parquet(int(random.integers(3))), random)
        path.write_bytes(data)
        what = f"{len(data)} bytes"
    kind = picked(random, (None, None, *COLUMNS))
    return Case(
        f"{kind or 'table'} {described(what)}", lambda: _read(path, kind), lambda found: check_round_trip(found, folder)
    )


def _read(path: Path, kind: str | None) -> sw.Recording:
    return sw.Recording.read(path) if kind is None else recognise(path, FileMapping(kind=kind)).recording


def check_round_trip(recording: sw.Recording, folder: Path) -> None:
    """Its numbers are finite, and files hold it as it is."""
    assert finite(recording), "a number that is not finite"
    for suffix in ("csv", "parquet"):
        again = folder / f"again.{suffix}"
        getattr(recording, f"to_{suffix}")(again)
        assert sw.Recording.read(again) == recording, f"a .{suffix} file holds it otherwise"


def _decoded(data: bytes) -> str:
    """Return the text, decoded by its byte order mark, else as UTF-8, else as Windows-1252."""
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return data.decode("utf-16")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252")


def check_against_csv(recording: sw.Recording, data: bytes) -> None:
    """Each number is what Python's own reader finds at its place."""
    ended = re.findall(r"[^\r\n]+(?:\r\n|\r|\n)?", _decoded(data))
    lines = [line for line in ended if line.strip(" \r\n") and line[0] != "#"]
    delimiter = next(mark for mark in "\t;," if mark in lines[0] or mark == ",")
    rows = list(csv.reader(io.StringIO("".join(lines), newline=""), delimiter=delimiter, strict=True))
    if not all(_NUMBER.fullmatch(cell.strip()) for cell in rows[0]):  # else the names stand in a comment
        rows = rows[1:]
    assert len(rows) == len(recording), f"{len(recording)} rows, where Python's csv finds {len(rows)}"
    for place, name in enumerate(recording.names):
        cells = [row[place].strip(" \t") for row in rows]
        odd = [cell for cell in cells if not _NUMBER.fullmatch(cell)]
        assert not odd, f"takes {odd[0]!r} for a number"
        expected = np.array([float(cell.replace(",", ".")) for cell in cells])
        assert np.array_equal(recording[name], expected), f"column {name} holds other numbers than Python's csv finds"


@cache
def _parquet(layout: int) -> bytes:
    """A file as it should be, as bytes."""
    columns = {"time": np.arange(50.0), "command": np.sin(np.arange(50.0)), "position": np.arange(50.0)}
    recording = sw.Recording(columns, {"time": "s", "command": "V", "position": "rad"}, "measured")
    fields = [pyarrow.field(name, pyarrow.float64(), metadata={"unit": unit}) for name, unit in recording.units.items()]
    table = pyarrow.table(dict(recording.columns), schema=pyarrow.schema(fields, metadata={"title": "measured"}))
    buffer = io.BytesIO()
    options: dict[str, Any] = [
        {"compression": "zstd", "use_byte_stream_split": True, "use_dictionary": False, "write_page_checksum": True},
        {"compression": "none"},
        {"compression": "snappy", "row_group_size": 7},
    ][layout]
    pyarrow.parquet.write_table(table, buffer, **options)
    return buffer.getvalue()


def _odd_table(random: Generator) -> pyarrow.Table:
    """A sound file whose columns are none of a recording, most of the time."""
    length = int(random.integers(0, 5))
    series = [_odd_series(random, length) for _ in range(int(random.integers(0, 4)))]
    names = [
        picked(random, ("time", "speed [rad/s]", "torque", "", " x", "a\nb", "time", "command", "\x1b[1m")) for _ in series
    ]
    metadata = [picked(random, (None, {"unit": "s"}, {"unit": b"\xff"}, {"unit": "furlong"}, {"unit": ""})) for _ in series]
    fields = [pyarrow.field(n, s.type, metadata=m) for n, s, m in zip(names, series, metadata, strict=True)]
    title = picked(random, (None, {"title": "a\nb"}, {"title": b"\xff"}, {"title": "ok"}))
    return pyarrow.Table.from_arrays(series, schema=pyarrow.schema(fields, metadata=title))


def _odd_series(random: Generator, length: int) -> pyarrow.Array:
    values: list[Any] = random.normal(size=length).tolist()
    kind = picked(
        random, ("float", "float", "time", "int", "text", "null", "some null", "list", "bool", "stamp", "nan", "words")
    )
    match kind:
        case "time":
            return pyarrow.array(np.arange(float(length)))
        case "int":
            return pyarrow.array(range(length), picked(random, (pyarrow.int8(), pyarrow.uint64(), pyarrow.decimal128(9, 2))))
        case "text":
            return pyarrow.array([str(value) for value in values], pyarrow.string())
        case "words":
            return pyarrow.array([picked(random, NUMBERS) for _ in values], pyarrow.string()).dictionary_encode()
        case "null":
            return pyarrow.nulls(length)
        case "some null":
            return pyarrow.array([None, *values[1:]][:length], pyarrow.float64())
        case "list":
            return pyarrow.array([[value] for value in values], pyarrow.list_(pyarrow.float64()))
        case "bool":
            return pyarrow.array([value > 0.0 for value in values], pyarrow.bool_())
        case "stamp":
            return pyarrow.array(range(length), pyarrow.timestamp("ns"))
        case "nan":
            return pyarrow.array([np.nan] * length, picked(random, (pyarrow.float32(), pyarrow.float64())))
        case _:
            return pyarrow.array(values, picked(random, (pyarrow.float32(), pyarrow.float64())))
