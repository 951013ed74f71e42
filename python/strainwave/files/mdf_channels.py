"""Channels of an MDF file of any version: their conversions, where their numbers stand in the records, and the numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.files.budget import ReadBudget, RefusedFile
from strainwave.messages import quoted

Array = NDArray[np.float64]
Convert = Callable[[Array], Array]


class RefusedChannel(ValueError):  # noqa: N818 - its message is the reason alone
    """The reason why a channel is not read; the other channels are."""


def refuse_formula(formula: str) -> RefusedChannel:
    """Return the refusal of a conversion that is a formula."""
    advice = "save the channel with a linear or table conversion, or as .csv"
    return RefusedChannel(f"its conversion is a formula, {quoted(formula)}, which is not evaluated; {advice}")


def identity(raw: Array) -> Array:
    """Return the raw values."""
    return raw


def linear(offset: float, factor: float) -> Convert:
    """Return the conversion `offset + factor * raw`."""
    return lambda raw: offset + factor * raw if (offset, factor) != (0.0, 1.0) else raw


def rational(parameters: Sequence[float]) -> Convert:
    """Return the quotient of two polynomials of second degree, highest power first.

    >>> rational([0.0, 2.0, 1.0, 0.0, 0.0, 4.0])(np.array([1.5]))
    array([1.])
    """
    p1, p2, p3, p4, p5, p6 = parameters
    return lambda raw: _divide((p1 * raw + p2) * raw + p3, (p4 * raw + p5) * raw + p6)


def hyperbolic(parameters: Sequence[float]) -> Convert:
    """Return the conversion that MDF 3 calls polynomial."""
    p1, p2, p3, p4, p5, p6 = parameters
    return lambda raw: _divide(p2 - p4 * (raw - p5 - p6), p3 * (raw - p5 - p6) - p1)


def exponential(parameters: Sequence[float], function: Callable[[Array], Array]) -> Convert:
    """Return the exponential or logarithmic conversion of MDF 3; `function` is `numpy.exp` or `numpy.log`."""
    p1, p2, p3, p4, p5, p6, p7 = parameters
    if p4 == 0.0:
        return lambda raw: _divide(function(_divide((raw - p7) * p6 - p3, p1)), p2)
    if p1 == 0.0:
        return lambda raw: _divide(function(_divide(_divide(p3, raw - p7) - p6, p4)), p5)
    raise RefusedChannel("its exponential conversion has both P1 and P4; one of them must be 0")


def interpolated(keys: Array, values: Array) -> Convert:
    """Return linear interpolation in a table, constant beyond its ends."""
    _check_sorted(keys)
    return lambda raw: np.interp(raw, keys, values)


def nearest(keys: Array, values: Array) -> Convert:
    """Return the value of the nearest key, of the lower one if two are equally near.

    >>> nearest(np.array([0.0, 2.0]), np.array([10.0, 20.0]))(np.array([-5.0, 1.0, 1.1, 9.0]))
    array([10., 10., 20., 20.])
    """
    _check_sorted(keys)
    return lambda raw: values[np.searchsorted(0.5 * keys[1:] + 0.5 * keys[:-1], raw, side="left")]


def ranges(lower: Array, upper: Array, values: Array, default: float, of_integers: bool) -> Convert:
    """Return the value of the range that contains the raw value; `default` if none does.

    >>> table = ranges(np.array([0.0, 5.0]), np.array([2.0, 6.0]), np.array([1.0, 2.0]), -1.0, of_integers=True)
    >>> table(np.array([0.0, 2.0, 3.0, 6.0]))
    array([ 1.,  1., -1.,  2.])
    """
    places = range_finder(lower, upper, of_integers)
    return lambda raw: np.append(values, default)[places(raw)]


def range_finder(lower: Array, upper: Array, of_integers: bool) -> Callable[[Array], NDArray[np.intp]]:
    """Return which range contains a value, -1 if none. The upper end belongs to a range of integers alone."""
    _check_sorted(lower)

    def places(raw: Array) -> NDArray[np.intp]:
        found = np.searchsorted(lower, raw, side="right") - 1
        inside = (raw <= upper[found]) if of_integers else ((raw < upper[found]) | (raw == lower[found]))
        return np.where((found >= 0) & inside, found, -1)

    return places


def piecewise(places: Callable[[Array], NDArray[np.intp]], pieces: Sequence[Convert | None]) -> Convert:
    """Return the conversion that differs between keys or ranges; the last is that of all other values, None gives nan."""

    known = np.array([piece is not None for piece in pieces])

    def convert(raw: Array) -> Array:
        place = places(raw) % len(pieces)
        order = np.argsort(place, kind="stable")
        order = order[known[place[order]]]
        found = np.full(len(raw), np.nan)
        for rows in np.split(order, np.flatnonzero(np.diff(place[order])) + 1) if len(order) else ():
            if piece := pieces[place[rows[0]]]:
                found[rows] = piece(raw[rows])
        return found

    return convert


def key_finder(keys: Array) -> Callable[[Array], NDArray[np.intp]]:
    """Return which key equals a value, -1 if none does."""
    _check_sorted(keys)

    def places(raw: Array) -> NDArray[np.intp]:
        found = np.minimum(np.searchsorted(keys, raw), len(keys) - 1)
        return np.where(keys[found] == raw, found, -1)

    return places


def _check_sorted(keys: Array) -> None:
    if not len(keys) or not (np.diff(keys) >= 0.0).all():
        raise RefusedChannel("the keys of its conversion table do not increase")


def _divide(numerator: Array | float, denominator: Array | float) -> Array:
    with np.errstate(all="ignore"):
        quotient: Array = np.divide(numerator, denominator)
    return quotient


# ---- Records ---------------------------------------------------------------------------------------------------------


Bytes = NDArray[np.uint8]

BYTES_OF_RECORD = 64  # that the place of an unsorted record takes in memory as Python has it
MAX_UNSORTED_RECORDS = 5_000_000  # of a data group with several channel groups, whose records are sorted one by one
FLOAT_BITS = (16, 32, 64)


class NumberField(NamedTuple):
    """Place of a number in a record.

    Args:
        kind: unsigned, signed or floating
        byte, bit: its first byte, and its first bit above the lowest one of its bytes
        bits: its length
        is_big_endian: its highest byte comes first
    """

    kind: Literal["u", "i", "f"]
    byte: int
    bit: int
    bits: int
    is_big_endian: bool

    @property
    def length(self) -> int:
        """Bytes that it touches."""
        return (self.bit + self.bits + 7) // 8


@dataclass(frozen=True)
class MdfChannel:
    """A channel that contains numbers.

    Args:
        name, unit: as the file has them
        field: where it stands in a record; None for the number of the record
        convert: from raw to physical values, or why the channel is not read
        is_master: True for the instants of its group
        is_time: False for a master that is an angle, a distance or an index
        invalid_bit: bit of the invalidation bytes that is set where a sample is not valid
    """

    name: str
    unit: str
    field: NumberField | None
    convert: Convert | RefusedChannel
    is_master: bool = False
    is_time: bool = True
    invalid_bit: int | None = None


@dataclass(frozen=True, eq=False)
class Records:
    """Samples of a channel group: bytes of each record, and its invalidation bytes, shape (n, length)."""

    content: Bytes
    invalid: Bytes

    def __len__(self) -> int:
        return len(self.content)


@dataclass(frozen=True, eq=False)
class ChannelGroup:
    """Channels sampled at the same instants; `master` is that of another group where this one has none."""

    channels: Sequence[MdfChannel]
    records: Records
    master: tuple[MdfChannel, Records] | None


def channel_values(channel: MdfChannel, records: Records, budget: ReadBudget) -> Array:
    """Return the physical values of a channel, nan where the file marks them as not valid.

    Raises:
        RefusedChannel: its conversion is not applied
        RefusedFile: the file would expand to more than it may, or the channel does not fit into its records
    """
    if isinstance(channel.convert, RefusedChannel):
        raise channel.convert
    budget.take_bytes(8 * len(records), f"channel {channel.name}")
    raw = np.arange(len(records), dtype=float) if channel.field is None else _raw(channel, channel.field, records.content)
    with np.errstate(all="ignore"):
        values = np.array(channel.convert(raw), float)
    if channel.invalid_bit is not None:
        byte, bit = divmod(channel.invalid_bit, 8)
        if byte >= records.invalid.shape[1]:
            raise RefusedFile(f"the invalidation bit of channel {channel.name} lies outside its record")
        values[(records.invalid[:, byte] >> bit) & 1 == 1] = np.nan
    return values


def _raw(channel: MdfChannel, field: NumberField, content: Bytes) -> Array:
    if field.byte + field.length > content.shape[1]:
        raise RefusedFile(f"channel {channel.name} lies outside its record of {content.shape[1]} bytes")
    if not 0 < field.bits <= 64 or (field.kind == "f" and (field.bit or field.bits not in FLOAT_BITS)):
        raise RefusedChannel(f"a number of {field.bits} bits at bit {field.bit} is not read")
    part = content[:, field.byte : field.byte + field.length]
    if field.bit == 0 and field.bits in (8, *FLOAT_BITS):
        order = ">" if field.is_big_endian else "<"
        kind = np.dtype(f"{order}{field.kind}{field.bits // 8}")
        return np.ascontiguousarray(part).view(kind)[:, 0].astype(float)
    return _bit_field(part[:, ::-1] if field.is_big_endian else part, field)


def _bit_field(part: Bytes, field: NumberField) -> Array:
    """Return integers of any length, from bytes whose lowest comes first."""
    whole = np.zeros(len(part), np.uint64)
    for place in range(field.length):
        shift = 8 * place - field.bit
        byte = part[:, place].astype(np.uint64)
        whole |= byte << np.uint64(shift) if shift >= 0 else byte >> np.uint64(-shift)
    unused = np.uint64(64 - field.bits)
    whole = whole << unused
    if field.kind == "i":
        return (whole.view(np.int64) >> unused.astype(np.int64)).astype(float)
    return (whole >> unused).astype(float)


class RecordLayout(NamedTuple):
    """Layout of the records of a channel group within its data group.

    Args:
        records: how many records the file claims
        length: bytes of a record without its number; None if each begins with its own length in four bytes
        invalid: last bytes of `length` that are invalidation bytes
    """

    records: int
    length: int | None
    invalid: int = 0


def records_of(
    data: Bytes, layouts: Mapping[int, RecordLayout], id_bytes: int, budget: ReadBudget, id_bytes_behind: int = 0
) -> dict[int, Records]:
    """Return the records of each channel group of a data group, by the number that stands before each record.

    Raises:
        RefusedFile: the data contain fewer records than the file claims, or other ones
    """
    wanted = {number: layout for number, layout in layouts.items() if layout.length is not None}
    if len(layouts) == 1 and len(wanted) == 1:
        ((number, layout),) = wanted.items()
        return {number: _of_one(data, number, layout, id_bytes, id_bytes_behind)}
    budget.take_bytes(len(data), "sorting its records")
    starts = _starts(data, layouts, id_bytes, id_bytes_behind, budget)
    whole = data.tobytes()
    records = {}
    for number, layout in wanted.items():
        length, there = layout.length or 0, starts[number][: layout.records]
        _check_count(len(starts[number]), layout.records)
        content = np.frombuffer(b"".join(whole[start : start + length] for start in there), np.uint8)
        records[number] = _split(content.reshape(len(there), length), layout)
    return records


def _of_one(data: Bytes, number: int, layout: RecordLayout, id_bytes: int, id_bytes_behind: int) -> Records:
    """Return the records of a data group that has one channel group."""
    stride = id_bytes + (layout.length or 0) + id_bytes_behind
    count = layout.records if stride else 0
    _check_count(len(data) // max(stride, 1), count)
    rows = data[: count * stride].reshape(count, stride)
    expected = np.frombuffer(number.to_bytes(8, "little")[:id_bytes], np.uint8)
    if (rows[:, :id_bytes] != expected).any():
        raise RefusedFile(f"a record has another number than {number}, which is that of its channel group")
    return _split(rows[:, id_bytes : id_bytes + (layout.length or 0)], layout)


def _split(rows: Bytes, layout: RecordLayout) -> Records:
    end = rows.shape[1] - layout.invalid
    if end < 0:
        raise RefusedFile(f"a record of {rows.shape[1]} bytes cannot have {layout.invalid} invalidation bytes")
    return Records(rows[:, :end], rows[:, end:])


def _check_count(found: int, claimed: int) -> None:
    if claimed > found:
        raise RefusedFile(f"claims {claimed} records, but its data contain {found}; it is damaged or was not closed")


def _starts(
    data: Bytes, layouts: Mapping[int, RecordLayout], id_bytes: int, id_bytes_behind: int, budget: ReadBudget
) -> dict[int, list[int]]:
    """Return where the records of each channel group begin."""
    if not id_bytes and len(data):
        raise RefusedFile("has several channel groups in one data group, whose records have no number")
    whole, place, count = data.data, 0, 0
    starts: dict[int, list[int]] = {number: [] for number in layouts}
    while place < len(whole):
        number = int.from_bytes(whole[place : place + id_bytes], "little")
        place += id_bytes
        if number not in layouts:
            raise RefusedFile(f"a record has the number {number}, which is that of no channel group")
        budget.take_bytes(BYTES_OF_RECORD, "sorting its records")
        starts[number].append(place)
        length = layouts[number].length
        place += 4 + int.from_bytes(whole[place : place + 4], "little") if length is None else length
        place += id_bytes_behind
        count += 1
        if count > MAX_UNSORTED_RECORDS:
            raise RefusedFile(f"has more than {MAX_UNSORTED_RECORDS} unsorted records; sort it where it was recorded")
    if place > len(whole):
        raise RefusedFile("its last record is not whole; it is damaged or was not closed")
    return starts
