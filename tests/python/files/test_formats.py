"""MAT, MDF and bags of ROS: what programs write into them is read back."""

from __future__ import annotations

import re
import struct
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from hypothesis.extra.numpy import arrays
from strainwave import Recording
from strainwave.files.labels import ColumnSource
from strainwave.files.matlab_table import open_mat
from strainwave.files.tables import open_table
from strainwave.identification.reading.source import measurement_files

asammdf = pytest.importorskip("asammdf")
h5py = pytest.importorskip("h5py")
pytest.importorskip("rosbags")

from rosbags.rosbag1 import Writer as Writer1  # noqa: E402
from rosbags.rosbag2 import StoragePlugin, Writer  # noqa: E402
from rosbags.typesys import Stores, get_typestore  # noqa: E402
from scipy.io import savemat  # noqa: E402

FOLDER = settings(deadline=None, max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
TIME = np.arange(50) * 0.01
numbers = arrays(np.float64, (7, 3), elements=st.floats(-1e6, 1e6))


def exactly(message: str) -> str:
    return f"^{re.escape(message)}$"


def sources(path: Path, names: Sequence[str]) -> list[ColumnSource]:
    labels = [label.name for label in open_table(path).labels]
    return [ColumnSource(labels.index(name), name, name, "1") for name in names]


def read(path: Path, *names: str) -> tuple[list[list[float]], list[str]]:
    columns, remarks = open_table(path).measured(sources(path, names))
    return [columns[name].tolist() for name in names], remarks


# MAT


def save_hdf5(path: Path, variables: dict[str, Any]) -> None:
    """As MATLAB does for version 7.3: transposed, a structure as a group."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in variables.items():
            if isinstance(value, dict):
                for key, each in value.items():
                    file.create_dataset(f"{name}/{key}", data=np.atleast_2d(each).T)
            else:
                file[name] = np.atleast_2d(value).T
    whole = bytearray(path.read_bytes())
    whole[:116] = b"MATLAB 7.3 MAT-file, written by a test".ljust(116)
    whole[116:128] = bytes(8) + b"\x00\x02IM"
    path.write_bytes(whole)


@FOLDER
@given(numbers, st.sampled_from(["4", "5", "compressed", "7.3"]), st.booleans())
def test_variables_of_a_mat_file_are_read_back(tmp_path: Path, values: Any, version: str, row: bool) -> None:
    shape = (1, -1) if row else (-1, 1)
    variables = {"t": values[:, 0].reshape(shape), "q": values[:, 1].reshape(shape), "tau": values[:, 2].reshape(shape)}
    path = tmp_path / "log.mat"
    if version == "7.3":
        save_hdf5(path, variables)
    else:
        savemat(path, variables, format=version[:1] if version == "4" else "5", do_compression=version == "compressed")
    assert np.array_equal(read(path, "t", "q", "tau")[0], values.T)


@pytest.mark.parametrize("save", [savemat, save_hdf5])
def test_structures_matrices_and_what_does_not_fit(tmp_path: Path, save: Any) -> None:
    path = tmp_path / "log.mat"
    matrix = np.arange(30.0).reshape(10, 3)
    save(path, {"data": {"t": np.arange(10.0), "q": matrix}, "kp": 160.18, "short": np.arange(4.0)})
    assert {label.name for label in open_table(path).labels} == {"data.t", "data.q_1", "data.q_2", "data.q_3"}
    values, remarks = read(path, "data.t", "data.q_2")
    assert values == [np.arange(10.0).tolist(), matrix[:, 1].tolist()]
    assert remarks == ["of another length than 10, and left out: short (4)"]
    assert open_mat(path).singles == {"kp": 160.18}


def test_a_mat_file_is_a_recording_where_units_are_given(tmp_path: Path) -> None:
    path = tmp_path / "log.mat"
    savemat(path, {"t": TIME, "q": np.sin(TIME)})
    assert Recording.read(path, {"time": "t", "angle": "q"}, {"time": "s", "angle": "rad"}).time.tolist() == TIME.tolist()


def structures(values: list[dict[str, Any]]) -> Any:
    """A row of structures, as MATLAB has it."""
    found = np.empty((1, len(values)), [(name, "O") for name in values[0]])
    for place, each in enumerate(values):
        found[0, place] = tuple(each.values())
    return found


def test_structures_of_structures_cells_and_scopes(tmp_path: Path) -> None:
    runs = [{"t": TIME[:count], "q": np.sin(TIME[:count])} for count in (20, 50, 50)]
    cells = np.empty((1, 3), object)
    cells[0] = runs
    for name, variable in (("runs", structures(runs)), ("runs", cells)):
        savemat(tmp_path / "log.mat", {name: variable})
        values, remarks = read(tmp_path / "log.mat", "runs.t", "runs.q")
        assert values == [TIME.tolist(), np.sin(TIME).tolist()]
        told = "runs holds 3 recordings, of which number 2 is taken, the first of the longest; save each in a file of its own"
        assert remarks == [told]
        each = measurement_files([tmp_path / "log.mat"]).files
        assert [file.path.name for file in each] == ["log.mat(1)", "log.mat(2)", "log.mat(3)"]
        assert [len(file.table.numbers([ColumnSource(0, "t", "t", "s")])["t"]) for file in each] == [20, 50, 50]
    savemat(tmp_path / "log.mat", {"data": {"joint2": {"meas": {"q": TIME}}, "t": TIME}})
    assert read(tmp_path / "log.mat", "data.joint2.meas.q", "data.t")[0] == [TIME.tolist()] * 2
    signals = structures([{"values": np.sin(TIME), "label": "q"}, {"values": np.cos(TIME), "label": "tau"}])
    savemat(
        tmp_path / "log.mat",
        {"ScopeData": {"time": TIME, "signals": signals}, "i": {"time": TIME, "signals": {"values": TIME}}},
    )
    labels = [label.name for label in open_table(tmp_path / "log.mat").labels]
    assert labels == ["ScopeData.time", "q", "tau", "i.time", "i"]


def test_groups_of_groups_texts_and_objects_of_version_7_3(tmp_path: Path) -> None:
    path = tmp_path / "log.h5"
    with h5py.File(path, "w") as file:
        file["robot/arm/time"], file["robot/arm/q"] = TIME, np.sin(TIME)
        file["note"] = np.frombuffer(b"arm", np.uint8).astype(np.uint16)
        file["note"].attrs["MATLAB_class"] = np.bytes_("char")
        file["table"] = np.arange(6, dtype=np.uint32)
        file["table"].attrs.update(MATLAB_class=np.bytes_("timetable"), MATLAB_object_decode=3)
        file["#refs#/a"], file["#refs#/b"] = TIME, np.cos(TIME)
        references = np.array([file["#refs#/a"].ref, file["#refs#/b"].ref], h5py.ref_dtype)
        file.create_dataset("cells", data=references)
    values, remarks = read(path, "robot.arm.time", "robot.arm.q", "cells_2")
    assert values == [TIME.tolist(), np.sin(TIME).tolist(), np.cos(TIME).tolist()]
    (told,) = remarks
    assert told.startswith(
        "table is left out: an object of MATLAB (timetable), which MATLAB alone reads: save its numbers instead"
    )


def element(kind: int, content: bytes) -> bytes:
    """Of a MAT file of version 5, with its tag."""
    return struct.pack("<2I", kind, len(content)) + content.ljust(-(-len(content) // 8) * 8, b"\0")


def test_a_mat_file_of_an_object_says_what_to_do(tmp_path: Path) -> None:
    """An object of class timeseries, as MATLAB's description of the format of version 5 has it (classes 17 and 13)."""
    numbers = [
        element(6, struct.pack("<2I", 13, 0)),
        element(5, struct.pack("<2i", 1, 1)),
        element(1, b""),
        element(6, bytes(4)),
    ]
    texts = [element(1, text) for text in (b"log", b"MCOS", b"timeseries")]
    whole = [element(6, struct.pack("<2I", 17, 0)), *texts, element(14, b"".join(numbers))]
    head = b"MATLAB 5.0 MAT-file, written by a test".ljust(124) + b"\x00\x01IM"
    (tmp_path / "log.mat").write_bytes(head + element(14, b"".join(whole)))
    told = r"holds no series of numbers; log is left out: an object of MATLAB \(timeseries\), .* save its numbers instead"
    with pytest.raises(ValueError, match=told):
        open_table(tmp_path / "log.mat")


@pytest.mark.parametrize("content", [b"", b"MATLAB 5.0 MAT-file", b"x" * 500])
def test_a_damaged_mat_file_is_refused_in_one_line(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "log.mat"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=rf"^{re.escape(str(path))} (cannot be read: [^\n]+|holds no series of numbers)$"):
        open_table(path)


# MDF


def save_mdf(path: Path, *groups: dict[str, tuple[Any, str]], times: Sequence[Any]) -> None:
    with asammdf.MDF(version="4.10") as file:
        for time, group in zip(times, groups, strict=True):
            file.append([asammdf.Signal(values, time, name=name, unit=unit) for name, (values, unit) in group.items()])
        file.save(path, overwrite=True)


@FOLDER
@given(numbers)
def test_channels_of_an_mdf_file_are_read_back_with_their_units(tmp_path: Path, values: Any) -> None:
    path = tmp_path / "log.mf4"
    save_mdf(path, {"q": (values[:, 0], "deg"), "i": (values[:, 1], "A")}, times=[np.arange(7) * 0.1])
    recording = Recording.read(path)
    assert recording.units == {"time": "s", "q": "deg", "i": "A"}
    assert (recording["q"].tolist(), recording["i"].tolist()) == (values[:, 0].tolist(), values[:, 1].tolist())


def test_channels_sampled_at_other_instants_are_put_on_the_slowest(tmp_path: Path) -> None:
    path = tmp_path / "log.mf4"
    fast, warm = np.arange(400) * 0.0013, np.array([0.0, 1.0])
    save_mdf(
        path,
        {"current": (3.0 * fast + 1.0, "A")},
        {"link_angle": (np.sin(TIME), "rad")},
        {"temperature": (20.0 + warm, "degC")},
        times=[fast, TIME, warm],
    )
    with pytest.raises(ValueError, match=r'"current" and "link_angle" were sampled at other instants; read them one by one$'):
        Recording.read(path)
    opened = open_table(path)
    units = {"time": "s", "current": "A", "link_angle": "rad", "temperature": "degC"}
    wanted = [ColumnSource(i, label.name, label.name, units[label.name]) for i, label in enumerate(opened.labels)]
    columns, remarks = opened.measured(wanted)
    assert columns["time"].tolist() == TIME.tolist()
    assert columns["current"] == pytest.approx(3.0 * TIME + 1.0)  # a straight line is interpolated exactly
    assert columns["temperature"] == pytest.approx(20.0 + TIME)
    assert remarks == [
        "sampled at other instants, and put on the 100 Hz of the others by linear interpolation: current, temperature"
    ]


def test_what_is_no_mdf_file_is_refused_in_one_line(tmp_path: Path) -> None:
    path = tmp_path / "log.mf4"
    path.write_bytes(b"MDF     but not really")
    with pytest.raises(ValueError, match=rf"^{re.escape(str(path))} cannot be read: [^\n]+$"):
        open_table(path)


# Bags


def joint_states(store: Any, time: Any, angles: Any) -> list[tuple[int, Any]]:
    kinds = store.types
    stamp, header = kinds["builtin_interfaces/msg/Time"], kinds["std_msgs/msg/Header"]
    extra = {"seq": 0} if "seq" in header.__dataclass_fields__ else {}
    found = []
    for at, angle in zip((time * 1e9).astype(int).tolist(), angles.tolist(), strict=True):
        when = header(stamp=stamp(sec=1_700_000_000 + at // 10**9, nanosec=at % 10**9), frame_id="", **extra)
        series = [np.array([angle, 2.0 * angle]), np.array([0.5, 0.25]), np.array([])]
        found.append((at, kinds["sensor_msgs/msg/JointState"](when, ["hip", "knee"], *series)))
    return found


def save_bag(path: Path, version: str, time: Any, angles: Any) -> Path:
    if version == "rosbag":
        store = get_typestore(Stores.ROS1_NOETIC)
        with Writer1(path) as bag:
            topic = bag.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=store)
            for at, message in joint_states(store, time, angles):
                bag.write(topic, at, store.serialize_ros1(message, "sensor_msgs/msg/JointState"))
        return path
    store = get_typestore(Stores.ROS2_HUMBLE)
    plugin = StoragePlugin.MCAP if version == "mcap" else StoragePlugin.SQLITE3
    with Writer(path, version=9, storage_plugin=plugin) as bag:
        topic = bag.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=store)
        for at, message in joint_states(store, time, angles):
            bag.write(topic, at, store.serialize_cdr(message, "sensor_msgs/msg/JointState"))
    return path


@pytest.mark.parametrize("version", ["rosbag", "folder", "db3", "mcap"])
def test_joint_states_of_a_bag_are_read_back(tmp_path: Path, version: str) -> None:
    path = save_bag(tmp_path / ("run.bag" if version == "rosbag" else "run"), version, TIME, np.sin(TIME))
    if version in ("mcap", "db3"):
        (path,) = path.glob(f"*.{version}")
    assert [label.name for label in open_table(path).labels] == [
        "time", "hip.position", "knee.position", "hip.velocity", "knee.velocity",
    ]  # fmt: skip
    recording = Recording.read(path)
    assert recording.time == pytest.approx(TIME, abs=2e-9)
    assert recording["knee.position"].tolist() == (2.0 * np.sin(TIME)).tolist()
    assert recording.unit("knee.velocity") == "rad/s"


def test_what_is_no_bag_is_refused_in_one_line(tmp_path: Path) -> None:
    for suffix in ("bag", "mcap", "db3"):
        path = tmp_path / f"run.{suffix}"
        path.write_bytes(b"no bag")
        with pytest.raises(ValueError, match=rf"^{re.escape(str(path))} (cannot be read: [^\n]+|holds no series of numbers)$"):
            open_table(path)


def test_a_format_whose_package_is_missing_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.mat"
    save_hdf5(path, {"t": TIME})
    for module in [each for each in sys.modules if each.split(".")[0] == "h5py"]:
        monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(ImportError, match=r"h5py: pip install 'strainwave\[formats\]'$"):
        open_table(path)
