"""Straight lines: through points that err in both directions, and a regime as stretches with knees between them."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from strainwave.equality import ComparedByFields
from strainwave.rig.analysis.result import Result, result
from strainwave.statistics.linear_fit import normal_inverse, solved

Array = NDArray[np.float64]

MAX_KNEES = 2  # stiff, soft, stiff again
MIN_SEGMENT_SHARE = 0.04  # share of the torque of a regime [1] that a straight stretch covers
MAX_KNEE_PLACES = 24  # torques tried for a knee
MAX_SEARCH_POINTS = 500  # points that determine the first place of a knee; all points then move it
MAX_SEARCH_STARTS = 4  # best places on the grid from which knees are moved: the best alone may lead to a local minimum
MAX_MISFIT_RATIO = 0.9  # a later start replaces the best one only below this share of its misfit [1]
PENALTY_PER_PARAMETER = 2.0  # in logarithms of the number of points [1]; noise alone then seldom causes a knee
NEGLIGIBLE_RESIDUAL = 3e-5  # share of the span of the angle [1]: rounding of the digits in a file leaves as much
KNEE_TOLERANCE = 1e-7  # share of the span of torque [1]: a point this near to a knee lies on it
MAX_GAUSS_NEWTON_STEPS = 25  # count
STEP_SHARES = 0.5 ** np.arange(10)  # of a Gauss-Newton step [1], tried one after the other
MISFIT_ROUNDING = 1e-9  # share of a misfit [1] by which rounding changes it at most, unless it is negligible
NEGLIGIBLE_MISFIT = 1e-18  # share of the sum of squares of the angle [1]: a smaller misfit is rounding itself

MAX_ITERATIONS = 200  # of the line fit; about ten are usual
SLOPE_TOLERANCE = 1e-13  # relative change of the slope at which the line fit ends [1]
MIN_RELATIVE_SIGMA = 1e-3  # smallest error of a point over the usual one [1], so that no single point determines the line


@dataclass(frozen=True, eq=False)
class Segments(ComparedByFields):
    """Angle over torque as a chain of straight lines.

    Attributes:
        knees: torque where one line passes into the next [N.m], shape (k,), ascending
        compliances: of each stretch [rad/(N.m)], shape (k + 1,)
        compliance_sigmas: their standard deviations [rad/(N.m)], shape (k + 1,)
        knee_results: the knees with their intervals [N.m]
        low, high: ends of the regime [N.m]
        scatter: root mean square of the angle about the lines, for the points less the parameters [rad]
        freedom: points less parameters
    """

    knees: Array
    compliances: Array
    compliance_sigmas: Array
    knee_results: tuple[Result, ...]
    low: float
    high: float
    scatter: float
    freedom: int

    @property
    def softest(self) -> int:
        """Return the index of the stretch with the greatest compliance."""
        return int(np.argmax(self.compliances))

    def stretch(self, number: int) -> tuple[float, float]:
        """Torques between which a stretch runs [N.m]."""
        ends = [self.low, *self.knees.tolist(), self.high]
        return ends[number], ends[number + 1]


def fit_segments(torque: Array, angle: Array, angle_sigma: Array, torque_sigma: Array) -> Segments:
    """Straight stretches through the points of a regime, with as many knees, up to two, as the points call for.

    A knee is taken where it lowers the sum of squares by more than noise does: by four times the logarithm of the number of
    points, in variances. Where no errors are stated, the variance is that of the scatter.

    Args:
        torque, angle: the points, shape (n,), n >= 2, the torque ascending, if not strictly
        angle_sigma, torque_sigma: standard deviations, shape (n,); all zero where they are not known

    >>> torque = np.linspace(0.0, 0.36, 19)
    >>> found = fit_segments(torque, torque / 4.0 + np.maximum(torque - 0.1, 0.0) * 3.0, np.zeros(19), np.zeros(19))
    >>> found.knees.round(6).tolist(), found.compliances.round(6).tolist()
    ([0.1], [0.25, 3.25])
    """
    span = float(torque[-1] - torque[0])
    variance = _variance(torque, angle, angle_sigma, torque_sigma, np.full(len(torque), np.ptp(angle) / span))
    stated = bool(np.any(variance > 0.0))
    tried: list[_Chain] = []
    for count in _counts(torque):
        known = tried[-1].knees if tried else np.empty(0)
        tried.append(_best(torque, angle, variance if stated else np.ones(len(torque)), count, known))
    n = len(torque)
    exact = (NEGLIGIBLE_RESIDUAL * float(np.ptp(angle))) ** 2

    def price(each: _Chain) -> float:
        squares = each.residual**2
        misfit = np.sum(squares / np.maximum(variance, exact)) if stated else n * np.log(max(float(squares.mean()), exact))
        return float(misfit + PENALTY_PER_PARAMETER * np.log(n) * each.parameters)

    best = min(tried, key=price)
    if stated and np.any(torque_sigma > 0.0):  # each stretch turns errors of torque into angle by its own compliance
        local = best.slopes[0] + np.heaviside(_past(torque, best.knees), 0.5) @ np.diff(best.slopes)
        variance = _variance(torque, angle, angle_sigma, torque_sigma, local)
        best = _refined(torque, angle, variance, best.knees)
    return best.segments(torque, stated)


def _counts(torque: Array) -> range:
    """Return the numbers of knees that these points can determine."""
    different = len(np.unique(torque))
    return range(0, min(MAX_KNEES, max(0, (different - 2) // 2)) + 1)


def _variance(torque: Array, angle: Array, angle_sigma: Array, torque_sigma: Array, compliance: Array) -> Array:
    variance = angle_sigma**2 + (compliance * torque_sigma) ** 2
    return np.asarray(np.maximum(variance, 1e-6 * variance.mean()))


@dataclass(frozen=True, eq=False)
class _Chain(ComparedByFields):
    """A chain of lines fitted: slopes, knees, misfit in variances, derivatives by all parameters, residual."""

    slopes: Array
    knees: Array
    misfit: float
    columns: Array
    residual: Array

    @property
    def parameters(self) -> int:
        return 2 + 2 * len(self.knees)

    def segments(self, torque: Array, stated: bool) -> Segments:
        freedom = len(torque) - self.parameters
        scatter = float(np.sqrt(np.sum(self.residual**2) / freedom)) if freedom > 0 else float("nan")
        size = self.misfit / freedom if freedom > 0 else float("nan")
        if stated:
            size = max(1.0, size) if freedom > 0 else 1.0  # a chain that misses points by more may err by more
        covariance = size * normal_inverse(self.columns)
        count = len(self.knees)
        sums = np.tril(np.ones((count + 1, count + 1)))
        slopes = sums @ covariance[1 : count + 2, 1 : count + 2] @ sums.T
        knees = tuple(
            _knee(torque, float(knee), i, self.knees, float(np.sqrt(covariance[count + 2 + i, count + 2 + i])))
            for i, knee in enumerate(self.knees)
        )
        return Segments(
            self.knees, self.slopes, np.sqrt(np.diag(slopes)), knees, float(torque[0]), float(torque[-1]), scatter, freedom
        )


def _knee(torque: Array, knee: float, number: int, knees: Array, sigma: float) -> Result:
    """Return a knee; next to a stretch of fewer than three points it may lie anywhere between its neighbours."""
    below = torque[(torque < knee) & (torque > (knees[number - 1] if number else -np.inf))]
    above = torque[(torque > knee) & (torque < (knees[number + 1] if number + 1 < len(knees) else np.inf))]
    if min(len(below), len(above)) >= 2:
        return result(knee, "N.m", random=sigma)
    low, high = float(torque[torque < knee].max(initial=torque[0])), float(torque[torque > knee].min(initial=torque[-1]))
    return Result(knee, "N.m", (high - low) / 12.0**0.5, 0.0, low, high)


def _best(torque: Array, angle: Array, variance: Array, count: int, known: Array) -> _Chain:
    """Return the best chain with `count` knees, found from places on a grid and from pairs of a place and the known knee.

    Two knees of the grid around a sharp one would else hide another that is less sharp.
    """
    if count == 0:
        return _refined(torque, angle, variance, np.empty(0))
    span = float(torque[-1] - torque[0])
    between = np.unique(np.concatenate((torque[1:-1], 0.5 * (torque[1:] + torque[:-1]))))
    between = between[(between > torque[0] + MIN_SEGMENT_SHARE * span) & (between < torque[-1] - MIN_SEGMENT_SHARE * span)]
    places = between[np.unique(np.linspace(0, len(between) - 1, MAX_KNEE_PLACES).astype(int))] if len(between) else between
    chosen = places[:, np.newaxis]
    if count == 2:
        first, second = np.triu_indices(len(places), 1)
        chosen = np.column_stack((places[first], places[second]))
        with_known = np.column_stack((places, np.broadcast_to(known, len(places))))
        chosen = np.concatenate((chosen, np.sort(with_known, axis=1))) if len(known) == 1 else chosen
        chosen = chosen[chosen[:, 1] - chosen[:, 0] > MIN_SEGMENT_SHARE * span]
    if not len(chosen):
        return _refined(torque, angle, variance, np.empty(0))
    every = -(-len(torque) // MAX_SEARCH_POINTS)
    some = torque[::every], angle[::every], variance[::every]
    starts = chosen[np.argsort(_misfits(*some, chosen))[:MAX_SEARCH_STARTS]]
    best, *others = (_refined(*some, start) for start in starts)
    for other in others:
        best = other if other.misfit < MAX_MISFIT_RATIO * best.misfit else best
    return best if every == 1 else _refined(torque, angle, variance, best.knees)


def _misfits(torque: Array, angle: Array, variance: Array, chosen: Array) -> Array:
    """Sum of squares in variances for each choice of knees, shape (k, count) of `chosen`."""
    span = float(torque[-1] - torque[0])
    weights = 1.0 / np.sqrt(variance)
    hinges = np.maximum(torque - chosen[:, :, np.newaxis], 0.0) / span
    lines = np.broadcast_to(np.stack((np.ones_like(torque), torque / span)), (len(chosen), 2, len(torque)))
    columns = np.concatenate((lines, hinges), axis=1) * weights
    normal = columns @ columns.transpose(0, 2, 1) + 1e-12 * np.eye(2 + chosen.shape[1]) * np.sum(weights**2)
    moments = columns @ (weights * angle)
    found = np.linalg.solve(normal, moments[:, :, np.newaxis])[:, :, 0]
    return np.asarray(np.sum((weights * angle - np.einsum("ki,kin->kn", found, columns)) ** 2, axis=1))


def _refined(torque: Array, angle: Array, variance: Array, knees: Array) -> _Chain:
    """Moves the knees to the best place: the lines are linear in the rest, and a knee moves by what its hinge calls for."""
    best = _lines(torque, angle, variance, knees)
    for _ in range(MAX_GAUSS_NEWTON_STEPS if len(knees) else 0):
        step = solved(best.columns, best.residual / np.sqrt(variance))
        step = step[2 + len(knees) :]
        better = _first_better(torque, angle, variance, best, step)
        if better is None:
            break
        done = best.misfit - better.misfit <= 1e-9 * best.misfit
        best = better
        if done:
            break
    return best


def _first_better(torque: Array, angle: Array, variance: Array, best: _Chain, step: Array) -> _Chain | None:
    """Return the chain after the longest of the halved steps of the knees that lowers the misfit; None if all are in vain.

    A knee that lies best on a point is left by no step: `_misfits` finds this for all halved steps at once.
    """
    moved = best.knees + STEP_SHARES[:, np.newaxis] * step
    gaps = np.diff(moved, prepend=torque[0], append=torque[-1], axis=1)
    moved = moved[np.all(gaps > MIN_SEGMENT_SHARE * (torque[-1] - torque[0]), axis=1)]
    for number, knees in enumerate(moved):
        if number == 1 and best.misfit > NEGLIGIBLE_MISFIT * np.sum(angle**2 / variance):
            promising = _misfits(torque, angle, variance, moved) < (1.0 + MISFIT_ROUNDING) * best.misfit
        elif number == 0:
            promising = np.ones(len(moved), bool)
        if promising[number] and (tried := _lines(torque, angle, variance, knees)).misfit < best.misfit:
            return tried
    return None


def _past(torque: Array, knees: Array) -> Array:
    """Return the distance of each torque past each knee; 0 for a point on the knee, which belongs half to either side."""
    past = torque[:, np.newaxis] - knees
    past[np.abs(past) < KNEE_TOLERANCE * (torque[-1] - torque[0])] = 0.0
    return past


def _lines(torque: Array, angle: Array, variance: Array, knees: Array) -> _Chain:
    weights = 1.0 / np.sqrt(variance)
    past = _past(torque, knees)
    columns = np.empty((len(torque), 2 + 2 * len(knees)))
    linear = columns[:, : 2 + len(knees)]
    linear[:, 0], linear[:, 1], linear[:, 2:] = 1.0, torque, np.maximum(past, 0.0)
    found = solved(weights[:, np.newaxis] * linear, weights * angle)
    residual = angle - linear @ found
    slopes = np.cumsum(found[1:])
    columns[:, 2 + len(knees) :] = -found[2:] * np.heaviside(past, 0.5)
    columns *= weights[:, np.newaxis]
    return _Chain(slopes, knees, float(np.sum((weights * residual) ** 2)), columns, residual)


@dataclass(frozen=True)
class FittedLine:
    """y = intercept + slope x through points with errors in both.

    Attributes:
        slope: its slope
        intercept: its value at x = 0
        sigma: standard deviation of the slope
        share_x: share of the errors of x in the variance of the slope [1]
        freedom: infinite where errors were stated; points less two where they were taken from the scatter about the line
        misfit: chi-square of the residuals over points less two [1]; not a number where errors were not stated
        bend: largest residual of y
    """

    slope: float
    intercept: float
    sigma: float
    share_x: float
    freedom: float
    misfit: float
    bend: float


def fit_line(x: Array, y: Array, sigma_x: Array, sigma_y: Array) -> FittedLine:
    """Line of greatest likelihood, by York's equations for errors that are independent.

    Where no errors are stated, both axes err by the same share of their span, and the size is taken from the scatter: the
    slope then does not depend on units, and swapping the axes inverts it.

    Args:
        x, y: the points, shape (n,), n >= 2, with at least two different x and y
        sigma_x, sigma_y: standard deviations of each, shape (n,); all zero where they are not known

    Source:
        York2004, section II; the variance of the slope is that of the equation it solves, linear in the errors

    >>> line = fit_line(np.array([0.0, 1.0, 2.0]), np.array([1.0, 3.0, 5.0]), np.zeros(3), np.full(3, 0.1))
    >>> round(line.slope, 12), round(line.sigma, 6)  # 0.1 / sqrt(2)
    (2.0, 0.070711)
    """
    stated = bool(np.any(sigma_x > 0.0) or np.any(sigma_y > 0.0))
    span_x, span_y = float(np.ptp(x)), float(np.ptp(y))
    if not stated:
        sigma_x, sigma_y = np.full(len(x), span_x), np.full(len(y), span_y)
    slope = float(np.sign(np.sum((x - x.mean()) * (y - y.mean()))) or 1.0) * span_y / span_x
    for _ in range(MAX_ITERATIONS):
        before = slope
        weights = _weights(slope, sigma_x, sigma_y)
        middle_x, middle_y = weights @ x / weights.sum(), weights @ y / weights.sum()
        from_x, from_y = x - middle_x, y - middle_y
        steps = weights * (from_x * sigma_y**2 + slope * from_y * sigma_x**2)  # York's beta
        pull = weights * (steps - weights @ steps / weights.sum())
        if not (across := float(pull @ from_x)):
            raise ValueError("angle and torque of a regime do not vary together; no line fits them: check the angles")
        slope = float(pull @ from_y) / across
        if abs(slope - before) <= SLOPE_TOLERANCE * abs(slope):
            break
    residual = y - middle_y - slope * from_x
    variances = np.array([slope**2 * np.sum((pull * sigma_x) ** 2), np.sum((pull * sigma_y) ** 2)]) / (pull @ from_x) ** 2
    freedom = len(x) - 2
    misfit = float(weights @ residual**2) / freedom if freedom else 0.0
    sigma = float(np.sqrt(variances.sum()))
    return FittedLine(
        slope,
        float(middle_y - slope * middle_x),
        sigma if stated else (sigma * float(np.sqrt(misfit)) if freedom else np.nan),
        float(variances[0] / variances.sum()),
        inf if stated else max(float(freedom), 1.0),
        misfit if stated else np.nan,
        float(np.abs(residual).max()),
    )


def _weights(slope: float, sigma_x: Array, sigma_y: Array) -> Array:
    """One over the variance of each residual."""
    variance = sigma_y**2 + slope**2 * sigma_x**2
    return np.asarray(1.0 / np.maximum(variance, MIN_RELATIVE_SIGMA**2 * variance.mean()))
