"""Recordings: what is refused, what survives a file bit for bit, and files as other people write them."""

from __future__ import annotations

import math
import os
import pickle
import re
from collections.abc import Callable
from pathlib import Path

import hypothesis.extra.numpy as hnp
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from strainwave.recording import Recording

DATA = Path(os.environ.get("STRAINWAVE_DATA", Path(__file__).parents[2].parent / "shared" / "data"))

EMPTY = "the cell is empty; every cell must hold a number"
UNITS = ["1", "rad", "N.m", "N.m.s/rad", "J/(K.kg)", "degC"]

RUN = Recording(
    {"time": [0.0, 0.5, 1.0, 1.5], "speed": [0.0, 30.0, 60.0, 30.0], "torque": [1.0, 2.0, 3.0, 4.0]},
    {"time": "s", "speed": "rpm", "torque": "N.m"},
    title="a run",
)

# Examples may share one folder; the first of them pays for the imports.
untimed = settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def exactly(message: str) -> str:
    return f"^{re.escape(message)}$"


def bits(recording: Recording) -> list[bytes]:
    return [recording[name].tobytes() for name in recording.names]


@st.composite
def recordings(draw: st.DrawFn) -> Recording:
    """Recordings with any finite numbers, names with any printable characters, with and without time."""
    printable = st.text(min_size=1, max_size=8).filter(lambda text: text.isprintable() and text == text.strip())
    names = draw(st.lists(printable.filter(lambda name: name != "time"), min_size=1, max_size=4, unique=True))
    length = draw(st.integers(1, 5))
    numbers = hnp.arrays(np.float64, length, elements=st.floats(allow_nan=False, allow_infinity=False))
    columns = {name: draw(numbers) for name in names}
    units = {name: draw(st.sampled_from(UNITS)) for name in names}
    if draw(st.booleans()):
        increasing = st.lists(st.floats(-1e9, 1e9), min_size=length, max_size=length, unique=True).map(sorted)
        columns, units = {"time": np.array(draw(increasing)), **columns}, {"time": "ms", **units}
    title = draw(st.one_of(st.just(""), printable))
    return Recording(columns, units, title)


# The value


def test_columns_are_read_in_their_own_and_in_other_units() -> None:
    assert RUN.names == ("time", "speed", "torque")
    assert RUN["speed"].tolist() == [0.0, 30.0, 60.0, 30.0]
    assert RUN.unit("speed") == "rpm"
    np.testing.assert_allclose(RUN.values("speed", "rad/s"), np.pi * np.array([0.0, 1.0, 2.0, 1.0]), rtol=1e-15)
    assert len(RUN) == 4
    assert "speed" in RUN
    assert "twist" not in RUN
    assert repr(RUN) == '<Recording "a run": 4 samples from 0 s to 1.5 s; time [s], speed [rpm], torque [N.m]>'


def test_time_is_in_seconds_whatever_its_unit() -> None:
    assert Recording({"time": [0, 250]}, {"time": "ms"}).time.tolist() == [0.0, 0.25]


def test_units_take_their_standard_spelling() -> None:
    assert Recording({"torque": [1.0]}, {"torque": "N·m"}).unit("torque") == "N.m"


def test_a_recording_cannot_be_changed() -> None:
    source = np.array([1.0, 2.0])
    recording = Recording({"torque": source}, {"torque": "N.m"})
    source[0] = 9.0
    assert recording["torque"].tolist() == [1.0, 2.0]
    with pytest.raises(ValueError, match="read-only"):
        recording["torque"][0] = 9.0
    with pytest.raises(TypeError, match="does not support item assignment"):
        recording.columns["torque"] = source  # type: ignore[index]
    with pytest.raises(AttributeError, match="cannot assign to field"):
        recording.title = "other"  # type: ignore[misc]


def test_what_cannot_change_is_not_copied() -> None:
    frozen = np.arange(10.0)
    frozen.setflags(write=False)
    recording = Recording({"time": frozen}, {"time": "s"})
    assert recording["time"] is frozen
    assert np.shares_memory(recording.between(2.0, 5.0)["time"], frozen)


def test_a_read_only_view_of_what_can_change_is_copied() -> None:
    source = np.arange(3.0)
    view = source[:]
    view.setflags(write=False)
    recording = Recording({"torque": view}, {"torque": "N.m"})
    source[0] = 9.0
    assert recording["torque"][0] == 0.0


def test_select_keeps_the_order_asked_for() -> None:
    chosen = RUN.select(["torque", "time"])
    assert chosen.names == ("torque", "time")
    assert chosen == Recording({"torque": RUN["torque"], "time": RUN["time"]}, {"torque": "N.m", "time": "s"}, "a run")


@given(st.floats(-1.0, 3.0), st.floats(-1.0, 3.0))
def test_between_keeps_the_samples_inside_both_ends_included(start: float, stop: float) -> None:
    inside = (start <= RUN.time) & (stop >= RUN.time)
    if not inside.any():
        with pytest.raises(ValueError, match=r"^no sample between .* s and .* s; time runs from 0 s to 1.5 s$"):
            RUN.between(start, stop)
        return
    part = RUN.between(start, stop)
    assert (part.title, part.units) == (RUN.title, RUN.units)
    for name in RUN.names:
        assert part[name].tolist() == RUN[name][inside].tolist()


def test_with_column_adds_or_replaces() -> None:
    added = RUN.with_column("twist", [0.0, 1.0, 2.0, 3.0], "arcmin")
    assert added.names == ("time", "speed", "torque", "twist")
    assert added.unit("twist") == "arcmin"
    assert added.select(RUN.names) == RUN
    replaced = RUN.with_column("torque", np.zeros(4), "Ncm")
    assert (replaced.names, replaced.unit("torque")) == (RUN.names, "N.cm")


@given(recordings())
def test_equal_means_the_same_in_every_respect(recording: Recording) -> None:
    name = recording.names[-1]
    assert recording == Recording(recording.columns, recording.units, recording.title)
    assert recording != Recording(recording.columns, recording.units, recording.title + "!")
    assert recording != Recording(recording.columns, {**recording.units, name: "A"}, recording.title)
    changed = recording[name].copy()
    changed[-1] = 1.0 if changed[-1] != 1.0 else 2.0
    if name != "time":
        assert recording != recording.with_column(name, changed, recording.unit(name))
    assert recording != 3


@given(recordings())
def test_pickling_keeps_everything(recording: Recording) -> None:
    copy = pickle.loads(pickle.dumps(recording))
    assert copy == recording
    assert bits(copy) == bits(recording)


@pytest.mark.parametrize(
    ("columns", "units", "message"),
    [
        ({}, {}, "a recording needs at least one column"),
        ({"a": [1.0, 2.0], "b": [1.0]}, {"a": "1", "b": "1"}, 'column "b" has 1 samples, column "a" has 2'),
        ({"a": []}, {"a": "1"}, 'column "a" must be one series of at least one sample; its shape is (0,)'),
        ({"a": [[1.0]]}, {"a": "1"}, 'column "a" must be one series of at least one sample; its shape is (1, 1)'),
        ({"a": 1.0}, {"a": "1"}, 'column "a" must be one series of at least one sample; its shape is ()'),
        ({"a": [[1.0], [1.0, 2.0]]}, {"a": "1"}, 'column "a" must be one series of numbers'),
        ({"a": [1.0, np.nan]}, {"a": "1"}, 'column "a" row 1: nan is not finite'),
        ({"a": [np.inf, np.nan]}, {"a": "1"}, 'column "a" row 0: inf is not finite'),
        (
            {"a": np.ma.masked_array([1.0, 2.0], [False, True])},
            {"a": "1"},
            'column "a" has masked values; every one must be a number',
        ),
        ({"a": [1.0]}, {}, 'column "a" has no unit; pass units={"a": "N.m"}, or "1" for a plain number'),
        ({"a": [1.0]}, {"a": "1", "b": "s"}, 'units names "b", which is not a column; there are a'),
        ({"a": [1.0]}, {"a": "xyz"}, 'column "a": unit "xyz" is not known; write it like N.m, rad/s, deg'),
        ({" a": [1.0]}, {" a": "1"}, "column name ' a' must be printable text without spaces around it"),
        ({"a\n": [1.0]}, {"a\n": "1"}, "column name 'a\\n' must be printable text without spaces around it"),
        ({"": [1.0]}, {"": "1"}, "column name '' must be printable text without spaces around it"),
        ({"time": [0.0]}, {"time": "rad"}, 'column "time": cannot convert "rad" to "s"'),
        (
            {"time": [0.0, 0.32, 0.31]},
            {"time": "s"},
            'column "time" row 2: 0.31 s does not lie after 0.32 s; time must increase',
        ),
        (
            {"time": [0, 5, 5]},
            {"time": "ms"},
            'column "time" row 2: 5.0 ms does not lie after 5.0 ms; time must increase',
        ),
    ],
)
def test_what_is_no_recording_is_refused(columns: dict[str, list[float]], units: dict[str, str], message: str) -> None:
    with pytest.raises(ValueError, match=exactly(message)):
        Recording(columns, units)


@pytest.mark.parametrize(("values", "kind"), [(["1.5"], "<U3"), ([True], "bool"), ([1j], "complex128"), ([None], "object")])
def test_what_is_no_number_is_refused(values: list[object], kind: str) -> None:
    with pytest.raises(TypeError, match=exactly(f'column "a" must hold numbers, not {kind}')):
        Recording({"a": values}, {"a": "1"})  # type: ignore[dict-item]


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda: RUN["twist"], 'no column "twist"; there are time, speed, torque'),
        (lambda: RUN.unit("twist"), 'no column "twist"; there are time, speed, torque'),
        (lambda: RUN.select(["twist"]), 'no column "twist"; there are time, speed, torque'),
        (lambda: RUN.values("speed", "N.m"), 'cannot convert "rpm" to "N.m"'),
        (lambda: RUN.select(["torque"]).time, 'no column "time"; there are torque'),
        (lambda: Recording({"a": [1.0]}, {"a": "1"}, "two\nlines"), "title 'two\\nlines' must be one line of text"),
        (lambda: RUN.plot(["twist"]), 'no column "twist"; there are time, speed, torque'),
        (lambda: RUN.select(["time"]).plot(), 'nothing to draw against "time"; there are time'),
    ],
)
def test_what_is_not_there_is_refused(ask: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=exactly(message)):
        ask()


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda: Recording([1.0], {}), 'columns must be a mapping, as in {"time": [0.0, 0.1]}, not [1.0]'),  # type: ignore[arg-type]
        (lambda: Recording({"a": [1.0]}, "s"), """units must be a mapping, as in {"time": "s"}, not 's'"""),  # type: ignore[arg-type]
        (lambda: Recording({"a": [1.0]}, {"a": "1"}, 3), "title must be a text, not 3"),  # type: ignore[arg-type]
        (lambda: RUN.select("time"), "names must be a list of names, not 'time'"),
        (lambda: RUN.plot("time"), "names must be a list of names, not 'time'"),
        (lambda: RUN.between("0", "1"), "start must be a number, not '0'"),  # type: ignore[arg-type]
        (lambda: RUN.between(0.0, None), "stop must be a number, not None"),  # type: ignore[arg-type]
    ],
)
def test_what_is_of_the_wrong_kind_is_refused(ask: Callable[[], object], message: str) -> None:
    with pytest.raises(TypeError, match=exactly(message)):
        ask()


def test_a_stretch_of_time_may_be_without_end_but_not_without_number() -> None:
    assert RUN.between(-math.inf, math.inf) == RUN
    with pytest.raises(ValueError, match=exactly("stop = nan s must lie in [-inf, inf]")):
        RUN.between(0.0, math.nan)


def test_a_file_that_cannot_be_written_is_told_by_its_own_name(tmp_path: Path) -> None:
    with pytest.raises(
        FileNotFoundError, match=f"^{re.escape(str(tmp_path))}/none/run.csv cannot be written: there is no folder"
    ):
        RUN.to_csv(tmp_path / "none" / "run.csv")
    with pytest.raises(IsADirectoryError, match=exactly(f"{tmp_path} cannot be written: it is a folder")):
        RUN.to_csv(tmp_path)


# Files of our own


@untimed
@given(recordings())
def test_csv_keeps_every_bit(tmp_path: Path, recording: Recording) -> None:
    recording.to_csv(tmp_path / "run.csv")
    again = Recording.read(tmp_path / "run.csv")
    assert again == recording
    assert bits(again) == bits(recording)


@untimed
@given(recordings())
def test_parquet_keeps_every_bit(tmp_path: Path, recording: Recording) -> None:
    recording.to_parquet(tmp_path / "run.parquet")
    again = Recording.read(tmp_path / "run.parquet")
    assert again == recording
    assert bits(again) == bits(recording)


def test_a_csv_header_names_column_and_unit(tmp_path: Path) -> None:
    RUN.to_csv(tmp_path / "run.csv")
    assert (tmp_path / "run.csv").read_text().splitlines()[:3] == [
        "# title: a run",
        '"time [s]","speed [rpm]","torque [N.m]"',
        "0,0,1",
    ]


def test_parquet_is_compressed_split_and_labelled(tmp_path: Path) -> None:
    RUN.to_parquet(tmp_path / "run.parquet")
    file = pq.ParquetFile(tmp_path / "run.parquet")
    chunk = file.metadata.row_group(0).column(1)
    assert chunk.compression == "ZSTD"
    assert "BYTE_STREAM_SPLIT" in chunk.encodings
    assert file.schema_arrow.field("speed").metadata[b"unit"] == b"rpm"
    assert file.schema_arrow.metadata[b"title"] == b"a run"


@pytest.mark.parametrize(("method", "writer"), [("to_csv", "pyarrow.csv"), ("to_parquet", "pyarrow.parquet")])
def test_a_write_that_fails_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, method: str, writer: str
) -> None:
    def fail(_: pa.Table, file: object, **__: object) -> None:
        if isinstance(file, Path):
            file.write_text("half")
        raise OSError("disk full")

    path = tmp_path / "run"
    path.write_text("old")
    monkeypatch.setattr(f"{writer}.write_{method.removeprefix('to_').replace('parquet', 'table')}", fail)
    with pytest.raises(OSError, match="disk full"):
        getattr(RUN, method)(path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


# Tables of other people


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


# Parquet of other people, and damaged


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


# Drawing


def test_a_plot_has_one_subplot_for_each_unit() -> None:
    run = RUN.with_column("load", [0.0, 0.0, 1.0, 1.0], "N.m")
    speed, torque = run.plot().axes
    assert (speed.get_ylabel(), torque.get_ylabel()) == ("speed [rpm]", "[N.m]")
    assert torque.get_xlabel() == "time [s]"
    assert torque.get_legend_handles_labels()[1] == ["torque", "load"]
    assert torque.get_legend() is not None
    assert np.array_equal(torque.lines[0].get_ydata(), RUN["torque"])
    assert speed.get_shared_x_axes().joined(speed, torque)


def test_a_plot_against_another_column() -> None:
    (axis,) = RUN.plot(["torque"], against="speed").axes
    assert axis.get_xlabel() == "speed [rpm]"
    assert np.array_equal(axis.lines[0].get_xdata(), RUN["speed"])


@untimed
@given(st.integers(20_001, 200_003), st.data())
def test_a_long_plot_keeps_single_peaks_and_both_ends(samples: int, data: st.DataObject) -> None:
    peak, valley = data.draw(st.lists(st.integers(0, samples - 1), min_size=2, max_size=2, unique=True))
    values = np.zeros(samples)
    values[peak], values[valley] = 1.0, -1.0
    time = np.arange(samples) * 1e-3
    (line,) = Recording({"time": time, "torque": values}, {"time": "s", "torque": "N.m"}).plot().axes[0].lines
    x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    assert len(x) <= 20_100
    assert np.all(np.diff(x) > 0.0)
    assert (x[0], x[-1]) == (time[0], time[-1])
    assert (x[np.argmax(y)], x[np.argmin(y)]) == (time[peak], time[valley])


def test_a_short_plot_draws_every_sample() -> None:
    time = np.arange(20_000.0)
    (line,) = Recording({"time": time, "a": time}, {"time": "s", "a": "1"}).plot().axes[0].lines
    assert len(np.asarray(line.get_xdata())) == 20_000


# Measured by others


def measured(name: str) -> Path:
    path = DATA / name
    if not path.exists():
        pytest.skip(f"measured data {path} is absent; set STRAINWAVE_DATA to the folder that holds it")
    return path


def test_the_robot_arm_table_is_refused_where_its_logger_dropped_out_and_read_without(tmp_path: Path) -> None:
    """Semicolons, decimal commas, text and nameless columns beside the numbers, 54 rows without: UCI 963."""
    path = measured("cobot-temperature/dataset_02052023.csv")
    columns, units = {"current": "Current_J2", "temperature": "Temperature_J2"}, {"current": "A", "temperature": "°C"}
    with pytest.raises(ValueError, match=exactly(f'{path} line 815, column "Current_J2": {EMPTY}')):
        Recording.read(path, columns, units)
    with pytest.raises(ValueError, match=r"column 25 has no name; name it, or pick columns with columns="):
        Recording.read(path)
    complete = [line for line in path.read_text().splitlines() if ";;;;;;;;;;;;;" not in line]
    (tmp_path / "complete.csv").write_text("\n".join(complete))
    recording = Recording.read(tmp_path / "complete.csv", columns, units)
    assert len(recording) == 7409 - 54
    assert (recording["current"][0], recording["temperature"][0]) == (-1.531441569, 29.375)
    assert (recording["current"][-1], recording["temperature"][-1]) == (-1.098950386, 40.6875)
    assert recording.values("temperature", "K")[0] == 302.525


def test_the_locked_torque_tables_are_refused_as_time_series_for_their_repeated_stamps() -> None:
    path = measured("locked-torque/Gearbox_1_super_tightened_spline_260705_0.7_A.csv")
    units = {"stamp": "s", "torque": "N.m"}
    recording = Recording.read(path, {"stamp": "time_s", "torque": "torque_Nm"}, units)
    reference = np.loadtxt(path, delimiter=",", skiprows=1)
    assert np.array_equal(recording["stamp"], reference[:, 0])
    assert np.array_equal(recording["torque"], reference[:, 1])
    reason = "0.0783 s does not lie after 0.0783 s; time must increase"
    with pytest.raises(ValueError, match=exactly(f'{path} line 10, column "time_s": {reason}')):
        Recording.read(path, {"time": "time_s"}, {"time": "s"})
    with pytest.raises(ValueError, match=r'column "time_s" has no unit; write it behind the name'):
        Recording.read(path)
