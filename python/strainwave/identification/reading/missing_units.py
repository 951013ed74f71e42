"""Units that a file does not state, from its numbers: steps of an encoder, an angle and its speed, the range of a joint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.files.units import convert, counts, measures
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.names import UNITS
from strainwave.messages import as_option, quoted

Array = NDArray[np.float64]

ANGLES = ("rad", "deg", "rev")
SPEEDS = ("rad/s", "deg/s", "rpm")
LIKE = 0.15  # relative: an angle's slope and a speed that differ by less are in units that fit
FINEST = 40  # bits of an encoder
COARSEST = 6
MULTIPLES = 0.95  # of the steps of an encoder that are whole multiples of the smallest
EQUAL = 1e-3  # relative: a step and a part of a revolution
JOINT = 4.0 * np.pi  # rad: a joint that is written in radians does not get further, two turns to each side
EPOCHS = ((1e17, "ns"), (1e14, "us"), (1e11, "ms"), (1e8, "s"))  # what time since 1970 exceeds, in each unit
FINER = ("ms", "us", "ns")  # than a second
DIFFERENCES = (5000, 200)  # parts of a record over which slopes are taken, the finest first: encoders have steps
RATES = (50.0, 100.0, 125.0, 200.0, 250.0, 400.0, 500.0, 800.0, 2000.0, 2500.0, 4000.0, 5000.0, 8000.0, 10_000.0)  # Hz, usual
NEAR = 0.03  # relative: a rate of rows that differs by less from a usual one is this one
NEAR_COUNTS = 3e-3  # relative: counts of a revolution that differ by less from a usual number are this one
WRAP = 0.5  # of the range of an angle: by more it does not move within a thousandth of a log, but where it begins anew
SLOWEST = 0.2  # s: rows further apart are none of a log in seconds


class Assumed(NamedTuple):
    """A unit that is not stated.

    Args:
        unit: the unit
        why: what determines it; empty if nothing does
        sure: True if that leaves no other
        scale: of that unit, in which the numbers count, as rows do the time between them
    """

    unit: str
    why: str
    sure: bool = False
    scale: float = 1.0

    @property
    def told(self) -> str:
        return f"{self.unit} {self.why}".strip()


def missing_units(columns: Sequence[Column], raw: Mapping[int, Array]) -> dict[int, Assumed]:
    """The units of the columns that state none, by their places.

    Args:
        columns: all, with the units that are stated or given
        raw: their numbers as they stand in the file, by their places

    Raises:
        ValueError: numbers may be in any unit
    """
    found = {
        column.position: (_of_time(column, columns, raw) if column.channel.quantity == "time" else _alone(column, values))
        for column, values in ((column, raw[column.position]) for column in columns)
        if column.unit is None
    }
    units = {column.position: column.unit or found[column.position].unit for column in columns}
    time = next((column for column in columns if column.channel.quantity == "time"), None)
    sure = {place for place in units if place not in found or found[place].why}
    if time is None:
        return found
    for angle, speed in _pairs(columns):
        if angle.position in sure and speed.position in sure:
            continue
        slope = _slope(raw[angle.position], raw[speed.position], convert(raw[time.position], units[time.position], "s"))
        for angle_unit, speed_unit in _fitting(slope, units, angle, speed, sure):
            for column, unit in ((angle, angle_unit), (speed, speed_unit)):
                if column.position in found and not found[column.position].why:
                    found[column.position] = Assumed(unit, f"as it fits {speed.name if column is angle else angle.name}")
                    units[column.position] = unit
                    sure.add(column.position)
            break
    return found


def counts_of_revolution(columns: Sequence[Column], raw: Mapping[int, Array]) -> dict[int, int]:
    """The counts of one revolution of encoders beside their speed, by their places; those that are a usual number.

    Args:
        columns, raw: as of `missing_units`
    """
    times = [convert(raw[c.position], c.unit, "s") for c in columns if c.channel.quantity == "time" and c.unit is not None]
    found = dict[int, int]()
    for angle, speed in _pairs(columns) if times else ():
        is_counted = angle.unit is not None and counts(angle.unit) and not measures(angle.unit, "rad")
        if not is_counted or speed.unit is None or not measures(speed.unit, "rad/s"):
            continue
        slope = _slope(raw[angle.position], raw[speed.position], times[0])
        per_turn = 1.0 / turns if (turns := convert(abs(slope), speed.unit, "rev/s")) > 0.0 else 0.0
        bits = round(np.log2(per_turn)) if per_turn > 1.0 else 0
        usual = (2**bits, 100 * round(per_turn / 100.0)) if COARSEST <= bits <= FINEST else ()
        near = next((each for each in usual if each and abs(per_turn / each - 1.0) < NEAR_COUNTS), None)
        if near is not None:
            found[angle.position] = near
    return found


def other_units(columns: Sequence[Column]) -> list[dict[int, str]]:
    """Other units that the columns without a stated one may be in, by their places: those that fit their numbers as well.

    Args:
        columns: with the units that were assumed of those that state none, and their values
    """
    angles = [c for c in columns if c.is_open and c.channel.quantity == "angle" and not c.channel.commanded]
    known = {speed.position for angle, speed in _pairs(columns) if not angle.is_open}
    speeds = [c for c in columns if c.is_open and c.channel.quantity == "speed" and c.position not in known]
    if not angles:
        units = [unit for unit in SPEEDS if speeds and unit != speeds[0].unit]
        return [{speed.position: unit for speed in speeds} for unit in units]
    if any(angle in angles and not speed.is_open for angle, speed in _pairs(columns)):
        return []
    found = []
    for unit in ANGLES:
        factor = convert(1.0, unit, "rad") / convert(1.0, str(angles[0].unit), "rad")
        units_of_speeds = [_unit_of_size(factor * convert(1.0, str(speed.unit), "rad/s")) for speed in speeds]
        if unit == angles[0].unit or None in units_of_speeds or any(_too_far(angle, factor) for angle in angles):
            continue
        paired = {speed.position: str(each) for speed, each in zip(speeds, units_of_speeds, strict=True)}
        found.append({**{angle.position: unit for angle in angles}, **paired})
    return found


def _too_far(angle: Column, factor: float) -> bool:
    """True if a joint would move further than joints do, were its angle so many times as large."""
    at_joint = angle.channel.side == "output" or (angle.robot and angle.channel.side is None)
    return at_joint and factor * float(np.abs(angle.si).max()) > JOINT


def _unit_of_size(size: float) -> str | None:
    """The unit of a speed by its size [rad/s]; None if none has it."""
    sizes = {unit: convert(1.0, unit, "rad/s") for unit in (*SPEEDS, "rev/s")}
    return next((unit for unit, each in sizes.items() if abs(size / each - 1.0) < EQUAL), None)


def _alone(column: Column, values: Array) -> Assumed:
    """What the numbers of a column tell by themselves."""
    there = values[np.isfinite(values)]
    if not there.size:
        return Assumed(UNITS[column.channel.quantity], "")
    match column.channel.quantity:
        case "temperature":
            return Assumed("degC", "as it would be too cold in K") if np.median(there) < 200.0 else Assumed("K", "")
        case "angle":
            return _of_angle(column, there)
        case quantity:
            return Assumed(UNITS[quantity], "")


def _of_time(column: Column, columns: Sequence[Column], raw: Mapping[int, Array]) -> Assumed:
    """Of stamps: by their size since 1970, by a step of a log in seconds, or by an angle and its speed in usual units."""
    values = raw[column.position][np.isfinite(raw[column.position])]
    late = float(np.abs(values).max(initial=0.0))
    for least, unit in EPOCHS:
        if late > least:
            return Assumed(unit, "since 1970")
    if len(values) > 1 and np.median(np.abs(np.diff(values))) < SLOWEST:
        return Assumed("s", "")
    for angle, speed in _pairs(columns):
        units = {each.position: each.unit or UNITS[each.channel.quantity] for each in (angle, speed)}
        sure = {each.position for each in (angle, speed) if each.unit is not None}
        slope = _slope(raw[angle.position], raw[speed.position], raw[column.position])
        for unit in FINER:
            if _fitting(slope * convert(1.0, unit, "s"), units, angle, speed, sure):
                return Assumed(unit, f"as {angle.name} then moves as {speed.name} says")
        counts_rows = bool((np.diff(values) == 1.0).all())
        for rate in RATES if counts_rows else ():
            if (
                slope
                and abs(convert(1.0, units[speed.position], "rad/s") * slope / rate / _size(units[angle.position]) - 1.0) < NEAR
            ):
                return Assumed(
                    "s", f"as it counts rows at {rate:g} Hz, at which {angle.name} moves as {speed.name} says", scale=1.0 / rate
                )
    hint = as_option("unit", "time", "ms")
    lasts = f" if the record lasted {np.ptp(values):.4g} ms" if len(values) else ""
    raise ValueError(
        f"column {quoted(column.name)} has no unit, and its steps do not determine it; give it: {hint}{lasts}; if it "
        "counts rows, give their rate: --constant rate=500"
    )


def _size(unit: str) -> float:
    return convert(1.0, unit, "rad")


def _of_angle(column: Column, values: Array) -> Assumed:
    """Radians, unless the steps of an encoder or the range of a joint tell otherwise."""
    step = smallest_step(values)
    for unit, turn in (("deg", 360.0), ("rad", 2.0 * np.pi), ("rev", 1.0)):
        if step and COARSEST <= (bits := round(np.log2(turn / step))) <= FINEST and abs(turn / step / 2.0**bits - 1.0) < EQUAL:
            return Assumed(unit, f"as its steps are those of an encoder of {bits} bits", True)
    at_joint = column.channel.side == "output" or (column.robot and column.channel.side is None)
    if at_joint and np.abs(values).max() > JOINT:
        return Assumed("deg", f"as a joint does not reach {np.abs(values).max():.4g} rad")
    return Assumed("rad", "")


def smallest_step(values: Array) -> float | None:
    """The step of which all steps of a series are whole multiples; None where there is none.

    >>> smallest_step(np.array([0.0, 0.5, 0.5, 2.0, 1.5, 3.0, 3.5]))
    0.5
    """
    steps = np.abs(np.diff(values[:100_000]))
    steps = steps[steps > 1e-12 * max(float(np.abs(values).max()), 1e-300)]
    if steps.size < 5:
        return None
    near = steps[steps < 20.0 * steps.min()]
    least = float(np.mean(near / np.round(near / steps.min())))
    near = steps[steps < 20.0 * least] / least
    off = np.abs(near - np.round(near))
    return least if np.mean(off < 0.02) > MULTIPLES and len(near) >= 5 else None


def _pairs(columns: Sequence[Column]) -> list[tuple[Column, Column]]:
    """Angles and speeds of one shaft."""
    kinds = [[c for c in columns if c.channel.quantity == name and not c.channel.commanded] for name in ("angle", "speed")]
    return [(angle, speed) for angle in kinds[0] for speed in kinds[1] if angle.channel.side == speed.channel.side]


@np.errstate(all="ignore")
def _slope(angle: Array, speed: Array, time: Array) -> float:
    """How much of the speed there is for each unit of the angle's slope, by least squares; 0 where nothing moves.

    Where an angle begins anew with each revolution it has no slope.
    """
    for parts in DIFFERENCES:
        if slope := _slope_over(angle, speed, time, max(2, len(time) // parts)):
            return slope
    return 0.0


@np.errstate(all="ignore")
def _slope_over(angle: Array, speed: Array, time: Array, apart: int) -> float:
    """The same over rows that are so far apart."""
    if len(time) <= apart:
        return 0.0
    moved = angle[apart:] - angle[:-apart]
    smooth = np.abs(moved) < WRAP * (np.nanmax(angle) - np.nanmin(angle))
    forward = np.flatnonzero(np.isfinite(moved + speed[apart:]) & (time[apart:] > time[:-apart]) & smooth)
    rate = moved[forward] / (time[apart:] - time[:-apart])[forward]
    middle = speed[forward + apart // 2]
    square = float(rate @ rate)
    related = square > 0.0 and middle @ middle > 0.0 and (rate @ middle) ** 2 > 0.5 * square * (middle @ middle)
    return float(rate @ middle) / square if related and np.isfinite(square) else 0.0


def _fitting(slope: float, units: Mapping[int, str], angle: Column, speed: Column, sure: set[int]) -> list[tuple[str, str]]:
    """Pairs of units that make the slope of the angle the speed; those in radians first."""
    pairs = []
    for one in (units[angle.position],) if angle.position in sure else ANGLES:
        for other in (units[speed.position],) if speed.position in sure else SPEEDS if one != "rev" else ("rev/s", *SPEEDS):
            expected = convert(1.0, f"{one}/s", other)
            if abs(slope / expected - 1.0) < LIKE:
                pairs.append((one, other))
    return pairs
