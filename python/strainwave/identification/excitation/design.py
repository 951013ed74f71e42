"""Choice among many possible measurements by their Fisher information.

Fedorov1972; Atkinson2007, chapters 10 (criteria) and 12 (exchange).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from strainwave.statistics.determined_sum import MIN_INFORMATION, MIN_MOVED, undetermined
from strainwave.statistics.linear_fit import solved

Array = NDArray[np.float64]
Criterion = Literal["A", "D"]
MIN_GAIN = 1e-9  # of a criterion; a smaller one is rounding
MAX_PASSES = 50  # of exchanges; a handful is enough
BUDGET_TOLERANCE = 1e-12  # relative, for rounding


def without_nuisances(slopes: Array, of_nuisances: Array) -> Array:
    """Return the information about parameters if the nuisances are unknown, too: the Schur complement, shape (p, p).

    Args:
        slopes: derivatives of what is measured by the parameters, over the noise, shape (n, p)
        of_nuisances: the same by the nuisances, shape (n, q)
    """
    if of_nuisances.shape[1]:
        slopes = slopes - of_nuisances @ solved(of_nuisances, slopes)
    information: Array = slopes.T @ slopes
    return information


def score(information: Array, wanted: Sequence[int], criterion: Criterion) -> Array:
    """Return the criterion of one information matrix or of many, the smaller the better, shape (…, p, p).

    A: logarithm of the sum of the variances of the wanted parameters. D: logarithm of the determinant of their covariance.
    """
    p = information.shape[-1]
    covariance = np.linalg.inv(information + MIN_INFORMATION * np.eye(p))[..., wanted, :][..., wanted]
    if criterion == "D":
        scored: Array = np.linalg.slogdet(covariance)[1]
        return scored
    return np.asarray(np.log(np.trace(covariance, axis1=-2, axis2=-1)))


def best(
    information: Array, cost: Array, budget: float, before: Array, wanted: Sequence[int], criterion: Criterion
) -> list[int]:
    """Return the places of the measurements to take, repeated ones several times: greedy by gain over cost, then by exchange.

    Args:
        information: of each candidate, in relative units, shape (m, p, p)
        cost: of each, shape (m,)
        budget: what all together may cost
        before: what is known before, shape (p, p)
        wanted: places of the parameters that count
    """
    chosen: list[int] = []
    total, left = before.copy(), budget
    while (affordable := np.flatnonzero(cost <= left * (1.0 + BUDGET_TOLERANCE))).size:
        gain = score(total, wanted, criterion) - score(total + information[affordable], wanted, criterion)
        place = int(np.argmax(gain / cost[affordable]))
        if gain[place] <= MIN_GAIN:
            break
        chosen.append(int(affordable[place]))
        total, left = total + information[chosen[-1]], left - cost[chosen[-1]]
    return _exchanged(chosen, information, cost, left, before, wanted, criterion)


def _exchanged(
    chosen: list[int], information: Array, cost: Array, left: float, before: Array, wanted: Sequence[int], criterion: Criterion
) -> list[int]:
    """Return the places with single measurements replaced by others, as long as that improves the criterion."""
    for _ in range(MAX_PASSES):
        improved = False
        for place, one in enumerate(chosen):
            rest = before + information[[*chosen[:place], *chosen[place + 1 :]]].sum(axis=0)
            possible = np.flatnonzero(cost <= (left + cost[one]) * (1.0 + BUDGET_TOLERANCE))
            scores = score(rest + information[possible], wanted, criterion)
            other = int(possible[np.argmin(scores)])
            if scores.min() < score(rest + information[one], wanted, criterion) - MIN_GAIN:
                left += float(cost[one] - cost[other])
                chosen[place], improved = other, True
        if not improved:
            break
    return sorted(chosen)


def covariance_of(information: Array) -> Array:
    """Return the covariance in relative units, shape (p, p); infinite for parameters of which a combination is not known."""
    values, directions = np.linalg.eigh(information)
    dead = undetermined(values)
    root = directions[:, ~dead] / np.sqrt(values[~dead])
    covariance: Array = root @ root.T
    for place in np.flatnonzero((np.abs(directions[:, dead]) > MIN_MOVED).any(axis=1)):
        covariance[place, place] = np.inf
    return covariance
