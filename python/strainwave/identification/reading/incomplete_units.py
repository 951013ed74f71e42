"""Units that need a number: the counts of a revolution of an encoder, and the rated value of which a torque is a share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from strainwave.files.units import convert, counts, is_share, measures
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.missing_units import bits_of, pairs_of_shafts
from strainwave.identification.reading.slopes import speed_per_slope
from strainwave.messages import listed, one_line
from strainwave.questions import Answer, QuestionError

COUNTS_EXAMPLE = "counts/16384"  # for example
USUAL_RATIOS = (100.0, 50.0, 80.0, 120.0, 160.0, 30.0)  # of catalogues, the most usual first
MIN_RANGE_OF_COUNTS = 1000  # range of whole numbers that are counts of an encoder
MIN_RANGE_OF_SHARES, MIN_ROWS_OF_SHARES = 20, 100  # range and rows of whole numbers that are shares of a rated torque
MAX_OFF_COUNTS = 3e-3  # relative difference of the counts of a revolution from a usual number


def with_counts(columns: Sequence[Column]) -> tuple[list[Column], list[str]]:
    """Return the columns, with the counts of a revolution if the speed of an encoder determines them; and remarks."""
    time = next((convert(c.raw, c.unit, "s") for c in columns if c.channel.quantity == "time" and c.unit is not None), None)
    known, remarks = list(columns), list[str]()
    for angle, speed in pairs_of_shafts(columns):
        is_counted = angle in known and counts(_incomplete_unit(angle))
        if time is not None and is_counted and speed.unit is not None and measures(speed.unit, "rad/s"):
            turns = convert(abs(speed_per_slope(angle.raw, speed.raw, time)), speed.unit, "rev/s")
            if number := _usual_counts(1.0 / turns if turns > 0.0 else 0.0):
                known[known.index(angle)] = replace(angle, unit=f"counts/{number}")
                remarks.append(f"a revolution has {number} counts of {angle.name}, as its speed shows")
    return known, remarks


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
        if needs[name] == COUNTS_EXAMPLE and (found := _counts_by_joint(column, columns, ratio)) is not None:
            needs[name], why = f"counts/{found[0]}", found[1]
            whys.append(why)
            del numbers[name]
    lacks = [f"how many counts a revolution has in {listed(column.name for column in counted)}"] if counted else []
    lacks += [f"of which rated value {listed(shares)} is a share"] if shares else []
    answer = Answer(listed(whys) or "with the numbers of the drive", {"units": needs}, numbers)
    raise QuestionError(f"the file does not contain {' and '.join(lacks)}", [answer])


def _usual_counts(per_turn: float) -> int | None:
    """Return the usual counts of a revolution near a number: a power of two, or hundreds; None if there are none."""
    if bits := bits_of(per_turn, MAX_OFF_COUNTS):
        return int(2**bits)
    hundreds = 100 * round(per_turn / 100.0)
    return hundreds if hundreds and abs(per_turn / hundreds - 1.0) < MAX_OFF_COUNTS else None


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
