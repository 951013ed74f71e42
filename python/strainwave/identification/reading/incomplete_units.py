"""Units that need a number: the counts of a revolution of an encoder, and the rated value of which a torque is a share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave.files.units import counts, is_share, measures
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.missing_units import counts_of_revolution
from strainwave.identification.reading.sides import UndecidedError
from strainwave.messages import as_option, listed

Array = NDArray[np.float64]

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


def check_units(columns: Sequence[Column], raw: Mapping[int, Array]) -> None:
    """Ask for the numbers that units need and the file does not contain.

    Raises:
        UndecidedError: a unit needs the counts of a revolution, or a rated value
    """
    needs = {column.name: unit for column in columns if (unit := _incomplete_unit(column, raw[column.position]))}
    if needs:
        counted = [name for name, unit in needs.items() if counts(unit)]
        shares = [name for name in needs if name not in counted]
        lacks = [f"how many counts a revolution has in {listed(counted)}"] if counted else []
        lacks += [f"of which rated value {listed(shares)} is a share"] if shares else []
        options = " ".join(as_option("unit", name, unit) for name, unit in needs.items())
        told = f"the file does not contain {' and '.join(lacks)}; add it, as with {options}"
        raise UndecidedError(told, (), options, FileMapping(units=needs))


def _incomplete_unit(column: Column, values: Array) -> str:
    """The unit of a column as it may be with a number that is missing; empty if it is complete."""
    share = f"permille of {'0.4 N.m' if column.channel.quantity == 'torque' else '10 A'}"
    if column.unit is not None:
        if is_share(column.unit):
            return share.replace("permille", "%") if column.unit.strip() in ("%", "percent") else share
        counted = "counts/16384/s" if column.channel.quantity == "speed" else "counts/16384"
        return counted if counts(column.unit) and not measures(column.unit, column.channel.unit) else ""
    there = values[np.isfinite(values)]
    is_whole = len(there) > 1 and bool((there == np.round(there)).all())
    if column.channel.quantity == "angle":
        return "counts/16384" if is_whole and np.ptp(there) > MIN_COUNTS else ""
    is_torque = column.channel.quantity == "torque" and column.channel.measured
    return share if is_torque and is_whole and len(there) > MIN_SAMPLES and np.ptp(there) >= MIN_STEPS else ""
