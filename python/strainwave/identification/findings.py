"""What each file tells of a gear or its drive, and what all files tell together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from strainwave.files.recording import Recording
from strainwave.identification.reading.recognise import Recognised

APART = 3.0  # standard deviations: two files contradict each other


@dataclass(frozen=True)
class Told:
    """A number as one file tells it.

    Attributes:
        path: where it stands in a gear set
        unit: its unit
        value: in SI units
        sigma: its standard deviation
        law: the law that it belongs to; numbers of different laws are not compared
        why: what speaks against it; empty where the file tells it
    """

    path: str
    unit: str
    value: float
    sigma: float
    law: str
    why: str = ""


@dataclass(frozen=True)
class Finding:
    """One file, and what became of it.

    Attributes:
        name: of the file
        recognised: what it is, and why; None where it could not be read
        model: the model that was chosen, in words
        told: its numbers
        error: rms on data held out over the rms of what varied [1]; not a number where nothing was held out
        remarks: what to know of it, in short sentences
        refused: why nothing was found; empty where something was
        same_as: the file that shows the same measurement; empty where none does
        curves: measured beside modelled, as `curves` of this package makes them; None where nothing was fitted
    """

    name: str
    recognised: Recognised | None = None
    model: str = ""
    told: tuple[Told, ...] = ()
    error: float = np.nan
    remarks: tuple[str, ...] = ()
    refused: str = ""
    same_as: str = ""
    curves: Recording | None = None


@dataclass(frozen=True)
class Number:
    """A number of the gear or its drive as all files tell it.

    Attributes:
        told: as the file has it that tells it best
        source: the name of that file
        others: what other files say of it, by name
        contradicts: names of files that say something else, beyond three standard deviations of both
    """

    told: Told
    source: str
    others: Mapping[str, Told] = field(default_factory=dict)
    contradicts: tuple[str, ...] = ()


def numbers_of(findings: Sequence[Finding]) -> tuple[Number, ...]:
    """Every number told, from the file that tells it best; files that show one measurement count once.

    Nothing is averaged: two files that disagree show that one of them, or the model, is wrong.
    """
    by_path: dict[tuple[str, ...], dict[str, Told]] = {}
    for finding in findings:
        for told in finding.told:
            if not told.why and np.isfinite(told.sigma):
                # what a drive carries may differ from one run to another, and is no number of the gear
                run = (finding.same_as or finding.name) if told.path.startswith("load.") else ""
                by_path.setdefault((told.path, told.law, run), {})[finding.name] = told
    copies = {finding.name for finding in findings if finding.same_as}
    return tuple(_number(each, copies) for each in by_path.values())


def _number(told: Mapping[str, Told], copies: set[str]) -> Number:
    own = {name: each for name, each in told.items() if name not in copies} or told
    best = min(own, key=lambda name: own[name].sigma)
    others = {name: each for name, each in told.items() if name != best}
    apart = [name for name, each in others.items() if name not in copies and distance(each, told[best]) > APART]
    return Number(told[best], best, others, tuple(apart))


def distance(one: Told, other: Told) -> float:
    """How far two files are apart in a number, in standard deviations of their difference."""
    off = one.value - other.value
    if ".phase" in one.path or one.path.endswith("_phase"):
        off = float(np.remainder(off + np.pi, 2.0 * np.pi) - np.pi)
    sigma = float(np.hypot(one.sigma, other.sigma))
    return abs(off) / sigma if sigma > 0.0 else (0.0 if off == 0.0 else np.inf)
