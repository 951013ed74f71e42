"""The columns that seem to be channels, which of them is which channel, and at which side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import Label
from strainwave.files.units import measures
from strainwave.identification.reading.names import Channel, Quantity, Side, meaning
from strainwave.messages import MAX_TEXT, listed, one_line
from strainwave.questions import OF_SIDES, Answer, QuestionError

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Column:
    """A column that seems to be a channel.

    Args:
        position: in the file, from 0
        label: its header in the file
        channel: what it measures
        which: the rest of its name, as the number of a joint
        robot: True if its name is that of a robot's joint channel
        by_user: True if a person named it
        neighbour: True for the angle of another joint than the one that is asked for
        regressor: True for a torque of which an unknown share acts
        unit: its unit in the file; None if none is stated
        sure: True if its unit is stated, or its numbers allow no other
        estimated: True if its name is that of an estimate
        raw: its numbers in the file, once they are read, nan in empty cells
        si: the same in SI units
    """

    position: int
    label: Label
    channel: Channel
    which: str = ""
    robot: bool = False
    by_user: bool = False
    neighbour: bool = False
    regressor: bool = False
    unit: str | None = None
    sure: bool = True
    estimated: bool = False
    raw: Array = field(default_factory=lambda: np.zeros(0))
    si: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def own(self) -> bool:
        """True for a channel of the joint that is asked for."""
        return not (self.neighbour or self.regressor)

    @property
    def name(self) -> str:
        """Name in the file, as messages and reports show it: on one line, without characters that a terminal obeys."""
        return one_line(self.label.name)

    @property
    def reference(self) -> str:
        """Name in the file; its number from 1 if its name cannot be typed."""
        name = self.label.name
        return name if self.name == name and len(name) <= MAX_TEXT else str(self.position + 1)

    @property
    def at_joint(self) -> bool:
        """True if it is measured at the output by its name, or called like a channel of a robot's joint."""
        return self.channel.side == "output" or (self.robot and self.channel.side is None)

    @property
    def si_unit(self) -> str:
        """Unit of `si`: a command may be an angle or a voltage."""
        return "V" if self.channel.commanded and self.unit is not None and measures(self.unit, "V") else self.channel.unit


# ---- Roles -----------------------------------------------------------------------------------------------------------


MAX_NAMED = 8  # columns of one list


@dataclass(frozen=True)
class ColumnRoles:
    """The kind of a set of columns, and the channel of each.

    Args:
        kind: of measurement
        columns: by the names of the channels
        side: at which it was measured, if that is one
        why: what determines it
        remarks: what was assumed
    """

    kind: str
    columns: dict[str, Column]
    side: Side | None
    why: tuple[str, ...]
    remarks: tuple[str, ...] = ()


def measured(columns: Sequence[Column], *quantities: Quantity) -> list[Column]:
    """Return the measured columns of quantities, those of the first quantity first."""
    return [column for each in quantities for column in columns if column.channel.quantity == each and column.channel.measured]


def commanded(columns: Sequence[Column], quantity: Quantity) -> list[Column]:
    """Return the references of a quantity."""
    return [column for column in columns if column.channel.quantity == quantity and column.channel.commanded]


def first(columns: Sequence[Column], quantity: Quantity) -> dict[str, Column]:
    """Return the first measured column of a quantity by its name; empty if there is none."""
    return {str(quantity): column for column in measured(columns, quantity)[:1]}


def needed_effort(columns: Sequence[Column], title: str) -> tuple[Quantity, Column]:
    """Return the one torque, or the one current if no torque was measured, with its quantity; raises as `needed`."""
    quantity: Quantity = "torque" if measured(columns, "torque") else "current"
    return quantity, needed(columns, quantity, title)


def needed(columns: Sequence[Column], quantity: Quantity, title: str) -> Column:
    """Return the one column of a quantity, or the one that a person named.

    Args:
        columns: of the file
        quantity: that it must have
        title: of the kind of measurement that needs it

    Raises:
        QuestionError: there is none, or several
    """
    candidates = measured(columns, quantity)
    candidates = candidates if len(candidates) == 1 else [column for column in candidates if column.by_user] or candidates
    if len(candidates) == 1:
        return candidates[0]
    lack = f"each of {names_of(candidates)} may be it" if candidates else f"it has {names_of(columns)}"
    raise QuestionError(f"{title} needs one {quantity}: {lack}", columns_for(quantity, candidates))


def channels(wanted: Mapping[str, Sequence[Column]]) -> dict[str, Column]:
    """Return the column of each channel, of those that may be it; raises as `put`."""
    by_channel = dict[str, Column]()
    for name, columns in wanted.items():
        for column in columns:
            put(by_channel, name, column)
    return by_channel


def put(found: dict[str, Column], name: str, column: Column) -> None:
    """Add the column of a channel; one that a person named replaces one that has it by its name.

    Raises:
        QuestionError: both may be the channel
    """
    if name not in found or (column.by_user and not found[name].by_user):
        found[name] = column
    elif column.by_user or not found[name].by_user:
        both = [found[name], column]
        raise QuestionError(f"{pair(*both)} may both be the {name}", columns_for(name, both))


def columns_for(name: str, columns: Sequence[Column]) -> list[Answer]:
    """Return the answers to which of some columns is a channel."""
    return [Answer(column.name, {"columns": {name: column.reference}}) for column in columns]


def names_of(columns: Sequence[Column]) -> str:
    """Return the names of columns in one list, of many the first ones and their number."""
    names = [column.name for column in columns]
    return listed(names) if len(names) <= MAX_NAMED else f"{listed(names[:MAX_NAMED])} and {len(names) - MAX_NAMED} more"


# ---- Sides -----------------------------------------------------------------------------------------------------------


MAX_JOINT_SPEED, MAX_JOINT_RANGE = 400.0, 720.0  # deg/s and deg: beyond them, numbers without a unit are no joint in degrees
MIN_MOTOR_SPEED = 60.0  # rad/s, 570 1/min: no output of a strain wave gear is as fast
SPEED_QUANTILE = 0.9  # of the time, in which a motor that is recognised by its speed may be slower
MAX_FACTOR_OF_SIDE = 2.0  # between the median speeds of two channels of one side
MIN_FACTOR_OF_SIDES = 10.0  # between the ranges of the angles of input and output
AS_WAS_GIVEN = "as was given"  # of a side


def side_of_table(speed: Column, torque: Column, given: Side | None) -> tuple[Side, str]:
    """Return the side at which a table of friction was measured, and what determines it."""
    if given is not None:
        return given, f"it was measured at the {given}, {AS_WAS_GIVEN}"
    if side := speed.channel.side or torque.channel.side:
        return side, f"by its names it was measured at the {side}"
    if speed.robot or torque.robot:
        return "output", f"{pair(speed, torque)} are what robots call the channels of a joint: measured at the output"
    fastest = float(np.abs(speed.si).max())
    if fastest > MIN_MOTOR_SPEED:
        return "input", f"it reaches {_per_minute(fastest)}, so it was measured at the input"
    return "input", f"no side is stated, the input is taken ({_per_minute(fastest)} at most); otherwise add --side output"


def side_of_motion(column: Column, others: Sequence[Column], time: Column | None, given: Side | None) -> tuple[Side, str]:
    """Return the side of an angle or speed of a log, and what determines it.

    Args:
        column: the angle or speed
        others: motions and torques of the log
        time: of the log
        given: the side that a person gave

    Raises:
        QuestionError: nothing determines it
    """
    if side := column.channel.side or given:
        return side, "" if column.channel.side else f"{column.name} is at the {side}, {AS_WAS_GIVEN}"
    if column.robot:
        by_name = meaning(column.label)
        is_word = by_name is not None and by_name.robot
        why = "what robots call a channel of a joint" if is_word else "a channel of one of several joints"
        return "output", f"{column.name} is {why}: it is taken to be at the output"
    motions = [each for each in others if {each.channel.quantity, column.channel.quantity} == {"angle", "speed"}]
    for other in motions:
        times = _times_as_fast(column, other, time)
        if (side := other.channel.side) and 1.0 / MAX_FACTOR_OF_SIDE < times < MAX_FACTOR_OF_SIDE:
            return side, f"{column.name} runs as {other.name} does, so it is at the {side} too"
        if column.sure and other.sure and max(times, 1.0 / times) > MIN_FACTOR_OF_SIDES:
            side = "input" if times > 1.0 else "output"
            return side, f"{column.name} runs {times:.3g} times as fast as {other.name}, so it is at the {side}"
    fastest = 0.0 if time is None else float(np.quantile(np.abs(_speed(column, time)), SPEED_QUANTILE))
    if fastest > MIN_MOTOR_SPEED:
        _check_unit(column, fastest)
        return "input", f"{column.name} reaches {_per_minute(fastest)}, so it is at the input"
    if {other.channel.side or ("output" if other.robot else None) for other in others} - {None} == {"output"}:
        return "output", f"{column.name} is recorded with channels of a joint: it is taken to be at the output"
    question = f"{column.name} may be the {column.channel.quantity} of the joint or of the motor"
    raise QuestionError(question, OF_SIDES, by_fit=True)


def _check_unit(column: Column, fastest: float) -> None:
    """Ask for the unit of a motion that is as fast as a motor, but may be that of a joint in degrees."""
    is_slow = fastest < MAX_JOINT_SPEED and (column.channel.quantity == "speed" or np.ptp(column.si) < MAX_JOINT_RANGE)
    if column.sure or not is_slow:
        return
    unit, what = {"angle": "deg", "speed": "deg/s"}[column.channel.quantity], column.channel.quantity
    motor = Answer(f"of the motor in {column.unit}", {"side": "input"})
    joint = Answer(f"of the joint in {unit}", {"side": "output", "units": {column.label.name: unit}})
    question = f"{column.name} has no unit, and may be the {what} of the motor or of the joint"
    raise QuestionError(question, [motor, joint], by_fit=True)


def side_of_torque(column: Column, sides: set[Side], given: Side | None) -> tuple[Side, str]:
    """Return the side at which the torque of a log is counted, and what determines it.

    Raises:
        QuestionError: nothing determines it
    """
    if side := column.channel.side:
        return side, ""
    if " of " in (column.unit or ""):  # of which `given` is the side of the angles
        return "input", f"{column.name} is a share of a rated torque, which is that of the motor"
    if given:
        return given, f"{column.name} is at the {given}, {AS_WAS_GIVEN}"
    if column.robot:
        return "output", f"{column.name} is what robots call the torque of a joint: it is counted at the output"
    if len(sides) == 1:
        (side,) = sides
        return side, f"{column.name} is recorded with motion of the {side} only: it is taken to be counted there"
    raise QuestionError(f"{column.name} may be the torque of the motor or of the joint", sides_of_torques([column]))


def sides_of_torques(torques: Sequence[Column]) -> list[Answer]:
    """Return the answers to which of some torques is meant, and at which side it is counted."""
    sides = {"input_torque": "of the motor", "joint_torque": "of the joint"}
    names = {column.name: _stem(column) for column in torques}
    return [
        Answer(f"{name} is the torque {side}", {"columns": {channel: column}})
        for name, column in names.items()
        for channel, side in sides.items()
    ]


def _stem(column: Column) -> str:
    """Return the name of a column, of one of a robot's joint without the number of the joint."""
    return column.name.removesuffix(column.which).rstrip("_.") if column.robot and column.which else column.reference


def sides_of_angles(angles: Sequence[Column]) -> tuple[Column, Column, str]:
    """Return that of two angles, or of two speeds, at the input; that at the output; and what determines it.

    Raises:
        QuestionError: nothing determines it
    """
    slow, fast = sorted(angles, key=lambda column: float(np.ptp(column.si)))
    is_alike = bool(np.ptp(fast.si) < MIN_FACTOR_OF_SIDES * np.ptp(slow.si))
    named = [column.channel.side for column in angles]
    if any(named):
        first, second = angles[::-1] if named[0] == "output" or named[1] == "input" else angles
        return first, second, ""
    if is_alike and angles[0].robot != angles[1].robot:  # theta of the motor, q of the joint
        motor, joint = sorted(angles, key=lambda column: column.robot)
        return motor, joint, f"{joint.name} is what robots call an angle of a joint, and {motor.name} runs with it at the motor"
    if is_alike:
        names = [f"{side}_{fast.channel.quantity}" for side in ("input", "output")]
        ways = [
            Answer(
                f"{motor.name} is that of the motor, {joint.name} of the joint",
                {"columns": dict(zip(names, (motor.reference, joint.reference), strict=True))},
            )
            for motor, joint in ((fast, slow), (slow, fast))
        ]
        raise QuestionError(f"which of {pair(slow, fast)} is that of the motor is not determined", ways)
    times = "" if np.ptp(slow.si) == 0.0 else f" {np.ptp(fast.si) / np.ptp(slow.si):.3g} times as far as {slow.name}"
    return fast, slow, f"{fast.name} runs{times}, so it is that of the input"


def pair(first: Column, second: Column) -> str:
    return f"{first.name} and {second.name}"


def _per_minute(speed: float) -> str:
    return f"{speed * 30.0 / np.pi:.4g} 1/min"


def _times_as_fast(column: Column, other: Column, time: Column | None) -> float:
    """Return the median speed of a motion over that of another one; not a number if one of them rests, or without a time."""
    angles = [each.si for each in (column, other) if each.channel.quantity == "angle"]
    if time is None or any(np.abs(np.diff(angle)).max(initial=0.0) > np.pi for angle in angles):  # one that begins anew
        return np.nan
    own, others = (float(np.median(np.abs(_speed(each, time)))) for each in (column, other))
    return own / others if own > 0.0 and others > 0.0 else np.nan


@np.errstate(all="ignore")
def _speed(column: Column, time: Column) -> Array:
    """Return a speed, or that of an angle over a thousandth of the record; 0 if its time does not run forward."""
    if column.channel.quantity == "speed":
        return column.si
    apart = max(len(column.si) // 1000, 1)
    elapsed, moved = time.si[apart:] - time.si[:-apart], column.si[apart:] - column.si[:-apart]
    forward = elapsed > 0.0
    return moved[forward] / elapsed[forward] if forward.any() else np.zeros(1)
