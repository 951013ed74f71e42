"""Tables as other people write them, as text and as Parquet: read, or refused with the place of the fault."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strainwave.recording import Recording

from tests.python.test_recording import EMPTY, RUN, exactly, untimed

# Text


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
    with pytest.raises(ValueError, match=exactly(f'{path} column "torque" is in "Nm", but units says "N.cm"')):
        Recording.from_csv(path, units={"torque": "N.cm"})


def test_a_unit_that_is_not_known_is_told_by_the_reader(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text("n [U/min]\n60\n")
    with pytest.raises(
        ValueError, match=exactly(f'{path} column "n": unit "U/min" is not known; write it like N.m, rad/s, deg')
    ):
        Recording.from_csv(path)
    assert Recording.from_csv(path, units={"n": "rpm"}) == Recording({"n": [60.0]}, {"n": "rpm"})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", " is empty"),
        ("\n# nothing\n\n", " is empty"),
        ("time [s],torque [N.m]\n", " has a header but no rows"),
        ("# c\n0.0,1.0\n", " line 2 holds numbers; it must name each column and its unit, as in torque [N.m]"),
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
        (
            "torque\n1\n",
            ' column "torque" has no unit; write it behind the name, as in torque [N.m], '
            'or give it apart as units={"torque": …}',
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
        ('a [1],b [1]\n1,"2\n', " line 2: unexpected end of data"),
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
        (b"torque [N.m]\n1\n2\xb0\n", " line 3 is not UTF-8: byte 16 is 0xb0"),
        ("torque [N.m]\n1\n".encode("utf-16"), " line 1 is not UTF-8: byte 0 is 0xff"),
    ],
)
def test_bytes_that_are_not_utf8_are_refused(tmp_path: Path, data: bytes, message: str) -> None:
    path = tmp_path / "table.csv"
    path.write_bytes(data)
    with pytest.raises(ValueError, match=exactly(f"{path}{message}")):
        Recording.from_csv(path)


@pytest.mark.parametrize("name", ["run.csv", "run.parquet"])
def test_a_file_that_is_not_there_is_refused(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))} cannot be read: .*[Nn]o such file or directory"):
        Recording.read(path)
    path.mkdir()
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))} cannot be read: "):
        Recording.read(path)


def test_an_unknown_suffix_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.xlsx"
    with pytest.raises(ValueError, match=exactly(f'{path}: suffix ".xlsx" is not known; use .csv, .txt, .tsv or .parquet')):
        Recording.read(path)


# Parquet, damaged too


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


def test_truncated_parquet_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.parquet"
    RUN.to_parquet(path)
    whole = path.read_bytes()
    for length in range(0, len(whole), 13):
        path.write_bytes(whole[:length])
        with pytest.raises(ValueError, match=f"^{re.escape(str(path))} cannot be read: .+$"):
            Recording.from_parquet(path)


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
