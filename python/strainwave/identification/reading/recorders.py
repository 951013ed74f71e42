"""Raw registers of recorders whose manuals define what one count is."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from strainwave.files.units import convert
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.slopes import MAX_OFF_SPEED, speed_per_slope
from strainwave.messages import as_option, listed


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
        found = [replace(each, unit=each.unit or LIBFRANKA_UNITS.get(each.channel.quantity)) for each in columns]
        return found, ["columns of libfranka are in rad, rad/s and N·m"]
    time = next((convert(c.raw, c.unit or "s", "s") for c in columns if c.channel.quantity == "time"), None)
    for known in KNOWN_RECORDERS:
        own = {column.label.name.casefold(): column for column in columns if column.label.name.casefold() in known.counts}
        if time is None or not {known.angle, known.speed} <= own.keys() or not all(map(_is_raw, own.values())):
            continue
        scaled = {name: _scaled(column, *known.counts[name]) for name, column in own.items()}
        angle, speed = scaled[known.angle], scaled[known.speed]
        expected = convert(1.0, f"{angle.unit}/s", str(speed.unit))
        if abs(abs(speed_per_slope(angle.raw, speed.raw, time)) / expected - 1.0) > MAX_OFF_SPEED:
            continue
        sizes = listed(f"{own[name].name} in {known.counts[name][0]:.4g} {known.counts[name][1]}" for name in scaled)
        name, unit = known.other
        other = f"; other models count {unit}: {as_option('unit', own[name].name, unit)}" if name in own else ""
        remark = f"raw registers of {known.recorder}, whose speed is the slope of the angle: {sizes}{other}"
        places = {each.position: each for each in scaled.values()}
        return [places.get(column.position, column) for column in columns], [remark]
    return list(columns), []


def _is_raw(column: Column) -> bool:
    """True for whole numbers without a unit."""
    values = column.raw[np.isfinite(column.raw)]
    return column.unit is None and bool((values == np.round(values)).all())


def _scaled(column: Column, size: float, unit: str) -> Column:
    return replace(column, raw=size * column.raw, unit=unit)
