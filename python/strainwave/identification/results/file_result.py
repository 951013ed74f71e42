"""What each file tells of a gear or its drive, and what all files tell together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from strainwave.files.recording import Recording
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.held_out import HeldOut
from strainwave.messages import listed

Array = NDArray[np.float64]
APART = 3.0  # standard deviations: two files contradict each other
AGREE = 2.0  # standard deviations: of files that are not further apart the mean is taken


@dataclass(frozen=True)
class FileEstimate:
    """A number as one file tells it.

    Attributes:
        path: where it stands in a gear set
        unit: its unit
        value: in SI units
        sigma: its standard deviation
        law: the law that it belongs to; numbers of different laws are not compared
        why: what speaks against it; empty where the file tells it
        common: the part of `sigma` that files share: of the torque constant, and of the inertia of the rotor
    """

    path: str
    unit: str
    value: float
    sigma: float
    law: str
    why: str = ""
    common: float = 0.0

    @property
    def own(self) -> float:
        """The part of the standard deviation that no other file shares."""
        return float(np.sqrt(max(self.sigma**2 - self.common**2, 0.0)))

    def resting_on(self, relative: float, beside: float = 0.0) -> FileEstimate:
        """The same, as uncertain as the torque constant that it rests on, besides; what is no torque rests on none.

        Args:
            relative: standard deviation of the torque constant over its value [1]
            beside: what is taken off a number that grows with the constant, as the inertia of the motor, or what a motor whose
                voltage was measured induces
        """
        return self.sharing(relative * (abs(self.value) + beside)) if self.is_of_torque else self

    def sharing(self, common: float) -> FileEstimate:
        """The same, with more of its standard deviation in common with other files."""
        return replace(self, sigma=float(np.hypot(self.sigma, common)), common=float(np.hypot(self.common, common)))

    def in_current(self) -> FileEstimate:
        """Return the same estimate in A, for a torque constant that is not known."""
        if not self.is_of_torque:
            return self
        return replace(self, unit=self.unit.replace("N.m", "A").replace("kg.m2", "A.s2/rad"), law="in A")

    @property
    def label(self) -> str:
        """Its path, with what distinguishes it from others of that path."""
        return f"{self.path} ({self.law})" if self.law.startswith(("in ", "of ", "at ")) else self.path

    @property
    def is_of_torque(self) -> bool:
        """True if it grows in proportion to all torques."""
        return self.unit.startswith(("N.m", "kg.m2"))

    @property
    def is_phase(self) -> bool:
        """Whether it is an angle that begins anew with each turn, so that its size means nothing."""
        return ".phase" in self.path or self.path.endswith("_phase")


@dataclass(frozen=True)
class FileResult:
    """One file, and what became of it.

    Attributes:
        name: of the file
        recognised: what it is, and why; None where it could not be read
        model: the model that was chosen, in words
        estimates: of its parameters
        error: rms on data held out over the rms of what varied [1]; not a number where nothing was held out
        remarks: what to know of it, in short sentences
        doubts: what speaks against the file as it was taken, though it is used
        refused: why nothing was found; empty where something was
        same_as: the file that shows the same measurement; empty where none does
        what: what it is, where the kind of the file does not say it
        part_of: the table that it is one point of, with others; empty where it stands for itself
        curves: measured beside modelled, as `curves` of this package makes them; None where nothing was fitted
        between: the same of the angle between the shafts, with its model as the title; None where it was not fitted
        held_out: the error on data that took no part in the fit; None where nothing was held out
    """

    name: str
    recognised: Recognised | None = None
    model: str = ""
    estimates: tuple[FileEstimate, ...] = ()
    error: float = np.nan
    remarks: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()
    refused: str = ""
    same_as: str = ""
    what: str = ""
    part_of: str = ""
    curves: Recording | None = None
    between: Recording | None = None
    held_out: HeldOut | None = None


@dataclass(frozen=True)
class CombinedParameter:
    """A number of the gear or its drive as all files tell it.

    Attributes:
        estimate: the value taken: the mean of the files that agree, or as the one file has it that tells it best
        source: the name of the file that tells it best
        others: what other files say of it, by name
        contradicts: names of files that say something else, beyond three standard deviations of both
        best: as the file has it that tells it best
        mean_of: names of the files that the mean is taken of, the best first; one where there is no mean
        widened: by what the standard deviation of the mean is multiplied, as files scatter more than they should [1]
    """

    estimate: FileEstimate
    source: str
    others: Mapping[str, FileEstimate] = field(default_factory=dict)
    contradicts: tuple[str, ...] = ()
    best: FileEstimate | None = None
    mean_of: tuple[str, ...] = ()
    widened: float = 1.0

    @property
    def taken_from(self) -> str:
        """The files that it rests on, in words."""
        if len(self.mean_of) < 2:
            return self.source
        return f"mean of {listed(self.mean_of)}"

    def of_file(self, name: str) -> FileEstimate:
        """As one file tells it."""
        return (self.best or self.estimate) if name == self.source else self.others[name]


def lines_of(numbers: Sequence[CombinedParameter]) -> Iterator[str]:
    """A line for each number, to print."""
    width = max((len(each.estimate.label) for each in numbers), default=0)
    for each in numbers:
        told = each.estimate
        yield f"  {told.label:{width}}  {told.value:11.5g} ± {told.sigma:<8.2g} {told.unit:12} {each.taken_from}"


def combine(findings: Sequence[FileResult]) -> tuple[CombinedParameter, ...]:
    """Every number told: the mean of the files that agree about it; files that show one measurement count once.

    Files that lie further from the best one than two standard deviations take no part in the mean: one of them, or the model,
    is wrong. Numbers of the gear come first, then those of what the drive carried, run by run.
    """
    by_path: dict[tuple[str, str, str], dict[str, FileEstimate]] = {}
    for finding in findings:
        for told in finding.estimates:
            if not told.why and np.isfinite(told.sigma):
                # what a drive carries may differ from one run to another, and is no number of the gear
                run = (finding.same_as or finding.name) if told.path.startswith("load.") else ""
                by_path.setdefault((told.path, told.law, run), {})[finding.name] = told
    copies = {finding.name for finding in findings if finding.same_as}
    runs = list(dict.fromkeys(run for _, _, run in by_path))
    in_order = sorted(by_path, key=lambda key: runs.index(key[2]) if key[2] else -1)
    return tuple(_number(by_path[key], copies) for key in in_order)


def _number(told: Mapping[str, FileEstimate], copies: set[str]) -> CombinedParameter:
    own = {name: each for name, each in told.items() if name not in copies} or told
    best = min(own, key=lambda name: own[name].sigma)
    others = {name: each for name, each in told.items() if name != best}
    apart = [name for name, each in others.items() if name not in copies and distance(each, told[best]) > APART]
    agree = [name for name in others if name not in copies and distance(others[name], told[best]) <= AGREE]
    agree = [] if best in copies else agree  # all of them show one measurement
    taken, widened = mean_of([told[best], *(others[name] for name in agree)])
    return CombinedParameter(taken, best, others, tuple(apart), told[best], (best, *agree), widened)


def mean_of(told: Sequence[FileEstimate]) -> tuple[FileEstimate, float]:
    """The weighted mean of a number as several files tell it, the best first, and by what its deviation was widened.

    It is the linear mean of least variance (Aitken1935): what is uncertain of the torque constant is common to all files that
    rest on it, and does not become smaller with their number. No file counts less than nothing. Where files scatter more than
    their standard deviations say, that of the mean is larger by the root of chi squared over its degrees of freedom
    (Birge1932).

    >>> one, other = (FileEstimate("load.inertia", "kg.m2", value, 0.05, "", common=0.04) for value in (1.0, 1.03))
    >>> mean, widened = mean_of([one, other])
    >>> round(mean.value, 3), round(mean.sigma, 4), widened
    (1.015, 0.0453, 1.0)
    """
    first, own = told[0], np.array([each.own for each in told])
    if len(told) == 1 or own.min() <= 0.0:
        return first, 1.0
    off, common = np.array([difference(each, first) for each in told]), np.array([each.common for each in told])
    weight = _weights(own, common)
    mean = float(weight @ off)
    left = np.linalg.solve(_covariance(own, common), off - mean)
    widened = max(1.0, float(np.sqrt((off - mean) @ left / (len(told) - 1))))
    alone, shared = widened * float(np.linalg.norm(weight * own)), float(weight @ common)
    return replace(first, value=first.value + mean, sigma=float(np.hypot(alone, shared)), common=shared), widened


def _weights(own: Array, common: Array) -> Array:
    """Weights of least variance that are not negative, of numbers with parts of their own and a part in common."""
    counted = np.ones(len(own), bool)
    while True:
        found = np.linalg.solve(_covariance(own[counted], common[counted]), np.ones(counted.sum()))
        if (found > 0.0).all():
            break
        counted[np.flatnonzero(counted)[found <= 0.0]] = False
    weight = np.zeros(len(own))
    weight[counted] = found / found.sum()
    return weight


def _covariance(own: Array, common: Array) -> Array:
    """Of numbers with parts of their own and a part in common, shape (n, n)."""
    return np.diag(own**2) + np.outer(common, common)


def distance(one: FileEstimate, other: FileEstimate) -> float:
    """How far two files are apart in a number, in standard deviations of their difference; what they share is no difference."""
    off = difference(one, other)
    sigma = float(np.hypot(np.hypot(one.own, other.own), one.common - other.common))
    return abs(off) / sigma if sigma > 0.0 else (0.0 if off == 0.0 else np.inf)


def difference(one: FileEstimate, other: FileEstimate) -> float:
    """The difference of two values; of phases the shorter way round."""
    off = one.value - other.value
    if one.is_phase:
        off = float(np.remainder(off + np.pi, 2.0 * np.pi) - np.pi)
    return off
