"""Units that need a number: the counts of a revolution of an encoder, and the rated value of which a torque is a share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.files.units import convert, counts, is_share, measures
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.missing_units import COARSEST, FINEST, NEAR_COUNTS, counts_of_revolution
from strainwave.identification.reading.sides import UndecidedError
from strainwave.messages import as_option, listed

Array = NDArray[np.float64]

COUNTED = "counts/16384"  # for example
RATIOS = (100.0, 50.0, 80.0, 120.0, 160.0, 30.0)  # of catalogues, the most usual first
MIN_COUNTS = 1000  # range of whole numbers that are counts of an encoder
MIN_STEPS, MIN_SAMPLES = 20, 100  # range and rows of whole numbers that are shares of a rated torque


def with_counts(columns: Sequence[Column], raw: Mapping[int, Array]) -> tuple[list[Column], list[str]]:
    """The columns, with the counts of a revolution where the speed beside an encoder determines them; and which."""
    found = counts_of_revolution(
        [replace(c, unit="counts") if counts(_incomplete_unit(c, raw[c.position])) else c for c in columns], raw
    )
    told = [
        f"a revolution has {found[c.position]} counts of {c.name}, as its speed shows" for c in columns if c.position in found
    ]
    return [replace(c, unit=f"counts/{found[c.position]}") if c.position in found else c for c in columns], told


def check_units(columns: Sequence[Column], raw: Mapping[int, Array], ratio: float | None) -> None:
    """Ask for the numbers that units need and the file does not contain.

    Args:
        columns, raw: as of `missing_units`
        ratio: of the gear, if a person gave it

    Raises:
        UndecidedError: a unit needs the counts of a revolution, or a rated value
    """
    needs = {column.name: unit for column in columns if (unit := _incomplete_unit(column, raw[column.position]))}
    by_joint = dict[str, str]()
    for column in columns:
        if needs.get(column.name) == COUNTED and (found := _counts_by_joint(column, columns, raw, ratio)) is not None:
            needs[column.name], by_joint[column.name] = f"counts/{found.counts}", found.why
    if needs:
        counted = [name for name, unit in needs.items() if counts(unit)]
        shares = [name for name in needs if name not in counted]
        whys = "".join(f" ({why})" for why in by_joint.values())
        lacks = [f"how many counts a revolution has in {listed(counted)}{whys}"] if counted else []
        lacks += [f"of which rated value {listed(shares)} is a share"] if shares else []
        options = " ".join(as_option("unit", name, unit) for name, unit in needs.items())
        told = f"the file does not contain {' and '.join(lacks)}; add it, as with {options}"
        raise UndecidedError(told, (), options, FileMapping(units=needs))


class _Counts(NamedTuple):
    """The counts of a revolution of an encoder of the motor, and what determines them."""

    counts: int
    why: str


def _counts_by_joint(
    column: Column, columns: Sequence[Column], raw: Mapping[int, Array], ratio: float | None
) -> _Counts | None:
    """The counts of a revolution of an encoder beside an angle of the joint: by a ratio that makes them a power of two."""
    joint = next((c for c in columns if c.channel.quantity == "angle" and c.unit and measures(c.unit, "rad")), None)
    if joint is None or joint.unit is None or column.channel.quantity != "angle":
        return None
    turns, counted = convert(raw[joint.position], joint.unit, "rev"), raw[column.position]
    there = np.isfinite(turns + counted)
    if not np.ptp(turns[there]) > 0.0:
        return None
    per_turn = abs(float(np.polyfit(turns[there], counted[there], 1)[0]))
    for each in RATIOS if ratio is None else (abs(ratio),):
        bits = round(np.log2(per_turn / each)) if per_turn > each else 0
        if COARSEST <= bits <= FINEST and abs(per_turn / each / 2.0**bits - 1.0) < NEAR_COUNTS:
            return _Counts(2**bits, f"{2**bits} at a ratio of {each:g}, as {joint.name} turns once in {per_turn:.6g} counts")
    return None


def _incomplete_unit(column: Column, values: Array) -> str:
    """The unit of a column as it may be with a number that is missing; empty if it is complete."""
    share = f"permille of {'0.4 N.m' if column.channel.quantity == 'torque' else '10 A'}"
    if column.unit is not None:
        if is_share(column.unit):
            return share.replace("permille", "%") if column.unit.strip() in ("%", "percent") else share
        counted = f"{COUNTED}/s" if column.channel.quantity == "speed" else COUNTED
        return counted if counts(column.unit) and not measures(column.unit, column.channel.unit) else ""
    there = values[np.isfinite(values)]
    is_whole = len(there) > 1 and bool((there == np.round(there)).all())
    if column.channel.quantity == "angle":
        return COUNTED if is_whole and np.ptp(there) > MIN_COUNTS else ""
    is_torque = column.channel.quantity == "torque" and column.channel.measured
    return share if is_torque and is_whole and len(there) > MIN_SAMPLES and np.ptp(there) >= MIN_STEPS else ""
