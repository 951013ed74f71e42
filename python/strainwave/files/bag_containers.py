"""The messages in bags of ROS: rosbag (version 2.0 of its format), MCAP, SQLite, and folders of the last two.

They are read here and not by a library: rosbags unpacks without a bound, follows the paths in a folder's metadata wherever they
lead, and makes code from the definitions in a bag. Here one budget bounds what is unpacked, and no other file is opened.
"""

from __future__ import annotations

import bz2
import mmap
import re
import sqlite3
import struct
from binascii import crc32
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from pathlib import Path
from urllib.parse import quote

from strainwave.files.bag_messages import Message
from strainwave.files.budget import MAX_TEXT_BYTES, ReadBudget, RefusedFile, open_regular, read_regular
from strainwave.messages import quoted

METADATA = "metadata.yaml"  # names the files of a folder
ROSBAG, MCAP, SQLITE, ZSTD = b"#ROSBAG V2.0\n", b"\x89MCAP0\r\n", b"SQLite format 3\0", b"\x28\xb5\x2f\xfd"
BYTES_OF_RECORD = 64  # counted for each record besides its content, so that empty ones end, too
MAX_SQL_STEPS = 200_000_000  # of the scan of one table
STEPS_AT_A_TIME = 1_000_000
UNPACKED_AT_A_TIME = 2**20  # bytes
_PATHS = re.compile(r"relative_file_paths:[ \t]*(\[[^\]]*\]|(?:\n[ \t]*-[^\n]*)*)")
_NAME = re.compile(r"""(?:\[|,|-[ \t])\s*["']?([^\[\],"'\n]+?)["']?[ \t]*(?=$|[\],])""", re.MULTILINE)
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
    text = read_regular(path / METADATA, MAX_TEXT_BYTES).decode()
    listed = _PATHS.search(text)
    names = _NAME.findall(listed[1]) if listed else []
    for name in names:
        if Path(name).name != name or name == ".." or (path / name).is_symlink():
            raise RefusedFile(f"{METADATA} names the file {quoted(name)}; a bag consists of files in its own folder")
    if not names:
        raise RefusedFile(f"{METADATA} names no file under relative_file_paths")
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
        found = bz2.BZ2Decompressor().decompress(content, size + 1)
    elif packing in ("lz4", "zstd"):
        import pyarrow

        with pyarrow.CompressedInputStream(pyarrow.BufferReader(content), packing) as stream:
            found = stream.read(size + 1)
    else:
        raise RefusedFile(f"a chunk is packed by {quoted(packing)}; bz2, lz4 and zstd are read")
    if len(found) != size:
        raise RefusedFile(f"a packed chunk does not have the {size} bytes that it claims")
    return memoryview(found)


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
    place, found = 0, {}
    while place < len(header):
        field, place = _sized(header, place)
        name, _, value = bytes(field).partition(b"=")
        found[name.decode()] = value
    return found


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
        opened.set_progress_handler(_step_counter(), STEPS_AT_A_TIME)
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
    found = opened.execute("SELECT type, rootpage FROM sqlite_master WHERE lower(name) = ?", [name]).fetchall()
    if [kind for kind, _ in found] != ["table"] or not found[0][1]:
        raise RefusedFile(f"{quoted(name)} is no table of its own in this database, as it is in a bag")
    if any(column[-1] for column in opened.execute(f"PRAGMA table_xinfo({name})")):
        raise RefusedFile(f"table {quoted(name)} has a computed column, which no bag has")


def _step_counter() -> Callable[[], int]:
    """Return what stops a query after `MAX_SQL_STEPS`."""
    left = iter(range(MAX_SQL_STEPS // STEPS_AT_A_TIME))
    return lambda: next(left, None) is None
