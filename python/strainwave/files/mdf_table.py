"""MDF files of measurement systems in vehicles and test benches, versions 2 to 4."""

from __future__ import annotations

import mmap
import re
import struct
import zlib
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple
from xml.sax.saxutils import unescape

import numpy as np
from numpy.typing import NDArray

from strainwave.files.array_table import Grid, GridTable, grid_table
from strainwave.files.budget import ReadBudget, RefusedFile, open_regular
from strainwave.files.labels import check_names, read_by_others
from strainwave.files.mdf_channels import (
    Bytes,
    ChannelGroup,
    Convert,
    MdfChannel,
    NumberField,
    RecordLayout,
    Records,
    RefusedChannel,
    channel_values,
    exponential,
    hyperbolic,
    identity,
    interpolated,
    key_finder,
    linear,
    nearest,
    piecewise,
    range_finder,
    ranges,
    rational,
    records_of,
    refuse_formula,
)
from strainwave.files.table_format import Format
from strainwave.messages import one_line

# ---- Blocks of versions 2 and 3 --------------------------------------------------------------------------------------


HEADER_BLOCK_PLACE = 64  # byte where the header block begins
KINDS_OF_3: dict[int, tuple[Any, bool | None]] = {  # by data type: kind of number, and byte order if not that of the file
    0: ("u", None), 1: ("i", None), 2: ("f", None), 3: ("f", None),
    9: ("u", True), 10: ("i", True), 11: ("f", True), 12: ("f", True),
    13: ("u", False), 14: ("i", False), 15: ("f", False), 16: ("f", False),
}  # fmt: skip
TIME_CHANNEL = 1  # type of a channel that contains the instants of its group
FORMULA, TEXTS, NONE = 10, (11, 12), 65535  # types of conversions


def channel_groups(data: Bytes, budget: ReadBudget) -> Iterator[ChannelGroup]:
    """Return the channel groups of a file of version 2 or 3."""
    whole = data.data
    is_big_endian = _unpack("H", whole, 24)[0] != 0
    (address,) = _unpack("I", _block(whole, HEADER_BLOCK_PLACE, b"HD"), 4)
    while address:
        block = _block(whole, address, b"DG", budget)
        address, first, _, place, _, ids = _unpack("4I2H", block, 4)
        layouts: dict[int, RecordLayout] = {}
        channels: dict[int, list[MdfChannel]] = {}
        while first:
            block = _block(whole, first, b"CG", budget)
            first, channel, _, number, _, length, records = _unpack("3I3HI", block, 4)
            if number in layouts:
                raise RefusedFile(f"has two channel groups of the number {number} in a data group")
            layouts[number] = RecordLayout(records, length)
            channels[number] = list(_channels(whole, channel, is_big_endian, budget))
        end = place + sum(layout.records * ((layout.length or 0) + ids) for layout in layouts.values())
        if end > len(data):
            raise RefusedFile(f"claims records up to byte {end}, but has {len(data)}; it is damaged or was not closed")
        records_by_number = records_of(data[place:end], layouts, int(ids > 0), budget, int(ids == 2)) if layouts else {}
        for number, own in channels.items():
            rows = records_by_number[number]
            yield ChannelGroup(own, rows, next(((channel, rows) for channel in own if channel.is_master), None))


def _channels(whole: memoryview, address: int, is_big_endian: bool, budget: ReadBudget) -> Iterator[MdfChannel]:
    """Return the channels of a group that contain numbers."""
    while address:
        block = _block(whole, address, b"CN", budget)
        address, conversion, _, dependency, _, kind = _unpack("5IH", block, 4)
        start, bits, data_type = _unpack("3H", block, 186)
        (long_name,) = _unpack("I", block, 218) if len(block) >= 222 else (0,)
        (more_bytes,) = _unpack("H", block, 226) if len(block) >= 228 else (0,)
        if data_type not in KINDS_OF_3 or dependency:
            continue
        kind_of_number, order = KINDS_OF_3[data_type]
        name = _text(_block(whole, long_name, b"TX")[4:]) if long_name else _text(block[26:58])
        budget.take_bytes(len(name), "the names of its channels")
        place = NumberField(kind_of_number, more_bytes + start // 8, start % 8, bits, is_big_endian if order is None else order)
        unit, convert = _conversion(_block(whole, conversion, b"CC"), budget) if conversion else ("", identity)
        if convert is not None:
            yield MdfChannel(name, unit, place, convert, is_master=kind == TIME_CHANNEL)


def _conversion(block: memoryview, budget: ReadBudget) -> tuple[str, Convert | RefusedChannel | None]:
    """Return unit and conversion; None if it gives texts."""
    unit = _text(block[22:42])
    kind, count = _unpack("2H", block, 42)
    try:
        return unit, _convert(kind, count, block[46:], budget)
    except RefusedChannel as refused:
        return unit, refused


def _convert(kind: int, count: int, parameters: memoryview, budget: ReadBudget) -> Convert | None:
    if kind == NONE:
        return identity
    if kind in TEXTS:
        return None
    if kind == FORMULA:
        raise refuse_formula(_text(parameters))
    if kind == 0:
        return linear(*_numbers(parameters, 2))
    if kind in (1, 2):
        budget.take_bytes(16 * count, "its conversion tables")
        keys, values = np.array(_numbers(parameters, 2 * count)).reshape(-1, 2).T
        return (interpolated if kind == 1 else nearest)(keys, values)
    if kind == 6:
        return hyperbolic(_numbers(parameters, 6))
    if kind in (7, 8):
        return exponential(_numbers(parameters, 7), np.exp if kind == 7 else np.log)
    if kind == 9:
        return rational(_numbers(parameters, 6))
    raise RefusedChannel(f"its conversion is of the type {kind}, which MDF 3 does not define")


def _block(whole: memoryview, address: int, kind: bytes, budget: ReadBudget | None = None) -> memoryview:
    """Return a block as its length is stated; with a budget one that no other block may refer to."""
    if budget is not None:
        budget.take_node()
        if not budget.is_new(address):
            raise RefusedFile(f"refers twice to the block at byte {address}")
    found, length = _unpack("2sH", whole, address)
    if found != kind or address + length > len(whole):
        raise RefusedFile(f"has no {kind.decode()} block at byte {address}, which it refers to; it is damaged")
    return whole[address : address + length]


def _unpack(form: str, block: memoryview, place: int) -> tuple[Any, ...]:
    return struct.unpack_from(f"<{form}", block, place)


def _numbers(block: memoryview, count: int) -> tuple[float, ...]:
    return _unpack(f"{count}d", block, 0)


def _text(block: memoryview) -> str:
    return bytes(block).partition(b"\0")[0].decode("latin-1").strip()


# ---- Blocks of version 4 ---------------------------------------------------------------------------------------------


MAX_TEXT_BLOCK_BYTES = 2**16  # bytes of a name, a unit or a formula
BYTES_OF_REFERENCE = 64  # that a reference of a conversion takes in memory

KINDS_OF_4: dict[int, tuple[Any, bool]] = {  # data types of numbers: kind, and whether the highest byte comes first
    0: ("u", False), 1: ("u", True), 2: ("i", False), 3: ("i", True), 4: ("f", False), 5: ("f", True),
}  # fmt: skip
FIXED, MASTER, VIRTUAL_MASTER, VIRTUAL = 0, 2, 3, 6  # types of channels that contain numbers
TIME_MASTERS = (0, 1)  # what a master is, where it is the time or nothing is stated
ALL_INVALID, SOME_INVALID = 1, 2  # flags of a channel
VARIABLE_LENGTH, REMOTE_MASTER = 1, 8  # flags of a channel group
WITH_INVALIDATION = 2**31  # flag of a list of columns
DATA_BLOCKS = (b"##DT", b"##DV", b"##DI")  # kinds of blocks that contain records, values of a column, invalidation bytes
DEFLATE, TRANSPOSED_DEFLATE = 0, 1  # how a block is packed


class _Group(NamedTuple):
    """A channel group before its records are read."""

    address: int
    master_group: int | None
    channels: Sequence[MdfChannel]


class _Block(NamedTuple):
    """A block: its kind, what it refers to, and its content."""

    kind: bytes
    links: Sequence[int]
    content: memoryview

    def unpack(self, form: str, place: int = 0) -> tuple[Any, ...]:
        return struct.unpack_from(f"<{form}", self.content, place)


class Mdf4File:
    """The blocks of a file of version 4, each structural one visited once."""

    def __init__(self, data: Bytes, budget: ReadBudget) -> None:
        self.data = data
        self.whole = data.data
        self.budget = budget

    def channel_groups(self) -> Iterator[ChannelGroup]:
        """Return the channel groups, each with the instants of its samples."""
        groups: list[_Group] = []
        records: dict[int, Records] = {}
        address = self._block(HEADER_BLOCK_PLACE, b"##HD").links[0]
        while address:
            address = self._data_group(address, groups, records)
        masters = {
            group.address: (channel, records[group.address])
            for group in groups
            for channel in reversed(group.channels)
            if channel.is_master
        }
        for group in groups:
            master = masters.get(group.address if group.master_group is None else group.master_group)
            yield ChannelGroup(group.channels, records[group.address], master)

    def _data_group(self, address: int, groups: list[_Group], records: dict[int, Records]) -> int:
        """Read a data group into `groups` and `records`; return where the next one stands."""
        block = self._new_block(address, b"##DG")
        following, first, place, _ = block.links[:4]
        (id_bytes,) = block.unpack("B")
        layouts: dict[int, RecordLayout] = {}
        numbers: dict[int, int] = {}
        while first:
            here, block = first, self._new_block(first, b"##CG")
            number, count, flags, _, length, invalid = block.unpack("2Q2H4x2I")
            if number in layouts:
                raise RefusedFile(f"has two channel groups of the number {number} in a data group")
            first, channel = block.links[:2]
            if flags & VARIABLE_LENGTH:
                layouts[number] = RecordLayout(count, None)
                continue
            layouts[number], numbers[number] = RecordLayout(count, length + invalid, invalid), here
            groups.append(_Group(here, block.links[6] if flags & REMOTE_MASTER else None, list(self._channels(channel))))
        data, invalidation = self._data(place)
        if invalidation is not None and len(layouts) == 1:
            ((number, layout),) = layouts.items()
            layouts[number] = layout._replace(length=(layout.length or 0) - layout.invalid, invalid=0)
            found = records_of(data, layouts, id_bytes, self.budget)
            marks = records_of(invalidation, {number: RecordLayout(layout.records, layout.invalid)}, 0, self.budget)
            found[number] = Records(found[number].content, marks[number].content)
        else:
            found = records_of(data, layouts, id_bytes, self.budget)
        records.update((numbers[number], each) for number, each in found.items())
        return int(following)

    def _channels(self, address: int, depth: int = 0) -> Iterator[MdfChannel]:
        """Return the channels of a list that contain numbers, and those of the structures among them."""
        while address:
            block = self._new_block(address, b"##CN", depth)
            address, composition, name, _, conversion, _, unit = block.links[:7]
            if composition:
                if self._kind(composition) == b"##CN":
                    yield from self._channels(composition, depth + 1)
                else:  # an array
                    continue
            kind, sync, data_type, bit, byte, bits, flags, invalid = block.unpack("4B4I")
            is_virtual = kind in (VIRTUAL_MASTER, VIRTUAL)
            if kind not in (FIXED, MASTER, VIRTUAL_MASTER, VIRTUAL) or data_type not in KINDS_OF_4 or flags & ALL_INVALID:
                continue
            own_unit, convert = self._conversion(conversion, KINDS_OF_4[data_type][0] != "f")
            if convert is not None:
                yield MdfChannel(
                    self._text(name),
                    self._text(unit) or own_unit,
                    None if is_virtual else NumberField(KINDS_OF_4[data_type][0], byte, bit, bits, KINDS_OF_4[data_type][1]),
                    convert,
                    is_master=kind in (MASTER, VIRTUAL_MASTER),
                    is_time=sync in TIME_MASTERS,
                    invalid_bit=invalid if flags & SOME_INVALID else None,
                )

    def _conversion(self, address: int, of_integers: bool) -> tuple[str, Convert | RefusedChannel | None]:
        """Return unit and conversion; None if it gives texts."""
        if not address:
            return "", identity
        unit = self._text(self._block(address, b"##CC").links[1])
        try:
            return unit, self._convert(address, of_integers)
        except RefusedChannel as refused:
            return unit, refused

    def _convert(self, address: int, of_integers: bool, depth: int = 0) -> Convert | None:
        self.budget.take_node(depth)
        block = self._block(address, b"##CC")
        kind, _, _, references, count = block.unpack("2B3H")
        self.budget.take_bytes(BYTES_OF_REFERENCE * references + 8 * count, "its conversion tables")
        values = np.array(block.unpack(f"{count}d", 24))
        if kind == 0:
            return identity
        if kind == 1:
            return linear(*values[:2].tolist())
        if kind == 2:
            return rational(values[:6].tolist())
        if kind == 3:
            raise refuse_formula(self._text(block.links[4]))
        if kind in (4, 5):
            return (interpolated if kind == 4 else nearest)(values[0::2], values[1::2])
        if kind == 6:
            lower, upper, results = values[:-1].reshape(-1, 3).T
            return ranges(lower, upper, results, float(values[-1]), of_integers)
        if kind in (7, 8):
            keys = values.reshape(-1, kind - 6)
            pieces = [self._piece(each, of_integers, depth + 1) for each in block.links[4 : 4 + references]]
            if not any(pieces) or len(pieces) != len(keys) + 1:
                return None
            order = np.argsort(keys[:, 0], kind="stable")
            first, last = keys[order, 0], keys[order, -1]
            places = key_finder(first) if kind == 7 else range_finder(first, last, of_integers)
            return piecewise(places, [*(pieces[place] for place in order), pieces[-1]])
        if kind in (9, 10, 11):  # from texts, or to them alone
            return None
        raise RefusedChannel(f"its conversion is of the type {kind}, which MDF 4 does not define")

    def _piece(self, address: int, of_integers: bool, depth: int) -> Convert | None:
        """Return the conversion of one key; None if that is a text."""
        return self._convert(address, of_integers, depth) if address and self._kind(address) == b"##CC" else None

    def _data(self, address: int) -> tuple[Bytes, Bytes | None]:
        """Return the data of a group, and its invalidation bytes if they stand apart."""
        if not address:
            return np.empty(0, np.uint8), None
        if self._kind(address) == b"##HL":
            address = self._new_block(address, b"##HL").links[0]
        if self._kind(address) not in (b"##DL", b"##LD"):
            return self._fragment(address), None
        data: list[Bytes] = []
        invalidation: list[Bytes] = []
        while address:
            block = self._new_block(address, self._kind(address))
            is_list = block.kind == b"##DL"
            flags, count = block.unpack("B3xI" if is_list else "2I")
            address = block.links[0]
            data += [self._fragment(each) for each in block.links[1 : 1 + count]]
            if not is_list and flags & WITH_INVALIDATION:
                invalidation += [self._fragment(each) for each in block.links[1 + count : 1 + 2 * count]]
        return self._joined(data), self._joined(invalidation) if invalidation else None

    def _joined(self, parts: Sequence[Bytes]) -> Bytes:
        if len(parts) == 1:
            return parts[0]
        self.budget.take_bytes(sum(map(len, parts)), "its data in several blocks")
        return np.concatenate([np.empty(0, np.uint8), *parts])

    def _fragment(self, address: int) -> Bytes:
        """Return the content of a data block, unpacked."""
        kind = self._kind(address)
        if kind != b"##DZ":
            block = self._block(address, kind if kind in DATA_BLOCKS else b"##DT")
            return np.frombuffer(block.content, np.uint8)
        block = self._block(address, b"##DZ")
        _, packing, columns, size, packed = block.unpack("2sBxI2Q")
        if packing not in (DEFLATE, TRANSPOSED_DEFLATE):
            raise RefusedFile(f"has a block packed in the way {packing}; deflate, 0 or 1, is read")
        self.budget.take_bytes(size, f"the packed block at byte {address}")
        inflater = zlib.decompressobj()
        data = np.frombuffer(inflater.decompress(block.content[24 : 24 + packed], size + 1), np.uint8)
        if len(data) != size:
            raise RefusedFile(f"the packed block at byte {address} does not have the {size} bytes that it claims")
        if packing == TRANSPOSED_DEFLATE and columns:
            whole = size // columns * columns
            data = np.concatenate([data[:whole].reshape(columns, -1).T.ravel(), data[whole:]])
        return data

    def _text(self, address: int) -> str:
        """Return a text, of one in XML what it states first."""
        if not address:
            return ""
        block = self._block(address, self._kind(address))
        if block.kind not in (b"##TX", b"##MD") or len(block.content) > MAX_TEXT_BLOCK_BYTES:
            raise RefusedFile(f"the block at byte {address} is no text of at most {MAX_TEXT_BLOCK_BYTES} bytes")
        self.budget.take_bytes(len(block.content), "its texts")
        text = bytes(block.content).partition(b"\0")[0].decode("utf-8", "replace")
        if block.kind == b"##MD":
            in_xml = re.search(r"<TX[^<>]*>([^<>]*)</TX>", text)
            text = unescape(in_xml[1]) if in_xml else ""
        return text.strip()

    def _new_block(self, address: int, kind: bytes, depth: int = 0) -> _Block:
        """Return a block that no other one may refer to."""
        self.budget.take_node(depth)
        if not self.budget.is_new(address):
            raise RefusedFile(f"refers twice to the block at byte {address}")
        return self._block(address, kind)

    def _block(self, address: int, kind: bytes) -> _Block:
        if self._kind(address) != kind:
            raise RefusedFile(f"has no {kind.decode()} block at byte {address}, which it refers to; it is damaged")
        length, count = struct.unpack_from("<2Q", self.whole, address + 8)
        begin = 24 + 8 * count
        if begin > length or address + length > len(self.whole):
            raise RefusedFile(f"its block at byte {address} ends behind the file, at byte {address + length}; it is damaged")
        links = struct.unpack_from(f"<{count}Q", self.whole, address + 24)
        return _Block(kind, links, self.whole[address + begin : address + length])

    def _kind(self, address: int) -> bytes:
        if not HEADER_BLOCK_PLACE <= address <= len(self.whole) - 24:
            raise RefusedFile(f"refers to byte {address}, where it has no block; it is damaged")
        return bytes(self.whole[address : address + 4])


# ---- The table -------------------------------------------------------------------------------------------------------


Array = NDArray[np.float64]
MDF_BEGINNINGS = (b"MDF ", b"UnFinMF ")  # at the beginning of every MDF file; the second while it is still being recorded


def open_mdf(path: str | Path) -> GridTable:
    """The channels of an MDF file that contain numbers, each group of them on a grid of its own.

    Linear, rational and table conversions are applied. A channel whose conversion is a formula is left out by its name.
    """
    grids: list[Grid] = []
    units = {"time": "s"}  # of the instants, whose name no channel shares
    left_out: list[str] = []
    with read_by_others(path, "MDF"), open_regular(path) as file:
        data = np.frombuffer(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ), np.uint8)
        budget, names, tries = ReadBudget(len(data)), list[str](), Counter[tuple[str, int]]()
        for number, group in enumerate(_groups(data, budget)):
            names += [channel.name for channel in group.channels]
            check_names(names)
            if len(group.records) and (grid := _grid(group, number, units, tries, left_out, budget)):
                grids.append(grid)
    return grid_table(one_line(str(path)), "", grids, units, left_out)


def _groups(data: Bytes, budget: ReadBudget) -> Iterator[ChannelGroup]:
    begin = data[:64].tobytes()
    if begin.startswith(MDF_BEGINNINGS[1]):
        raise RefusedFile("was not closed by its recorder (UnFinMF); let the recorder's software finalise it")
    if not begin.startswith(MDF_BEGINNINGS[0]):
        raise ValueError("no MDF file")
    version = int.from_bytes(begin[28:30], "little")
    return Mdf4File(data, budget).channel_groups() if version >= 400 else channel_groups(data, budget)


def _grid(
    group: ChannelGroup,
    number: int,
    units: dict[str, str],
    tries: Counter[tuple[str, int]],
    left_out: list[str],
    budget: ReadBudget,
) -> Grid | None:
    """Return the channels of a group; add what they are measured in, and what of it is not read."""
    try:
        time = _time(group, budget)
    except RefusedChannel as refused:
        left_out.append(f"channel group {number} is left out: {refused}")
        return None
    columns: dict[str, Array] = {}
    for channel in group.channels:
        if channel.is_master:
            continue
        name = _unique(channel.name, number, units, tries)
        try:
            columns[name] = channel_values(channel, group.records, budget)
            units[name] = channel.unit
        except RefusedChannel as refused:
            left_out.append(f"{name} is left out: {refused}")
    return Grid(time, columns) if columns else None


def _time(group: ChannelGroup, budget: ReadBudget) -> Array:
    """Return the instants of a group [s]."""
    if group.master is None:
        raise RefusedChannel("it has no time channel")
    channel, records = group.master
    if not channel.is_time:
        raise RefusedChannel(f"{channel.name}, over which it was sampled, is not the time")
    if len(records) != len(group.records):
        raise RefusedFile(f"has {len(group.records)} samples at {len(records)} instants of {channel.name}")
    return channel_values(channel, records, budget)


def _unique(name: str, group: int, taken: Collection[str], tries: Counter[tuple[str, int]]) -> str:
    """Return the name, with the number of its group behind it where the file has it already; `tries` counts these."""
    unique = name
    while unique in taken:
        count = tries[name, group]
        tries[name, group] += 1
        unique = f"{name}.{group}.{count}" if count else f"{name}.{group}"
    return unique


FORMAT: Format = Format(
    (".mf4", ".mdf"),
    open_mdf,
    "MDF",
    "of the channel",
    about=(
        "version 2 to 4: the numeric channels; invalid values become nan. Linear, rational and table conversions are applied. "
        "A formula is never evaluated: its channel is left out and named."
    ),
)
