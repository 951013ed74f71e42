"""Numbers that a file does not determine: the set before the file is their prior, and sums that are determined are kept."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import friction
from strainwave.files.entries import Entry
from strainwave.identification.fitting.fit import Fit, solved_problem, with_priors
from strainwave.identification.results.determined import sizes_of
from strainwave.identification.results.file_result import FileEstimate
from strainwave.identification.results.gear_so_far import START_SPREAD, GearSoFar
from strainwave.identification.results.identifiability import MAX_CORRELATION, combination
from strainwave.messages import listed, one_line
from strainwave.parameters import plain
from strainwave.statistics.determined_sum import DeterminedSum
from strainwave.statistics.linear_fit import normal_inverse

Array = NDArray[np.float64]

BY_SET = "determined together with numbers that are not identified, between which the set before the file divides"
DIVIDED = friction.Coulomb | friction.Stribeck | friction.LuGre  # laws with Coulomb and viscous friction
MIN_RELATIVE_SIGMA = 1e-3  # of a torque: friction is repeated no better
MAX_SHIFT_SIGMA = 1.0  # standard deviations: an estimate that its prior moves farther is determined in combination only


def with_set_before(
    found: Fit, estimates: Sequence[FileEstimate], known: GearSoFar, prefix: str = ""
) -> tuple[Fit, tuple[FileEstimate, ...]]:
    """Return a fit and its estimates with the set before the file as the prior of what the file does not determine.

    Args:
        found: the fit
        estimates: of the file, judged
        known: the set before the file
        prefix: of the paths of the fit in a gear set
    """
    priors = priors_of_undetermined(found, estimates, known, prefix)
    if not priors:
        return found, tuple(estimates)
    again = with_priors(found, {path: (each.value, each.weighted) for path, each in priors.items()})
    return again, moved(estimates, again, found, priors, prefix)


@dataclass(frozen=True)
class PriorOfSet:
    """A number of the set before a file as the prior of a fit.

    Attributes:
        value: the number
        sigma: its standard deviation
        weighted: the same for a fit whose estimates are more uncertain than its weights are: the prior counts as much more
    """

    value: float
    sigma: float
    weighted: float


def priors_of_undetermined(
    found: Fit, estimates: Sequence[FileEstimate], known: GearSoFar, prefix: str = ""
) -> dict[str, PriorOfSet]:
    """Return the priors of unknowns that are not identified, and of those that correlate with one so that only sums are."""
    places = {plain(prefix + each.path): place for place, each in enumerate(found.plan.unknowns)}
    open_ones = [each for each in estimates if each.state != "identified" and each.path in places]
    if not open_ones:
        return {}
    priors = priors_of(found, estimates, known, prefix)
    # others than these have two meanings in a fit, as friction in one direction and a zero
    open_places = [
        places[each.path] for each in open_ones
        if np.isfinite(each.sigma) or not np.isfinite(found.estimates[places[each.path]].sigma)
    ]  # fmt: skip
    correlation = np.abs(np.nan_to_num(found.correlation))
    acts = {
        unknown.path for place, unknown in enumerate(found.plan.unknowns)
        if any(place == other or correlation[place, other] > MAX_CORRELATION for other in open_places)
    }  # fmt: skip
    acted_on = {path: prior for path, prior in priors.items() if path in acts}
    return acted_on if any(found.plan.unknowns[place].path in acted_on for place in open_places) else {}


def priors_of(found: Fit, estimates: Sequence[FileEstimate], known: GearSoFar, prefix: str = "") -> dict[str, PriorOfSet]:
    """Return the numbers of the set before a file as priors of the unknowns of a fit, by path.

    Elements of a sequence have none: those of two gears have nothing in common.
    """
    problem, x = solved_problem(found)
    by_weights, sigmas = problem.naive_sigma(x, problem.weights(x)), {each.path: each.sigma for each in estimates}
    priors = {}
    for place, unknown in enumerate(found.plan.unknowns):
        path = plain(prefix + unknown.path)
        if "[" not in path and (prior := known.prior(path, found.gear)) is not None:
            value, sigma = prior
            priors[unknown.path] = PriorOfSet(value, sigma, sigma * _share(by_weights[place], sigmas.get(path, np.inf)))
    return priors


def _share(by_weights: float, sigma: float) -> float:
    """Return the standard deviation by the weights of a fit over that of the estimate [1]; 1 if the fit determines none."""
    return min(by_weights / sigma, 1.0) if np.isfinite(by_weights) and np.isfinite(sigma) and sigma > 0.0 else 1.0


def moved(
    estimates: Iterable[FileEstimate], again: Fit, found: Fit, priors: Mapping[str, PriorOfSet], prefix: str = ""
) -> tuple[FileEstimate, ...]:
    """Return estimates with the values of a fit with priors, and what is determined only in combination marked so."""
    places = {plain(prefix + each.path): place for place, each in enumerate(found.estimates)}
    return tuple(
        _moved(each, places[each.path], again, found, priors.get(found.estimates[places[each.path]].path))
        if each.path in places else each
        for each in estimates
    )  # fmt: skip


def _moved(each: FileEstimate, place: int, again: Fit, found: Fit, prior: PriorOfSet | None) -> FileEstimate:
    new = again.estimates[place]
    if prior is None:
        return replace(each, value=new.value)
    sums = combination(found, place)
    is_split = bool(sums) or (not each.why and abs(new.value - each.value) > MAX_SHIFT_SIGMA * each.sigma)
    return replace(
        each, value=new.value,
        sigma=float(np.hypot(1.0 / np.hypot(1.0 / max(each.sigma, 1e-300), 1.0 / prior.sigma), each.common)),
        why=sums or each.why or (BY_SET if is_split else ""), in_combination=each.in_combination or is_split,
    )  # fmt: skip


# ---- Sums of friction ------------------------------------------------------------------------------------------------


def with_friction_at(known: GearSoFar, speed: Array, estimates: Sequence[FileEstimate], side: str, name: str) -> GearSoFar:
    """Return the set with the friction that a file determines at speeds too few for a law.

    The sum of Coulomb and viscous friction is as measured. Its division is that of the set, scaled to the sum, as far as the
    speeds leave it open.

    Args:
        known: the set before the file
        speed: measured, with the sign of the motion [rad/s], shape (n,); one direction does not separate friction from gravity
        estimates: friction at each size of the speed, in order
        side: at which both were measured, `input` or `output`
        name: of the file
    """
    from scipy.optimize import nnls

    law: Any = known.gear_set.gear.friction_input
    ratio = abs(known.gear_set.gear.kinematics.ratio) if side == "output" else 1.0
    torque, sigma = np.array([(each.value, each.sigma) for each in estimates]).T
    at, sum_of, spread = sizes_of(speed) * ratio, torque / ratio, np.maximum(sigma, MIN_RELATIVE_SIGMA * np.abs(torque)) / ratio
    sizes = np.round(np.log(np.abs(speed)), 1)
    both_ways = np.array([len(np.unique(np.sign(speed[sizes == size]))) == 2 for size in np.unique(sizes)])
    usable = np.isfinite(spread) & (sum_of > 0.0) & both_ways
    if "friction_input" in known.determined or not isinstance(law, DIVIDED) or law.coulomb <= 0.0:
        return known
    if not usable.any():
        return known
    at, sum_of, spread = at[usable], sum_of[usable], spread[usable]
    before = np.array([law.coulomb, law.viscous])
    columns = np.stack([np.ones_like(at), at], axis=1)
    weighted = columns @ before / spread
    divided = before * float(weighted @ (sum_of / spread)) / float(weighted @ weighted)
    by_set = START_SPREAD * np.maximum(divided, MIN_RELATIVE_SIGMA * divided.max())
    rows = np.concatenate([columns / spread[:, np.newaxis], np.diag(1.0 / by_set)])
    coulomb, viscous = nnls(rows, np.concatenate([sum_of / spread, divided / by_set]))[0].tolist()
    sigmas = np.sqrt(np.diag(normal_inverse(rows))).tolist()
    numbers = {"coulomb": coulomb, "breakaway": law.breakaway * coulomb / law.coulomb, "viscous": viscous}
    sums = [
        DeterminedSum(("coulomb", "viscous"), (1.0, where), total, within, "N.m")
        for where, total, within in zip(at.tolist(), sum_of.tolist(), spread.tolist(), strict=True)
    ]
    why = f"identified in combination: {one_line(name)} determines {listed(map(str, sums))}; the split is that of the start set"
    entries = {
        f"gear.friction_input.{each}": Entry(why, uncertainty=sigmas[place])
        for place, each in ((0, "coulomb"), (0, "breakaway"), (1, "viscous"))
    }
    return known.with_sums({"friction_input": law.replace(**numbers)}, entries, name)
