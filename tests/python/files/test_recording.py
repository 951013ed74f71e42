"""Recordings: what is refused, and what survives a file bit for bit."""

from __future__ import annotations

import math
import os
import pickle
import re
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import BinaryIO

import hypothesis.extra.numpy as hnp
import numpy as np
import pandas
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from matplotlib.text import Text
from strainwave.files.recording import Recording

DATA = Path(os.environ.get("STRAINWAVE_DATA", Path(__file__).parents[3].parent / "shared" / "data"))

EMPTY = "the cell is empty; every cell must hold a number"
UNITS = ["1", "rad", "N.m", "N.m.s/rad", "J/(K.kg)", "degC"]

RUN = Recording(
    {"time": [0.0, 0.5, 1.0, 1.5], "speed": [0.0, 30.0, 60.0, 30.0], "torque": [1.0, 2.0, 3.0, 4.0]},
    {"time": "s", "speed": "rpm", "torque": "N.m"},
    title="a run",
)

# Examples may share one folder; the first of them pays for the imports.
untimed = settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def check_told(error: ValueError) -> None:
    """The message is one short line."""
    assert str(error).isprintable()
    assert len(str(error)) < 300


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
        columns, units = {"time": np.array(draw(increasing)), **columns}, {"time": "s", **units}
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
    assert repr(RUN) == '<Recording: "a run": 4 samples from 0 s to 1.5 s; time [s], speed [rpm], torque [N.m]>'


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


@pytest.mark.slow("files")
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
            {"time": [0.0, 5e-324]},
            {"time": "ms"},
            'column "time" row 1: 5e-324 ms does not lie after 0.0 ms in seconds; time must increase',
        ),
        ({"time": [0.0, 1e308]}, {"time": "h"}, 'column "time" row 1: 1e+308 h is too large a number in s'),
        ({1000 * "a": [np.nan]}, {1000 * "a": "1"}, f'column "{60 * "a"}…" row 0: nan is not finite'),
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
        (lambda: RUN.values("speed", "N.m"), 'column "speed": cannot convert "rpm" to "N.m"'),
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
        (lambda: RUN.plot(against=True), "against must be a text, not True"),
        (lambda: Recording([1.0], {}), 'columns must be a mapping, as in {"time": [0.0, 0.1]}, not [1.0]'),  # type: ignore[arg-type]
        (lambda: Recording({"a": [1.0]}, "s"), """units must be a mapping, as in {"time": "s"}, not 's'"""),  # type: ignore[arg-type]
        (lambda: Recording({"a": [1.0]}, {"a": "1"}, 3), "title must be a text, not 3"),  # type: ignore[arg-type]
        (lambda: RUN[[1]], "the name of a column must be a text, not [1]"),  # type: ignore[index]
        (lambda: RUN.with_column([1], RUN["time"], "s"), "the name of a column must be a text, not [1]"),  # type: ignore[arg-type]
        (lambda: RUN.select("time"), "names must be a list of names, not 'time'"),
        (lambda: RUN.plot("time"), "names must be a list of names, not 'time'"),
        (lambda: RUN.between([0], 1), "start must be a number, not [0]"),  # type: ignore[arg-type]
        (lambda: RUN.between(0.0, None), "stop must be a number, not None"),  # type: ignore[arg-type]
    ],
)
def test_what_is_of_the_wrong_kind_is_refused(ask: Callable[[], object], message: str) -> None:
    with pytest.raises(TypeError, match=exactly(message)):
        ask()


def test_what_is_no_name_is_in_no_recording() -> None:
    assert "time" in RUN
    assert [1] not in RUN


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


numbers = st.floats(allow_nan=False, allow_infinity=False)


@untimed
@given(st.lists(numbers, min_size=2, max_size=2), st.lists(numbers, min_size=2, max_size=2), st.sampled_from(["s", "us", "h"]))
def test_numbers_of_any_size_are_taken_or_refused(times: list[float], values: list[float], unit: str) -> None:
    """What is taken has a time in seconds that increases, can be shown and cut, and is converted or refused."""
    try:
        recording = Recording({"time": times, "speed": values}, {"time": unit, "speed": "rpm"})
    except ValueError as error:
        check_told(error)
        return
    assert recording.time[0] < recording.time[1]
    assert recording.between(*recording.time) == recording
    assert "2 samples" in repr(recording)
    try:
        degrees = recording.values("speed", "deg/s")
    except ValueError as error:
        check_told(error)
        return
    np.testing.assert_allclose(degrees / 6.0, values, rtol=1e-15, atol=1e-323)


def test_a_plot_reaches_as_far_as_axes_do(tmp_path: Path) -> None:
    widest = Recording({"time": [-1e300, 1e300], "speed": [1e300, -1e300]}, {"time": "s", "speed": "rpm"})
    widest.plot().savefig(tmp_path / "widest.svg")
    for name in ("time", "speed"):
        wider = widest.with_column(name, [-1.0, 1e301], widest.unit(name))
        beyond = f'column "{name}" cannot be drawn: it reaches 1e+301; at most 1e+300 can be drawn'
        with pytest.raises(ValueError, match=exactly(beyond)):
            wider.plot()


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
    def fail(_: pa.Table, file: BinaryIO, **__: object) -> None:
        file.write(b"half")
        raise OSError("disk full")

    path = tmp_path / "run"
    path.write_text("old")
    monkeypatch.setattr(f"{writer}.write_{method.removeprefix('to_').replace('parquet', 'table')}", fail)
    with pytest.raises(OSError, match="disk full"):
        getattr(RUN, method)(path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


# Drawing


def test_a_plot_has_one_subplot_for_each_unit() -> None:
    run = RUN.with_column("load", [0.0, 0.0, 1.0, 1.0], "N.m")
    speed, torque = run.plot().axes
    assert (speed.get_title(loc="left"), torque.get_title(loc="left")) == ("speed [rpm]", "[N·m]")
    assert torque.get_xlabel() == "time [s]"
    assert torque.get_legend_handles_labels()[1] == ["torque", "load"]
    assert torque.get_legend() is not None
    assert np.array_equal(torque.lines[0].get_ydata(), RUN["torque"])
    assert speed.get_shared_x_axes().joined(speed, torque)


def test_a_curve_that_would_be_flat_beside_a_larger_one_has_a_panel_of_its_own() -> None:
    sizes = {"command": 1.0, "input_angle": 100.0, "output_angle": 5.0, "twist": 0.04}
    columns = {"time": [0.0, 1.0], **{name: [0.0, -size] for name, size in sizes.items()}}
    figure = Recording(columns, dict.fromkeys(sizes, "rad") | {"time": "s"}).plot()
    panels = [[str(line.get_label()) for line in axis.lines] for axis in figure.axes]
    assert panels == [["command"], ["input angle", "output angle"], ["twist"]]
    assert [axis.get_title(loc="left") for axis in figure.axes] == ["command [rad]", "[rad]", "twist [mrad]"]


def test_what_a_picture_says_of_names_is_no_mathematics() -> None:
    recording = Recording({"time": [0.0, 1.0], "a$b$": [0.0, 1.0]}, {"time": "s", "a$b$": "1"}, title="$x^2$")
    figure = recording.plot()
    figure.savefig(BytesIO(), format="svg")
    assert (figure.get_suptitle(), figure.axes[0].get_title(loc="left")) == ("$x^2$", "a$b$")
    assert not any(text.get_parse_math() for text in figure.findobj(Text) if isinstance(text, Text) and "$" in text.get_text())


def test_a_plot_leaves_out_what_does_not_change_but_for_rounding() -> None:
    columns = {"time": [0.0, 1.0], "torque": [0.0, 5.0], "rounding": [0.0, 1e-9], "constant": [3.0, 3.0], "power": [0.0, 1e-9]}
    units = {"time": "s", "torque": "N.m", "rounding": "N.m", "constant": "N.m", "power": "W"}
    assert [axis.get_title(loc="left") for axis in Recording(columns, units).plot().axes] == ["torque [N·m]", "power [nW]"]
    still = Recording({"time": [0.0, 1.0], "constant": [3.0, 3.0]}, {"time": "s", "constant": "N.m"})
    assert [axis.get_title(loc="left") for axis in still.plot().axes] == ["constant [N·m]"]


def test_a_plot_against_another_column() -> None:
    (axis,) = RUN.plot(["torque"], against="speed").axes
    assert axis.get_xlabel() == "speed [rpm]"
    assert np.array_equal(axis.lines[0].get_xdata(), RUN["speed"])


def test_the_title_of_a_plot_is_that_of_the_recording_or_names_its_columns() -> None:
    columns = {"time": [0.0, 1.0], "output_angle": [0.0, 1.0], "torque": [0.0, 1.0]}
    units = {"time": "s", "output_angle": "rad", "torque": "N.m"}
    assert Recording(columns, units, title="joint 3").plot().get_suptitle() == "joint 3"
    for title in ("", "simulation: explicit steps of 0.1 s"):
        assert Recording(columns, units, title=title).plot().get_suptitle() == "Output angle and torque over time"
    many = {"time": [0.0, 1.0], **{f"column_{k}": [0.0, 1.0] for k in range(6)}}
    title = Recording(many, dict.fromkeys(many, "s")).plot().get_suptitle()
    assert " ".join(title.split()) == "Column 0, column 1, column 2 and 3 more columns over time"


@pytest.mark.slow("files")
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


def test_a_recording_is_taken_by_dict_and_pandas() -> None:
    import pandas

    run = Recording({"time": [0.0, 0.1], "motor speed": [1.0, 2.0]}, {"time": "s", "motor speed": "rad/s"})
    assert {name: values.tolist() for name, values in dict(run).items()} == {"time": [0.0, 0.1], "motor speed": [1.0, 2.0]}
    frame = run.to_frame()
    assert frame.attrs["units"] == run.units
    pandas.testing.assert_frame_equal(pandas.DataFrame(run), frame, check_exact=True)
    assert list(run) == [(0.0, 1.0), (0.1, 2.0)]
    assert len(list(run)) == len(run)


def test_a_table_of_pandas_is_a_recording(tmp_path: Path) -> None:
    columns = {"time": [0.0, 0.1], "torque": [1.0, 2.0]}
    made = Recording(columns, {"time": "s", "torque": "N.m"})
    frame = pandas.DataFrame(columns)
    assert Recording(frame, made.units) == Recording(made.to_frame()) == made
    assert Recording(frame.rename(columns={"time": "time [s]", "torque": "torque (N.m)"})) == made
    with pytest.raises(ValueError, match='column "torque" has no unit'):
        Recording(frame.rename(columns={"time": "time [s]"}))
    with pytest.raises(TypeError, match="units must be given"):
        Recording(columns)
