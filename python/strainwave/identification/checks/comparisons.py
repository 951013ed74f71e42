"""Checks of what files determine together: against the start set, and of files with each other."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from strainwave.files.gear_set import GearSet
from strainwave.identification.fitting.influence import uncertainty
from strainwave.identification.results.check import Check
from strainwave.identification.results.combined_parameter import MAX_DISTANCE, CombinedParameter, difference, distance
from strainwave.identification.results.file_result import FileEstimate, FileResult
from strainwave.messages import listed

CHANCE = 2.7e-3  # probability that a sum of squares exceeds its limit by chance: that of three standard deviations
FIRST_STIFFNESS = ("gear.stiffness.k", "gear.stiffness.k1", "gear.stiffness.a1")  # at zero twist, by the law
MAX_LISTED = 4  # parameters named with a comparison, those furthest apart first
REPEATABILITY = {"friction_input": 0.2, "friction_mesh": 0.2, "hysteresis": 0.2}  # of a part from run to run, in logarithms
REPEATABILITY_OF_OTHERS = 0.05  # of stiffness, kinematic error, damping and ratios


@dataclass(frozen=True)
class _Compared:
    """A parameter beside its value in the start set.

    Attributes:
        estimate: by the files
        source: file that determines it best
        before: value in the start set
        spread: its relative standard deviation there [1]
        off: logarithm of the estimate over the value before
        sigma: standard deviation of that logarithm
    """

    estimate: FileEstimate
    source: str
    before: float
    spread: float
    off: float
    sigma: float

    def __str__(self) -> str:
        value = f"{self.estimate.path} = {self.estimate.value:.4g} ± {self.estimate.sigma:.2g} {self.estimate.unit}"
        return f"{value} against {self.before:.4g} ± {100.0 * self.spread:.2g} % ({self.off / self.sigma:+.1f} σ)"


def with_start_set(start: GearSet, parameters: Sequence[CombinedParameter], failed: Collection[str] = ()) -> Iterator[Check]:
    """Yield the check that friction and stiffness are those of the start set, by the logarithms of all numbers together.

    Assumed numbers of the set, and files with a failed check, take no part. Logarithms are compared, since a number with a
    spread of 30 % may be two thirds or one and a half of the one stated, but never less than nothing.
    """
    from scipy.stats import chi2

    compared = list(_compared(start, [each for each in parameters if each.source not in failed]))
    if not compared:
        return
    squares = sum((each.off / each.sigma) ** 2 for each in compared)
    limit = float(chi2.isf(CHANCE, len(compared)))
    apart = sorted(compared, key=lambda each: -abs(each.off / each.sigma))
    more = f", and {len(apart) - MAX_LISTED} more" if len(apart) > MAX_LISTED else ""
    yield Check(
        "numbers of the start set", listed(dict.fromkeys(each.source for each in apart)), squares, limit, "1", squares > limit,
        f"the files contradict the set {start.name}: {'; '.join(map(str, apart[:MAX_LISTED]))}{more}",
        "start from the set of this gear (size and ratio), or see whether units, sides, ratio and torque constant are right",
    )  # fmt: skip


def _compared(start: GearSet, parameters: Sequence[CombinedParameter]) -> Iterator[_Compared]:
    seen = set[str]()
    for each in parameters:
        estimate = each.estimate
        found = _in_set(start, estimate)
        if found is None or found[0] in seen:
            continue
        path, before = found
        entry = start.sources.get(path)
        if entry is None or entry.assumed or before <= 0.0 or estimate.value <= 0.0:
            continue
        seen.add(path)
        spread = uncertainty(before, entry) / before
        of_kept = float(np.linalg.norm([*estimate.shift_by_kept.values(), 0.0]))
        sigma = float(np.linalg.norm([spread, estimate.sigma / estimate.value, of_kept]))
        yield _Compared(estimate, each.source, before, spread, float(np.log(estimate.value / before)), sigma)


def _in_set(start: GearSet, estimate: FileEstimate) -> tuple[str, float] | None:
    """Return the number of the start set that an estimate is compared with; None if it has none of the same meaning.

    Of springs the stiffness at zero twist is compared. Where their knees lie depends on how far they were twisted.
    """
    path, spring = estimate.path, start.gear.stiffness
    if path in FIRST_STIFFNESS and estimate.label == path:
        first, stiffness = spring.fields[0]["name"], float(spring.tangent(0.0))
        return (f"gear.stiffness.{first}", stiffness) if stiffness == float(getattr(spring, first)) else None
    if not path.startswith("gear.friction_input.") or "[" in path or estimate.label != path:
        return None
    try:
        return path, float(attrgetter(path)(start))
    except AttributeError:
        return None


def between_files(parameters: Sequence[CombinedParameter], files: Sequence[FileResult]) -> Iterator[Check]:
    """Yield a check for each two files that contradict each other, of those without a failed check.

    Friction and hysteresis differ from run to run by more than their standard deviations, by temperature and wear. A check
    fails if two files are further apart than that explains, too. Friction of two laws fails none: their numbers differ even if
    they describe the same friction.
    """
    failed, laws = {file.name for file in files if file.failed}, {file.name: _friction_of(file) for file in files}
    pairs = dict[tuple[str, str], list[_Contradiction]]()
    for each in parameters:
        for name in each.contradicts:
            if not failed & {name, each.source}:
                one_law = laws.get(name) == laws.get(each.source)
                pairs.setdefault((each.source, name), []).append(_contradiction(each, name, comparable=one_law))
    for (one, other), own in pairs.items():
        found = sorted(own, key=lambda each: -each.apart)
        more = f", and {len(found) - MAX_LISTED} more" if len(found) > MAX_LISTED else ""
        yield Check(
            "agreement of files", f"{one}, {other}", found[0].apart, MAX_DISTANCE, "1", found[0].apart > MAX_DISTANCE,
            f"{one} and {other} contradict each other: {'; '.join(each.words for each in found[:MAX_LISTED])}{more}",
            "see whether sides, columns, units and the ratio are right for both, and compare temperature, load, speed and "
            "lubricant; leave out the file that is not of this gear as you want it",
        )  # fmt: skip


def repeatability(path: str) -> float:
    """Return the relative standard deviation of a parameter from run to run of one gear, by its path."""
    return REPEATABILITY.get(path.removeprefix("gear.").partition(".")[0], REPEATABILITY_OF_OTHERS)


class _Contradiction(NamedTuple):
    """A parameter of which two files differ, in words, and how far apart they are beyond what runs of one gear differ by."""

    words: str
    apart: float


def _contradiction(each: CombinedParameter, name: str, *, comparable: bool) -> _Contradiction:
    best, other, path = each.of_file(each.source), each.others[name], each.estimate.path
    spread = repeatability(path) * abs(best.value)
    sigma = float(np.hypot(np.hypot(best.own, other.own), best.common - other.common))
    apart = abs(difference(best, other)) / float(np.hypot(spread, sigma))
    words = (
        f"{each.estimate.label} = {best.value:.4g} ± {best.sigma:.2g} against {other.value:.4g} ± {other.sigma:.2g} "
        f"{best.unit}, {distance(best, other):.3g} standard deviations apart"
    )
    return _Contradiction(words, apart if comparable or not path.startswith("gear.friction_input.") else 0.0)


def _friction_of(file: FileResult) -> str:
    """Return the law of friction that was fitted to a file."""
    return file.model if file.fit is None else str(file.fit.gear.friction_input.name)
