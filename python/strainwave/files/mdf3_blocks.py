"""MDF files of version 2 and 3 by their blocks; lengths and places as ASAM MDF 3.3 has them."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from strainwave.files.budget import ReadBudget, RefusedFile
from strainwave.files.mdf_channels import Bytes, ChannelGroup, MdfChannel, NumberField, RecordLayout, Records, records_of
from strainwave.files.mdf_conversion import (
    Convert,
    RefusedChannel,
    exponential,
    hyperbolic,
    identity,
    interpolated,
    linear,
    nearest,
    rational,
    refuse_formula,
)

HEADER_BLOCK_PLACE = 64  # byte where the header block begins
KINDS: dict[int, tuple[Any, bool | None]] = {  # data types: kind of number, and byte order where it is not that of the file
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
        found = records_of(data[place:end], layouts, int(ids > 0), budget, int(ids == 2)) if layouts else {}
        yield from (ChannelGroup(each, found[number], _master(each, found[number])) for number, each in channels.items())


def _channels(whole: memoryview, address: int, is_big_endian: bool, budget: ReadBudget) -> Iterator[MdfChannel]:
    """Return the channels of a group that contain numbers."""
    while address:
        block = _block(whole, address, b"CN", budget)
        address, conversion, _, dependency, _, kind = _unpack("5IH", block, 4)
        start, bits, data_type = _unpack("3H", block, 186)
        (long_name,) = _unpack("I", block, 218) if len(block) >= 222 else (0,)
        (more_bytes,) = _unpack("H", block, 226) if len(block) >= 228 else (0,)
        if data_type not in KINDS or dependency:
            continue
        kind_of_number, order = KINDS[data_type]
        name = _text(_block(whole, long_name, b"TX")[4:]) if long_name else _text(block[26:58])
        budget.take_bytes(len(name), "the names of its channels")
        place = NumberField(kind_of_number, more_bytes + start // 8, start % 8, bits, is_big_endian if order is None else order)
        unit, convert = _conversion(_block(whole, conversion, b"CC"), budget) if conversion else ("", identity)
        if convert is not None:
            yield MdfChannel(name, unit, place, convert, is_master=kind == TIME_CHANNEL)


def _master(channels: Sequence[MdfChannel], records: Records) -> tuple[MdfChannel, Records] | None:
    return next(((channel, records) for channel in channels if channel.is_master), None)


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
