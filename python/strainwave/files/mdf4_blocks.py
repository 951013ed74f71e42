"""MDF files of version 4 by their blocks; lengths and places as ASAM MDF 4.2 has them."""

from __future__ import annotations

import re
import struct
import zlib
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple
from xml.sax.saxutils import unescape

import numpy as np

from strainwave.files.budget import ReadBudget, RefusedFile
from strainwave.files.mdf_channels import Bytes, ChannelGroup, MdfChannel, NumberField, RecordLayout, Records, records_of
from strainwave.files.mdf_conversion import (
    Convert,
    RefusedChannel,
    identity,
    interpolated,
    key_finder,
    linear,
    nearest,
    piecewise,
    range_finder,
    ranges,
    rational,
    refuse_formula,
)

HEADER_BLOCK_PLACE = 64  # byte where the header block begins
MAX_TEXT = 2**16  # bytes of a name, a unit or a formula
BYTES_OF_REFERENCE = 64  # that a reference of a conversion takes in memory

KINDS: dict[int, tuple[Any, bool]] = {  # data types of numbers: kind, and whether the highest byte comes first
    0: ("u", False), 1: ("u", True), 2: ("i", False), 3: ("i", True), 4: ("f", False), 5: ("f", True),
}  # fmt: skip
FIXED, MASTER, VIRTUAL_MASTER, VIRTUAL = 0, 2, 3, 6  # types of channels that contain numbers
TIME = (0, 1)  # what a master is, where it is the time or nothing is stated
ALL_INVALID, SOME_INVALID = 1, 2  # flags of a channel
VARIABLE_LENGTH, REMOTE_MASTER = 1, 8  # flags of a channel group
WITH_INVALIDATION = 2**31  # flag of a list of columns
DATA = (b"##DT", b"##DV", b"##DI")  # kinds of blocks that contain records, values of a column, invalidation bytes
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
            if kind not in (FIXED, MASTER, VIRTUAL_MASTER, VIRTUAL) or data_type not in KINDS or flags & ALL_INVALID:
                continue
            own_unit, convert = self._conversion(conversion, KINDS[data_type][0] != "f")
            if convert is not None:
                yield MdfChannel(
                    self._text(name),
                    self._text(unit) or own_unit,
                    None if is_virtual else NumberField(KINDS[data_type][0], byte, bit, bits, KINDS[data_type][1]),
                    convert,
                    is_master=kind in (MASTER, VIRTUAL_MASTER),
                    is_time=sync in TIME,
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
            block = self._block(address, kind if kind in DATA else b"##DT")
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
        if block.kind not in (b"##TX", b"##MD") or len(block.content) > MAX_TEXT:
            raise RefusedFile(f"the block at byte {address} is no text of at most {MAX_TEXT} bytes")
        self.budget.take_bytes(len(block.content), "its texts")
        text = bytes(block.content).partition(b"\0")[0].decode("utf-8", "replace")
        if block.kind == b"##MD":
            found = re.search(r"<TX[^<>]*>([^<>]*)</TX>", text)
            text = unescape(found[1]) if found else ""
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
