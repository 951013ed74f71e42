"""Dependence of a measured quantity on what was varied: regressions, and tests corrected for their number."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from strainwave.equality import ComparedByFields
from strainwave.presentation import Presented
from strainwave.statistics.linear_fit import solved
from strainwave.statistics.scale import student

Array = NDArray[np.float64]
Law = Literal["power", "exponential", "linear"]

SIGNIFICANCE_LEVEL = 0.05  # of all tests of a series together [1]
SHUFFLE_COUNT = 1999  # permutations of a test
SHUFFLE_SEED = 20240229  # the same series gives the same numbers
REPEAT_TOLERANCE = 0.02  # share of the span of a column [1]: rows that differ by less are repeats
ROUNDING_TOLERANCE = 1e-12  # share of the values [1]: smaller residuals and effects are rounding
MAX_EXPLAINED_SHARE = 0.95  # share of a factor's variance that others may explain [1]; beyond it the effect may be theirs


@dataclass(frozen=True)
class Slope(Presented):
    """A coefficient of a regression.

    Attributes:
        value: the coefficient; not a number if the data do not determine it
        sigma: its standard deviation
        freedom: degrees of freedom that the residuals have
        p: probability of a coefficient as far from zero, were it zero (t-test); 1 if the data do not determine it
    """

    value: float
    sigma: float
    freedom: int
    p: float

    @property
    def half_width(self) -> float:
        """Return half the width of the 95 % interval."""
        return student(0.95, self.freedom) * self.sigma


@dataclass(frozen=True)
class Trend(Presented):
    """Dependence of a quantity on a factor, without the effects of the other factors and of the units.

    Attributes:
        factor: what was varied
        quantity: what was measured
        law: power, quantity ~ factor^value; exponential, quantity ~ exp(value factor); linear, where a quantity is not
            positive throughout: its change per factor
        slope: the coefficient with its t-test
        shuffled: probability by shuffling the residuals (Freedman and Lane 1983), which needs no normal distribution
        corrected: the t-test's probability times as many as Holm's method asks for, over all tests of the series
        misfit: probability that scatter of repeated conditions alone makes the points lie as far from the laws of all factors,
            times as many as Holm's method asks for, over all quantities; not a number where no condition was repeated
        together_with: factors that were varied along with this one, so that the effect may be theirs
        points: how many measurements

    >>> import strainwave as sw
    >>> series = sw.rig.Series({"torque_max": [0.1, 0.2, 0.3, 0.4]}, {"area": [1.0, 4.1, 8.8, 16.3]})
    >>> (trend,) = sw.rig.analyse_series(series)
    >>> trend.law, round(trend.slope.value, 2), round(trend.slope.half_width, 2), trend.significant
    ('power', 2.0, 0.11, True)
    """

    factor: str
    quantity: str
    law: Law
    slope: Slope
    shuffled: float
    corrected: float
    misfit: float
    together_with: tuple[str, ...]
    points: int

    @property
    def significant(self) -> bool:
        """True if there is an effect, at 5 % for all tests of the series together."""
        return self.corrected < SIGNIFICANCE_LEVEL

    @property
    def bent(self) -> bool:
        """True if repeated conditions show that the measurements do not follow the law."""
        return self.misfit < SIGNIFICANCE_LEVEL

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval of the coefficient, for this test by itself."""
        return self.slope.value - self.slope.half_width, self.slope.value + self.slope.half_width


def regress(columns: Array, values: Array) -> list[Slope]:
    """Least squares of values on columns, each with the t-test of its coefficient.

    Args:
        columns: shape (n, m); those that are sums of others get no coefficient
        values: shape (n,)

    Raises:
        ValueError: there are not more values than columns

    >>> import numpy as np
    >>> x = np.array([0.0, 1.0, 2.0, 3.0])
    >>> constant, slope = regress(np.column_stack((np.ones(4), x)), np.array([0.0, 1.1, 1.9, 3.0]))
    >>> round(slope.value, 6), round(slope.half_width, 6)
    (0.98, 0.182546)
    """
    n, m = columns.shape
    if n <= m:
        raise ValueError(f"{n} measurements do not determine {m} coefficients with an interval; {m + 1} or more are needed")
    size = np.linalg.norm(columns, axis=0)
    basis, triangle = np.linalg.qr(columns / np.where(size > 0.0, size, 1.0))
    if np.abs(np.diag(triangle)).min() < 1e-9:
        return [Slope(float("nan"), float("inf"), n - m, 1.0)] * m
    solution = np.linalg.solve(triangle, basis.T @ values)
    residual = values - basis @ (basis.T @ values)
    variance = float(residual @ residual) / (n - m)
    inverse = np.linalg.inv(triangle)
    sigmas = np.sqrt(variance * np.sum(inverse**2, axis=1)) / size
    solution = np.where(np.abs(solution) > ROUNDING_TOLERANCE * np.linalg.norm(values), solution, 0.0)
    return [_slope(float(value), float(sigma), n - m) for value, sigma in zip(solution / size, sigmas, strict=True)]


def lack_of_fit(columns: Array, values: Array) -> float:
    """Probability that pure error alone makes values lie as far from a regression.

    Rows whose columns differ by less than a fiftieth of their spans are repeats, as loops at nearly one temperature: the
    scatter of their residuals is pure error, of as many degrees of freedom as there are rows more than different ones. What
    the residuals have beyond it, of the degrees of freedom that are left, is compared by Fisher's F.

    Args:
        columns: of the regression, shape (n, m)
        values: shape (n,)

    Returns:
        Not a number where no row is repeated, no different row is left beyond the coefficients, or the law is exact.

    Source:
        DraperSmith1998, section 2.1

    >>> x = np.repeat([0.0, 1.0, 2.0], 2)
    >>> bent = x**2 + np.tile([0.1, -0.1], 3)
    >>> round(lack_of_fit(np.column_stack((np.ones(6), x)), bent), 4)  # F(1, 3) = (4/3) / (0.06 / 3)
    0.0038
    """
    from scipy.special import fdtrc

    spans = np.ptp(columns, axis=0)
    cells = np.round((columns - columns.min(axis=0)) / np.where(spans > 0.0, REPEAT_TOLERANCE * spans, 1.0))
    different, of = np.unique(cells, axis=0, return_inverse=True)
    of = of.ravel()
    residual = values - columns @ solved(columns, values)
    means = np.bincount(of, weights=residual) / np.bincount(of)
    pure, left = len(values) - len(different), len(different) - int(np.linalg.matrix_rank(columns))
    error = float(np.sum((residual - means[of]) ** 2))
    if pure < 1 or left < 1 or float(residual @ residual) <= ROUNDING_TOLERANCE**2 * float(values @ values):
        return float("nan")
    beyond = float(np.sum(means[of] ** 2))
    return float(fdtrc(left, pure, (beyond / left) / (error / pure))) if error > 0.0 else 0.0


def _slope(value: float, sigma: float, freedom: int) -> Slope:
    from scipy.stats import t

    if sigma <= 1e-12 * abs(value):
        return Slope(value, sigma, freedom, 0.0 if value else 1.0)
    return Slope(value, sigma, freedom, float(2.0 * t.sf(abs(value) / sigma, freedom)))


def holm(probabilities: Sequence[float]) -> list[float]:
    """Probabilities corrected for their number (Holm 1979): the chance of one false alarm or more is kept.

    >>> holm([0.01, 0.04, 0.03])
    [0.03, 0.06, 0.06]
    """
    corrected, highest = [0.0] * len(probabilities), 0.0
    for rank, place in enumerate(sorted(range(len(probabilities)), key=lambda each: probabilities[each])):
        highest = max(highest, min(1.0, (len(probabilities) - rank) * probabilities[place]))
        corrected[place] = highest
    return corrected


def shuffled(others: Array, factor: Array, values: Array, shuffles: int = SHUFFLE_COUNT, seed: int = SHUFFLE_SEED) -> float:
    """Probability that shuffled residuals show a dependence on the factor as strong (Freedman and Lane 1983).

    Args:
        others: columns of what else the values depend on, shape (n, m)
        factor: shape (n,)
        values: shape (n,)
        shuffles: how many are drawn
        seed: which

    Returns:
        At least 1 / (shuffles + 1).
    """
    basis = np.linalg.qr(others)[0]
    own, residual = factor - basis @ (basis.T @ factor), values - basis @ (basis.T @ values)
    random = np.random.default_rng(seed)
    drawn = random.permuted(np.tile(residual, (shuffles, 1)), axis=1)
    drawn -= (drawn @ basis) @ basis.T
    strengths = _strengths(drawn, own)
    here = _strengths(residual[np.newaxis], own)[0]
    return float((1 + np.sum(strengths >= here * (1.0 - 1e-12))) / (shuffles + 1))


def _strengths(residuals: Array, factor: Array) -> Array:
    """Squares of the correlations of residuals with a factor, shape (k,)."""
    sizes = np.sum(residuals**2, axis=1) * float(factor @ factor)
    return np.asarray((residuals @ factor) ** 2 / np.where(sizes > 0.0, sizes, 1.0))


@dataclass(frozen=True, eq=False)
class Design(ComparedByFields):
    """Conditions of a series: a column for each factor as its law takes it, and the specimen of each measurement.

    Args:
        laws: of each factor
        columns: of each factor, as measured, shape (n,)
        units: which specimen each measurement is of, n texts; each has a level of its own
    """

    laws: Mapping[str, Law]
    columns: Mapping[str, Array]
    units: tuple[str, ...]

    def taken(self, factor: str) -> Array:
        """The column of a factor: its logarithm where the law is a power."""
        column = self.columns[factor]
        return np.log(column) if self.laws[factor] == "power" else column - column.mean()

    def levels(self) -> Array:
        """Columns of the level of each specimen, shape (n, units)."""
        names = sorted(set(self.units))
        return np.array([[float(each == name) for name in names] for each in self.units])

    def others(self, factor: str) -> Array:
        """All columns but that of a factor."""
        rest = [self.taken(each) for each in self.columns if each != factor]
        return np.column_stack((self.levels(), *rest))

    def together(self, factor: str) -> tuple[str, ...]:
        """Return the factors that changed along with one: each explains nearly all of it, or all of them do."""
        alone = [each for each in self.columns if each != factor and _explained(self, factor, [each]) > MAX_EXPLAINED_SHARE]
        rest = [each for each in self.columns if each != factor]
        return tuple(alone) or (tuple(rest) if rest and _explained(self, factor, rest) > MAX_EXPLAINED_SHARE else ())


def _explained(design: Design, factor: str, by: Sequence[str]) -> float:
    """Share of a factor's variance within specimens that others explain."""
    levels = np.linalg.qr(design.levels())[0]

    def within(column: Array) -> Array:
        return np.asarray(column - levels @ (levels.T @ column))

    column = within(design.taken(factor))
    others = np.column_stack([within(design.taken(each)) for each in by])
    left = column - others @ solved(others, column)
    total = float(column @ column)
    return 1.0 - float(left @ left) / total if total > 0.0 else 1.0


def trends(design: Design, quantities: Mapping[str, Array]) -> list[Trend]:
    """Fit each quantity to all factors at once, and test each dependence.

    A quantity that is positive throughout is fitted by its logarithm: the law of a factor then is a power or an exponential,
    and scatter counts relative to the size.

    Args:
        design: what was varied, one factor or more
        quantities: measured values by name, shape (n,)

    Raises:
        ValueError: too few measurements
    """
    found = [trend for name, values in quantities.items() for trend in _of_quantity(design, name, values)]
    corrected = holm([each.slope.p for each in found])
    tested = {each.quantity: each.misfit for each in found if not np.isnan(each.misfit)}
    misfits = dict(zip(tested, holm(list(tested.values())), strict=True))
    return [
        replace(each, corrected=value, misfit=misfits.get(each.quantity, each.misfit))
        for each, value in zip(found, corrected, strict=True)
    ]


def _of_quantity(design: Design, name: str, values: Array) -> list[Trend]:
    positive = bool(np.all(values > 0.0))
    fitted = np.log(values) if positive else values
    if not positive:
        design = replace(design, laws=dict.fromkeys(design.laws, "linear"))
    factors = list(design.columns)
    levels = design.levels()
    columns = np.column_stack((levels, *[design.taken(each) for each in factors]))
    slopes, misfit = regress(columns, fitted)[levels.shape[1] :], lack_of_fit(columns, fitted)
    found = []
    for factor, slope in zip(factors, slopes, strict=True):
        determined = bool(np.isfinite(slope.value))
        p = shuffled(design.others(factor), design.taken(factor), fitted) if determined else 1.0
        together = design.together(factor)
        found.append(Trend(factor, name, design.laws[factor], slope, p, slope.p, misfit, together, len(values)))
    return found
