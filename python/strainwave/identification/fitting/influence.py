"""Influence of the parameters that a fit kept: the change of its estimates if one of these is wrong."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave.equality import ComparedByFields
from strainwave.files.entries import Entry
from strainwave.identification.fitting.fit import Fit
from strainwave.identification.fitting.problem import MIN_NOISE
from strainwave.parameters import Parameter, every
from strainwave.statistics.linear_fit import solved
from strainwave.statistics.residuals import correlation_length

Array = NDArray[np.float64]

MAX_EXPLAINED_SHARE = 0.3  # of the residuals' power: a kept parameter whose change explains more of it is wrong
MIN_SHARE_OF_LARGEST = 0.8  # of the largest share explained: which of such parameters explains a little more is chance
DESIGNED_PARTS = ("control.", "gear.kinematics.", "kinematics.")  # exact, as they are designed
REFERENCE_NAMES = (".reference_temperature", ".reference_speed")  # exact: the other numbers of a law are those there
SIGMA_IF_NOT_STATED = 0.1  # relative, of a kept value whose source states neither spread nor uncertainty
SIGMA_IF_ASSUMED = 0.5  # relative, of a kept value that is assumed


@dataclass(frozen=True, eq=False)
class InfluenceOfKept(ComparedByFields):
    """Change of the estimates of a fit with the parameters that it kept.

    Attributes:
        kept: the parameters kept whose value is not zero
        slopes: change of each estimate over the change of each of these, shape (estimates, kept)
        bounds: error of each of them that makes a residual as large as the noise, shape (kept,)
        shift_if_free: change of each of them if it were fitted, shape (kept,)
        explained_share: share of the residuals' power that this change explains, shape (kept,)
    """

    kept: tuple[Parameter, ...]
    slopes: Array
    bounds: Array
    shift_if_free: Array
    explained_share: Array

    @classmethod
    def none(cls, estimates: int) -> InfluenceOfKept:
        """Return that of a fit that explains nothing."""
        return cls((), np.zeros((estimates, 0)), *np.zeros((3, 0)))

    def suspects(self, known: Mapping[str, Entry], prefix: str = "") -> list[int]:
        """Return the places of kept parameters that the measurement contradicts, the least certain first.

        A change of such a parameter explains much of the residuals, is larger than its uncertainty allows, and leads to a
        possible value. Several that explain about as much are all returned: the data do not determine which is wrong.
        """
        uncertainties = np.array([uncertainty(each.value, known.get(prefix + each.path)) for each in self.kept])
        better = self.shift_if_free + [each.value for each in self.kept]
        possible = (better >= [each.low for each in self.kept]) & (better <= [each.high for each in self.kept])
        wrong = possible & (np.abs(self.shift_if_free) > uncertainties) & (self.explained_share > MAX_EXPLAINED_SHARE)
        least = MIN_SHARE_OF_LARGEST * float(np.max(self.explained_share, initial=0.0, where=wrong))
        strain = np.abs(self.shift_if_free) / np.maximum(uncertainties, 1e-300)
        return sorted(np.flatnonzero(wrong & (self.explained_share >= least)).tolist(), key=lambda place: strain[place])

    def shifts(self, estimate: int, known: Mapping[str, Entry], prefix: str = "") -> dict[str, float]:
        """Return the shift of an estimate by the standard deviation of each kept parameter, in its unit; largest first.

        Args:
            estimate: its place in the fit
            known: sources of the kept parameters, by `prefix` and path; without one, 10 % is taken
        """
        moved = {}
        for each, slope, bound in zip(self.kept, self.slopes[estimate].tolist(), self.bounds.tolist(), strict=True):
            before = uncertainty(each.value, known.get(prefix + each.path))
            # prior and measurement weigh by their variances
            moved[each.path] = abs(slope) * before / float(np.hypot(1.0, before / bound)) if before > 0.0 else 0.0
        return dict(sorted(moved.items(), key=lambda item: -item[1]))


def uncertainty(value: float, entry: Entry | None) -> float:
    """Return the standard deviation of a kept value by its source; else 10 % of it, and 50 % if it is assumed.

    >>> uncertainty(20.0, Entry("catalogue", spread=0.3)), uncertainty(20.0, None), uncertainty(20.0, Entry("assumed"))
    (6.0, 2.0, 10.0)
    """
    if entry is not None and (stated := entry.sigma(value)) is not None:
        return stated
    return (SIGMA_IF_ASSUMED if entry is not None and entry.assumed else SIGMA_IF_NOT_STATED) * abs(value)


def influence(found: Fit) -> InfluenceOfKept:
    """Return the change of the estimates of a fit with what it kept, to first order.

    At the minimum the gradient J'r of the least squares is zero, and stays so when a kept parameter changes: the estimates move
    by -(J'J)^-1 J'K, with J and K the derivatives of the weighted residuals by the free and by the kept parameters. The part of
    K that no change of the estimates makes up for remains in the residuals, and so bounds the kept parameter.
    """
    known = every(found.model)
    nuisances = len(found.experiment.nuisances)
    of_model = found.estimates[: len(found.estimates) - nuisances]
    free = [known[estimate.path] for estimate in of_model]
    own = {each.number for each in free}
    kept = tuple(each for each in known.values() if each.number not in own and each.value != 0.0 and not _is_exact(each.path))
    unknowns = np.array([estimate.value for estimate in found.estimates[len(of_model) :]])
    numbers = [each.number for each in (*free, *kept)]
    _, slopes = found.experiment.predict(found.model, numbers, unknowns)
    residual = np.sqrt(np.mean(found.residuals[:, found.training] ** 2, axis=1))
    size = np.abs(found.experiment.measured).max(axis=1)
    weights = 1.0 / np.maximum(residual, MIN_NOISE * np.where(size > 0.0, size, 1.0))
    residuals = (found.residuals[:, found.training] * weights[:, np.newaxis]).ravel()
    columns = (slopes * weights[:, np.newaxis])[:, :, found.training].reshape(len(slopes), -1).T
    by_free = np.column_stack((columns[:, : len(free)], columns[:, len(numbers) :]))
    by_kept = columns[:, len(free) : len(numbers)]
    acting = np.any(by_kept, axis=0)
    moved = np.zeros((by_free.shape[1], len(kept)))
    moved[:, acting] = -solved(by_free, by_kept[:, acting])
    shown = by_kept + by_free @ moved
    power = np.sum(shown**2, axis=0)
    divisor = np.where(power > 0.0, power, 1.0)
    length = max(correlation_length(row) for row in found.residuals[:, found.training])
    bounds = np.where(power > 0.0, np.sqrt(length / divisor), np.inf)
    shift = np.where(power > 0.0, residuals @ shown / divisor, 0.0)
    explained = shift**2 * power / max(float(residuals @ residuals), 1e-300)
    return InfluenceOfKept(kept, moved, bounds, shift, explained)


def _is_exact(path: str) -> bool:
    return path.startswith(DESIGNED_PARTS) or path.endswith(REFERENCE_NAMES) or ".order[" in path
