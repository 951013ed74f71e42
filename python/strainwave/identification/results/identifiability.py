"""Identifiability of the estimates of a fit: those that the data determine, and why not the others."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from strainwave.files.entries import Entry
from strainwave.identification.candidates.friction import STEADY_NUMBERS
from strainwave.identification.fitting.fit import Fit, solved_problem
from strainwave.identification.fitting.influence import InfluenceOfKept
from strainwave.identification.fitting.unknowns import Estimate
from strainwave.identification.results.file_result import TOO_UNCERTAIN, FileEstimate, is_uncertain
from strainwave.statistics.determined_sum import DeterminedSum, sum_by_covariance, sum_by_information

MAX_SIGMA_OF_PHASE = 0.5  # rad
MAX_RELATIVE_SHIFT = 0.25  # relative shift by the uncertainty of a kept parameter; beyond it the estimate is not identified
MAX_SHIFT_BY_WRONG = 0.05  # relative shift by a kept parameter that the measurement contradicts
MIN_SHIFT_LISTED = 0.02  # relative shift; smaller ones are not listed
MAX_LISTED = 3  # kept parameters named with an estimate
MAX_CORRELATION = 0.98  # of two estimates; with a larger one, those that are uncertain are identified in combination


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
    """

    fit: Fit
    source: str
    influence: InfluenceOfKept
    explained: bool = True
    shared: Mapping[str, str] = field(default_factory=dict)
    prefix: str = "gear."

    def estimates(self, sources: Mapping[str, Entry], determined: Collection[str]) -> Iterator[FileEstimate]:
        """Yield the estimates of the parameters, without those of the measurement, as zeros of encoders.

        Args:
            sources: of all numbers of the gear set, before the file
            determined: paths of numbers that earlier files determine, whose uncertainty is part of that of the estimates
        """
        free = len(self.fit.estimates) - len(self.fit.experiment.nuisances)
        for place, estimate in enumerate(self.fit.estimates[:free]):
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
                in_combination=in_combination, shift_by_kept=dict(list(relative.items())[:MAX_LISTED]),
            )  # fmt: skip

    def _why(self, place: int, path: str, sources: Mapping[str, Entry], shifts: Mapping[str, float]) -> tuple[str, bool]:
        """Return why the data do not determine an estimate, and whether they do together with another; empty if they do."""
        estimate = self.fit.estimates[place]
        if self.explained and not np.isfinite(estimate.sigma) and (why := combination(self.fit, place)):
            return why, True
        if why := self._undetermined(place):
            return why, False
        if not _is_phase(estimate) and is_uncertain(estimate.value, estimate.sigma):
            why = combination(self.fit, place)
            return why or TOO_UNCERTAIN, bool(why)
        if why := self.shared.get(path, ""):
            return why, True
        return self._by_wrong(place, sources) or _by_kept(estimate, shifts), False

    def _undetermined(self, place: int) -> str:
        estimate = self.fit.estimates[place]
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


def _law(path: str, gear: Any) -> str:
    """Return the law that gives a number its meaning; empty for numbers that mean the same in every law."""
    part, _, name = path.removeprefix("gear.").partition(".")
    return "" if part == "friction_input" and name in STEADY_NUMBERS else str(getattr(gear, part).name)


def _by_kept(estimate: Estimate, shifts: Mapping[str, float]) -> str:
    """Return the kept parameters whose uncertainty shifts an estimate far; empty if none does."""
    size = _size(estimate)
    far = [f"{path} by {100.0 * shift / size:.2g} %" for path, shift in shifts.items() if shift > MAX_RELATIVE_SHIFT * size]
    return f"the uncertainty of kept parameters may change it: {', '.join(far[:MAX_LISTED])}" if far else ""


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
    found = sum_by_information(rows.T @ rows, leads[place], x, paths, fit.estimates[place].unit)
    return None if found is None or len(found.paths) == 1 else found


def _is_phase(estimate: Estimate) -> bool:
    return ".phase[" in estimate.path


def _size(estimate: Estimate) -> float:
    return 1.0 if _is_phase(estimate) else abs(estimate.value)


def _is_in(path: str, determined: Collection[str]) -> bool:
    """True for a number that files determine; also for a breakaway torque that follows a Coulomb torque that they determine."""
    return path in determined or (path.endswith(".breakaway") and path.replace(".breakaway", ".coulomb") in determined)
