"""Which parameters a fit to a file determines, by themselves or in sums, and which keep the set before as their prior."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import friction
from strainwave.files.entries import Entry
from strainwave.identification.candidates.friction import STEADY_NUMBERS
from strainwave.identification.fitting.fit import Fit, solved_problem, with_priors
from strainwave.identification.fitting.influence import InfluenceOfKept
from strainwave.identification.fitting.unknowns import Estimate
from strainwave.identification.results.file_result import TOO_UNCERTAIN, FileEstimate, is_uncertain
from strainwave.identification.results.gear_so_far import START_SPREAD, GearSoFar
from strainwave.identification.results.steady_friction import sizes_of
from strainwave.messages import listed, one_line
from strainwave.parameters import plain
from strainwave.statistics.determined_sum import DeterminedSum, sum_by_covariance, sum_by_information
from strainwave.statistics.linear_fit import normal_inverse

Array = NDArray[np.float64]

MAX_SIGMA_OF_PHASE = 0.5  # rad
MAX_RELATIVE_SHIFT = 0.25  # relative shift by the uncertainty of a kept parameter; beyond it the estimate is not identified
MAX_SHIFT_BY_WRONG = 0.05  # relative shift by a kept parameter that the measurement contradicts
MIN_SHIFT_LISTED = 0.02  # relative shift; smaller ones are not listed
MAX_KEPT_LISTED = 3  # kept parameters named with an estimate
MAX_CORRELATION = 0.98  # of two estimates; with a larger one, those that are uncertain are identified in combination
BY_SET = "determined together with numbers that are not identified, between which the set before the file divides"
DIVIDED_LAWS = friction.Coulomb | friction.Stribeck | friction.LuGre  # laws with Coulomb and viscous friction
SLOPES_AT_KNEE = {"gear.stiffness.t1": ("k1", "k2"), "gear.stiffness.t2": ("k2", "k3")}
BETWEEN_KNEES = "gear.stiffness.k2"
MIN_SLOPE_SIGMAS = 2.0  # standard deviations by which the slopes of a spring differ at a knee
MIN_RELATIVE_SIGMA = 1e-3  # of a torque: friction is repeated no better
MAX_SHIFT_SIGMA = 1.0  # standard deviations: an estimate that its prior moves farther is determined in combination only


@dataclass(frozen=True)
class JudgedFit:
    """A fit to a file, and the limits of its estimates.

    Attributes:
        fit: the fit
        source: name of the file
        influence: of the kept parameters
        explained: False if the model does not explain the measurement; then it determines nothing
        shared: parameters that this kind of measurement determines only together with others, by path, and how
        prefix: of the paths of the fit in a gear set; empty for the fit of a drive
        spread: standard deviation of estimates that the fit does not contain, by path: by the choice of its model, or by what
            that lacks
    """

    fit: Fit
    source: str
    influence: InfluenceOfKept
    explained: bool = True
    shared: Mapping[str, str] = field(default_factory=dict)
    prefix: str = "gear."
    spread: Mapping[str, float] = field(default_factory=dict)

    def with_set_before(self, known: GearSoFar) -> tuple[Fit, tuple[FileEstimate, ...]]:
        """Return the fit and its estimates, with the set before the file as the prior of what the file does not determine."""
        estimates = without_bare_knees(self.estimates(known.gear_set.sources, known.determined_by))
        return with_set_before(self.fit, estimates, known, self.prefix) if self.explained else (self.fit, estimates)

    def estimates(self, sources: Mapping[str, Entry], determined: Collection[str]) -> Iterator[FileEstimate]:
        """Yield the estimates of the parameters, without those of the measurement, as zeros of encoders.

        Args:
            sources: of all numbers of the gear set, before the file
            determined: paths of numbers that earlier files determine, whose uncertainty is part of that of the estimates
        """
        free = len(self.fit.estimates) - len(self.fit.experiment.nuisances)
        for place in range(free):
            estimate = self._spread(place)
            path, size = self.prefix + estimate.path, _size(estimate)
            shifts = self.influence.shifts(place, sources, self.prefix)
            of_others = [
                shift for kept, shift in shifts.items() if path in self.shared or _is_in(self.prefix + kept, determined)
            ]
            sigma = float(np.linalg.norm([estimate.sigma, *of_others]))
            why, in_combination = self._why(place, path, sources, shifts)
            relative = {kept: shift / size for kept, shift in shifts.items() if size > 0.0 and shift > MIN_SHIFT_LISTED * size}
            yield FileEstimate(
                path, estimate.unit, estimate.value, sigma, _law(path, self.fit.gear), why,
                in_combination=in_combination, shift_by_kept=dict(list(relative.items())[:MAX_KEPT_LISTED]),
            )  # fmt: skip

    def _spread(self, place: int) -> Estimate:
        """Return an estimate with its whole standard deviation."""
        estimate = self.fit.estimates[place]
        return replace(estimate, sigma=float(np.hypot(estimate.sigma, self.spread.get(estimate.path, 0.0))))

    def _why(self, place: int, path: str, sources: Mapping[str, Entry], shifts: Mapping[str, float]) -> tuple[str, bool]:
        """Return why the data do not determine an estimate, and whether they do together with another; empty if they do."""
        estimate = self._spread(place)
        if self.explained and not np.isfinite(estimate.sigma) and (why := combination(self.fit, place)):
            return why, True
        if why := self._undetermined(place):
            return why, False
        if not _is_phase(estimate) and is_uncertain(estimate.value, estimate.sigma):
            why = combination(self.fit, place)
            return why or TOO_UNCERTAIN, bool(why)
        if why := self.shared.get(path, ""):
            return why, True
        if why := self._by_wrong(place, sources):
            return why, False
        size = _size(estimate)
        far = [f"{kept} by {100.0 * shift / size:.2g} %" for kept, shift in shifts.items() if shift > MAX_RELATIVE_SHIFT * size]
        return f"the uncertainty of kept parameters may change it: {', '.join(far[:MAX_KEPT_LISTED])}" if far else "", False

    def _undetermined(self, place: int) -> str:
        estimate = self._spread(place)
        if not self.explained:
            return f"the model does not explain {self.source}"
        if not np.isfinite(estimate.sigma):
            return f"{self.source} stays the same when it changes"
        if estimate.at_limit:
            return f"ended at its bound; {self.source} would move it further"
        if _is_phase(estimate):
            return f"standard deviation is {estimate.sigma:.2g} rad" if estimate.sigma > MAX_SIGMA_OF_PHASE else ""
        return ""

    def _by_wrong(self, place: int, sources: Mapping[str, Entry]) -> str:
        """Return the kept parameter that the measurement contradicts, if its correction would shift the estimate far."""
        influence, size = self.influence, _size(self.fit.estimates[place])
        shifts = {
            influence.kept[kept].path: influence.slopes[place, kept] * influence.shift_if_free[kept] / size
            for kept in influence.suspects(sources, self.prefix)
        }
        path = max(shifts, key=lambda each: abs(shifts[each]), default="")
        if not path or abs(shifts[path]) < MAX_SHIFT_BY_WRONG:
            return ""
        return (
            f"{self.source} disagrees with the kept {path}: fitting that too would change this by {100.0 * shifts[path]:+.2g} %"
        )


def without_bare_knees(estimates: Iterable[FileEstimate]) -> tuple[FileEstimate, ...]:
    """Return estimates in which a knee of a spring is identified only between two slopes that are, and that differ.

    The slope between two knees is identified only if these are apart.
    """
    judged = tuple(_apart(estimates))
    slopes = {estimate.path: estimate for estimate in judged}
    return tuple(
        replace(
            estimate,
            why=estimate.why or _bare([slopes.get(f"gear.stiffness.{name}") for name in SLOPES_AT_KNEE[estimate.path]]),
        )
        if estimate.path in SLOPES_AT_KNEE
        else estimate
        for estimate in judged
    )


def _apart(estimates: Iterable[FileEstimate]) -> Iterator[FileEstimate]:
    """Yield estimates, the slope between two knees of a spring not identified if their distance is not significant."""
    judged = {each.path: each for each in estimates}
    first, second = (judged.get(path) for path in SLOPES_AT_KNEE)
    for path, each in judged.items():
        if path == BETWEEN_KNEES and first is not None and second is not None and not each.why:
            far = second.value - first.value > MIN_SLOPE_SIGMAS * float(np.hypot(first.sigma, second.sigma))
            yield each if far else replace(each, why="the knees beside this slope are not significantly apart")
        else:
            yield each


def _bare(slopes: Sequence[FileEstimate | None]) -> str:
    """Return why a knee between two slopes is not identified; empty if they are identified and differ."""
    below, above = slopes
    if below is None or above is None:
        return ""
    if "not identified" in (below.state, above.state):
        return "a slope beside this knee is not identified"
    if abs(above.value - below.value) < MIN_SLOPE_SIGMAS * float(np.hypot(below.sigma, above.sigma)):
        return "the slopes beside this knee do not differ significantly"
    return ""


def _law(path: str, gear: Any) -> str:
    """Return the law that gives a number its meaning; empty for numbers that mean the same in every law."""
    part, _, name = path.removeprefix("gear.").partition(".")
    return "" if part == "friction_input" and name in STEADY_NUMBERS else str(getattr(gear, part).name)


def combination(fit: Fit, place: int) -> str:
    """Return the sum with others that the data determine although they hardly determine an estimate, in words; or nothing."""
    own = fit.estimates[place]
    both = _with_partner(fit, place) if np.isfinite(own.sigma) else _inseparable(fit, place)
    return "" if both is None or is_uncertain(both.value, both.sigma) else both.with_others


def _with_partner(fit: Fit, place: int) -> DeterminedSum | None:
    """Return the sum of an estimate with the one that it correlates with most, if it does so nearly entirely."""
    correlation, free = np.abs(fit.correlation[place]), len(fit.plan.unknowns)
    correlation[place] = 0.0
    correlation[free : free + len(fit.plan.tied)] = 0.0  # what follows another one is known as well
    if free <= place < free + len(fit.plan.tied):
        correlation[fit.plan.tied[place - free].unknown] = 0.0
    partner = int(np.argmax(np.nan_to_num(correlation)))
    if not correlation[partner] > MAX_CORRELATION:
        return None
    values, paths = np.array([each.value for each in fit.estimates]), [each.path for each in fit.estimates]
    return sum_by_covariance(fit.covariance, (place, partner), values, paths, fit.estimates[place].unit)


def _inseparable(fit: Fit, place: int) -> DeterminedSum | None:
    """Return the sum of an estimate with those that the data do not separate from it at all."""
    problem, x = solved_problem(fit)
    rows, (leads, _) = problem.information(x, problem.weights(x)), problem.leads()
    paths = [fit.estimates[leads.index(unknown)].path for unknown in range(len(x))]
    determined = sum_by_information(rows.T @ rows, leads[place], x, paths, fit.estimates[place].unit)
    return None if determined is None or len(determined.paths) == 1 else determined


def _is_phase(estimate: Estimate) -> bool:
    return ".phase[" in estimate.path


def _size(estimate: Estimate) -> float:
    return 1.0 if _is_phase(estimate) else abs(estimate.value)


def _is_in(path: str, determined: Collection[str]) -> bool:
    """True for a number that files determine; also for a breakaway torque that follows a Coulomb torque that they determine."""
    return path in determined or (path.endswith(".breakaway") and path.replace(".breakaway", ".coulomb") in determined)


# ---- Priors of what is not determined --------------------------------------------------------------------------------


def with_set_before(
    found: Fit, estimates: Sequence[FileEstimate], known: GearSoFar, prefix: str
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
    places, shifted = {plain(prefix + each.path): place for place, each in enumerate(found.estimates)}, []
    for each in estimates:
        if (place := places.get(each.path)) is None:
            shifted.append(each)
            continue
        value, prior = again.estimates[place].value, priors.get(found.estimates[place].path)
        if prior is None:
            shifted.append(replace(each, value=value))
            continue
        sums = combination(found, place)
        is_split = bool(sums) or (not each.why and abs(value - each.value) > MAX_SHIFT_SIGMA * each.sigma)
        own = 1.0 / np.hypot(1.0 / max(each.sigma, 1e-300), 1.0 / prior.sigma)
        why = sums or each.why or (BY_SET if is_split else "")
        sigma, in_combination = float(np.hypot(own, each.common)), each.in_combination or is_split
        shifted.append(replace(each, value=value, sigma=sigma, why=why, in_combination=in_combination))
    return tuple(shifted)


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
    if "friction_input" in known.determined or not isinstance(law, DIVIDED_LAWS) or law.coulomb <= 0.0:
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
