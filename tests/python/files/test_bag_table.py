"""Bags of ROS: whatever packs them they are read back; other files are not opened, and nothing expands without a bound."""

from __future__ import annotations

import bz2
import re
import sqlite3
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pytest
from strainwave.files.array_table import GridTable
from strainwave.files.bag_table import open_bag

from tests.python.files.test_formats import joint_states, save_bag

pytest.importorskip("rosbags")

from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

TIME = np.arange(30) * 0.01
JOINTS = "sensor_msgs/msg/JointState"


def columns(table: GridTable) -> dict[str, list[float]]:
    return {name: values.tolist() for grid in table.grids for name, values in grid.columns.items()}


def refused(path: Path, reason: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))}[^\n]*{reason}[^\n]*$"):
        open_bag(path)


@pytest.mark.parametrize(
    ("mode", "plugin"),
    [
        (CompressionMode.FILE, StoragePlugin.MCAP),
        (CompressionMode.FILE, StoragePlugin.SQLITE3),
        (CompressionMode.MESSAGE, StoragePlugin.MCAP),
        (CompressionMode.MESSAGE, StoragePlugin.SQLITE3),
        (CompressionMode.STORAGE, StoragePlugin.MCAP),
    ],
)
def test_packed_bags_of_version_2_are_read_back(tmp_path: Path, mode: Any, plugin: Any) -> None:
    store = get_typestore(Stores.ROS2_HUMBLE)
    bag = Writer(tmp_path / "run", version=9, storage_plugin=plugin)
    bag.set_compression(mode, CompressionFormat.ZSTD)
    with bag:
        joints = bag.add_connection("/joint_states", JOINTS, typestore=store)
        number = bag.add_connection("/arm/load", "std_msgs/msg/Int32", typestore=store)
        for at, message in joint_states(store, TIME, np.sin(TIME)):
            bag.write(joints, at, store.serialize_cdr(message, JOINTS))
            content = store.types["std_msgs/msg/Int32"](data=at // 10**6)
            bag.write(number, at, store.serialize_cdr(content, "std_msgs/msg/Int32"))
    found = columns(open_bag(tmp_path / "run"))
    assert found["hip.position"] == np.sin(TIME).tolist()
    assert found["arm.load"] == np.arange(0.0, 300.0, 10.0).tolist()


@pytest.mark.parametrize("packing", list(Writer1.CompressionFormat))
def test_packed_bags_of_version_1_are_read_back(tmp_path: Path, packing: Any) -> None:
    store = get_typestore(Stores.ROS1_NOETIC)
    bag = Writer1(tmp_path / "run.bag")
    bag.set_compression(packing)
    with bag:
        joints = bag.add_connection("/joint_states", JOINTS, typestore=store)
        for at, message in joint_states(store, TIME, np.sin(TIME)):
            bag.write(joints, at, store.serialize_ros1(message, JOINTS))
    assert columns(open_bag(tmp_path / "run.bag"))["hip.position"] == np.sin(TIME).tolist()


# Other files


@pytest.mark.parametrize("name", ["../secret/run.mcap", "/etc/passwd", "..", "link.mcap"])
def test_a_folder_names_only_files_of_its_own(tmp_path: Path, name: str) -> None:
    save_bag(tmp_path / "secret", "mcap", TIME, np.sin(TIME))
    save_bag(tmp_path / "run", "mcap", TIME, np.sin(TIME))
    (tmp_path / "run" / "link.mcap").symlink_to(next((tmp_path / "secret").glob("*.mcap")))
    metadata = tmp_path / "run" / "metadata.yaml"
    metadata.write_text(metadata.read_text().replace("run.mcap", name))
    refused(tmp_path / "run", "a bag consists of files in its own folder")


def test_a_folder_without_files_is_refused(tmp_path: Path) -> None:
    (tmp_path / "metadata.yaml").write_text("a: &a [x]\nb: [*a, *a]\n")
    refused(tmp_path, "metadata.yaml names no file under relative_file_paths")


# Claims


def mcap(*records: tuple[int, bytes]) -> bytes:
    return b"\x89MCAP0\r\n" + b"".join(bytes([number]) + struct.pack("<Q", len(data)) + data for number, data in records)


def text(content: bytes) -> bytes:
    return struct.pack("<I", len(content)) + content


def chunk(size: int, packing: bytes, content: bytes) -> tuple[int, bytes]:
    return 6, struct.pack("<3QI", 0, 0, size, 0) + text(packing) + struct.pack("<Q", len(content)) + content


ZEROS = 9 * 2**17  # bytes: as many empty records of nine bytes each
PACKED = {
    "zstd": pyarrow.compress(bytes(ZEROS), codec="zstd", asbytes=True),
    "lz4": pyarrow.compress(bytes(ZEROS), codec="lz4", asbytes=True),
}


@pytest.mark.parametrize("packing", ["zstd", "lz4"])
@pytest.mark.parametrize(
    ("size", "reason"),
    [(1000, "does not have the 1000 bytes that it claims"), (2**62, "expands the file to"), (ZEROS + 1, "does not have")],
)
def test_chunks_that_do_not_keep_what_they_claim(tmp_path: Path, packing: str, size: int, reason: str) -> None:
    (tmp_path / "run.mcap").write_bytes(mcap(chunk(size, packing.encode(), PACKED[packing])))
    refused(tmp_path / "run.mcap", reason)


@pytest.mark.slow("files")
def test_many_chunks_that_expand_each_to_what_it_claims(tmp_path: Path) -> None:
    (tmp_path / "run.mcap").write_bytes(mcap(*([chunk(ZEROS, b"zstd", PACKED["zstd"])] * 300)))
    with pytest.raises(ValueError, match=r"its records expands|a packed chunk expands"):
        open_bag(tmp_path / "run.mcap")


def test_a_chunk_of_rosbag_that_expands_to_more_than_it_claims(tmp_path: Path) -> None:
    def record(fields: dict[bytes, bytes], data: bytes) -> bytes:
        return text(b"".join(text(name + b"=" + value) for name, value in fields.items())) + text(data)

    fields = {b"op": b"\5", b"compression": b"bz2", b"size": struct.pack("<I", 1000)}
    (tmp_path / "run.bag").write_bytes(b"#ROSBAG V2.0\n" + record(fields, bz2.compress(bytes(ZEROS))))
    refused(tmp_path / "run.bag", "does not have the 1000 bytes that it claims")


def test_a_packed_file_that_expands_to_gigabytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("strainwave.files.budget.MIN_ALLOWED_BYTES", ZEROS // 2)
    (tmp_path / "run.db3").write_bytes(PACKED["zstd"])
    refused(tmp_path / "run.db3", "its packed content expands the file to")


def test_a_message_that_claims_more_joints_than_it_has(tmp_path: Path) -> None:
    header = b"\0\1\0\0" + struct.pack("<iI", 1, 2) + text(b"\0") + bytes(3)
    message = struct.pack("<HIQQ", 1, 0, 0, 0) + header + struct.pack("<I", 2**32 - 1)
    records = (3, struct.pack("<H", 1) + text(JOINTS.encode())), (4, struct.pack("<2H", 1, 1) + text(b"/q") + text(b"cdr"))
    (tmp_path / "run.mcap").write_bytes(mcap(*records, (5, message)))
    refused(tmp_path / "run.mcap", "a message claims 4294967295 fields, more than fit into it")


# Databases


NUMBERS = "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);" \
          "INSERT INTO topics VALUES (1, '/a', 'std_msgs/msg/Float64', 'cdr');"  # fmt: skip
WITHOUT_END = "WITH RECURSIVE n(i) AS (VALUES(1) UNION ALL SELECT i + 1 FROM n) SELECT 1, i AS timestamp, i AS data FROM n"
COMPUTED = "data BLOB AS (zeroblob(900000000))"


@pytest.mark.parametrize(
    ("schema", "reason"),
    [
        (f"CREATE VIEW messages AS {WITHOUT_END};", '"messages" is no table of its own'),
        (
            f"CREATE TABLE messages(id, topic_id, timestamp, {COMPUTED}); INSERT INTO messages VALUES (1, 1, 1);",
            "computed column",
        ),
        ("CREATE VIRTUAL TABLE messages USING rtree(topic_id, timestamp, data);", '"messages" is no table of its own'),
    ],
)
def test_a_database_whose_messages_are_computed(tmp_path: Path, schema: str, reason: str) -> None:
    with sqlite3.connect(tmp_path / "run.db3") as made:
        made.executescript(NUMBERS + schema)
    made.close()
    refused(tmp_path / "run.db3", reason)


def test_no_file_is_made_beside_a_database_and_none_read(tmp_path: Path) -> None:
    with sqlite3.connect(tmp_path / "run.db3") as made:
        made.executescript(NUMBERS + "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data);")
        content = [(1, row, b"\0\1\0\0" + struct.pack("<d", 0.5 * row)) for row in range(3)]
        made.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)", content)
    made.close()
    (tmp_path / "run.db3-journal").write_bytes(b"\xd9\xd5\x05\xf9\x20\xa1\x63\xd7" + bytes(600))
    assert columns(open_bag(tmp_path / "run.db3")) == {"a": [0.0, 0.5, 1.0]}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.db3", "run.db3-journal"]
