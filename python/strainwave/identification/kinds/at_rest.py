"""Friction at rest, before a shaft slides: presliding loops and ramps of torque."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from strainwave import friction
from strainwave.files.recording import Recording
from strainwave.identification.candidates.presliding import (
    BreakawayTorque,
    PreslidingCandidate,
    breakaway_torque,
    fit_presliding,
)
from strainwave.identification.checks.sizes import friction_at_rest
from strainwave.identification.checks.unexplained import (
    MAX_SHARE_OF_PRESLIDING,
    MAX_SHARE_OF_TORQUE,
    only_if_explained,
    share_left,
)
from strainwave.identification.experiments.presliding import Breakaway, PreslidingLoop, breakaways
from strainwave.identification.fitting.estimate import Estimate
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.file_result import FileEstimate, FileResult, Picture
from strainwave.identification.results.gear_so_far import GearSoFar, plain, with_torque
from strainwave.identification.results.held_out import HeldOut

SIGNIFICANCE_SIGMA = 3.0  # beyond which two numbers differ
MAX_RELATIVE_SIGMA = 0.5  # of an estimate that is determined
SLIDING = (friction.Coulomb, friction.Stribeck)  # laws whose numbers a law with bristles has, too
BRISTLES = (friction.LuGre, friction.MaxwellSlipFriction)
NO_RAMP = "no ramp went that way"


def presliding(file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
    """Fit bristle or Maxwell elements to a loop of small motion at rest.

    Raises:
        ValueError: the file does not determine it; states why
    """
    recording, uncertain = at_input(file, known)
    loop = PreslidingLoop.of(recording)
    slides = _sliding_beyond(0.5 * float(np.ptp(loop.torque)), known)
    best, *_ = fit_presliding(loop)
    slid = best.reach >= 1.0 and slides is None
    begun = np.arange(len(loop.angle)) >= loop.turns[0]
    held_out = HeldOut(
        "each part of the loop, predicted from the others", "torque at rest", "N.m", best.error,
        float(np.std(loop.torque[begun])), samples=int(begun.sum()),
    )  # fmt: skip
    whole = share_left({held_out.channel: (held_out.relative, MAX_SHARE_OF_PRESLIDING)}, file.path.name)
    estimates = only_if_explained(_elements(best, uncertain, slid=slid), whole)
    remarks = [*file.remarks]
    if slides is not None:
        remarks.append(
            f"its torque stays below the {slides:.3g} N·m at which the shaft slides by other files: it determines the "
            "stiffness, and the torque from below"
        )
    elif not slid:
        remarks.append(
            f"the shaft moved {best.reach:.2g} times as far as it must to slide: it determines the torque from below only"
        )
    sliding, after = known.sliding(), known
    if not isinstance(sliding, SLIDING):
        why = "which has bristles by an earlier file" if isinstance(sliding, BRISTLES) else "which has no bristles"
        remarks.append(f"the gear keeps its friction law, {sliding.name}, {why}; the numbers stand in the results")
    elif best.reach >= 1.0 or slides is not None:
        law = best.law(sliding, slid=slid)
        if not isinstance(sliding, friction.Stribeck):
            remarks.append("a Stribeck speed of 1 rad/s is assumed in the gear, as no table determines it")
        level = next(each.sigma for each in estimates if each.path.endswith(("breakaway", "share[0]")))
        if slid and sliding.coulomb - best.breakaway > SIGNIFICANCE_SIGMA * level and sliding.coulomb > 1.01 * best.breakaway:
            remarks.append(
                f"it breaks away at {best.breakaway:.3g} N·m, below the {sliding.coulomb:.3g} N·m with which it slides: "
                "the smaller one is taken in the gear"
            )
        sigmas = {each.path.removeprefix("gear.friction_input."): each.sigma for each in estimates if not each.why}
        after = known.with_sliding(law, sigmas, file.path.name)
    compared = {"small_angle": loop.angle, "torque": loop.torque, "modelled": best.predicted}
    units = {"small_angle": "rad", "torque": "N.m", "modelled": "N.m"}
    curves = Recording({name: values[begun] for name, values in compared.items()}, units)
    picture = Picture(curves, "loop", "torque at the input")
    checks = (*friction_at_rest(0.5 * float(np.ptp(loop.torque)), known.initial.gear, file.path.name), whole)
    return FileResult(
        file.path.name, file, _in_words(best), estimates, tuple(remarks), checks, pictures=(picture,), held_out=held_out
    ), after


def _sliding_beyond(largest: float, known: GearSoFar) -> float | None:
    """Return the torque at which the input slides by other files, if it exceeds the largest of a loop beyond doubt [N.m]."""
    law = known.sliding()
    if "friction_input" not in known.determined or not isinstance(law, (*SLIDING, friction.LuGre)):
        return None
    entries = [entry for path, entry in known.gear_set.sources.items() if plain(path) == "gear.friction_input.coulomb"]
    sigma = max((entry.uncertainty or 0.0 for entry in entries), default=0.0)
    level = max(law.coulomb, law.breakaway)
    return level if level - SIGNIFICANCE_SIGMA * sigma > largest else None


def _in_words(best: PreslidingCandidate) -> str:
    return "a bristle (LuGre)" if best.name == "bristle" else f"{best.name} (Maxwell slip)"


def _elements(best: PreslidingCandidate, uncertain: float, *, slid: bool) -> Iterator[FileEstimate]:
    """Yield the numbers of a law with bristles, under the names that it has for them."""
    short = "" if slid else "the loop never slid, so that it determines the torque from below only"
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
        yield _estimate(each, f"gear.friction_input.{names[each.path]}", own, uncertain, short if level else "")


def breakaway(file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
    """Fit the breakaway torque of ramps, in both directions.

    Raises:
        ValueError: no ramp broke the shaft away
    """
    recording, uncertain = at_input(file, known)
    ramps = breakaways(recording)
    found = breakaway_torque(ramps)
    remarks = [*file.remarks, f"{len(ramps)} {'ramp of torque breaks' if len(ramps) == 1 else 'ramps of torque break'} it away"]
    sides = [each for each in (found.forward, found.reverse) if each is not None]
    few = "one ramp shows no scatter" if len(ramps) <= len(sides) else ""
    both = _mean(sides)
    for each, way in zip((found.forward, found.reverse), ("forward", "in reverse"), strict=True):
        remarks.append(f"{way}: " + (NO_RAMP if each is None else _with_sigma(each)))
    if found.slope is not None:
        remarks.append(
            f"for each decade of the ramps' rate it changes by {found.slope.value:.2g} ± {found.slope.sigma:.1g} N·m"
        )
    scatter = np.array([abs(ramp.torque) - each.value for ramp in ramps for each in [_of_way(ramp, found)]])
    left = float(np.sqrt(np.mean(scatter**2))) / both.value
    whole = share_left({"the torque of breakaway": (left, MAX_SHARE_OF_TORQUE)}, file.path.name)
    estimates = only_if_explained((_estimate(both, "gear.friction_input.breakaway", "", uncertain, few),), whole)
    law, after = known.sliding(), known
    if isinstance(law, (*SLIDING, friction.LuGre)) and not _has_breakaway(known) and not estimates[0].why:
        if both.value >= law.coulomb:
            after = known.with_sliding(law.replace(breakaway=both.value), {"breakaway": estimates[0].sigma}, file.path.name)
        else:
            remarks.append(
                f"it lies below the Coulomb torque of the gear, {law.coulomb:.3g} N·m, which keeps its breakaway torque"
            )
    checks = (*friction_at_rest(both.value, known.initial.gear, file.path.name), whole)
    return FileResult(file.path.name, file, "breakaway of each ramp", estimates, tuple(remarks), checks), after


def _with_sigma(each: Estimate) -> str:
    scatter = f"± {each.sigma:.2g} N·m" if np.isfinite(each.sigma) else "N·m, of one ramp"
    return f"{each.value:.4g} {scatter}"


def _of_way(ramp: Breakaway, found: BreakawayTorque) -> Estimate:
    """Return the breakaway torque in the direction of a ramp."""
    each = found.forward if ramp.torque > 0.0 else found.reverse
    assert each is not None
    return each


def _has_breakaway(known: GearSoFar) -> bool:
    """True if an earlier file determines the breakaway torque."""
    return any(plain(path) == "gear.friction_input.breakaway" for path in known.determined_by)


def _mean(sides: list[Estimate]) -> Estimate:
    """Return the mean of both directions; if they differ by more than chance, half the difference adds to its uncertainty."""
    values, sigmas = np.array([each.value for each in sides]), np.array([each.sigma for each in sides])
    value, sigma = float(values.mean()), float(np.linalg.norm(sigmas)) / len(sides)
    half = 0.5 * float(np.ptp(values))
    if 2.0 * half > SIGNIFICANCE_SIGMA * np.linalg.norm(sigmas):
        sigma = float(np.hypot(sigma, half))
    return replace(sides[0], path="breakaway", value=value, sigma=sigma)


def _estimate(each: Estimate, path: str, law: str, uncertain: float, short: str) -> FileEstimate:
    common = uncertain * abs(each.value)
    sigma = float(np.hypot(each.sigma, common))
    why = short or ("its standard deviation exceeds half the value" if sigma > MAX_RELATIVE_SIGMA * abs(each.value) else "")
    return FileEstimate(path, each.unit, each.value, sigma, law, why, common)


def at_input(file: Recognised, known: GearSoFar) -> tuple[Recording, float]:
    """Return angle and torque of the input; what was measured at the output is referred to it by the ratio."""
    recording, uncertain = with_torque(file, known.gear_set)
    if file.side != "output":
        return recording, uncertain
    ratio = abs(known.gear_set.gear.kinematics.ratio)
    turned = recording.with_column("angle", ratio * recording["angle"], "rad")
    return turned.with_column("torque", recording["torque"] / ratio, "N.m"), uncertain
