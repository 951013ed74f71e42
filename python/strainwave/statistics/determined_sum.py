"""Sums of parameters that data determine although they do not determine the terms, in words.

Fits, tables, gear files, reports, exports and plans of experiments state what a record does not separate by these words alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave.messages import listed
from strainwave.presentation import Statement
from strainwave.statistics.linear_fit import solved

Array = NDArray[np.float64]

MIN_MOVED = 1e-6  # of a direction that is not determined: a parameter that it moves less is determined by itself
MIN_PART = 0.02  # of the first term of a sum: smaller ones are not named
MIN_INFORMATION = 1e-4  # in relative units, a standard deviation of 100 times the value: less counts as not known
MIN_RELATIVE_INFORMATION = 1e-13  # of the largest eigenvalue: less is rounding
UNIT_TOLERANCE = 1e-3  # relative: a factor that is nearer to 1 is not written


@dataclass(frozen=True)
class DeterminedSum(Statement):
    """Sum of parameters that is determined while its terms are not.

    Attributes:
        paths: of the parameters
        factors: of each in the sum, that of the first is 1
        value: of the sum
        sigma: its standard deviation
        unit: its unit, that of the first parameter

    >>> at_one_speed = DeterminedSum(("friction_input.coulomb", "friction_input.viscous"), (1.0, 10.0), 0.064, 2e-5, "N.m")
    >>> print(at_one_speed)
    coulomb + 10 viscous = 0.064 ± 2e-05 N.m
    >>> at_one_speed.with_others
    'determined together with friction_input.viscous: coulomb + 10 viscous = 0.064 ± 2e-05 N.m'
    """

    paths: tuple[str, ...]
    factors: tuple[float, ...]
    value: float
    sigma: float
    unit: str

    def _headline(self) -> str:
        last = [path.rpartition(".")[2] for path in self.paths]
        names = last if len(set(last)) == len(last) else self.paths
        return f"{sum_in_words(names, self.factors)} = {self.value:.5g} ± {self.sigma:.2g} {self.unit}"

    @property
    def with_others(self) -> str:
        """Words about the first parameter."""
        return f"determined together with {listed(self.paths[1:])}: {self}"


def sum_in_words(names: Sequence[str], factors: Sequence[float]) -> str:
    """Return a sum of parameters, the first of which has the factor 1.

    >>> sum_in_words(["a", "b", "c"], [1.0, -1.0, 0.25])
    'a - b + 0.25 c'
    """
    words = names[0]
    for name, factor in zip(names[1:], factors[1:], strict=True):
        size = "" if abs(abs(factor) - 1.0) < UNIT_TOLERANCE else f"{abs(factor):.3g} "
        words += f" {'+' if factor > 0.0 else '-'} {size}{name}"
    return words


def sum_by_covariance(
    covariance: Array, chosen: Sequence[int], values: Array, paths: Sequence[str], unit: str
) -> DeterminedSum:
    """Return the sum of least variance of an estimate and others that correlate with it.

    Args:
        covariance: of all estimates, finite among the chosen ones
        chosen: places of the estimate and of the others
        values, paths: of all estimates
        unit: of the first one

    >>> covariance = np.array([[1.0, -0.1], [-0.1, 0.010001]])  # of Coulomb and viscous friction near 10 rad/s
    >>> print(sum_by_covariance(covariance, [0, 1], np.array([2.0, 0.5]), ["coulomb", "viscous"], "N.m"))
    coulomb + 10 viscous = 6.9995 ± 0.01 N.m
    """
    first, *others = chosen
    factors = np.append(1.0, -solved(covariance[np.ix_(others, others)], covariance[others, first]))
    variance = float(factors @ covariance[chosen, first])
    return _sum(chosen, factors, values, np.sqrt(max(variance, 0.0)), paths, unit)


def sum_by_information(information: Array, place: int, values: Array, paths: Sequence[str], unit: str) -> DeterminedSum | None:
    """Return a parameter, or its sum with those that data do not separate from it; None if they do not depend on it.

    Args:
        information: inverse covariance of all parameters, singular in directions that change nothing, shape (p, p)
        place: of the parameter
        values, paths: of all parameters
        unit: of the one

    >>> rows = np.array([[1.0, 10.0, 0.0], [-1.0, -10.0, 0.0], [0.0, 0.0, 3.0]]) / 0.1  # at ± 10 rad/s, noise 0.1 N.m
    >>> print(sum_by_information(rows.T @ rows, 0, np.array([2.0, 0.5, 1.0]), ["coulomb", "viscous", "inertia"], "N.m"))
    coulomb + 10 viscous = 7 ± 0.071 N.m
    """
    size = np.where(values != 0.0, np.abs(values), 1.0)
    relative = information * np.outer(size, size)
    eigenvalues, directions = np.linalg.eigh(relative)
    dead = directions[:, undetermined(eigenvalues)]
    moved = np.abs(dead).max(axis=1, initial=0.0, where=np.abs(dead[place]) > MIN_MOVED)
    chosen = [place, *(other for other in np.flatnonzero(moved > MIN_MOVED).tolist() if other != place)]
    rest = [other for other in range(len(values)) if other not in chosen]
    own, across = relative[np.ix_(chosen, chosen)], relative[np.ix_(rest, chosen)]
    row = own[0] - across[:, 0] @ solved(relative[np.ix_(rest, rest)], across)
    taking_part = np.abs(row) > MIN_PART * row[0]
    if not row[0] > MIN_INFORMATION:
        return None
    chosen = [other for other, takes_part in zip(chosen, taking_part, strict=True) if takes_part]
    factors = size[place] / size[chosen] * row[taking_part] / row[0]
    return _sum(chosen, factors, values, size[place] / np.sqrt(row[0]), paths, unit)


def undetermined(eigenvalues: Array) -> NDArray[np.bool_]:
    """Return True for eigenvalues of an information in relative units whose directions are not determined, shape (p,)."""
    return np.asarray(eigenvalues < max(MIN_INFORMATION, MIN_RELATIVE_INFORMATION * float(eigenvalues.max(initial=0.0))))


def _sum(chosen: Sequence[int], factors: Array, values: Array, sigma: float, paths: Sequence[str], unit: str) -> DeterminedSum:
    names = tuple(paths[place] for place in chosen)
    return DeterminedSum(names, tuple(factors.tolist()), float(factors @ values[list(chosen)]), float(sigma), unit)
