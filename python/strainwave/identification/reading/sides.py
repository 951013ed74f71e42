"""Sides of channels whose names contain none: by words of robots, by their speed, and by the other channels."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.reading.column import Column
from strainwave.identification.reading.names import Side, meaning
from strainwave.questions import OF_SIDES, Answer, QuestionError

Array = NDArray[np.float64]

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
        found = meaning(column.label)
        is_word = found is not None and found.robot
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
    """Ask for the unit of a motion that is as fast as a motor, but may be that of a joint in degrees.

    Raises:
        QuestionError: both are possible
    """
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
    if side := column.channel.side or given:
        return side, "" if column.channel.side else f"{column.name} is at the {side}, {AS_WAS_GIVEN}"
    if " of " in (column.unit or ""):
        return "input", f"{column.name} is a share of a rated torque, which is that of the motor"
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
