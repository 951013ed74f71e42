"""Checks of what files determine together: against the start set, and of files with each other."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from itertools import combinations
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from strainwave.files.gear_set import GearSet
from strainwave.identification.fitting.influence import uncertainty
from strainwave.identification.results.combined_parameter import (
    MAX_DISTANCE,
    CombinedParameter,
    difference,
    distance,
    is_friction,
)
from strainwave.identification.results.file_result import (
    COULOMB_PATH,
    GRAVITY_PATH,
    LOAD_INERTIA,
    Check,
    FileEstimate,
    FileResult,
)
from strainwave.identification.results.steady_friction import STEADY_FRICTION, friction_of, has_loss, mean_load, measured_speeds
from strainwave.messages import listed
from strainwave.typeset import fixed, number, percent, uncertain, unit

AGREEMENT = "agreement of files"  # name of the check of two files
SCALE_OF_TORQUES = "torques of two files"  # likewise, of all their torques together
LOAD_PATHS = (LOAD_INERTIA, GRAVITY_PATH)
MAX_CHANCE_OF_START_SET = 2.7e-3  # probability that a sum of squares exceeds its limit: that of three standard deviations
FIRST_STIFFNESS = ("gear.stiffness.k", "gear.stiffness.k1", "gear.stiffness.a1")  # at zero twist, by the law
SPEED_QUANTILES, SPEED_COUNT = (0.1, 0.9), 5  # quantiles of the speeds of a file, and how many speeds between them are compared
MAX_PARAMETERS_LISTED = 4  # parameters named with a comparison, those furthest apart first
MAX_GRAVITY_OF_RATING = 3.0  # assumed: times the largest torque in the ratings; sets differ in the torques that they state
# Relative standard deviation of numbers from run to run of one gear, by temperature, running-in and pose (assumed).
RUN_TO_RUN_SPREADS = {"friction_input": 0.2, "steady_friction": 0.2, "load": 0.05}
MAX_OFF_RATIO = 0.025  # of its logarithm: of the same gear either spline may be held, as 50 and 51
GAIN_SIGMA = 0.01  # relative, of two sensors or recorders of one bench: of all other numbers (assumed)


def with_start_set(start: GearSet, parameters: Sequence[CombinedParameter], failed: Collection[str] = ()) -> Iterator[Check]:
    """Yield the check that friction and stiffness are those of the start set, by the logarithms of all numbers together.

    Assumed numbers of the set, and files with a failed check, take no part. Logarithms are compared, since a number with a
    spread of 30 % may be two thirds or one and a half of the one stated, but never less than nothing.
    """
    from scipy.special import chdtri

    compared = list(_off_start(start, [each for each in parameters if each.source not in failed]))
    if not compared:
        return
    squares = sum(sigmas**2 for _, sigmas, _ in compared)
    limit = float(chdtri(len(compared), MAX_CHANCE_OF_START_SET))
    apart = sorted(compared, key=lambda each: -abs(each[1]))
    words = [words for *_, words in apart[:MAX_PARAMETERS_LISTED]]
    more = f", and {len(apart) - MAX_PARAMETERS_LISTED} more" if len(apart) > MAX_PARAMETERS_LISTED else ""
    yield Check(
        "numbers of the start set", listed(dict.fromkeys(source for source, *_ in apart)), squares, limit, "1", squares > limit,
        f"the files contradict the set {start.name}: {'; '.join(words)}{more}",
        "start from the set of this gear (size and ratio), or see whether units, sides, ratio and torque constant are right",
    )  # fmt: skip


def ratio_in_files(start: GearSet, files: Sequence[FileResult]) -> Iterator[Check]:
    """Yield the check that the ratio in a remark of a file is that of the set, unless a person gave one with the file."""
    ratio = abs(start.gear.kinematics.ratio)
    for file in files:
        read = file.recognised
        if read is None or not read.ratio or "ratio" in read.constants:
            continue
        off = abs(float(np.log(read.ratio / ratio)))
        yield Check(
            "ratio in the file", file.name, off, MAX_OFF_RATIO, "1", off > MAX_OFF_RATIO,
            f"a remark in the file states a ratio of {read.ratio:g}, the set {start.name} has {ratio:g}",
            "start from the set of that ratio; or give the ratio that is right, with --constant ratio=NUMBER",
        )  # fmt: skip


def gravity_in_ratings(
    start: GearSet, parameters: Sequence[CombinedParameter], failed: Collection[str] = ()
) -> Iterator[Check]:
    """Yield the check that a gear of the size of the start set can carry the load. Files with a failed check take no part."""
    allowed = max((each.value for each in start.ratings.values() if each.unit == "N.m"), default=0.0)
    if allowed == 0.0:
        return
    for each in parameters:
        if each.estimate.path == GRAVITY_PATH and each.estimate.unit == "N.m" and each.source not in failed:
            share = each.estimate.value / allowed
            yield Check(
                "gravity within the ratings", each.source, share, MAX_GRAVITY_OF_RATING, "1", share > MAX_GRAVITY_OF_RATING,
                f"the gravity of its load is {each.estimate.value:.4g} N·m, {share:.3g} times the largest torque in "
                f"the ratings of {start.name} ({allowed:.4g} N·m)",
                "see whether the side, the unit of the angle and the torque, and the ratio are right, or start from a set of "
                "the right size",
            )  # fmt: skip


def _off_start(start: GearSet, parameters: Sequence[CombinedParameter]) -> Iterator[tuple[str, float, str]]:
    """Yield the best file of each compared parameter, its distance from the start set in standard deviations, and words."""
    compared = set[str]()
    for each in parameters:
        estimate = each.estimate
        path, before = _in_set(start, estimate)
        if path in compared:
            continue
        entry = start.sources.get(path)
        if entry is None or entry.assumed or before <= 0.0 or estimate.value <= 0.0:
            continue
        compared.add(path)
        spread = uncertainty(before, entry) / before
        of_kept = float(np.linalg.norm([*estimate.shift_by_kept.values(), 0.0]))
        sigma = max(float(np.linalg.norm([spread, estimate.sigma / estimate.value, of_kept])), 1e-300)
        off = float(np.log(estimate.value / before)) / sigma
        value = f"{estimate.path} = {uncertain(estimate.value, estimate.sigma)} {unit(estimate.unit)}"
        apart = f"{fixed(abs(off), 1)} σ {'above' if off > 0.0 else 'below'}"
        yield each.source, off, f"{value}, {apart} {number(before, 4)} ± {percent(spread)}"


def _in_set(start: GearSet, estimate: FileEstimate) -> tuple[str, float]:
    """Return the number of the start set that an estimate is compared with; no path if it has none of the same meaning.

    Of springs the stiffness at zero twist is compared, and that of further segments with a spring of the same law. Where their
    knees lie depends on how far they were twisted.
    """
    path, spring = estimate.path, start.gear.stiffness
    if path in FIRST_STIFFNESS and estimate.label == path:
        first, stiffness = spring.fields[0]["name"], float(spring.tangent(0.0))
        return (f"gear.stiffness.{first}", stiffness) if stiffness == float(getattr(spring, first)) else ("", 0.0)
    further = estimate.law == spring.name and estimate.unit == "N.m/rad" and path.startswith("gear.stiffness.")
    if not (further or path.startswith("gear.friction_input.")) or "[" in path or estimate.label != path:
        return "", 0.0
    try:
        return path, float(attrgetter(path)(start))
    except AttributeError:
        return "", 0.0


def between_files(parameters: Sequence[CombinedParameter], files: Sequence[FileResult]) -> Iterator[Check]:
    """Yield a check for each two files that differ by more than their standard deviations, of those without a failed check.

    A check fails if two files are further apart than runs of one gear are, too, by temperature and wear. Friction is compared
    as a torque, at speeds that both files measured: numbers of two laws differ even if they describe the same friction.
    """
    sound = {file.name: file for file in files if not file.failed and not file.same_as and not file.refused}
    pairs = {(one, other): _of_friction(sound[one], sound[other]) for one, other in combinations(sound, 2)}
    compared_by_torque = {frozenset(pair) for pair, friction in pairs.items() if friction is not None}
    apart = {pair: [_contradiction(*found)] for pair, found in pairs.items() if found and distance(*found) > MAX_DISTANCE}
    for each in parameters:
        for name in sound.keys() & set(each.contradicts) if each.source in sound else ():
            of_two_laws = sound[name].friction != sound[each.source].friction
            if is_friction(each.estimate.path) and (of_two_laws or {name, each.source} in compared_by_torque):
                continue
            pair = (each.source, name) if (each.source, name) in pairs else (name, each.source)
            apart.setdefault(pair, []).append(_contradiction(*(each.of_file(file) for file in pair)))
    for (one, other), found in apart.items():
        found.sort(key=lambda each: -each.apart)
        more = f", and {len(found) - MAX_PARAMETERS_LISTED} more" if len(found) > MAX_PARAMETERS_LISTED else ""
        yield Check(
            AGREEMENT, f"{one}, {other}", found[0].apart, MAX_DISTANCE, "1", found[0].apart > MAX_DISTANCE,
            f"their estimates differ: {'; '.join(each.words for each in found[:MAX_PARAMETERS_LISTED])}{more}"
            f"{_taken(found[0], parameters, one, other)}",
            "see whether both files are of one joint, and whether sides, columns, units and the ratio are right for both; "
            "compare temperature, load, speed and lubricant; leave out a file of another gear",
        )  # fmt: skip


def torque_scales(files: Sequence[FileResult]) -> Iterator[Check]:
    """Yield a check for each two logs that differ in load and friction by one factor, as by another torque constant.

    Another load changes no friction, and another temperature no load. Files with a failed check take no part.
    """
    logs = [each for each in files if not each.failed and not each.same_as and not each.refused]
    for one, other in combinations(logs, 2):
        pairs = list(_log_ratios(one, other))
        if not any(path in LOAD_PATHS for path, *_ in pairs) or all(path in LOAD_PATHS for path, *_ in pairs):
            continue
        off, sigma = (np.array([each[place] for each in pairs]) for place in (1, 2))
        weight = sigma**-2 / np.sum(sigma**-2)
        factor = float(weight @ off)
        differs = bool(np.all(np.abs(off) > MAX_DISTANCE * sigma)) and abs(factor) > MAX_DISTANCE * GAIN_SIGMA
        is_one = bool(np.all(np.abs(off - factor) < MAX_DISTANCE * sigma))
        if differs and is_one:
            yield Check(
                SCALE_OF_TORQUES, f"{one.name}, {other.name}", abs(factor), MAX_DISTANCE * GAIN_SIGMA, "1", True,
                f"{listed(path for path, *_ in pairs)} of the first are all {float(np.exp(factor)):.4g} times those of the "
                "second: another load changes no friction, and another temperature no load",
                "see whether torque constant, current scale and unit are the same in both files",
            )  # fmt: skip


def _log_ratios(one: FileResult, other: FileResult) -> Iterator[tuple[str, float, float]]:
    """Yield the logarithm of one value over the other, with its standard deviation, of load and Coulomb friction of one law."""
    compared = (*LOAD_PATHS, *([COULOMB_PATH] if one.friction == other.friction else []))
    there = {(each.path, each.law): each for each in other.estimates if not each.why}
    for each in one.estimates:
        its = there.get((each.path, each.law))
        if each.path in compared and not each.why and its is not None and min(each.value, its.value) > 0.0:
            sigma = float(np.hypot(each.own / each.value, its.own / its.value))
            yield each.path, float(np.log(each.value / its.value)), max(sigma, 1e-300)


def other_loads(files: Sequence[FileResult]) -> dict[str, str]:
    """Return a remark on each log whose load is not that of the first log that determines it, by file name.

    Runs of one joint may carry two loads, so this is no check. But two joints often differ by their loads alone: gears of one
    size have friction as similar as two runs of one gear.
    """
    logs = [each for each in files if each.recognised and each.recognised.kind == "log" and each.estimates and not each.same_as]
    remarks = dict[str, list[str]]()
    for path in LOAD_PATHS:
        own = {log.name: next((each for each in log.estimates if each.path == path), None) for log in logs}
        determining = {name: each for name, each in own.items() if each is not None and not each.why}
        for first, reference in list(determining.items())[:1]:
            for name, each in own.items():
                if (each is None or name in determining) and (words := _load_apart(each, reference)):
                    remarks.setdefault(name, []).append(f"{words}, of {first}")
    causes = "one joint had another load or its arm another pose, or these are two joints, each with a gear of its own"
    return {name: f"its load differs: {'; '.join(words)}; {causes}" for name, words in remarks.items()}


def _load_apart(estimate: FileEstimate | None, reference: FileEstimate) -> str:
    """Return in words how a number of a load differs from that of another log; empty if it does not."""
    if estimate is None:  # the model that predicts best has none; one without inertia only moved too slowly
        shows = reference.path == GRAVITY_PATH and reference.value > MAX_DISTANCE * reference.sigma
        words = f"{uncertain(reference.value, reference.sigma)} {unit(reference.unit)}"
        return f"no {GRAVITY_PATH} against {words}" if shows else ""
    difference_of_loads = _contradiction(estimate, reference)
    return difference_of_loads.words if estimate.unit == reference.unit and difference_of_loads.apart > MAX_DISTANCE else ""


def _of_friction(one: FileResult, other: FileResult) -> tuple[FileEstimate, FileEstimate] | None:
    """Return the friction of two files at the speed where they differ most, of those that both measured; None without one.

    A loss under load is counted at the load of the file whose law has none, and whose Coulomb torque contains it.
    """
    speeds = [measured_speeds(each) for each in (one, other)]
    units = {each.is_in_current for each in (one, other)}
    if min(map(len, speeds)) == 0 or len(units) > 1:
        return None
    slowest, fastest = zip(*(np.quantile(each, SPEED_QUANTILES) for each in speeds), strict=True)
    low, high = max(slowest), min(fastest)
    if low > high:
        return None
    without_loss = [each for each in (one, other) if not has_loss(each)]
    load = max(map(mean_load, without_loss)) if len(without_loss) == 1 else 0.0
    speeds_of_both = np.geomspace(low, high, SPEED_COUNT).tolist()
    pairs = [(friction_of(one, speed, load), friction_of(other, speed, load)) for speed in speeds_of_both]
    return max(pairs, key=lambda pair: _contradiction(*pair).apart)


def repeatability(path: str) -> float:
    """Return the relative standard deviation of a parameter from run to run of one gear, by its path."""
    return RUN_TO_RUN_SPREADS.get(path.removeprefix("gear.").partition(".")[0], GAIN_SIGMA)


class _Contradiction(NamedTuple):
    """A parameter of which two files differ.

    Attributes:
        words: both estimates, and how far apart they are and may be
        apart: the same in standard deviations, with what runs of one gear differ by
        path: of the parameter
        first_is_surer: True if the estimate of the first file has the smaller standard deviation
    """

    words: str
    apart: float
    path: str
    first_is_surer: bool


def _taken(found: _Contradiction, parameters: Sequence[CombinedParameter], one: str, other: str) -> str:
    """Return which of two files a parameter is taken from, and why; empty if it is from neither."""
    path = COULOMB_PATH if found.path == STEADY_FRICTION else found.path
    source = next((each.source for each in parameters if each.estimate.path == path and each.source in (one, other)), "")
    if not source:
        return ""
    is_surer = found.first_is_surer == (source == one)
    why = "its standard deviation is the smaller" if is_surer else "the gear has its law, as it was fitted first"
    return f"; {source} is taken because {why}"


def _contradiction(one: FileEstimate, other: FileEstimate) -> _Contradiction:
    best = min(one, other, key=lambda each: each.sigma)
    spread = repeatability(best.path) * abs(best.value)
    sigma = float(np.hypot(np.hypot(one.own, other.own), one.common - other.common))
    off, usual, size = abs(difference(one, other)), max(float(np.hypot(spread, sigma)), 1e-300), abs(best.value)
    as_share = size > 0.0 and not best.is_phase
    differ, may = (
        percent(each / size) if as_share else f"{number(each, 2)} {unit(best.unit)}" for each in (off, MAX_DISTANCE * usual)
    )
    words = (
        f"{one.label} = {uncertain(one.value, one.sigma)} against {uncertain(other.value, other.sigma)} {unit(one.unit)}: "
        f"they differ by {differ}; runs of one gear differ by up to {may}"
    )
    return _Contradiction(words, off / usual, best.path, one.sigma <= other.sigma)
