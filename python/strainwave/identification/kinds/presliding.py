"""Presliding loops: small motions to and fro at rest, before the shaft slides."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave.analysis.branches import turning_points
from strainwave.files.recording import Recording
from strainwave.identification.candidates.presliding import BRANCH_FOLDS, PreslidingCandidate, PreslidingLoop, fit_presliding
from strainwave.identification.candidates.torsion import plain_error
from strainwave.identification.checks.sizes import friction_at_rest
from strainwave.identification.checks.unexplained import MAX_SHARE_OF_PRESLIDING, Left, error_left, only_if_explained
from strainwave.identification.kinds.at_rest import (
    BRISTLE_LAWS,
    SLIDING_LAWS,
    WITH_BREAKAWAY,
    AtRest,
    at_input,
    estimate_of,
    goes_to_and_fro,
)
from strainwave.identification.kinds.kind import Ranked
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import Column
from strainwave.identification.results.file_result import FileEstimate, FileResult, HeldOut
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.identification.results.pictures import Picture
from strainwave.parameters import plain
from strainwave.statistics.residuals import correlation_length
from strainwave.statistics.scale import SIGNIFICANCE_SIGMA


class Presliding(AtRest):
    """Angle and torque of a shaft that moves to and fro without sliding on."""

    def recognises(self, columns: Sequence[Column], mapping: FileMapping) -> bool:
        """True if the angle goes to and fro by little."""
        return goes_to_and_fro(columns, mapping)

    def motion(self, angle: Column, force: Column) -> str:
        """Return in words how the shaft moves."""
        moved, turns = f"moves by {1e3 * np.ptp(angle.si):.3g} mrad in all", len(turning_points(angle.si))
        return f"{angle.name} {moved} and turns back {turns} times under {force.name}"

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Fit bristle or Maxwell elements to a loop of small motion at rest.

        Raises:
            ValueError: the file does not determine it; states why
        """
        recording, uncertain = at_input(file, known)
        loop, name = PreslidingLoop.of(recording), file.path.name
        best, *_ = fit_presliding(loop)
        begun, largest = _begun(loop), 0.5 * float(np.ptp(loop.torque))
        branch = np.searchsorted(loop.turns, np.flatnonzero(begun), "right") % BRANCH_FOLDS
        parts = [branch == part for part in np.unique(branch)]
        plain = plain_error(loop.angle[begun], loop.torque[begun], parts) if len(parts) > 1 else np.nan
        slides = _sliding_beyond(largest, known)
        held_out = HeldOut(
            "each part of the loop, predicted from the others", "torque at rest", "N.m", best.error,
            float(np.std(loop.torque[begun])), plain, samples=int(begun.sum()),
        )  # fmt: skip
        whole = error_left({held_out.channel: Left(held_out.error, held_out.zero, "N.m", MAX_SHARE_OF_PRESLIDING)}, name)
        slid = best.reach >= 1.0 and slides is None
        estimates = only_if_explained(_elements(best, uncertain, slid=slid), whole)
        after, of_law = _with_bristles(best, known, estimates, name, slides)
        compared = {"small_angle": loop.angle, "torque": loop.torque, "modelled": best.predicted}
        units = {"small_angle": "rad", "torque": "N.m", "modelled": "N.m"}
        curves = Recording({each: values[begun] for each, values in compared.items()}, units)
        return FileResult(
            name, file, "a bristle (LuGre)" if best.name == "bristle" else f"{best.name} (Maxwell slip)", estimates,
            (*file.remarks, *_short_of(best, slides), *of_law),
            (*friction_at_rest(largest, known.initial.gear, name), whole),
            pictures=(Picture(curves, "loop", "torque at the input"),), held_out=held_out,
        ), after  # fmt: skip

    def rank(self, file: Recognised, known: GearSoFar) -> tuple[Ranked, ...]:
        """Return a bristle and numbers of Maxwell elements by their error on data held out."""
        loop = PreslidingLoop.of(at_input(file, known)[0])
        begun = _begun(loop)
        return tuple(
            Ranked(
                each.name, len(each.estimates), each.error, np.nan, "N.m",
                correlation_length((loop.torque - each.predicted)[begun]),
            )
            for each in fit_presliding(loop)
        )  # fmt: skip


def _begun(loop: PreslidingLoop) -> NDArray[np.bool_]:
    """Return the samples from the first reversal on: before it the history of the loop is not known."""
    return np.arange(len(loop.angle)) >= loop.turns[0]


def _sliding_beyond(largest: float, known: GearSoFar) -> float | None:
    """Return the torque at which the input slides by other files, if it certainly exceeds the largest of a loop [N.m]."""
    law = known.sliding()
    if "friction_input" not in known.determined or not isinstance(law, WITH_BREAKAWAY):
        return None
    entries = [entry for path, entry in known.gear_set.sources.items() if plain(path) == "gear.friction_input.coulomb"]
    sigma = max((entry.uncertainty or 0.0 for entry in entries), default=0.0)
    level = max(law.coulomb, law.breakaway)
    return level if level - SIGNIFICANCE_SIGMA * sigma > largest else None


def _short_of(best: PreslidingCandidate, slides: float | None) -> Iterator[str]:
    """Yield how far a loop stays from sliding."""
    if slides is not None:
        yield (
            f"its torque stays below the {slides:.3g} N·m at which the shaft slides by other files: it determines the "
            "stiffness, and the torque from below"
        )
    elif best.reach < 1.0:
        yield f"the shaft moved {best.reach:.2g} times as far as it must to slide: it determines the torque from below only"


def _with_bristles(
    best: PreslidingCandidate, known: GearSoFar, estimates: Sequence[FileEstimate], name: str, slides: float | None
) -> tuple[GearSoFar, list[str]]:
    """Return the gear with the law that a loop determines, and remarks; the gear as it is if the loop fits no law of it."""
    sliding = known.sliding()
    if not isinstance(sliding, SLIDING_LAWS):
        why = "which has bristles by an earlier file" if isinstance(sliding, BRISTLE_LAWS) else "which has no bristles"
        return known, [f"the gear keeps its friction law, {sliding.name}, {why}; the numbers stand in the results"]
    if best.reach < 1.0 and slides is None:
        return known, []
    slid, remarks = slides is None, list[str]()
    if not hasattr(sliding, "stribeck_speed"):
        remarks.append("a Stribeck speed of 1 rad/s is assumed in the gear, as no table determines it")
    level = next(each.sigma for each in estimates if each.path.endswith(("breakaway", "share[0]")))
    if slid and sliding.coulomb - best.breakaway > SIGNIFICANCE_SIGMA * level and sliding.coulomb > 1.01 * best.breakaway:
        remarks.append(
            f"it breaks away at {best.breakaway:.3g} N·m, below the {sliding.coulomb:.3g} N·m with which it slides: "
            "the smaller one is taken in the gear"
        )
    sigmas = {each.path.removeprefix("gear.friction_input."): each.sigma for each in estimates if not each.why}
    return known.with_sliding(best.law(sliding, slid=slid), sigmas, name), remarks


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
        yield estimate_of(each, f"gear.friction_input.{names[each.path]}", own, uncertain, short if level else "")
