"""Units that a file does not state: of known recorders, by numbers, or with a number that is missing."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.files.units import convert, counts, is_share, measures
from strainwave.identification.reading.motion import MAX_OFF_SPEED, speed_per_slope
from strainwave.identification.reading.names import UNITS
from strainwave.identification.reading.roles import Column
from strainwave.identification.reading.times import is_file_time
from strainwave.messages import as_option, listed, one_line, quoted
from strainwave.questions import LOG_AT_RATE, Answer, QuestionError

Array = NDArray[np.float64]

ANGLE_UNITS = {"rad": 2.0 * np.pi, "deg": 360.0, "rev": 1.0}  # units, and a revolution in each
SPEED_UNITS = ("rad/s", "deg/s", "rpm")
EPOCH_UNITS = ((1e18, "ns"), (1e14, "us"), (1e11, "ms"), (1e8, "s"))  # smallest time since 1970 in each unit
# Hz, usual.
USUAL_RATES = (50.0, 100.0, 125.0, 200.0, 250.0, 400.0, 500.0, 800.0, 2000.0, 2500.0, 4000.0, 5000.0, 8000.0, 10_000.0)
MIN_BITS, MAX_BITS = 6, 40  # of an encoder
MAX_OFF_RATE = 0.03  # relative difference of the rate of rows from a usual one
MAX_OFF_EXACT_SPEED = 0.02  # relative difference of a speed from the slope of its angle, in the right units
MAX_OFF_STEP = 1e-3  # relative difference of a step from a part of a revolution
MIN_SHARE_OF_MULTIPLES = 0.95  # of the steps of an encoder
MAX_JOINT_ANGLE = 4.0 * np.pi  # rad: two turns to each side, the most that joints have
MIN_JOINT_RANGE = 0.1  # rad: a joint that moves by less in a log shows neither gravity nor inertia
MAX_STEP_OF_LOG = 0.2  # s
MIN_KELVIN = 200.0  # K: gears are not colder


class Assumed(NamedTuple):
    """The unit of a column.

    Args:
        unit: the unit
        why: what determines it; empty if nothing does
        sure: True if no other one is possible
        scale: of that unit, in which the numbers count, as rows do the time between them
    """

    unit: str
    why: str = ""
    sure: bool = False
    scale: float = 1.0


def units_of(columns: Sequence[Column]) -> dict[int, Assumed]:
    """Return the units of columns, by their positions: those stated, else those that numbers determine, else the usual ones.

    Args:
        columns: with the units that are stated or given, and their numbers

    Raises:
        QuestionError: a time may be in any unit
    """
    units = {column.position: _by_itself(column, columns) for column in columns}
    time = next((column for column in columns if column.channel.quantity == "time"), None)
    for pair in pairs_of_shafts(columns) if time is not None else ():
        of_pair = [units[each.position].unit if units[each.position].why else None for each in pair]
        if time is None or None not in of_pair:
            continue
        slope = abs(speed_per_slope(pair[0].raw, pair[1].raw, convert(time.raw, units[time.position].unit, "s")))
        for column, other, own, unit in zip(pair, pair[::-1], of_pair, next(iter(_fitting(slope, *of_pair)), ()), strict=False):
            is_usual = column is pair[0] and of_pair[1] is None and unit == UNITS["angle"]
            if own is None:
                units[column.position] = Assumed(unit, "as is usual" if is_usual else f"as it fits {other.name}")
    return units


def other_units(columns: Sequence[Column]) -> list[dict[int, str]]:
    """Return other units that fit the numbers of the columns without a stated one as well, by their positions.

    Args:
        columns: with the units that were assumed of those that state none, and their values
    """
    angles = [c for c in columns if not c.sure and c.channel.quantity == "angle" and not c.channel.commanded]
    with_sure_angle = {speed.position for angle, speed in pairs_of_shafts(columns) if angle.sure}
    speeds = [c for c in columns if not c.sure and c.channel.quantity == "speed" and c.position not in with_sure_angle]
    if not angles:
        units = [unit for unit in SPEED_UNITS if speeds and unit != speeds[0].unit]
        return [{speed.position: unit for speed in speeds} for unit in units]
    if any(angle in angles and speed.sure for angle, speed in pairs_of_shafts(columns)):
        return []
    ways, of_units = [], {unit: convert(1.0, unit, "rad/s") for unit in (*SPEED_UNITS, "rev/s")}
    for unit in ANGLE_UNITS:
        factor = convert(1.0, unit, "rad") / convert(1.0, str(angles[0].unit), "rad")
        sizes = [factor * convert(1.0, str(speed.unit), "rad/s") for speed in speeds]
        units_of_speeds = [
            next((name for name, own in of_units.items() if abs(size / own - 1.0) < MAX_OFF_STEP), None) for size in sizes
        ]
        if unit == angles[0].unit or None in units_of_speeds or not all(_may_move(angle, factor) for angle in angles):
            continue
        paired = {speed.position: str(each) for speed, each in zip(speeds, units_of_speeds, strict=True)}
        ways.append({**{angle.position: unit for angle in angles}, **paired})
    return ways


def bits_of(counts: float, max_off: float) -> int | None:
    """Return the bits of an encoder with so many counts a revolution; None if they are no power of two.

    Args:
        counts: of a revolution [1]
        max_off: largest relative difference from the power of two [1]
    """
    bits = round(np.log2(counts)) if counts > 1.0 else 0
    return bits if MIN_BITS <= bits <= MAX_BITS and abs(counts / 2.0**bits - 1.0) < max_off else None


def _may_move(angle: Column, factor: float) -> bool:
    """True if a joint may move as far as it would, were its angle so many times as large."""
    furthest, moved = factor * float(np.abs(angle.si).max()), factor * float(np.ptp(angle.si))
    return not angle.at_joint or (furthest < MAX_JOINT_ANGLE and (moved > MIN_JOINT_RANGE or factor > 1.0))


def _by_itself(column: Column, columns: Sequence[Column]) -> Assumed:
    """Return the unit of a column that is stated, or that its own numbers determine, or the usual one."""
    values = column.raw[np.isfinite(column.raw)]
    if column.channel.quantity == "time" and is_file_time(values):
        return Assumed("us", "as it counts tenths of them since 1601", True, scale=0.1)
    if column.unit is not None:
        return Assumed(column.unit, "stated", True)
    match column.channel.quantity:
        case "time":
            return _of_time(column, values, columns)
        case "temperature" if len(values) and np.median(values) < MIN_KELVIN:
            return Assumed("degC", "as it would be too cold in K")
        case "angle" if len(values):
            return _of_angle(column, values)
    return Assumed(UNITS[column.channel.quantity])


def _of_time(column: Column, values: Array, columns: Sequence[Column]) -> Assumed:
    """Return the unit of stamps: by their size since 1970, by a step of a log, or by an angle and its speed in usual units."""
    latest = float(np.abs(values).max(initial=0.0))
    if unit := next((unit for least, unit in EPOCH_UNITS if latest > least), None):
        return Assumed(unit, "since 1970")
    if len(values) > 1 and np.median(np.abs(np.diff(values))) < MAX_STEP_OF_LOG:
        return Assumed("s")
    counts_rows = bool((np.diff(values) == 1.0).all())
    for angle, speed in pairs_of_shafts(columns):
        slope, then = abs(speed_per_slope(angle.raw, speed.raw, column.raw)), f"{speed.name} is then the slope of {angle.name}"
        for unit in ("ms", "us", "ns"):
            if _fitting(slope * convert(1.0, unit, "s"), angle.unit, speed.unit):
                return Assumed(unit, f"as {then}")
        expected = convert(1.0, f"{angle.unit or UNITS['angle']}/s", speed.unit or UNITS["speed"])
        for rate in USUAL_RATES if counts_rows else ():
            if abs(slope / rate / expected - 1.0) < MAX_OFF_RATE:
                return Assumed("s", f"as it counts rows at {rate:g} Hz: {then}", scale=1.0 / rate)
    lasted = float(np.ptp(values)) if len(values) else 0.0
    ways = [
        Answer(f"in {unit}: the record lasted {convert(lasted, unit, 's'):.4g} s", {"units": {column.label.name: unit}})
        for unit in ("ms", "us", "s")
    ]
    raise QuestionError(
        f"column {quoted(column.name)} has no unit, and its steps do not determine it",
        [*ways, *[replace(LOG_AT_RATE, label="it counts rows")] * counts_rows],
    )


def _of_angle(column: Column, values: Array) -> Assumed:
    """Return radians, unless the steps of an encoder or the range of a joint determine another unit."""
    step = smallest_step(values)
    for unit in ("deg", "rad", "rev"):
        if step and (bits := bits_of(ANGLE_UNITS[unit] / step, MAX_OFF_STEP)):
            return Assumed(unit, f"as its steps are those of an encoder of {bits} bits", True)
    if column.at_joint and np.abs(values).max() > MAX_JOINT_ANGLE:
        return Assumed("deg", f"as a joint does not reach {np.abs(values).max():.4g} rad")
    return Assumed("rad")


def smallest_step(values: Array) -> float | None:
    """Return the step of which all steps of a series are whole multiples; None if there is none.

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
    return least if np.mean(off < 0.02) > MIN_SHARE_OF_MULTIPLES and len(near) >= 5 else None


def pairs_of_shafts(columns: Sequence[Column]) -> list[tuple[Column, Column]]:
    """Return angles and speeds of one shaft."""
    own = [column for column in columns if not column.channel.commanded]
    angles, speeds = ([column for column in own if column.channel.quantity == each] for each in ("angle", "speed"))
    return [(angle, speed) for angle in angles for speed in speeds if angle.channel.side == speed.channel.side]


def _fitting(slope: float, angle: str | None, speed: str | None) -> list[tuple[str, str]]:
    """Return units of an angle and its speed in which the speed is the slope; None is open.

    Those in which it is nearly exactly come first, as rpm are 1.05 times °/s beside rev and rad; of these radians.
    """
    pairs = [
        (one, other)
        for one in (ANGLE_UNITS if angle is None else (angle,))
        for other in ((speed,) if speed is not None else SPEED_UNITS if one != "rev" else ("rev/s", *SPEED_UNITS))
    ]
    off = {pair: abs(slope / convert(1.0, f"{pair[0]}/s", pair[1]) - 1.0) for pair in pairs}
    return sorted((pair for pair in pairs if off[pair] < MAX_OFF_SPEED), key=lambda pair: off[pair] > MAX_OFF_EXACT_SPEED)


# ---- Units that need a number ----------------------------------------------------------------------------------------


COUNTS_EXAMPLE = "counts/16384"  # for example
USUAL_RATIOS = (100.0, 50.0, 80.0, 120.0, 160.0, 30.0)  # of catalogues, the most usual first
MIN_RANGE_OF_COUNTS = 1000  # range of whole numbers that are counts of an encoder
MIN_RANGE_OF_SHARES, MIN_ROWS_OF_SHARES = 20, 100  # range and rows of whole numbers that are shares of a rated torque
MAX_OFF_COUNTS = 3e-3  # relative difference of the counts of a revolution from a usual number


def with_counts(columns: Sequence[Column]) -> tuple[list[Column], list[str]]:
    """Return the columns, with the counts of a revolution if the speed of an encoder determines them; and remarks."""
    time = next((convert(c.raw, c.unit, "s") for c in columns if c.channel.quantity == "time" and c.unit is not None), None)
    counted, remarks = list(columns), list[str]()
    for angle, speed in pairs_of_shafts(columns):
        is_counted = angle in counted and counts(_incomplete_unit(angle))
        if time is not None and is_counted and speed.unit is not None and measures(speed.unit, "rad/s"):
            turns = convert(abs(speed_per_slope(angle.raw, speed.raw, time)), speed.unit, "rev/s")
            per_turn = 1.0 / turns if turns > 0.0 else 0.0
            bits, hundreds = bits_of(per_turn, MAX_OFF_COUNTS), 100 * round(per_turn / 100.0)
            is_hundreds = hundreds and abs(per_turn / hundreds - 1.0) < MAX_OFF_COUNTS
            if number := int(2**bits) if bits else hundreds if is_hundreds else 0:
                counted[counted.index(angle)] = replace(angle, unit=f"counts/{number}")
                remarks.append(f"a revolution has {number} counts of {angle.name}, as its speed shows")
    return counted, remarks


def check_units(columns: Sequence[Column], ratio: float | None) -> None:
    """Ask for the numbers that units need and the file does not contain.

    Args:
        columns: with the units that are stated or given, and their numbers
        ratio: of the gear, if a person gave it

    Raises:
        QuestionError: a unit needs the counts of a revolution, or a rated value
    """
    needs = {column.label.name: unit for column in columns if (unit := _incomplete_unit(column))}
    if not needs:
        return
    counted = [column for column in columns if counts(needs.get(column.label.name, ""))]
    shares = [name for name, unit in needs.items() if not counts(unit)]
    numbers = {column.label.name: "counts of a revolution" for column in counted}
    numbers |= {name: f"rated value of which {one_line(name)} is a share" for name in shares}
    whys = list[str]()
    for column in counted:
        name = column.label.name
        if needs[name] == COUNTS_EXAMPLE and (by_joint := _counts_by_joint(column, columns, ratio)) is not None:
            needs[name], why = f"counts/{by_joint[0]}", by_joint[1]
            whys.append(why)
            del numbers[name]
    lacks = [f"how many counts a revolution has in {listed(column.name for column in counted)}"] if counted else []
    lacks += [f"of which rated value {listed(shares)} is a share"] if shares else []
    answer = Answer(listed(whys) or "with the numbers of the drive", {"units": needs}, numbers)
    raise QuestionError(f"the file does not contain {' and '.join(lacks)}", [answer])


def _counts_by_joint(column: Column, columns: Sequence[Column], ratio: float | None) -> tuple[int, str] | None:
    """Return the counts of a motor's encoder from an angle of the joint and a ratio that makes them 2^n; and the reason."""
    joint = next((c for c in columns if c.channel.quantity == "angle" and c.unit and measures(c.unit, "rad")), None)
    if joint is None or joint.unit is None or column.channel.quantity != "angle":
        return None
    turns, counted = convert(joint.raw, joint.unit, "rev"), column.raw
    there = np.isfinite(turns + counted)
    if not np.ptp(turns[there]) > 0.0:
        return None
    per_turn = abs(float(np.polyfit(turns[there], counted[there], 1)[0]))
    for each in USUAL_RATIOS if ratio is None else (abs(ratio),):
        if bits := bits_of(per_turn / each, MAX_OFF_COUNTS):
            return 2**bits, f"{2**bits} at a ratio of {each:g}, as {joint.name} turns once in {per_turn:.6g} counts"
    return None


def _incomplete_unit(column: Column) -> str:
    """Return the unit of a column as it may be with a number that is missing; empty if it is complete."""
    share = f"permille of {'0.4 N.m' if column.channel.quantity == 'torque' else '10 A'}"
    if column.unit is not None:
        if is_share(column.unit):
            return share.replace("permille", "%") if column.unit.strip() in ("%", "percent") else share
        counted = f"{COUNTS_EXAMPLE}/s" if column.channel.quantity == "speed" else COUNTS_EXAMPLE
        return counted if counts(column.unit) and not measures(column.unit, column.channel.unit) else ""
    values = column.raw[np.isfinite(column.raw)]
    if len(values) < 2 or not (values == np.round(values)).all():
        return ""
    if column.channel.quantity == "angle":
        return COUNTS_EXAMPLE if np.ptp(values) > MIN_RANGE_OF_COUNTS else ""
    is_torque = column.channel.quantity == "torque" and column.channel.measured
    return share if is_torque and len(values) > MIN_ROWS_OF_SHARES and np.ptp(values) >= MIN_RANGE_OF_SHARES else ""


# ---- Registers of known recorders ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Registers:
    """Registers of a recorder.

    Args:
        recorder: its name
        counts: size of one count of each register, and its unit
        angle, speed: registers of one shaft, which must agree with each other
        other: the register whose count differs in other models of the recorder, and its unit there
        source: where the maker states this
    """

    recorder: str
    counts: Mapping[str, tuple[float, str]]
    angle: str
    speed: str
    other: tuple[str, str]
    source: str


DYNAMIXEL_X = Registers(
    "Dynamixel X",
    {"present_position": (1.0 / 4096.0, "rev"), "present_velocity": (0.229, "rpm"), "present_current": (2.69e-3, "A")},
    "present_position",
    "present_velocity",
    ("present_current", "mA"),
    "ROBOTIS e-Manual, control table of XM430",
)
KNOWN_RECORDERS = (DYNAMIXEL_X,)
# Names of torques of libfranka, whose numbers are in SI units (its reference, RobotState).
LIBFRANKA_TORQUE = re.compile(r"(\w+\.)?tau_J(_d)?\W*\d*\W*")
LIBFRANKA_UNITS = {"angle": "rad", "speed": "rad/s", "torque": "N.m"}


def with_registers(columns: Sequence[Column]) -> tuple[list[Column], list[str]]:
    """Return the columns of a known recorder in their units; and remarks.

    Registers are whole numbers without a unit. The speed must be the slope of the angle by what their counts are.
    """
    if any(LIBFRANKA_TORQUE.fullmatch(column.label.name) for column in columns):
        in_units = [replace(each, unit=each.unit or LIBFRANKA_UNITS.get(each.channel.quantity)) for each in columns]
        return in_units, ["columns of libfranka are in rad, rad/s and N·m"]
    time = next((convert(c.raw, c.unit or "s", "s") for c in columns if c.channel.quantity == "time"), None)
    for registers in KNOWN_RECORDERS:
        own = {column.label.name.casefold(): column for column in columns if column.label.name.casefold() in registers.counts}
        if time is None or not {registers.angle, registers.speed} <= own.keys() or not all(map(_is_raw, own.values())):
            continue
        counts_of = {name: registers.counts[name] for name in own}
        scaled = {name: replace(own[name], raw=size * own[name].raw, unit=unit) for name, (size, unit) in counts_of.items()}
        angle, speed = scaled[registers.angle], scaled[registers.speed]
        expected = convert(1.0, f"{angle.unit}/s", str(speed.unit))
        if abs(abs(speed_per_slope(angle.raw, speed.raw, time)) / expected - 1.0) > MAX_OFF_SPEED:
            continue
        sizes = listed(f"{own[name].name} in {registers.counts[name][0]:.4g} {registers.counts[name][1]}" for name in scaled)
        name, unit = registers.other
        other = f"; other models count {unit}: {as_option('unit', own[name].name, unit)}" if name in own else ""
        remark = f"raw registers of {registers.recorder}, whose speed is the slope of the angle: {sizes}{other}"
        places = {each.position: each for each in scaled.values()}
        return [places.get(column.position, column) for column in columns], [remark]
    return list(columns), []


def _is_raw(column: Column) -> bool:
    """True for whole numbers without a unit."""
    values = column.raw[np.isfinite(column.raw)]
    return column.unit is None and bool((values == np.round(values)).all())
