"""Combination of the estimates of all files: the value of each parameter that they determine together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, typeset
from strainwave.identification.experiments.motion_log import MIN_INERTIA
from strainwave.identification.results.file_result import IN_CURRENT, LOAD_INERTIA, MOTOR_INERTIA, FileEstimate, FileResult
from strainwave.messages import listed
from strainwave.presentation import Presented, Row
from strainwave.typeset import uncertain, unit

Array = NDArray[np.float64]

MAX_DISTANCE = 3.0  # standard deviations: two files that are further apart contradict each other
MAX_DISTANCE_IN_MEAN = 2.0  # standard deviations: of files that are no further apart the mean is taken
LOAD_WITH_MOTOR = (
    "the inertia of the motor is not known: load.inertia is that of the load, plus that of the motor times the ratio squared"
)
MOTOR_WITHOUT_LOAD = (
    "the inertia of the motor is not known: motor.inertia is what the torque of the motor shows, less the load, which the "
    "wind-up of the gear shows; "
)


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
        weights = np.linalg.solve(_covariance(own[counted], common[counted]), np.ones(counted.sum()))
        if (weights > 0.0).all():
            break
        counted[np.flatnonzero(counted)[weights <= 0.0]] = False
    weight = np.zeros(len(own))
    weight[counted] = weights / weights.sum()
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


# ---- Inertia of the motor --------------------------------------------------------------------------------------------


def drive_of(result: FileResult) -> Drive | None:
    """Return the drive fitted to a file; None if it was no drive."""
    model = None if result.fit is None else result.fit.parts[0].model
    return model if isinstance(model, Drive) else None


def without_motor(files: Sequence[FileResult], *, accept: bool = False) -> tuple[FileResult, ...]:
    """Return the results with loads less the motor, if a file determines its inertia; a remark states what load.inertia is.

    Args:
        files: results
        accept: whether files with a failed check determine it although others do
    """
    motors = {each.estimate.law: each for each in combine(files, accept=accept) if each.estimate.path == MOTOR_INERTIA}
    return tuple(_without_motor(file, motors) for file in files)


def _without_motor(file: FileResult, motors: Mapping[str, CombinedParameter]) -> FileResult:
    drive, own = drive_of(file), {each.path: each for each in file.estimates}
    if drive is None or LOAD_INERTIA not in own or (drive.motor.inertia > MIN_INERTIA and MOTOR_INERTIA not in own):
        return file
    load, motor = own[LOAD_INERTIA], motors.get(own[LOAD_INERTIA].law)
    if MOTOR_INERTIA in own:
        of_gear = drive.gear.input_inertia
        remark = MOTOR_WITHOUT_LOAD + (
            f"the gear's {of_gear:.3g} kg·m² are not in it" if of_gear else "the wave generator's is in it"
        )
    elif motor is not None:
        load = _less(load, motor.estimate, drive.gear.kinematics.ratio**2)
        remark = f"the inertia of the motor is that of {motor.taken_from}, and load.inertia is without it"
    elif load.law == IN_CURRENT:
        return file
    else:
        remark = LOAD_WITH_MOTOR
    estimates = tuple(load if each.path == LOAD_INERTIA else each for each in file.estimates)
    read = () if file.recognised is None else file.recognised.remarks
    place = 1 + max((file.remarks.index(each) for each in read if each in file.remarks), default=-1)  # behind how it was read
    return replace(file, estimates=estimates, remarks=(*file.remarks[:place], remark, *file.remarks[place:]))


def _less(load: FileEstimate, motor: FileEstimate, factor: float) -> FileEstimate:
    """Return the inertia of a load without that of the motor; what both share is no uncertainty of their difference."""
    own, common = float(np.hypot(load.own, factor * motor.own)), abs(load.common - factor * motor.common)
    less = replace(load, value=load.value - factor * motor.value, sigma=float(np.hypot(own, common)), common=common)
    return less.unless_uncertain()
