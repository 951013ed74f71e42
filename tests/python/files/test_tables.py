"""Tables as other people write them, as text and as Parquet: read, or refused with the place of the fault."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings, strategies as st
from strainwave.files.budget import read_text
from strainwave.files.labels import ColumnSource, labels_of, read_by_others
from strainwave.files.recording import Recording
from strainwave.files.tables import FORMATS, LISTED_FORMATS, open_table
from strainwave.files.text_table import CsvTable

from tests.python.files.test_recording import EMPTY, RUN, exactly, untimed
from tests.support.work import calls

# Text


def open_simple(path: Path) -> CsvTable:
    """The reader of a text format, as docs/contributing/add-a-file-format.md describes it."""
    with read_by_others(path, "swlo"):
        header, end, rows = read_text(path, 2**20).partition("\n")
    delimiter = ";"
    return CsvTable(str(path), "", delimiter, labels_of(header.split(delimiter)), memoryview((end + rows).encode()), line=1)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_reader_of_text_takes_any_end_of_a_line(tmp_path: Path, end: str) -> None:
    path = tmp_path / "a.swlo"
    path.write_bytes(end.join(["time [s];torque [N.m]", "0;1,5", "1;-0,5", ""]).encode())
    table = open_simple(path)
    assert [label.name for label in table.labels] == ["time", "torque"]
    assert table.contents == ["numbers", "numbers"]
    columns = [ColumnSource(0, "time", "time", "s"), ColumnSource(1, "torque", "torque", "N.m")]
    assert table.numbers(columns)["torque"].tolist() == [1.5, -0.5]
    path.write_bytes(path.read_bytes().replace(b"-0,5", b"none"))
    with pytest.raises(ValueError, match=exactly(f'{path} line 3, column "torque": "none" is not a number')):
        open_simple(path).numbers(columns)


def test_a_reader_of_text_states_why_it_does_not_read_a_file(tmp_path: Path) -> None:
    path = tmp_path / "a.swlo"
    path.write_bytes(b"time\xff\n")
    with pytest.raises(ValueError, match=exactly(f"{path}: is not a text in UTF-8")):
        open_simple(path)
    path.write_bytes(bytes(2**20 + 1))
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))}: has more than 1 MB"):
        open_simple(path)
    with pytest.raises(ValueError, match=exactly(f"{path}.txt cannot be read: No such file or directory")):
        open_simple(Path(f"{path}.txt"))


UNCLOSED = "a quoted cell must end with its quote, on the same line"


@pytest.mark.parametrize(
    "text",
    [
        "time [s],torque [N.m]\n0,1.5\n1,-2e-3\n",
        "\ufefftime [s],torque [N.m]\r\n0,1.5\r\n1,-2e-3\r\n\r\n\r\n",
        "time (s), torque (Nm)\n 0 , +1.5 \n 1 ,\t-0.002\n",
        '"time [s]", "torque [N.m]"\n"0","1.5"\n1,"-.002"\n',
        "time [s];torque [N·m]\n0;1.5\n1;-0.002\n",
        "time [s];torque [N.m]\n0;1,5\n1;-2,0E-3\n",
        "time [s]\ttorque [N.m]\n0\t1,5\n1,\t-,002",
        "# made by a logger, 2024\n\n#\n  \ntime [s],torque [N.m]\n# begin\n0,1.5\n   \n1,-0.002\n# end\n",
        "time [ s ],torque [N m]\n0.,1.5\n1.0e0,-2.E-03\n",
        '"time [s]";"torque [N.m]"\n0;1,5\n1;-0,002\n',
        "# comment\rtime [s],torque [N.m]\r0,1.5\r# comment\r1,-0.002\r",
        "# comment\r\n# comment\rtime [s],torque [N.m]\n0,1.5\r\n\r\n# comment\r1,-0.002",
    ],
)
def test_one_table_in_many_dialects(tmp_path: Path, text: str) -> None:
    path = tmp_path / "table.csv"
    path.write_bytes(text.encode())
    assert Recording.from_csv(path) == Recording({"time": [0.0, 1.0], "torque": [1.5, -0.002]}, {"time": "s", "torque": "N.m"})


@pytest.mark.parametrize("suffix", [".csv", ".CSV", ".txt", ".tsv"])
def test_text_tables_are_known_by_their_suffix(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"table{suffix}"
    path.write_text("speed (rpm)\n60\n")
    assert Recording.read(path) == Recording({"speed": [60.0]}, {"speed": "rpm"})


def test_columns_picks_renames_and_leaves_the_rest_unread(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text('Motor Speed,note,t [ms],note\n1,"a, b",0,\n2,,5,nan\n')
    recording = Recording.read(path, columns={"time": "t", "speed": "Motor Speed"}, units={"speed": "rpm"})
    assert recording == Recording({"time": [0.0, 5.0], "speed": [1.0, 2.0]}, {"time": "ms", "speed": "rpm"})


def test_columns_may_name_the_whole_header(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text("speed [rpm],speed [rad/s]\n60,6.28\n")
    assert Recording.from_csv(path, {"speed": "speed [rad/s]"})["speed"].tolist() == [6.28]


def test_round_brackets_around_no_unit_belong_to_the_name(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text("speed (motor) (r/min),heat (J/(kg.K))\n60,1\n")
    recording = Recording.from_csv(path)
    assert recording.names == ("speed (motor)", "heat")
    assert (recording.unit("speed (motor)"), recording.unit("heat")) == ("rev/min", "J/(K.kg)")


def test_a_unit_may_be_given_twice_but_not_contradict(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text("torque [Nm]\n1\n")
    assert Recording.from_csv(path, units={"torque": "N.m"}).unit("torque") == "N.m"
    with pytest.raises(ValueError, match=exactly(f'{path} column "torque" is in "Nm", but the unit given for it is "N.cm"')):
        Recording.from_csv(path, units={"torque": "N.cm"})


def test_a_unit_that_is_not_known_is_told_by_the_reader(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text("n [furlongs/min]\n60\n")
    with pytest.raises(
        ValueError, match=exactly(f'{path} column "n": unit "furlongs/min" is not known; write it like N.m, rad/s, deg')
    ):
        Recording.from_csv(path)
    assert Recording.from_csv(path, units={"n": "rpm"}) == Recording({"n": [60.0]}, {"n": "rpm"})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", " is empty"),
        ("\n# nothing\n\n", " is empty"),
        ("time [s],torque [N.m]\n", " has a header but no rows"),
        (
            "# c\n0.0,1.0\n",
            ' column "column_1" has no unit; write it behind the name, as in torque [N.m], '
            'or give it with --unit column_1=UNIT (in Python units={"column_1": "UNIT"})',
        ),
        ("time [s],torque [N.m]\n0,1\n1,abc\n", ' line 3, column "torque": "abc" is not a number'),
        ("time [s],torque [N.m]\n0,\n", f' line 2, column "torque": {EMPTY}'),
        ("# c\n\ntime [s],torque [N.m]\n0,1\n# c\n1,nan\n", ' line 6, column "torque": nan is not finite'),
        ("time [s],torque [N.m]\n0,1\n\n1,-inf\n", ' line 4, column "torque": -inf is not finite'),
        ("time [s],torque [N.m]\n0,1e400\n", ' line 2, column "torque": inf is not finite'),
        ("time [s],torque [N.m]\n0,1\n2\n", " line 3: the number of cells is 1; the header has 2"),
        ("time [s],torque [N.m]\n0,1,\n", " line 2: the number of cells is 3; the header has 2"),
        ("time [s],torque [N.m]\n0,1\n,,,\n", " line 3: the number of cells is 4; the header has 2"),
        ("torque [N.m]\n1,5\n", " line 2: the number of cells is 2; the header has 1"),
        ("torque [N.m],torque [N.cm]\n1,2\n", ' has 2 columns named "torque"; names must differ'),
        ("torque [N.m],,\n1,2,3\n", " column 2 has no name; name it, or pick columns with columns={...}"),
        ("a [1],a [1],\n1,2,3\n", " column 3 has no name; name it, or pick columns with columns={...}"),
        (
            "torque\n1\n",
            ' column "torque" has no unit; write it behind the name, as in torque [N.m], '
            'or give it with --unit torque=UNIT (in Python units={"torque": "UNIT"})',
        ),
        ("torque []\n1\n", ' column "torque": unit "" is not known; write it like N.m, rad/s, deg'),
        (
            "time [s]\n0\n0.32\n0.31\n",
            ' line 4, column "time": 0.31 s does not lie after 0.32 s; time must increase',
        ),
        ("time [rad]\n0\n", ': column "time": cannot convert "rad" to "s"'),
        ("a [1];b [1]\n1,5;2\n1;2.5\n", ' line 3, column "b": "2.5" is not a number with the decimal mark ","'),
        ("a [1];b [1]\n1.5;2\n1.234,5;2\n", ' line 3, column "a": "1.234,5" is not a number'),
        ("a [1]\n1_000\n", ' line 2, column "a": "1_000" is not a number'),
        ("a [1]\n0x10\n", ' line 2, column "a": "0x10" is not a number'),
        ("a [1]\n٣\n", ' line 2, column "a": "٣" is not a number'),
        ('a [1],b [1]\n1,"2\n', f" line 2: {UNCLOSED}"),
        ('a [1],b [1]\n1,"2\n#"\n3,4\n', f" line 2: {UNCLOSED}"),
        ('a [1];b [1]\r# "\r1;2\r3;"4""\r', f" line 4: {UNCLOSED}"),
        ('a [1],b [1]\n"1"2,3\n', f" line 2: {UNCLOSED}"),
        ('a [1],"b\n[1]"\n1,2\n', " line 1: the header cannot be read: unexpected end of data"),
        ('"a"b\tc\n1\t2\n', " line 1: the header cannot be read: '\\t' expected after '\"'"),
        (131073 * "a" + "\n1\n", " line 1: the header cannot be read: field larger than field limit (131072)"),
        (1001 * "a" + "\n1\n", f' line 1 has a column "{60 * "a"}…" of 1001 characters; a name has at most 1000'),
        ("a [1]\n" + 1_000_000 * "x" + "\n", f' line 2, column "a": "{60 * "x"}…" is not a number'),
        ("a [1]\n\x1b[31mred\n", r' line 2, column "a": "\x1b[31mred" is not a number'),
        (
            "\x1b[31mred\n1\n",
            r' column "\x1b[31mred" has no unit; write it behind the name, as in torque [N.m], '
            r"""or give it with --unit '\x1b[31mred=UNIT' (in Python units={"\x1b[31mred": "UNIT"})""",
        ),
        ("a\tb [1]\n", " has a header but no rows"),
    ],
)
def test_a_faulty_table_is_refused_with_its_place(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "table.csv"
    path.write_bytes(text.encode())
    with pytest.raises(ValueError, match=exactly(f"{path}{message}")):
        Recording.from_csv(path)


@untimed
@given(
    rows=st.integers(1, 30),
    columns=st.integers(2, 5),
    text=st.text(alphabet="abc.-+ eE", max_size=5),
    delimiter=st.sampled_from(",;\t"),
    data=st.data(),
)
def test_any_cell_that_is_no_number_is_found(
    tmp_path: Path, rows: int, columns: int, text: str, delimiter: str, data: st.DataObject
) -> None:
    row, column = data.draw(st.integers(0, rows - 1)), data.draw(st.integers(0, columns - 1))
    cells = [[f"c{i} [1]" for i in range(columns)], *([str(i * 0.5)] * columns for i in range(rows))]
    cells[row + 1][column] = text
    path = tmp_path / "table.csv"
    path.write_text("".join(f"{delimiter.join(line)}\n" for line in cells))
    with pytest.raises(ValueError, match=f'^{re.escape(str(path))} line {row + 2}, column "c{column}": '):
        Recording.from_csv(path)


def understood(text: str, delimiter: str) -> list[list[str]]:
    """The rows of a table as Python's csv module reads them, a comment being skipped where a row could begin."""
    lines = iter(re.split(r"(?<=\n)|(?<=\r)(?!\n)", text))
    return [
        next(csv.reader(chain([line], lines), delimiter=delimiter))
        for line in lines
        if not line.startswith("#") and line.strip(" \r\n")
    ]


def number(cell: str) -> float:
    return float(cell.strip(" \t").replace(",", "."))


decimals = st.floats(allow_nan=False, allow_infinity=False).map(repr) | st.integers(-99, 99).map(str)
remarks = st.text(alphabet="ab #5\"'é.", max_size=6)
ends = st.sampled_from(["\n", "\r\n", "\r"])
between = st.sampled_from(["", "", "\n", "  \r\n", "# it's 5\" long\r", "#\n", "\r\r"])


@st.composite
def tables(draw: st.DrawFn, delimiter: str) -> str:
    """Rows of a number, a remark and a number as programs write them, with any line ends, comments and blank lines."""
    mark = "." if delimiter == "," else draw(st.sampled_from(".,"))
    pieces = []
    for _ in range(draw(st.integers(1, 6))):
        first, last = (draw(decimals).replace(".", mark) for _ in range(2))
        first = draw(st.sampled_from([first, f'"{first}"', f" {first} "]))
        remark = '"' + draw(remarks).replace('"', '""') + '"'
        pieces += [draw(between), delimiter.join([first, remark, last]), draw(ends)]
    return "".join(pieces)


def read_numbers(path: Path, text: str, delimiter: str) -> list[list[float]]:
    """Both columns of numbers in a file with this text below its header."""
    path.write_bytes(delimiter.join(["a [1]", "remark", "b [1]"]).encode() + b"\n" + text.encode())
    recording = Recording.from_csv(path, {"a": "a", "b": "b"})
    return [recording["a"].tolist(), recording["b"].tolist()]


def expected_numbers(text: str, delimiter: str) -> list[list[float]]:
    return [[number(row[column]) for row in understood(text, delimiter)] for column in (0, 2)]


@untimed
@given(st.data(), st.sampled_from(",;\t"))
def test_what_programs_write_is_read_as_the_csv_module_does(tmp_path: Path, data: st.DataObject, delimiter: str) -> None:
    text = data.draw(tables(delimiter))
    assert read_numbers(tmp_path / "table.csv", text, delimiter) == expected_numbers(text, delimiter)


@untimed
@given(st.data(), st.sampled_from(",;\t"))
def test_any_text_is_read_as_the_csv_module_does_or_refused(tmp_path: Path, data: st.DataObject, delimiter: str) -> None:
    """Some characters of a good table are replaced by others that mean something in a table."""
    text = data.draw(tables(delimiter))
    for _ in range(data.draw(st.integers(1, 3))):
        place = data.draw(st.integers(0, len(text) - 1))
        other = data.draw(st.sampled_from(["", '"', "\n", "\r", "#", " ", delimiter, "\n#", '"\n']))
        text = text[:place] + other + text[place + 1 :]
    try:
        numbers = read_numbers(tmp_path / "table.csv", text, delimiter)
    except ValueError:
        return
    assert numbers == expected_numbers(text, delimiter)


@pytest.mark.slow("files")
@settings(untimed, max_examples=25)
@given(st.data())
def test_where_a_block_of_the_reader_ends_changes_nothing(tmp_path: Path, data: st.DataObject) -> None:
    """The rows stand across the end of the first mebibyte, in which Arrow reads."""
    text = data.draw(tables(","))
    header = len("a [1],remark,b [1]\n")
    before = 2**20 - header - data.draw(st.integers(0, len(text.encode())))
    row = f"1,{1000 * 'x'},2\n"
    filling = row * (before // len(row) - 1)
    filling += f"1,{(before - len(filling) - 5) * 'x'},2\n"
    count = before // len(row)
    first, last = expected_numbers(text, ",")
    numbers = read_numbers(tmp_path / "table.csv", filling + text + "3,,4\n", ",")
    assert numbers == [[*count * [1.0], *first, 3.0], [*count * [2.0], *last, 4.0]]


def test_a_line_too_long_for_the_reader_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text(f"a [1],remark\n1,x\n2,{2**22 * 'x'}\n3,x\n")
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))} line 3 has 4194306 bytes; at most 1048576 can be read$"):
        Recording.from_csv(path, {"a": "a"})


def test_a_header_too_long_for_the_reader_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text(f"{2**21 * ';'}\n1;2\n")
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))} line 1 has 2097152 bytes; at most 1048576 can be read$"):
        open_table(path)


@pytest.mark.parametrize("header", ["a{}b", "a{}(b"])
def test_blanks_without_end_in_a_header_take_linear_time(tmp_path: Path, header: str) -> None:
    """A search that begins again at each blank would take minutes."""
    path = tmp_path / "table.csv"
    path.write_text(f"{header.format(100_000 * ' ')}\n0\n1\n")
    with pytest.raises(ValueError, match=r" line 1 has a column .* of 10000\d characters; a name has at most 1000$"):
        open_table(path)


def test_blanks_without_end_between_cells_take_linear_time(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text(f"t q\n0 1\n1{900_000 * ' '}2\n")
    table = open_table(path)
    assert table.numbers([ColumnSource(1, "q", "q", "1")])["q"].tolist() == [1.0, 2.0]


def test_a_name_has_at_most_a_thousand_characters(tmp_path: Path) -> None:
    path = tmp_path / "table.json"
    path.write_text(json.dumps({1000 * "q": [1.0, 2.0]}))
    assert len(open_table(path).labels) == 1
    path.write_text(json.dumps({1001 * "q": [1.0, 2.0]}))
    with pytest.raises(ValueError, match=r'has a column "q+…" of 1001 characters; a name has at most 1000$'):
        open_table(path)


def _many_columns(suffix: str, path: Path, count: int) -> None:
    """Write a file of so many columns."""
    names = [f"q{place} [rad]" for place in range(count)]
    if suffix == ".csv":
        path.write_text(f"{','.join(names)}\n" + 2 * f"{','.join(count * ['1'])}\n")
    elif suffix == ".parquet":
        pq.write_table(pa.table({name: [1.0, 2.0] for name in names}), path)
    else:
        path.write_text(json.dumps({name: [1.0, 2.0] for name in names}))


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".json"])
def test_a_table_has_at_most_four_thousand_columns(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"table{suffix}"
    _many_columns(suffix, path, 4000)
    assert len(open_table(path).labels) == 4000
    _many_columns(suffix, path, 4001)
    with pytest.raises(ValueError, match=r"has 4001 columns; at most 4000 are read: save those that are needed$"):
        open_table(path)


def test_no_row_of_a_table_takes_a_call_of_its_own(tmp_path: Path) -> None:
    path, rows, read = tmp_path / "table.csv", 200_000, []

    def attempt() -> None:
        read.append(Recording.from_csv(path))

    for count in (10, rows):  # the first pays for imports
        path.write_bytes(b'"speed [rpm]";"torque [N.m]"\r\n' + count * b'1,5;"-1,25e-3"\r\n')
        work = calls(attempt)
    assert work < rows / 20
    assert len(read[-1]) == rows
    assert read[-1]["torque"][-1] == -1.25e-3


@pytest.mark.parametrize(
    ("columns", "units", "message"),
    [
        ({"a": "x"}, None, ' has no column "x"; it has speed, torque'),
        ({"a": "speed"}, {"b": "s"}, ': units names "b", which is not read; there are a'),
        ({}, None, ": no column to read"),
        (None, {"b": "s"}, ': units names "b", which is not read; there are speed, torque'),
    ],
)
def test_columns_and_units_that_are_not_there_are_refused(
    tmp_path: Path, columns: dict[str, str] | None, units: dict[str, str] | None, message: str
) -> None:
    path = tmp_path / "table.csv"
    path.write_text("speed [rpm],torque [N.m]\n1,2\n")
    with pytest.raises(ValueError, match=exactly(f"{path}{message}")):
        Recording.from_csv(path, columns, units)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"torque [N.m]\n1\n2\x90\n", " line 3 is not UTF-8: byte 16 is 0x90; if it is no text, save it as CSV"),
        (b"\xff\xfet\0\0\xd8", " line 1 is not complete UTF-16: byte 4 is 0x00; if it is no text, save it as CSV"),
        (
            "torque [N.m]\n1\n".encode("utf-16-le"),
            " holds a zero byte at 1, which no text does; save it as UTF-8, not as UTF-16",
        ),
    ],
)
def test_bytes_that_are_not_utf8_are_refused(tmp_path: Path, data: bytes, message: str) -> None:
    path = tmp_path / "table.csv"
    path.write_bytes(data)
    with pytest.raises(ValueError, match=exactly(f"{path}{message}")):
        Recording.from_csv(path)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_names_and_units_of_spreadsheets_are_read_in_their_encoding(tmp_path: Path, encoding: str) -> None:
    path = tmp_path / "table.csv"
    path.write_bytes("Öltemperatur [°C];Moment [µN.m]\r\n21,5;2\r\n".encode(encoding))
    table = Recording.from_csv(path)
    assert table.names == ("Öltemperatur", "Moment")
    assert table.unit("Öltemperatur") == "degC"
    assert table["Moment"].tolist() == [2.0]


def test_a_file_of_an_unknown_suffix_that_is_not_there_does_not_exist(tmp_path: Path) -> None:
    path = tmp_path / "run.doc"
    with pytest.raises(ValueError, match=exactly(f"{path} does not exist; check its name")):
        Recording.read(path)


@pytest.mark.parametrize("name", ["run.csv", "run.parquet"])
def test_a_file_that_is_not_there_is_refused(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))} cannot be read: .*[Nn]o such file or directory"):
        Recording.read(path)
    path.mkdir()
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))} cannot be read: "):
        Recording.read(path)


def test_an_unknown_suffix_is_refused_with_those_of_all_formats(tmp_path: Path) -> None:
    path = tmp_path / "run.doc"
    path.touch()
    *others, last = [suffix for each in LISTED_FORMATS for suffix in each.suffixes]
    assert {".csv", ".parquet", ".dat", ".mat"} < {*others, last}
    for read in (Recording.read, Recording.header):
        with pytest.raises(ValueError, match=exactly(f'{path}: suffix ".doc" is not known; use {", ".join(others)} or {last}')):
            read(path)


def test_no_suffix_belongs_to_two_formats() -> None:
    assert len(FORMATS) == sum(len(each.suffixes) for each in LISTED_FORMATS)
    assert all(suffix == suffix.lower() and suffix.startswith(".") for suffix in FORMATS)


def test_other_files_that_people_have_are_refused_with_what_to_do(tmp_path: Path) -> None:
    for name in ("log.pkl", "log.xlsx"):
        (tmp_path / name).touch()
    with pytest.raises(ValueError, match=r"a pickle may run any program as it is read: save it as \.npz"):
        Recording.read(tmp_path / "log.pkl")
    with pytest.raises(ValueError, match=r"save the sheet as \.csv$"):
        Recording.read(tmp_path / "log.xlsx")


# Parquet, damaged too


@pytest.mark.parametrize("read", [Recording.from_csv, Recording.from_parquet, Recording.header, Recording.read])
@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_a_name_that_no_file_can_have_is_refused_in_one_line(read: Callable[[Any], object], suffix: str) -> None:
    with pytest.raises(ValueError, match=r"^\S+ cannot be read: [^\n]*surrogates not allowed$"):
        read(f"\ud800.{suffix}")


@pytest.mark.parametrize("read", [Recording.from_csv, Recording.from_parquet, Recording.header, Recording.read])
def test_what_is_no_path_is_refused_in_one_line(read: Callable[[Any], object], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(TypeError, match=r"^[^\n]*not (a|')?Recording'?$"):
        read(Recording({"x": [1.0]}, {"x": "1"}))
    assert capsys.readouterr() == ("", "")


def write_parquet(path: Path, **columns: object) -> None:
    pq.write_table(pa.table(columns), path)


def test_parquet_without_metadata_is_read_by_its_names(tmp_path: Path) -> None:
    path = tmp_path / "run.parquet"
    write_parquet(path, **{"t [s]": pa.array([0, 1]), "motor.speed": pa.array([1.5, 2.5], pa.float32()), "note": ["a", "b"]})
    recording = Recording.read(path, {"speed": "motor.speed", "time": "t"}, {"speed": "rpm"})
    assert recording == Recording({"speed": [1.5, 2.5], "time": [0.0, 1.0]}, {"speed": "rpm", "time": "s"})


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (["a"], ' column "x [1]" holds string, not numbers'),
        ([True], ' column "x [1]" holds bool, not numbers'),
        ([1.0, None], ' row 1, column "x": nan is not finite'),
        (
            [2**60 + 1],
            ' column "x [1]": Integer value 1152921504606846977 not in range: -9007199254740992 to 9007199254740992',
        ),
        (pa.array([], pa.float64()), ': column "x" must be one series of at least one sample; its shape is (0,)'),
    ],
)
def test_faulty_parquet_is_refused(tmp_path: Path, values: list[object], message: str) -> None:
    path = tmp_path / "run.parquet"
    write_parquet(path, **{"x [1]": values})
    with pytest.raises(ValueError, match=exactly(f"{path}{message}")):
        Recording.from_parquet(path)


def test_parquet_metadata_that_is_no_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.parquet"
    pq.write_table(pa.table({"x": [1.0]}, schema=pa.schema([pa.field("x", pa.float64(), metadata={"unit": b"\xff"})])), path)
    for read in (Recording.header, Recording.read):
        with pytest.raises(ValueError, match=f"^{re.escape(str(path))} cannot be read: 'utf-8' codec can't decode byte 0xff"):
            read(path)


def test_parquet_columns_of_one_name_are_refused_and_the_others_read(tmp_path: Path) -> None:
    path = tmp_path / "table.parquet"
    pq.write_table(pa.table([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]], names=["t [s]", "t [s]", "q [rad]"]), path)
    table = open_table(path)
    with pytest.raises(ValueError, match=exactly(f'{path} has 2 columns named "t [s]"; names must differ')):
        table.measured([ColumnSource(0, "t", "t", "s")])
    assert table.measured([ColumnSource(2, "q", "q", "rad")])[0]["q"].tolist() == [5.0, 6.0]


def test_parquet_without_columns_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.parquet"
    write_parquet(path)
    with pytest.raises(ValueError, match=exactly(f"{path}: no column to read")):
        Recording.read(path)


def test_truncated_parquet_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.parquet"
    RUN.to_parquet(path)
    whole = path.read_bytes()
    for length in range(0, len(whole), 13):
        path.write_bytes(whole[:length])
        with pytest.raises(ValueError, match=f"^{re.escape(str(path))} cannot be read: .+$"):
            Recording.from_parquet(path)


@pytest.mark.slow("files")
def test_a_flipped_bit_in_the_data_is_refused_or_harmless(tmp_path: Path) -> None:
    """Without checksums nearly every flip in byte-stream-split data reads back as other numbers."""
    path = tmp_path / "run.parquet"
    recording = Recording({"x": np.random.default_rng(1).normal(size=500)}, {"x": "N.m"})
    recording.to_parquet(path)
    whole = path.read_bytes()
    chunk = pq.ParquetFile(path).metadata.row_group(0).column(0)
    refused = 0
    for position in range(chunk.data_page_offset, chunk.data_page_offset + chunk.total_compressed_size, 5):
        damaged = bytearray(whole)
        damaged[position] ^= 0x10
        path.write_bytes(damaged)
        try:
            assert Recording.from_parquet(path) == recording
        except ValueError:
            refused += 1
    assert refused > 0.95 * chunk.total_compressed_size / 5
