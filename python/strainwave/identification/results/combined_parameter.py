"""Combination of the estimates of all files: the value of each parameter that they determine together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from strainwave import typeset
from strainwave.identification.results.file_result import FileEstimate, FileResult
from strainwave.messages import listed
from strainwave.presentation import Presented, Row
from strainwave.typeset import uncertain, unit

Array = NDArray[np.float64]
MAX_DISTANCE = 3.0  # standard deviations: two files that are further apart contradict each other
MAX_DISTANCE_IN_MEAN = 2.0  # standard deviations: of files that are no further apart the mean is taken


@dataclass(frozen=True)
class CombinedParameter(Presented):
    """A parameter of the gear or its drive, from the estimates of all files.

    Attributes:
        estimate: the result: the mean of the files that agree, or the estimate of the best file
        source: the name of the best file: the one whose law the gear has, else that with the smallest standard deviation
        others: estimates of other files, by their names
        contradicts: names of files whose estimate lies beyond three standard deviations of both
        best: the estimate of the best file
        mean_of: names of the files in the mean, the best first; one if there is no mean
        widened: factor of the standard deviation of the mean, if files scatter more than they should [1]
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
        """Names of the files that determine it, in words."""
        if len(self.mean_of) < 2:
            return self.source
        return f"mean of {listed(self.mean_of)}"

    def of_file(self, name: str) -> FileEstimate:
        """Return the estimate of one file."""
        return (self.best or self.estimate) if name == self.source else self.others[name]

    def _headline(self) -> str:
        taken = self.estimate
        return f"{taken.label} = {typeset.uncertain_quantity(taken.value, taken.sigma, taken.unit)}, {self.taken_from}"

    def _rows(self) -> Iterator[Row]:
        for name in (self.source, *self.others):
            each = self.of_file(name)
            note = "contradicts" if name in self.contradicts else "in the mean" if name in self.mean_of else ""
            yield Row(name, each.value, each.unit, each.sigma, note)


def lines_of(numbers: Sequence[CombinedParameter]) -> Iterator[str]:
    """Yield a line for each parameter, to print."""
    cells = [
        (each.estimate.label, uncertain(each.estimate.value, each.estimate.sigma), unit(each.estimate.unit)) for each in numbers
    ]
    name, size, of = (max(map(len, column), default=0) for column in zip(*cells, strict=True)) if cells else (0, 0, 0)
    for (label, words, in_unit), each in zip(cells, numbers, strict=True):
        yield f"  {label:{name}}  {words:>{size}}  {in_unit:{of}}  {each.taken_from}"


def combine(
    files: Sequence[FileResult], *, accept: bool = False, determined_by: Mapping[str, str] | None = None
) -> tuple[CombinedParameter, ...]:
    """Return every parameter determined: the mean of the files that agree; files with the same measurement count once.

    The best file is the one whose law the gear has by `determined_by`, a file for each path; else the one with the smallest
    standard deviation. Files that lie further from it than two standard deviations take no part in the mean: one of them, or
    the model, is wrong. Of friction no mean is taken over files with different laws, whose numbers have different meanings. A
    file with a failed check takes part only if no other file determines the parameter, or if `accept` is true.
    Parameters of the gear come first, then those of what the drive carried, run by run.
    """
    by_path: dict[tuple[str, str, str], dict[str, FileEstimate]] = {}
    for file in files:
        for estimate in file.estimates:
            if not estimate.why and np.isfinite(estimate.sigma):
                # what a drive carries may differ from one run to another, and is no number of the gear
                run = (file.same_as or file.name) if estimate.path.startswith("load.") else ""
                by_path.setdefault((estimate.path, estimate.law, run), {})[file.name] = estimate
    copies = {file.name for file in files if file.same_as}
    failed = {file.name for file in files if file.failed and not accept}
    runs = list(dict.fromkeys(run for _, _, run in by_path))
    in_order = sorted(by_path, key=lambda key: runs.index(key[2]) if key[2] else -1)
    laws = {file.name: file.friction for file in files}
    own = determined_by or {}
    return tuple(
        _combined(by_path[key], copies, failed, laws if is_friction(key[0]) else {}, own.get(key[0], "")) for key in in_order
    )


def is_friction(path: str) -> bool:
    """True for a number of a law of friction."""
    return path.startswith("gear.friction_")


def _combined(
    estimates: Mapping[str, FileEstimate], copies: set[str], failed: set[str], laws: Mapping[str, str], first: str
) -> CombinedParameter:
    own = {name: each for name, each in estimates.items() if name not in copies} or estimates
    own = {name: each for name, each in own.items() if name not in failed} or own
    apart_from = copies if own.keys() <= failed else copies | failed  # these take no part in the mean
    best = min(own, key=lambda name: (Path(name).name != first, own[name].sigma))
    others = {name: each for name, each in estimates.items() if name != best}
    apart = [name for name, each in others.items() if name not in copies and distance(each, estimates[best]) > MAX_DISTANCE]
    agree = [
        name for name in others
        if name not in apart_from and laws.get(name) == laws.get(best)
        and distance(others[name], estimates[best]) <= MAX_DISTANCE_IN_MEAN
    ]  # fmt: skip
    agree = [] if best in copies else agree  # all of them are one measurement
    mean, widened = mean_of([estimates[best], *(others[name] for name in agree)])
    return CombinedParameter(mean, best, others, tuple(apart), estimates[best], (best, *agree), widened)


def mean_of(estimates: Sequence[FileEstimate]) -> tuple[FileEstimate, float]:
    """Return the weighted mean of the estimates of several files, the best first, and the factor of its standard deviation.

    It is the linear mean of least variance (Aitken1935): what is uncertain of the torque constant is common to all files that
    rest on it, and does not become smaller with their number. No file counts less than nothing. If files scatter more than
    their standard deviations, that of the mean is larger by the root of chi squared over its degrees of freedom
    (Birge1932).

    >>> one, other = (FileEstimate("load.inertia", "kg.m2", value, 0.05, "", common=0.04) for value in (1.0, 1.03))
    >>> mean, widened = mean_of([one, other])
    >>> round(mean.value, 3), round(mean.sigma, 4), widened
    (1.015, 0.0453, 1.0)
    """
    first, own = estimates[0], np.array([each.own for each in estimates])
    if len(estimates) == 1 or own.min() <= 0.0:
        return first, 1.0
    off, common = np.array([difference(each, first) for each in estimates]), np.array([each.common for each in estimates])
    weight = _weights(own, common)
    mean = float(weight @ off)
    left = np.linalg.solve(_covariance(own, common), off - mean)
    widened = max(1.0, float(np.sqrt((off - mean) @ left / (len(estimates) - 1))))
    alone, shared = widened * float(np.linalg.norm(weight * own)), float(weight @ common)
    return replace(first, value=first.value + mean, sigma=float(np.hypot(alone, shared)), common=shared), widened


def _weights(own: Array, common: Array) -> Array:
    """Return weights of least variance that are not negative, of numbers with parts of their own and a part in common."""
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
    """Return the covariance of numbers with parts of their own and a part in common, shape (n, n)."""
    return np.diag(own**2) + np.outer(common, common)


def distance(one: FileEstimate, other: FileEstimate) -> float:
    """Return the distance of two estimates in standard deviations of their difference; what they share is no difference."""
    off = difference(one, other)
    sigma = float(np.hypot(np.hypot(one.own, other.own), one.common - other.common))
    return abs(off) / sigma if sigma > 0.0 else (0.0 if off == 0.0 else np.inf)


def difference(one: FileEstimate, other: FileEstimate) -> float:
    """Return the difference of two values; of phases the shorter way round."""
    off = one.value - other.value
    if one.is_phase:
        off = float(np.remainder(off + np.pi, 2.0 * np.pi) - np.pi)
    return off
