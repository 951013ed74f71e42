"""Any table, written in any of the shapes that people and programs write: it is read back as it was."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from numpy.typing import NDArray
from strainwave import Recording
from strainwave.files.labels import ColumnSource
from strainwave.files.tables import open_table

FOLDER = settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
NAMES = ("motor speed", "tau", "Zeit", "q_1")
UNITS = ("rpm", "N.m", "s", "rad")

values = st.floats(-1e9, 1e9, allow_subnormal=False).map(lambda number: float(f"{number:.12g}"))
grids = st.integers(1, 4).flatmap(
    lambda count: st.lists(st.lists(values, min_size=count, max_size=count), min_size=1, max_size=8)
)
suffixes = st.sampled_from([".csv", ".txt", ".dat"])


def rows_as(rows: Sequence[Sequence[float]], delimiter: str, mark: str) -> list[str]:
    return [delimiter.join(f"{value:.12g}".replace(".", mark) for value in row) for row in rows]


def columns_by_number(path: Path, count: int, unit: str | None = "1") -> list[NDArray[np.float64]]:
    units = {f"c{i}": unit for i in range(count)} if unit else None
    recording = Recording.read(path, {f"c{i}": str(i + 1) for i in range(count)}, units)
    return [recording[f"c{i}"] for i in range(count)]


@FOLDER
@given(grids, st.sampled_from([(",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ",")]), st.booleans(), suffixes)
def test_a_table_with_a_header(
    tmp_path: Path, rows: list[list[float]], shape: tuple[str, str], comments: bool, suffix: str
) -> None:
    delimiter, mark = shape
    count = len(rows[0])
    header = delimiter.join(f"{name} [{unit}]" for name, unit in zip(NAMES[:count], UNITS, strict=False))
    lines = [header, *rows_as(rows, delimiter, mark)]
    if comments:
        lines = ["# of a test", "", lines[0], "# 1,2", *lines[1:], ""]
    if count == 1:
        lines = [line.replace(",", ".") for line in lines]
    path = tmp_path / f"table{suffix}"
    path.write_text("\n".join(lines))
    recording = Recording.read(
        path, {name: name for name in NAMES[:count] if name != "Zeit"} | dict.fromkeys(["x"][: count > 2], "Zeit")
    )
    for i, name in enumerate(NAMES[:count]):
        assert recording["x" if name == "Zeit" else name].tolist() == [row[i] for row in rows]


@FOLDER
@given(grids, st.sampled_from([(",", "."), (";", "."), (";", ","), ("\t", "."), (" ", "."), ("   ", ".")]), suffixes)
def test_a_table_without_a_header_by_the_numbers_of_its_columns(
    tmp_path: Path, rows: list[list[float]], shape: tuple[str, str], suffix: str
) -> None:
    delimiter, mark = shape
    count = len(rows[0])
    path = tmp_path / f"table{suffix}"
    path.write_text("\n".join(rows_as(rows, delimiter, mark if count > 1 else ".")) + "\n")
    assert Recording.header(path) == tuple(f"column_{i}" for i in range(1, count + 1))
    assert [column.tolist() for column in columns_by_number(path, count)] == np.transpose(rows).tolist()


@FOLDER
@given(grids.filter(lambda rows: len(rows[0]) > 1), st.sampled_from([",", ";", " ", "\t"]))
def test_what_numpy_writes_with_names_in_a_comment(tmp_path: Path, rows: list[list[float]], delimiter: str) -> None:
    count = len(rows[0])
    names = [f"{name.replace(' ', '_')} [{unit}]" for name, unit in zip(NAMES[:count], UNITS, strict=False)]
    path = tmp_path / "table.txt"
    np.savetxt(path, rows, fmt="%.12g", delimiter=delimiter, header=delimiter.join(names))
    assert Recording.header(path) == tuple(name.split(" ")[0] for name in names)
    assert [column.tolist() for column in columns_by_number(path, count, None)] == np.transpose(rows).tolist()


@FOLDER
@given(grids.filter(lambda rows: len(rows[0]) > 1 and len(rows) > 1), st.data())
def test_a_torn_last_row_is_left_out_and_named_where_that_is_allowed(
    tmp_path: Path, rows: list[list[float]], data: st.DataObject
) -> None:
    count = len(rows[0])
    header = ",".join(f"c{i} [1]" for i in range(count))
    *whole, last = rows_as(rows, ",", ".")
    torn = last[: data.draw(st.integers(1, last.rindex(",")))]
    path = tmp_path / "table.csv"
    path.write_text("\n".join([header, *whole, torn]))
    opened = open_table(path)
    columns, remarks = opened.measured([ColumnSource(i, f"c{i}", f"c{i}", "1") for i in range(count)])
    assert [columns[f"c{i}"].tolist() for i in range(count)] == np.transpose(rows[:-1]).tolist()
    assert remarks == [
        f'its last row, line {len(rows) + 1}, ends too early and is left out: "{torn[:60]}{"…" if len(torn) > 60 else ""}"'
    ]


@FOLDER
@given(grids, st.sampled_from(["", "nan", "NaN", "NULL", "N/A"]), st.data())
def test_cells_without_a_number_are_nan_where_that_is_allowed(
    tmp_path: Path, rows: list[list[float]], nothing: str, data: st.DataObject
) -> None:
    count = len(rows[0])
    missing = data.draw(st.lists(st.tuples(st.integers(0, len(rows) - 1), st.integers(0, count - 1)), max_size=4))
    cells = [[f"{value:.12g}" for value in row] for row in rows]
    expected = np.array(rows)
    for row, column in missing:
        cells[row][column], expected[row, column] = nothing or '""', np.nan
    path = tmp_path / "table.csv"
    path.write_text("\n".join([",".join(f"c{i} [1]" for i in range(count)), *(",".join(row) for row in cells)]) + "\n")
    columns, _ = open_table(path).measured([ColumnSource(i, f"c{i}", f"c{i}", "1") for i in range(count)])
    assert np.array_equal(np.column_stack([columns[f"c{i}"] for i in range(count)]), expected, equal_nan=True)


def test_dates_are_seconds_since_the_first(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text("when,c [1]\n2026-01-31T23:59:59.500Z,1\n,2\n2026-02-01T00:00:01.250Z,3\n")
    opened = open_table(path)
    assert opened.contents == ["dates", "numbers"]
    columns, _ = opened.measured([ColumnSource(0, "when", "time", "s")])
    assert np.array_equal(columns["time"], [0.0, np.nan, 1.75], equal_nan=True)


@FOLDER
@given(grids.filter(lambda rows: len(rows[0]) > 1), st.sampled_from([",", ";", "\t"]), st.booleans())
def test_units_below_the_header_and_lines_above_it(
    tmp_path: Path, rows: list[list[float]], delimiter: str, above: bool
) -> None:
    """As recorders write them: what it is and when above, units below the names."""
    count = len(rows[0])
    header = [delimiter.join(NAMES[:count]), delimiter.join(UNITS[:count])]
    before = ["Recorder: X 100", "Date: 2026-03-01 10:00", ""] if above else []
    path = tmp_path / "table.csv"
    path.write_text("\n".join([*before, *header, *rows_as(rows, delimiter, ".")]) + "\n")
    opened = open_table(path)
    assert [(label.name, label.unit) for label in opened.labels] == list(zip(NAMES, UNITS, strict=True))[:count]
    columns, remarks = opened.measured([ColumnSource(i, NAMES[i], NAMES[i], UNITS[i]) for i in range(count)])
    assert [columns[NAMES[i]].tolist() for i in range(count)] == [[row[i] for row in rows] for i in range(count)]
    assert remarks == (["its header is line 4; what stands above it is left out"] if above else [])
    if above:
        with pytest.raises(ValueError, match="its header is line 4; delete what stands above it"):
            Recording.read(path)
    else:
        assert Recording.read(path, {"x": NAMES[1]}).unit("x") == UNITS[1]


@pytest.mark.parametrize("written", ['"[{}, {}]"', "[{} {}]", "\"array('d', [{}, {}])\"", '"({}, {})"'])
def test_lists_in_cells_are_columns(tmp_path: Path, written: str) -> None:
    path = tmp_path / "table.csv"
    rows = [f"{row},{written.format(row + 0.1, -row)},{row + 0.5}" for row in range(3)]
    path.write_text("\n".join(["time,position,note (x)", *rows]) + "\n")
    opened = open_table(path)
    assert [label.name for label in opened.labels] == ["time", "position_1", "position_2", "note (x)"]
    columns, _ = opened.measured([ColumnSource(place, "", str(place), "1") for place in range(4)])
    assert columns["1"].tolist() == [0.1, 1.1, 2.1]
    assert columns["2"].tolist() == [0.0, -1.0, -2.0]
    assert columns["3"].tolist() == [0.5, 1.5, 2.5]


@pytest.mark.parametrize(
    "written",
    [
        ("23:59:59,5", "", "00:00:01,25"),
        ("31.01.2026 23:59:59,5", "", "01.02.2026 00:00:01,25"),
        ("2026/01/31 23:59:59.5", "", "2026/02/01 00:00:01.25"),
    ],
)
def test_times_of_day_are_seconds_since_the_first(tmp_path: Path, written: tuple[str, ...]) -> None:
    path = tmp_path / "table.csv"
    path.write_text("\n".join(["Zeit;c [1]", *(f"{text};{place}" for place, text in enumerate(written))]) + "\n")
    opened = open_table(path)
    assert opened.contents == ["dates", "numbers"]
    columns, _ = opened.measured([ColumnSource(0, "Zeit", "time", "s")])
    assert np.array_equal(columns["time"], [0.0, np.nan, 1.75], equal_nan=True)
