"""Bags of the Robot Operating System: rosbag, rosbag2 and MCAP; the states of joints in them, and plain numbers."""

from __future__ import annotations

import bz2
import mmap
import re
import sqlite3
import struct
from array import array
from binascii import crc32
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

import numpy as np

from strainwave.files.array_table import Grid, GridTable, grid_table
from strainwave.files.budget import MAX_TEXT_BYTES, ReadBudget, RefusedFile, open_regular, read_regular
from strainwave.files.labels import check_names, read_by_others
from strainwave.files.table_format import Format
from strainwave.messages import one_line, quoted

JOINT_STATE = "sensor_msgs/msg/JointState"
PLAIN_NUMBERS = {
    f"std_msgs/msg/{kind}": form for kind, form in {"Float64": "d", "Float32": "f", "Int32": "i", "Int64": "q"}.items()
}
JOINT_UNITS = {"position": "rad", "velocity": "rad/s", "effort": "N.m"}  # of revolute joints, as the message defines them


class Message(NamedTuple):
    """A message of a bag, not yet decoded.

    Args:
        topic, kind: where it was published, and its type, as `std_msgs/msg/Float64`
        stamp: when it was recorded [ns]
        content: its bytes
        is_ros1: in the encoding of ROS 1, else in CDR, that of ROS 2
    """

    topic: str
    kind: str
    stamp: int
    content: memoryview
    is_ros1: bool


class JointStates(NamedTuple):
    """Content of a `JOINT_STATE`: the stamp of its header [ns], 0 if none was set, and its numbers by name."""

    stamp: int
    numbers: list[tuple[str, float]]


def plain_number(message: Message) -> float:
    """Return the number of a message of one of the kinds in `PLAIN_NUMBERS`."""
    return float(_MessageReader(message).take(PLAIN_NUMBERS[message.kind])[0])


def joint_states(message: Message) -> JointStates:
    """Return the state of each joint; an effort or velocity that was not measured is left empty in the message."""
    reader = _MessageReader(message)
    if message.is_ros1:
        reader.take("I")
    seconds, nanoseconds = reader.take("I" if message.is_ros1 else "i") + reader.take("I")
    reader.text()
    names = [reader.text() for _ in reader.items(4)]
    numbers = []
    for channel in JOINT_UNITS:
        values = reader.take(f"{len(reader.items(8))}d")
        if len(values) == len(names):
            numbers += [(f"{joint}.{channel}", value) for joint, value in zip(names, values, strict=True)]
    return JointStates(seconds * 1_000_000_000 + nanoseconds, numbers)


class _MessageReader:
    """Reads the fields of a message one after the other.

    CDR aligns each to its own size, behind four bytes that name the byte order.
    """

    def __init__(self, message: Message) -> None:
        self.is_ros1 = message.is_ros1
        self.order = "<" if message.is_ros1 or message.content[1] & 1 else ">"
        self.content = message.content if message.is_ros1 else message.content[4:]
        self.place = 0

    def take(self, form: str) -> tuple[Any, ...]:
        """Return fields that are all of one size."""
        size = struct.calcsize(f"<{form[-1]}")
        if not self.is_ros1 and not form.startswith("0"):
            self.place += -self.place % size
        numbers = struct.unpack_from(self.order + form, self.content, self.place)
        self.place += size * len(numbers)
        return numbers

    def text(self) -> str:
        (length,) = self.take("I")
        begin, self.place = self.place, self.place + length
        if self.place > len(self.content):
            raise RefusedFile("a text in a message is longer than the message; it is damaged")
        return bytes(self.content[begin : self.place]).rstrip(b"\0").decode()

    def items(self, size: int) -> range:
        """Return the numbers of a sequence of fields of at least `size` bytes."""
        (count,) = self.take("I")
        if count * size > len(self.content) - self.place:
            raise RefusedFile(f"a message claims {count} fields, more than fit into it; it is damaged")
        return range(count)


# ---- Containers ------------------------------------------------------------------------------------------------------


METADATA_FILE = "metadata.yaml"  # names the files of a folder
ROSBAG, MCAP, SQLITE, ZSTD = b"#ROSBAG V2.0\n", b"\x89MCAP0\r\n", b"SQLite format 3\0", b"\x28\xb5\x2f\xfd"
BYTES_OF_RECORD = 64  # counted for each record besides its content, so that empty ones end, too
MAX_SQL_STEPS = 200_000_000  # of the scan of one table
STEPS_AT_A_TIME = 1_000_000
UNPACKED_AT_A_TIME = 2**20  # bytes
_PATHS_LINE = re.compile(r"relative_file_paths:[ \t]*(\[[^\]]*\]|(?:\n[ \t]*-[^\n]*)*)")
_NAME_LINE = re.compile(r"""(?:\[|,|-[ \t])\s*["']?([^\[\],"'\n]+?)["']?[ \t]*(?=$|[\],])""", re.MULTILINE)
OF_ROSBAG = {"chunk": 5, "connection": 7, "message": 2}  # kinds of records
OF_MCAP = {"schema": 3, "channel": 4, "message": 5, "chunk": 6, "end": 15}


def bag_files(path: Path) -> list[Path]:
    """Return the files of a bag: itself, or those in its folder that its metadata names.

    Raises:
        RefusedFile: the metadata name a file outside of the folder, or none
        OSError: they cannot be read
    """
    if not path.is_dir():
        return [path]
    text = read_regular(path / METADATA_FILE, MAX_TEXT_BYTES).decode()
    listed = _PATHS_LINE.search(text)
    names = _NAME_LINE.findall(listed[1]) if listed else []
    for name in names:
        if Path(name).name != name or name == ".." or (path / name).is_symlink():
            raise RefusedFile(f"{METADATA_FILE} names the file {quoted(name)}; a bag consists of files in its own folder")
    if not names:
        raise RefusedFile(f"{METADATA_FILE} names no file under relative_file_paths")
    return [path / name for name in names]


def messages_of(files: Iterable[Path], kinds: Collection[str], budget: ReadBudget) -> Iterator[Message]:
    """Return the messages of some kinds that are in the files of a bag, in their order.

    Raises:
        RefusedFile: the bag would expand to more than it may, or is damaged
        Exception: it is damaged; any kind
    """
    for file in files:
        with open_regular(file) as opened:
            whole = memoryview(mmap.mmap(opened.fileno(), 0, access=mmap.ACCESS_READ))
        content = _content(whole, budget)
        if content[: len(ROSBAG)] == ROSBAG:
            yield from _of_rosbag(content, kinds, budget)
        elif content[: len(MCAP)] == MCAP:
            yield from _of_mcap(content, kinds, budget)
        elif content[: len(SQLITE)] == SQLITE:
            yield from _of_sqlite(file, None if content is whole else content, len(content), kinds, budget)
        else:
            raise ValueError("no bag file")


def _content(data: memoryview, budget: ReadBudget) -> memoryview:
    """Return a message or file, unpacked if it is a zstd stream: the first letters are none of CDR."""
    return memoryview(b"".join(_unzipped(data, budget))) if data[:4] == ZSTD else data


def _unzipped(content: memoryview, budget: ReadBudget) -> Iterator[bytes]:
    """Return the content of a zstd stream, piece by piece."""
    import pyarrow

    with pyarrow.CompressedInputStream(pyarrow.BufferReader(content), "zstd") as stream:
        while piece := stream.read(UNPACKED_AT_A_TIME):
            budget.take_bytes(len(piece), "its packed content")
            yield piece


def _unpacked(content: memoryview, packing: str, size: int, budget: ReadBudget) -> memoryview:
    """Return the content of a chunk, which is of the size claimed."""
    if packing in ("", "none"):
        return content
    budget.take_bytes(size, "a packed chunk")
    if packing == "bz2":
        unpacked = bz2.BZ2Decompressor().decompress(content, size + 1)
    elif packing in ("lz4", "zstd"):
        import pyarrow

        with pyarrow.CompressedInputStream(pyarrow.BufferReader(content), packing) as stream:
            unpacked = stream.read(size + 1)
    else:
        raise RefusedFile(f"a chunk is packed by {quoted(packing)}; bz2, lz4 and zstd are read")
    if len(unpacked) != size:
        raise RefusedFile(f"a packed chunk does not have the {size} bytes that it claims")
    return memoryview(unpacked)


def _kind(name: str) -> str:
    """Return the type of a message as ROS 2 names it."""
    return name if "/msg/" in name else name.replace("/", "/msg/")


# rosbag


def _of_rosbag(content: memoryview, kinds: Collection[str], budget: ReadBudget) -> Iterator[Message]:
    connections: dict[bytes, tuple[str, str]] = {}
    for header, data in _records(content[len(ROSBAG) :], budget):
        inside: Iterable[tuple[Mapping[str, bytes], memoryview]] = [(header, data)]
        if header.get("op") == bytes([OF_ROSBAG["chunk"]]):
            packing, size = header["compression"].decode(), int.from_bytes(header["size"], "little")
            inside = _records(_unpacked(data, packing, size, budget), budget)
        for header, data in inside:
            if header.get("op") == bytes([OF_ROSBAG["connection"]]):
                budget.take_node()
                connections[header["conn"]] = header["topic"].decode(), _kind(_fields(data)["type"].decode())
            elif header.get("op") == bytes([OF_ROSBAG["message"]]):
                topic, kind = connections[header["conn"]]
                if kind in kinds:
                    seconds, nanoseconds = struct.unpack("<2I", header["time"])
                    yield Message(topic, kind, seconds * 1_000_000_000 + nanoseconds, data, is_ros1=True)


def _records(content: memoryview, budget: ReadBudget) -> Iterator[tuple[Mapping[str, bytes], memoryview]]:
    """Return the header and the data of each record."""
    place = 0
    while place < len(content):
        budget.take_bytes(BYTES_OF_RECORD, "its records")
        header, place = _sized(content, place)
        data, place = _sized(content, place)
        yield _fields(header), data


def _fields(header: memoryview) -> dict[str, bytes]:
    place, fields = 0, {}
    while place < len(header):
        field, place = _sized(header, place)
        name, _, value = bytes(field).partition(b"=")
        fields[name.decode()] = value
    return fields


def _sized(content: memoryview, place: int, form: str = "I") -> tuple[memoryview, int]:
    """Return what stands behind its own length, and where the next begins."""
    (length,) = struct.unpack_from(f"<{form}", content, place)
    begin = place + struct.calcsize(f"<{form}")
    if begin + length > len(content):
        raise RefusedFile(f"a record at byte {place} is longer than what contains it; it is damaged or was not closed")
    return content[begin : begin + length], begin + length


# MCAP


def _of_mcap(content: memoryview, kinds: Collection[str], budget: ReadBudget) -> Iterator[Message]:
    types: dict[int, str] = {0: ""}
    channels: dict[int, tuple[str, str, bool]] = {}
    for number, record in _mcap_records(content[len(MCAP) :], budget):
        inside: Iterable[tuple[int, memoryview]] = [(number, record)]
        if number == OF_MCAP["chunk"]:
            inside = _mcap_records(_chunk(record, budget), budget)
        for number, record in inside:
            if number == OF_MCAP["schema"]:
                budget.take_node()
                types[struct.unpack_from("<H", record)[0]] = _kind(bytes(_sized(record, 2)[0]).decode())
            elif number == OF_MCAP["channel"]:
                budget.take_node()
                channel, schema = struct.unpack_from("<2H", record)
                name, place = _sized(record, 4)
                encoding, _ = _sized(record, place)
                channels[channel] = bytes(name).decode(), types[schema], bytes(encoding) == b"ros1"
            elif number == OF_MCAP["message"]:
                channel, _, stamp = struct.unpack_from("<HIQ", record)
                topic, kind, is_ros1 = channels[channel]
                if kind in kinds:
                    yield Message(topic, kind, stamp, _content(record[22:], budget), is_ros1)


def _mcap_records(content: memoryview, budget: ReadBudget) -> Iterator[tuple[int, memoryview]]:
    """Return the number and the content of each record up to the end of the data."""
    place = 0
    while place < len(content) and (number := content[place]) != OF_MCAP["end"]:
        budget.take_bytes(BYTES_OF_RECORD, "its records")
        record, place = _sized(content, place + 1, "Q")
        yield number, record


def _chunk(record: memoryview, budget: ReadBudget) -> memoryview:
    size, checksum = struct.unpack_from("<QI", record, 16)
    packing, place = _sized(record, 28)
    content = _unpacked(_sized(record, place, "Q")[0], bytes(packing).decode(), size, budget)
    if checksum and crc32(content) != checksum:
        raise RefusedFile("the checksum of a chunk is wrong; it is damaged")
    return content


# SQLite


def _of_sqlite(
    path: Path, content: memoryview | None, size: int, kinds: Collection[str], budget: ReadBudget
) -> Iterator[Message]:
    """Return the messages of a database, which stands in `content` where it was packed.

    It is opened as one that nobody changes, so that no journal next to it is read. Its tables must be tables, without computed
    columns: a view may contain a query without end.
    """
    source = ":memory:" if content is not None else f"file:{quote(str(path.resolve()))}?mode=ro&immutable=1"
    opened = sqlite3.connect(source, uri=True)
    try:
        if content is not None:
            opened.deserialize(content)
        opened.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, size)
        left = iter(range(MAX_SQL_STEPS // STEPS_AT_A_TIME))
        opened.set_progress_handler(lambda: next(left, None) is None, STEPS_AT_A_TIME)
        opened.execute("PRAGMA trusted_schema = OFF")
        for table in ("topics", "messages"):
            _check_table(opened, table)
        topics = {
            number: (name, _kind(kind), coding == "ros1")
            for number, name, kind, coding in opened.execute("SELECT id, name, type, serialization_format FROM topics")
        }
        for number, stamp, data in opened.execute("SELECT topic_id, timestamp, data FROM messages"):
            budget.take_bytes(BYTES_OF_RECORD, "its messages")
            topic, kind, is_ros1 = topics[number]
            if kind in kinds:
                yield Message(topic, kind, stamp, _content(memoryview(data), budget), is_ros1)
    finally:
        opened.close()


def _check_table(opened: sqlite3.Connection, name: str) -> None:
    tables = opened.execute("SELECT type, rootpage FROM sqlite_master WHERE lower(name) = ?", [name]).fetchall()
    if [kind for kind, _ in tables] != ["table"] or not tables[0][1]:
        raise RefusedFile(f"{quoted(name)} is no table of its own in this database, as it is in a bag")
    if any(column[-1] for column in opened.execute(f"PRAGMA table_xinfo({name})")):
        raise RefusedFile(f"table {quoted(name)} has a computed column, which no bag has")


# ---- The table -------------------------------------------------------------------------------------------------------


def open_bag(path: str | Path) -> GridTable:
    """The channels of a bag: position, velocity and effort of each joint, as `elbow.position`, and topics of plain numbers.

    The time of a joint's state is that of its header; that of a plain number is when it was recorded. It counts from the first.
    """
    series: dict[tuple[str, str], _Series] = {}
    with read_by_others(path, "bag"):
        files = bag_files(Path(path))
        budget = ReadBudget(sum(file.stat().st_size for file in files))
        for message in messages_of(files, (JOINT_STATE, *PLAIN_NUMBERS), budget):
            own = series.setdefault((message.topic, message.kind), _Series(budget))
            if message.kind == JOINT_STATE:
                state = joint_states(message)
                own.add(message.stamp, state.stamp or message.stamp, dict(state.numbers))
            else:
                own.add(message.stamp, message.stamp, {"": plain_number(message)})
        begin = min((each.begin for each in series.values()), default=0)
        several = sum(kind == JOINT_STATE for _, kind in series) > 1
        check_names([name for each in series.values() for name in each.columns])
        grids = [each.grid(begin, _prefix(topic, kind, several)) for (topic, kind), each in series.items()]
    names = [name for grid in grids for name in grid.columns]
    units = {name: JOINT_UNITS[name.rpartition(".")[2]] for name in names if name.rpartition(".")[2] in JOINT_UNITS}
    return grid_table(one_line(str(path)), "", grids, units)


def _prefix(topic: str, kind: str, several: bool) -> str:
    """Return what stands before the names of a topic's numbers."""
    if kind == JOINT_STATE:
        return f"{topic.strip('/')}." if several else ""
    return topic.strip("/").replace("/", ".")


class _Series:
    """Numbers of one topic as they come, nan where a message lacks one."""

    def __init__(self, budget: ReadBudget) -> None:
        self.budget = budget
        self.recorded = array("q")  # ns
        self.stamps = array("q")  # ns
        self.columns: dict[str, array[float]] = {}

    def add(self, recorded: int, stamp: int, numbers: Mapping[str, float]) -> None:
        new = numbers.keys() - self.columns.keys()
        self.budget.take_bytes(8 * (2 + len(self.columns) + len(new) * (1 + len(self.stamps))), "its messages")
        self.columns.update((name, array("d", [np.nan]) * len(self.stamps)) for name in numbers if name in new)
        self.recorded.append(recorded)
        self.stamps.append(stamp)
        for name, values in self.columns.items():
            values.append(numbers.get(name, np.nan))

    @property
    def begin(self) -> int:
        """The stamp of the message that was recorded first [ns]."""
        return self.stamps[int(np.argmin(self.recorded))]

    def grid(self, begin: int, prefix: str) -> Grid:
        """Return the numbers in the order in which they were recorded."""
        order = np.argsort(self.recorded, kind="stable")
        time = (np.array(self.stamps)[order] - begin).astype(float) * 1e-9
        return Grid(time, {f"{prefix}{name}": np.array(values)[order] for name, values in self.columns.items()})


FORMAT: Format = Format(
    (".bag", ".mcap", ".db3"),
    open_bag,
    "Bags of ROS 1 and 2",
    "of the message: rad, rad/s, N.m",
    about=(
        "a file, or the folder of a bag. Each joint state has `knee.position`, `knee.velocity`, `knee.effort` over the time in "
        "its header; topics of plain numbers are columns, too. With several topics of joint states, the topic precedes the "
        "name."
    ),
)
