"""Messages of ROS that contain series of numbers: states of joints, and plain numbers, in the encodings of ROS 1 and ROS 2.

Their layout is part of ROS. The definitions that a bag contains are not read, as reading them means to run code made from them.
"""

from __future__ import annotations

import struct
from typing import Any, NamedTuple

from strainwave.files.budget import RefusedFile

JOINTS = "sensor_msgs/msg/JointState"
NUMBERS = {f"std_msgs/msg/{kind}": form for kind, form in {"Float64": "d", "Float32": "f", "Int32": "i", "Int64": "q"}.items()}
UNITS = {"position": "rad", "velocity": "rad/s", "effort": "N.m"}  # of revolute joints, as the message defines them


class Message(NamedTuple):
    """A message of a bag, not yet decoded.

    Args:
        topic, kind: where it was published, and its type, as `std_msgs/msg/Float64`
        stamp: when it was recorded [ns]
        content: its bytes
        is_ros1: in the encoding of ROS 1, else in CDR, that of ROS 2
    """

    topic: str
    kind: str
    stamp: int
    content: memoryview
    is_ros1: bool


class JointStates(NamedTuple):
    """Content of a message of the kind `JOINTS`: the stamp of its header [ns], 0 if none was set, and its numbers by name."""

    stamp: int
    numbers: list[tuple[str, float]]


def plain_number(message: Message) -> float:
    """Return the number of a message of one of the kinds in `NUMBERS`."""
    return float(_MessageReader(message).take(NUMBERS[message.kind])[0])


def joint_states(message: Message) -> JointStates:
    """Return the state of each joint; an effort or velocity that was not measured is left empty in the message."""
    reader = _MessageReader(message)
    if message.is_ros1:
        reader.take("I")
    seconds, nanoseconds = reader.take("I" if message.is_ros1 else "i") + reader.take("I")
    reader.text()
    names = [reader.text() for _ in reader.items(4)]
    numbers = []
    for channel in UNITS:
        values = reader.take(f"{len(reader.items(8))}d")
        if len(values) == len(names):
            numbers += [(f"{joint}.{channel}", value) for joint, value in zip(names, values, strict=True)]
    return JointStates(seconds * 1_000_000_000 + nanoseconds, numbers)


class _MessageReader:
    """Reads the fields of a message one after the other.

    CDR aligns each to its own size, behind four bytes that name the byte order.
    """

    def __init__(self, message: Message) -> None:
        self.is_ros1 = message.is_ros1
        self.order = "<" if message.is_ros1 or message.content[1] & 1 else ">"
        self.content = message.content if message.is_ros1 else message.content[4:]
        self.place = 0

    def take(self, form: str) -> tuple[Any, ...]:
        """Return fields that are all of one size."""
        size = struct.calcsize(f"<{form[-1]}")
        if not self.is_ros1 and not form.startswith("0"):
            self.place += -self.place % size
        found = struct.unpack_from(self.order + form, self.content, self.place)
        self.place += size * len(found)
        return found

    def text(self) -> str:
        (length,) = self.take("I")
        begin, self.place = self.place, self.place + length
        if self.place > len(self.content):
            raise RefusedFile("a text in a message is longer than the message; it is damaged")
        return bytes(self.content[begin : self.place]).rstrip(b"\0").decode()

    def items(self, size: int) -> range:
        """Return the numbers of a sequence of fields of at least `size` bytes."""
        (count,) = self.take("I")
        if count * size > len(self.content) - self.place:
            raise RefusedFile(f"a message claims {count} fields, more than fit into it; it is damaged")
        return range(count)
