"""Files of one recorder, which writes all of them in the same units: what one file leaves open another one may determine."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from strainwave.identification.reading.channels import CHANNELS
from strainwave.identification.reading.names import Side
from strainwave.identification.reading.recognise import Recognised, recognise
from strainwave.identification.reading.source import MeasurementFile


class Reading(NamedTuple):
    """One way to read a file: the side, and quantity and unit of each motion."""

    side: Side | None
    motions: tuple[tuple[str, str], ...]


MAX_FILES = 200  # of one recorder: each is read once for each of its alternatives


def consistent(files: Sequence[Recognised], opened: Mapping[Path, MeasurementFile]) -> list[Recognised]:
    """Return the files, those of one recorder in the one reading that all of them allow, if there is one.

    Files are of one recorder if their columns have the same names.

    Args:
        files: in any order
        opened: the files to read again, by their paths
    """
    groups = dict[frozenset[str], list[Recognised]]()
    for file in files:
        groups.setdefault(frozenset(file.columns.values()), []).append(file)
    taken = dict[Path, Recognised]()
    for group in groups.values():
        if 1 < len(group) <= MAX_FILES and any(file.question for file in group):
            taken |= _in_one_reading(group, opened)
    return [taken.get(file.path, file) for file in files]


def _in_one_reading(group: Sequence[Recognised], opened: Mapping[Path, MeasurementFile]) -> dict[Path, Recognised]:
    """The files of a recorder in the reading that all of the usual kind allow; empty if there is none, or several."""
    usual, _ = Counter(file.kind for file in group).most_common(1)[0]
    readings = {file.path: {_reading(each): each for each in _ways(file, opened)} for file in group}
    common = set[Reading].intersection(*(set(readings[file.path]) for file in group if file.kind == usual))
    if len(common) != 1:
        return {}
    (one,) = common
    found = dict[Path, Recognised]()
    for file in group:
        ways = readings[file.path]
        same = ways.get(one) or next((each for reading, each in ways.items() if reading.motions == one.motions), file)
        units = ", ".join(unit for _, unit in one.motions)
        told = f"in {units}, as the other files with these columns allow nothing else"
        found[file.path] = replace(same, question="", alternatives=(), remarks=(told, *same.remarks))
    return found


def _ways(file: Recognised, opened: Mapping[Path, MeasurementFile]) -> list[Recognised]:
    """A file as it was read, and in its alternatives."""
    source = opened[file.path]
    return [file, *(recognise(source, each.mapping) for each in file.alternatives)]


def _reading(file: Recognised) -> Reading:
    quantities = {name: CHANNELS[name].quantity for name in file.units if name in CHANNELS}
    motions = {(str(quantity), file.units[name]) for name, quantity in quantities.items() if quantity in ("angle", "speed")}
    return Reading(file.side, tuple(sorted(motions)))
