"""Which side of the gear a channel sits on, where its name does not say so: by words of robots, speed and neighbours."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.reading.column import Column
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import Side, meaning
from strainwave.messages import as_option

Array = NDArray[np.float64]

JOINT_SPEED, JOINT_RANGE = 400.0, 720.0  # deg/s and deg: what is no larger may be a joint in degrees, where no unit is stated
FAST = 60.0  # rad/s, 570 1/min: what turns faster is a motor, and no output of a strain wave gear
ALIKE = (0.5, 2.0)  # between the speed of one channel and of another: they are of one side
APART = 10.0  # times: of two angles of which one runs so much further it is that of the input
SAID = "was said to be at the"
OFTEN = 0.9  # of the time: a motor that is taken for one by its speed is slower for that share


class UndecidedError(ValueError):
    """A question about a file that its names and numbers leave open.

    Args:
        message: the question, and how to answer it
        ways: mappings of which each answers it, the usual one first, if a fit can decide between them; else none
        options: what to add to the command line
        answer: one that may be given, as far as it shows what is asked next
    """

    def __init__(
        self, message: str, ways: Sequence[FileMapping] = (), options: str = "", answer: FileMapping | None = None
    ) -> None:
        super().__init__(message)
        self.ways, self.options, self.answer = tuple(ways), options, answer


def side_of_table(speed: Column, torque: Column, said: Side | None) -> tuple[Side, str]:
    """Where a table of friction was measured, and what tells so."""
    if said is not None:
        return said, f"it was said to be measured at the {said}"
    if side := speed.channel.side or torque.channel.side:
        return side, f"its names say that it was measured at the {side}"
    if speed.robot or torque.robot:
        return "output", f"{pair(speed, torque)} are what robots call the channels of a joint: measured at the output"
    fastest = float(np.abs(speed.si).max())
    if fastest > FAST:
        return "input", f"it reaches {_per_minute(fastest)}, so it was measured at the input"
    slow = f"{_per_minute(fastest)} at most"
    return "input", f"no side is stated, the input is taken ({slow}); --side output says that it was measured there"


def side_of_motion(column: Column, beside: Sequence[Column], time: Column | None, said: Side | None) -> tuple[Side, str]:
    """The side of an angle or speed of a log, and what tells so, motions and torques beside it among others.

    Raises:
        UndecidedError: nothing does
    """
    if column.channel.side is not None:
        return column.channel.side, ""
    if said is not None:
        return said, f"{column.name} {SAID} {said}"
    if column.robot:
        why = "what robots call a channel of a joint" if _is_word_of_robots(column) else "a channel of one of several joints"
        return "output", f"{column.name} is {why}: it is taken to be at the output"
    for other in beside:
        if (
            (side := other.channel.side)
            and {other.channel.quantity, column.channel.quantity} == {"angle", "speed"}
            and _alike(column, other, time)
        ):
            return side, f"{column.name} runs as {other.name} does, so it is at the {side} too"
    fastest = 0.0 if time is None else float(np.quantile(np.abs(_speed(column, time)), OFTEN))
    if fastest > FAST:
        if (
            not column.sure
            and fastest < JOINT_SPEED
            and (column.channel.quantity == "speed" or np.ptp(column.si) < JOINT_RANGE)
        ):
            unit = {"angle": "deg", "speed": "deg/s"}[column.channel.quantity]
            joint = f"--side output {as_option('unit', column.name, unit)}"
            may_be = f"{column.name} has no unit: it may be that of a motor in {column.unit}, or that of a joint in {unit}"
            as_joint = FileMapping(side="output", units={column.name: unit})
            raise UndecidedError(f"{may_be}; say it, with --side input, or with {joint}", [FileMapping(side="input"), as_joint])
        return "input", f"{column.name} reaches {_per_minute(fastest)}, so it is at the input"
    others = {other.channel.side or ("output" if other.robot else None) for other in beside} - {None}
    if others == {"output"}:
        return "output", f"{column.name} stands beside channels of a joint: it is taken to be at the output"
    ways = " or ".join(f"--column {side}_{column.channel.quantity}={column.name}" for side in ("input", "output"))
    unknown = f"whether {column.name} was measured at the motor or at the output cannot be told"
    sides = [FileMapping(side="output"), FileMapping(side="input")]
    raise UndecidedError(f"{unknown}; say it with {ways}, or with --side for all", sides)


def _is_word_of_robots(column: Column) -> bool:
    """True if the name itself is that of a joint's channel, and not only its number."""
    found = meaning(column.label)
    return found is not None and found.robot


def side_of_torque(column: Column, sides: set[Side], said: Side | None) -> tuple[Side, str]:
    """The side at which the torque of a log is counted, and what tells so.

    Raises:
        UndecidedError: nothing does
    """
    if column.channel.side is not None:
        return column.channel.side, ""
    if said is not None:
        return said, f"{column.name} {SAID} {said}"
    if " of " in (column.unit or ""):
        return "input", f"{column.name} is a share of a rated torque, which is that of the motor"
    if column.robot:
        return "output", f"{column.name} is what robots call the torque of a joint: it is counted at the output"
    if len(sides) == 1:
        (side,) = sides
        return side, f"{column.name} stands beside motion of the {side} only: it is taken to be counted there"
    ways = f"--column input_torque={column.name} or --column joint_torque={column.name}"
    unknown = f"whether {column.name} is counted at the motor or at the output cannot be told"
    raise UndecidedError(f"{unknown}; say it with {ways}", (), ways)


def sides_of_angles(angles: Sequence[Column]) -> tuple[Column, Column, str]:
    """Which of two angles, or of two speeds, is that of the input and which that of the output, and what tells so.

    Raises:
        UndecidedError: nothing does
    """
    first, second = angles
    if first.channel.side == "output" or second.channel.side == "input":
        first, second = second, first
    if first.channel.side or second.channel.side:
        return first, second, ""
    slow, fast = sorted(angles, key=lambda column: float(np.ptp(column.si)))
    if np.ptp(fast.si) < APART * np.ptp(slow.si):
        quantity = fast.channel.quantity
        ways = f"--column input_{quantity}={fast.name} --column output_{quantity}={slow.name}"
        raise UndecidedError(
            f"which of {pair(slow, fast)} is the {quantity} of the output cannot be told; say it, as with {ways}"
        )
    times = "" if np.ptp(slow.si) == 0.0 else f" {np.ptp(fast.si) / np.ptp(slow.si):.3g} times as far as {slow.name}"
    return fast, slow, f"{fast.name} runs{times}, so it is that of the input"


def pair(first: Column, second: Column) -> str:
    return f"{first.name} and {second.name}"


def _per_minute(speed: float) -> str:
    return f"{speed * 30.0 / np.pi:.4g} 1/min"


def _alike(first: Column, second: Column, time: Column | None) -> bool:
    """Whether two channels, one of them an angle, run about equally fast."""
    if time is None:
        return False
    one, other = (float(np.median(np.abs(_speed(column, time)))) for column in (first, second))
    return ALIKE[0] * other < one < ALIKE[1] * other


def _speed(column: Column, time: Column) -> Array:
    """A speed, or that which an angle gives over a thousandth of the record, 0 where none does."""
    if column.channel.quantity == "speed":
        return column.si
    apart = max(len(column.si) // 1000, 1)
    elapsed = time.si[apart:] - time.si[:-apart]
    forward = elapsed > 0.0
    if not forward.any():
        return np.zeros(1)
    speed: Array = (column.si[apart:] - column.si[:-apart])[forward] / elapsed[forward]
    return speed
