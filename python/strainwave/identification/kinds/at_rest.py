"""Friction at rest, before a shaft slides: what presliding loops and ramps of torque tell, as findings."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from strainwave import friction
from strainwave.files.recording import Recording
from strainwave.identification.candidates.presliding import PreslidingCandidate, breakaway_torque, fit_presliding
from strainwave.identification.experiments.presliding import PreslidingLoop, breakaways
from strainwave.identification.fitting.estimate import Estimate
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.file_result import FileEstimate, FileResult
from strainwave.identification.results.gear_so_far import GearSoFar, plain, with_torque

CLEARLY = 3.0  # standard deviations
HALF = 0.5  # of a value: a number whose standard deviation is larger is not told
SLIDING = (friction.Coulomb, friction.Stribeck)  # laws whose numbers a law with bristles has, too
NO_RAMP = "no ramp went that way"


def presliding(file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
    """Bristle or Maxwell elements of a loop of small motion at rest.

    Raises:
        ValueError: it cannot be told; says why
    """
    recording, uncertain = at_input(file, known)
    loop = PreslidingLoop.of(recording)
    best, *_ = fit_presliding(loop)
    told = tuple(_elements(best, uncertain))
    begun = np.arange(len(loop.angle)) >= loop.turns[0]
    error = best.error / float(np.std(loop.torque[begun]))
    remarks = [*file.remarks]
    if best.reach < 1.0:
        remarks.append(f"the shaft moved {best.reach:.2g} times as far as it must to slide: the torque is told only from below")
    sliding, after = known.sliding(), known
    if not isinstance(sliding, SLIDING):
        remarks.append(
            f"the gear keeps its friction law, {sliding.name}, which has no bristles; the numbers stand in the results"
        )
    elif best.reach >= 1.0:
        law = best.law(sliding)
        if not isinstance(sliding, friction.Stribeck):
            remarks.append("a Stribeck speed of 1 rad/s is assumed in the gear, as no table tells it")
        level = next(each for each in told if each.path.endswith(("breakaway", "share[0]")))
        if sliding.coulomb - best.breakaway > CLEARLY * level.sigma and sliding.coulomb > 1.01 * best.breakaway:
            remarks.append(
                f"it breaks away at {best.breakaway:.3g} N·m, below the {sliding.coulomb:.3g} N·m with which it slides: "
                "the smaller one is taken in the gear"
            )
        sigmas = {each.path.removeprefix("gear.friction_input."): each.sigma for each in told if not each.why}
        after = known.with_sliding(law, sigmas, file.path.name)
    compared = {"small_angle": loop.angle, "torque": loop.torque, "modelled": best.predicted}
    units = {"small_angle": "rad", "torque": "N.m", "modelled": "N.m"}
    curves = Recording({name: values[begun] for name, values in compared.items()}, units)
    return FileResult(file.path.name, file, _in_words(best), told, error, tuple(remarks), curves=curves), after


def _in_words(best: PreslidingCandidate) -> str:
    return "a bristle (LuGre)" if best.name == "bristle" else f"{best.name} (Maxwell slip)"


def _elements(best: PreslidingCandidate, uncertain: float) -> Iterator[FileEstimate]:
    """The numbers of a law with bristles, under the names that it has for them."""
    short = "" if best.reach >= 1.0 else "the loop never slid, so that it tells the torque from below only"
    if best.name == "bristle":
        names, law = {"stiffness": "bristle_stiffness", "breakaway": "breakaway"}, "lugre"
    else:
        places = len(best.estimates) // 2
        names, law = {"stiffness": "stiffness[0]", "breakaway": "share[0]"}, "maxwell_slip_friction"
        names |= {f"stiffness[{i}]": f"stiffness[{i}]" for i in range(places)}
        names |= {f"breakaway[{i}]": f"share[{i}]" for i in range(places)}
    for each in best.estimates:
        level = each.path.startswith("breakaway")
        own = "" if level and best.name == "bristle" else law  # breakaway is the same in every law that has it
        yield _told(each, f"gear.friction_input.{names[each.path]}", own, uncertain, short if level else "")


def breakaway(file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
    """The torque of breakaway of ramps, in both directions.

    Raises:
        ValueError: no ramp broke the shaft away
    """
    recording, uncertain = at_input(file, known)
    ramps = breakaways(recording)
    found = breakaway_torque(ramps)
    remarks = [*file.remarks, f"{len(ramps)} ramps of torque break it away"]
    sides = [each for each in (found.forward, found.reverse) if each is not None]
    few = "one ramp tells no scatter" if len(ramps) <= len(sides) else ""
    both = _mean(sides)
    for each, way in zip((found.forward, found.reverse), ("forward", "in reverse"), strict=True):
        remarks.append(f"{way}: " + (NO_RAMP if each is None else f"{each.value:.4g} ± {each.sigma:.2g} N·m"))
    if found.slope is not None:
        remarks.append(
            f"for each decade of the ramps' rate it changes by {found.slope.value:.2g} ± {found.slope.sigma:.1g} N·m"
        )
    told = (_told(both, "gear.friction_input.breakaway", "", uncertain, few),)
    law, after = known.sliding(), known
    if isinstance(law, (*SLIDING, friction.LuGre)) and not _tells_breakaway(known) and not told[0].why:
        if both.value >= law.coulomb:
            after = known.with_sliding(law.replace(breakaway=both.value), {"breakaway": told[0].sigma}, file.path.name)
        else:
            remarks.append(
                f"it lies below the Coulomb torque of the gear, {law.coulomb:.3g} N·m, which keeps its breakaway torque"
            )
    return FileResult(file.path.name, file, "breakaway of each ramp", told, np.nan, tuple(remarks)), after


def _tells_breakaway(known: GearSoFar) -> bool:
    """Whether an earlier file has told the torque of breakaway."""
    return any(plain(path) == "gear.friction_input.breakaway" for path in known.determined_by)


def _mean(sides: list[Estimate]) -> Estimate:
    """The mean of both directions; where they differ by more than chance, half of the difference is an uncertainty of it."""
    values, sigmas = np.array([each.value for each in sides]), np.array([each.sigma for each in sides])
    value, sigma = float(values.mean()), float(np.linalg.norm(sigmas)) / len(sides)
    half = 0.5 * float(np.ptp(values))
    if 2.0 * half > CLEARLY * np.linalg.norm(sigmas):
        sigma = float(np.hypot(sigma, half))
    return replace(sides[0], path="breakaway", value=value, sigma=sigma)


def _told(each: Estimate, path: str, law: str, uncertain: float, short: str) -> FileEstimate:
    common = uncertain * abs(each.value)
    sigma = float(np.hypot(each.sigma, common))
    why = short or ("its standard deviation exceeds half the value" if sigma > HALF * abs(each.value) else "")
    return FileEstimate(path, each.unit, each.value, sigma, law, why, common)


def at_input(file: Recognised, known: GearSoFar) -> tuple[Recording, float]:
    """Angle and torque of the input; what was measured at the output is referred to it by the ratio."""
    recording, uncertain = with_torque(file, known.gear_set)
    if file.side != "output":
        return recording, uncertain
    ratio = abs(known.gear_set.gear.kinematics.ratio)
    turned = recording.with_column("angle", ratio * recording["angle"], "rad")
    return turned.with_column("torque", recording["torque"] / ratio, "N.m"), uncertain
