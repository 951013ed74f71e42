"""Beyond the linear interval of an estimate: profile likelihood, bootstrap, other minima."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments, typeset
from strainwave.equality import ComparedByFields
from strainwave.identification.fitting.fit import REFIT_TOLERANCE, ROUGH_TOLERANCE, Fit, solved_from, solved_problem
from strainwave.messages import listed, quoted
from strainwave.presentation import PLAIN_DIGITS, Pictured, Presented, Row
from strainwave.progress import Progress, by_count, in_turn
from strainwave.statistics.residuals import correlation_length
from strainwave.statistics.scale import ONE_SIGMA, student

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
MAX_VALUES_TO_A_SIDE = 24  # values tried to each side
END_TOLERANCE = 0.01  # of an end of the interval, relative in the root of the cost
MAX_RELATIVE_DISTANCE = 1e3  # from the estimate, over the size of the parameter
LENGTHS_PER_BLOCK = 4.0  # correlation lengths (assumed; bias of the variance falls with it, its scatter grows)
MAX_DRAWS = 100_000
MIN_DRAWS = 20  # that determine an interval
MAX_START_FACTOR = 2.0  # between the end of a fit and the initial value of another one
DEFAULT_STARTS = 8
MAX_STARTS = 10_000
MAX_STEPS_OF_START = 15  # steps of a fit with other initial values
MAX_RIVAL_COST = 9.0  # rise of the cost three standard deviations off, if the model is linear
MIN_SEPARATION_SIGMA = 5.0  # standard deviations between two minima: with so small a rise no linear model has it
MIN_RELATIVE_DISTANCE = 1e-3  # of a parameter: fits without noise end as near as that


# ---- Profile likelihood ----------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Profile(ComparedByFields, Pictured):
    """Profile likelihood of one parameter.

    Attributes:
        path: of the parameter
        unit: its unit
        values: tried, ascending, shape (n,)
        cost: rise of the cost above its least, the others fitted anew, shape (n,); if the model is linear, the square of the
            distance in standard deviations
        limit: cost at the ends of the interval
        interval: of the confidence asked for; to a side where the data do not bound the parameter, it ends at the limit of
            the law or of `bounds`, or is infinite
        open_below, open_above: True if the data do not bound it to that side

    >>> cost = np.array([4.0, 0.0, 1.0])
    >>> print(Profile("gear.damping", "N.m.s/rad", np.array([1.0, 2.0, 9.0]), cost, 4.0, (1.0, np.inf), False, True))
    Profile: gear.damping is above 1 N.m.s/rad; the data do not determine how large
      it is
      gear.damping           2  N·m·s/rad  of least cost
      interval          1 to ∞  N·m·s/rad
      cost at its ends       4
      values tried      1 to 9  N·m·s/rad
    """

    path: str
    unit: str
    values: Array
    cost: Array
    limit: float
    interval: tuple[float, float]
    open_below: bool
    open_above: bool

    def _headline(self) -> str:
        low, high = self.interval
        if self.open_below and self.open_above:
            return f"{self.path} is not determined: the data bound it to neither side"
        if self.open_above:
            return f"{self.path} is above {low:.4g} {self.unit}; the data do not determine how large it is"
        if self.open_below:
            return f"{self.path} is below {high:.4g} {self.unit}; the data do not determine how small it is"
        return f"{self.path} lies between {low:.4g} and {high:.4g} {self.unit}"

    def _rows(self) -> Iterator[Row]:
        yield Row(self.path, float(self.values[self.cost.argmin()]), self.unit, note="of least cost")
        yield Row("interval", self.interval, self.unit)
        yield Row("cost at its ends", self.limit, "1")
        yield Row("values tried", (float(self.values.min()), float(self.values.max())), self.unit)

    def plot(self) -> Figure:
        """Return a figure of the cost over the parameter, with the cost at the ends of the interval."""
        from strainwave.drawing.simple import Series, points_figure

        title = f"Profile likelihood of {self.path}"
        limit = {"ends of the interval": self.limit}
        return points_figure(
            title, Series(self.path, self.unit, self.values), Series("cost above the least", "1", self.cost), limit
        )


def profile(found: Fit, path: str, *, confidence: float = 0.95, progress: Progress = None) -> Profile:
    """Return the profile likelihood of one unknown of a fit: held at one value after the other, with all others fitted anew.

    The interval of an estimate takes the model to be linear. This one need not be symmetric, and shows to which side the data
    do not bound a parameter. Its scale is adjusted so that near the least cost it agrees with the standard deviation of the
    estimate, which accounts for correlated residuals.

    Args:
        found: result of `fit`
        path: of a free parameter, or an unknown of the measurement, as the estimates name it
        confidence: of the interval
        progress: as of `sw.simulate`

    Returns:
        The values tried [unit of the parameter] and the cost at each, shape (n,), and the interval.

    Raises:
        TypeError: `found` is no fit
        ValueError: the fit has no such unknown

    Source: Bates & Watts, Nonlinear regression analysis (1988), section 6.1; adjustment: Chandler & Bate, Biometrika 94 (2007)
    167-183, section 2.

    >>> import strainwave as sw
    >>> law = sw.friction.Coulomb(coulomb=0.02, breakaway=0.02, viscous=3e-4)
    >>> speed = np.linspace(1.0, 50.0, 60)
    >>> torque = law.steady(speed) + 1e-4 * np.random.default_rng(0).normal(size=60)
    >>> table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    >>> found = sw.fit(sw.Gear(friction_input=law), table, ["friction_input.coulomb", "friction_input.viscous"])
    >>> print(profile(found, "friction_input.coulomb"))
    Profile: friction_input.coulomb lies between 0.01992 and 0.02003 N.m
      friction_input.coulomb              0.019979  N·m  of least cost
      interval                0.019925 to 0.020034  N·m
      cost at its ends                      4.0198
      values tried            0.019924 to 0.020035  N·m
    """
    path, confidence = arguments.text("path", path), arguments.number("confidence", confidence, low=0.0, high=1.0)
    problem, best = solved_problem(found)
    tied = {each.path for each in found.plan.tied}
    unknowns = [each for each in found.estimates if each.path not in tied]
    names = [each.path for each in unknowns]
    if path not in names:
        raise ValueError(f"the fit has no unknown {quoted(path)}; it has {listed(names)}")
    place = names.index(path)
    estimate, weights = unknowns[place], problem.weights(best)
    least = problem.cost(best, weights)
    naive = problem.naive_sigma(best, weights)[place]
    adjusted = (naive / estimate.sigma) ** 2 if np.isfinite(estimate.sigma) and estimate.sigma > 0.0 else 1.0
    limit = (student(confidence, estimate.freedom) / student(ONE_SIGMA, estimate.freedom)) ** 2
    low, high = problem.limits()[place]

    def towards(end: float) -> tuple[list[float], list[float], float, bool]:
        last = best.copy()

        def distance(value: float) -> float:
            """Return the root of the rise of the cost; infinite where the model is not valid."""
            nonlocal last
            start = last.copy()
            start[place] = value
            try:
                solved = problem.solve(start, weights, REFIT_TOLERANCE, held=[place])
                rise = problem.cost(solved, weights) - least
            except (ValueError, FloatingPointError):
                return np.inf
            last = solved
            return float(np.sqrt(max(rise, 0.0) * adjusted))

        return _search(distance, estimate.value, estimate.sigma, end, float(np.sqrt(limit)), abs(estimate.start))

    with in_turn(progress, 2) as turn:
        turn(f"{path}, smaller")
        below, of_below, first, open_below = towards(low)
        turn(f"{path}, larger")
        above, of_above, second, open_above = towards(high)
    values = np.array([*below, estimate.value, *above])
    cost = np.array([*of_below, 0.0, *of_above])
    order = np.argsort(values)
    return Profile(path, estimate.unit, values[order], cost[order], limit, (first, second), open_below, open_above)


def _search(
    distance: Callable[[float], float], value: float, sigma: float, end: float, wanted: float, size: float
) -> tuple[list[float], list[float], float, bool]:
    """Return values and costs towards an end, the value of the distance wanted, and True if no value has it."""
    sense = 1.0 if end > value else -1.0
    size = max(abs(value), size) or 1.0
    farthest = min(abs(end - value), MAX_RELATIVE_DISTANCE * size)
    step = min(0.5 * sigma if np.isfinite(sigma) and sigma > 0.0 else 0.1 * size, farthest)
    near, near_root, far, far_root = 0.0, 0.0, np.inf, np.inf
    tried, costs = [], []
    for trial in range(MAX_VALUES_TO_A_SIDE):
        if step <= 0.0:
            break
        root = distance(value + sense * step)
        if np.isfinite(root):
            tried.append(value + sense * step)
            costs.append(root**2)
            if abs(root - wanted) <= END_TOLERANCE * wanted:
                return tried, costs, value + sense * step, False
        if root < wanted:
            if step >= farthest:
                break
            near, near_root = step, root
            ahead = step * np.clip(1.02 * wanted / max(root, 1e-300), 1.2, 3.0)
            step = min(ahead, farthest)
        else:
            far, far_root = step, root
        if np.isfinite(far):  # every other step halves, as a line alone may creep
            is_half = trial % 2 or not np.isfinite(far_root)
            share = 0.5 if is_half else float(np.clip((wanted - near_root) / (far_root - near_root), 0.05, 0.95))
            step = near + share * (far - near)
    if np.isfinite(far):
        return tried, costs, value + sense * far, False
    return tried, costs, end, True


# ---- Bootstrap -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Bootstrap(ComparedByFields, Pictured):
    """Estimates of many resampled measurements.

    Attributes:
        paths: of the estimates
        units: unit of each
        values: estimates of each draw, shape (draws, p)
        failed: draws for which no fit was found; they are not among the values

    >>> drawn = Bootstrap(("friction_input.coulomb",), ("N.m",), np.array([[0.019], [0.020], [0.021]]), 0)
    >>> drawn.sigma.round(4).tolist(), [round(end, 4) for end in drawn.interval("friction_input.coulomb", 0.5)]
    ([0.001], [0.0195, 0.0205])
    """

    paths: tuple[str, ...]
    units: tuple[str, ...]
    values: Array
    failed: int

    @property
    def sigma(self) -> Array:
        """Standard deviation of each estimate, shape (p,)."""
        return np.asarray(np.std(self.values, axis=0, ddof=1))

    def interval(self, path: str, confidence: float = 0.95) -> tuple[float, float]:
        """Return the interval that contains this share of the draws, with as many on either side of it (percentiles).

        Raises:
            ValueError: there is no such estimate, or `confidence` lies outside of (0, 1)
            TypeError: `path` is no text, or `confidence` no number
        """
        path, confidence = arguments.text("path", path), arguments.number("confidence", confidence, low=0.0, high=1.0)
        if path not in self.paths:
            raise ValueError(f"there is no estimate of {quoted(path)}; there are {listed(self.paths)}")
        ends = np.quantile(self.values[:, self.paths.index(path)], [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence])
        return float(ends[0]), float(ends[1])

    def _headline(self) -> str:
        failed = f", {self.failed} without a fit" if self.failed else ""
        return f"{len(self.values)} draws of {listed(self.paths)}{failed}"

    def _rows(self) -> Iterator[Row]:
        for path, unit, values, sigma in zip(self.paths, self.units, self.values.T, self.sigma.tolist(), strict=True):
            low, high = (typeset.number(end, PLAIN_DIGITS) for end in self.interval(path))
            yield Row(path, float(values.mean()), unit, sigma, f"95 %: {low} to {high}")

    def plot(self) -> Figure:
        """Return a figure of the histogram of the draws of each estimate."""
        from strainwave.drawing.simple import Series, histograms_figure

        drawn = [Series(*each) for each in zip(self.paths, self.units, self.values.T, strict=True)]
        return histograms_figure(f"Estimates of {len(self.values)} draws", drawn)


def bootstrap(found: Fit, draws: int = 200, *, seed: int = 0, progress: Progress = None) -> Bootstrap:
    """Return fits to resampled measurements: the prediction of the model, and blocks of its residuals in another order.

    Blocks are several correlation lengths long, and channels of a record keep their instants, so that noise correlates as
    before. Priors are drawn anew, too. Nothing is taken to be linear. A noise whose size changes along a record becomes one of
    constant size; `Estimate.sigma` is better then.

    Args:
        found: result of `fit`
        draws: count of fits, 20 or more; each starts where `found` ended
        seed: of the random numbers
        progress: as of `sw.simulate`

    Returns:
        The estimates of each draw that could be fitted, shape (draws, p), in the order and units of `found.estimates`.

    Raises:
        TypeError: `found` is no fit
        ValueError: too few draws
        FloatingPointError: no draw could be fitted

    Source: Künsch, Annals of Statistics 17 (1989) 1217-1241; Politis & Romano (1992) for blocks that go round the end.

    >>> import strainwave as sw
    >>> law = sw.friction.Coulomb(coulomb=0.02, breakaway=0.02, viscous=3e-4)
    >>> speed = np.linspace(1.0, 50.0, 60)
    >>> torque = law.steady(speed) + 1e-4 * np.random.default_rng(0).normal(size=60)
    >>> table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    >>> found = sw.fit(sw.Gear(friction_input=law), table, ["friction_input.coulomb"])
    >>> drawn = bootstrap(found, 100)
    >>> bool(abs(drawn.sigma[0] / found.estimates[0].sigma - 1.0) < 0.3)
    True
    """
    draws = arguments.whole("draws", draws, MIN_DRAWS, MAX_DRAWS)
    random = np.random.default_rng(arguments.whole("seed", seed, 0))
    problem, best = solved_problem(found)
    weights = problem.weights(best)
    left = problem.residuals(best)
    samples = sum(each.size for each in left)
    grown = float(np.sqrt(samples / max(samples - len(best), 1)))  # residuals are smaller than their noise
    lengths = [
        max(1, min(round(LENGTHS_PER_BLOCK * max(map(correlation_length, each))), max(1, each.shape[1] // 4))) for each in left
    ]
    predicted = [each for each, _ in problem.predict(best)]
    values = []
    with by_count(progress, "drawing measurements anew", draws) as done:
        for draw in range(1, draws + 1):
            for record, model, each, length in zip(problem.records, predicted, left, lengths, strict=True):
                record.measured = model.copy()
                record.measured[:, record.training] += grown * _resampled(each, length, random)
            problem.draw_priors(random)
            with suppress(ValueError, FloatingPointError):
                values.append(problem.solve(best, weights, REFIT_TOLERANCE))
            if done is not None:
                done(draw)
    if not values:
        raise FloatingPointError(
            "no resampled measurement could be fitted: the model diverges near its estimates; bound the parameters, or fix some"
        )
    order, factors = problem.leads()
    paths, units = zip(*((each.path, each.unit) for each in found.estimates), strict=True)
    return Bootstrap(paths, units, np.stack(values)[:, order] * factors, draws - len(values))


def _resampled(left: Array, length: int, random: np.random.Generator) -> Array:
    """Return blocks of residuals in another order, less their mean, shape (channels, n)."""
    n = left.shape[1]
    starts = random.integers(0, n, -(-n // length))
    rows = (starts[:, np.newaxis] + np.arange(length)).ravel()[:n] % n
    return np.asarray((left - left.mean(axis=1, keepdims=True))[:, rows])


# ---- Other minima ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class End(ComparedByFields, Presented):
    """A minimum at which fits with different initial values ended.

    Attributes:
        values: of the free parameters, by path
        cost: rise above the least cost; if the model is linear, the square of the distance in standard deviations
        starts: count of the fits that ended there
    """

    values: Mapping[str, float]
    cost: float
    starts: int


@dataclass(frozen=True, eq=False)
class Minima(ComparedByFields, Pictured):
    """Minima of a fit.

    Attributes:
        best: the fit of the least cost; the given one if none ended lower
        ends: that of the least cost first; that of the given fit is among them
        units: of the free parameters, by path
        lower: True if another start led to a lower cost

    >>> import numpy as np
    >>> import strainwave as sw
    >>> law = sw.friction.Coulomb(coulomb=0.02, breakaway=0.02, viscous=3e-4)
    >>> speed = np.linspace(1.0, 50.0, 60)
    >>> torque = law.steady(speed) + 1e-4 * np.random.default_rng(0).normal(size=60)
    >>> table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    >>> found = sw.identification.minima(sw.fit(sw.Gear(friction_input=law), table, ["friction_input.coulomb"]), starts=3)
    >>> len(found.ends), found.ends[0].starts, found.rivals, found.lower
    (1, 4, (), False)
    """

    best: Fit
    ends: tuple[End, ...]
    units: Mapping[str, str]
    lower: bool

    @property
    def rivals(self) -> tuple[End, ...]:
        """Other ends than the best that explain the measurement about as well."""
        return tuple(end for end in self.ends[1:] if end.cost < MAX_RIVAL_COST)

    def _headline(self) -> str:
        count = sum(end.starts for end in self.ends)
        return f"{self.ends[0].starts} of {count} starts ended at {self._words(self.ends[0])}"

    def _rows(self) -> Iterator[Row]:
        for number, end in enumerate(self.ends, start=1):
            yield Row(f"cost of minimum {number}", end.cost, "1", note=f"above the least, {end.starts} starts")
            yield from (Row(f"{path} ({number})", value, self.units[path]) for path, value in end.values.items())

    def _remarks(self) -> Iterator[str]:
        if self.lower:
            yield "this is lower than where the fit ended: it had ended at a minimum that explains less; use `best`"
        for end in self.rivals:
            yield (
                f"{end.starts} ended at {self._words(end)}, which explains the measurement about as well: the data do not "
                "separate the two, and no standard deviation counts it. Bound the parameters, or measure what separates them"
            )
        if self.ends[0].starts == 1 and sum(end.starts for end in self.ends) > 1:
            yield "no other start ended there: a lower minimum may be left; give more starts, or start nearer"

    def plot(self) -> Figure:
        """Return a figure of the cost of each minimum over the number of the minimum, the least first."""
        from strainwave.drawing.simple import Series, points_figure

        place = np.arange(1.0, len(self.ends) + 1.0)
        cost = np.array([end.cost for end in self.ends])
        return points_figure("Minima of the fit", Series("minimum", "1", place), Series("cost above the least", "1", cost))

    def _words(self, end: End) -> str:
        return listed([f"{path} = {value:.5g} {self.units[path]}" for path, value in end.values.items()])


def minima(found: Fit, starts: int = DEFAULT_STARTS, *, seed: int = 0, progress: Progress = None) -> Minima:
    """Return the minima at which a fit with other initial values ends.

    Each free parameter starts at up to twice or half of its estimate, at random. A drive that vibrates has a minimum at each
    natural frequency that gains or loses a period over the record; one that sticks has many. Their residuals need not look
    wrong, and standard deviations do not count other minima.

    Args:
        found: result of `fit`
        starts: count of other initial values; each takes about as long as the fit did
        seed: of the random numbers
        progress: as of `sw.simulate`

    Returns:
        The best fit, and each minimum with the number of starts that ended there.

    Raises:
        TypeError: `found` is no fit
        ValueError: no start

    >>> import strainwave as sw
    >>> law = sw.friction.Coulomb(coulomb=0.02, breakaway=0.02, viscous=3e-4)
    >>> speed = np.linspace(1.0, 50.0, 60)
    >>> torque = law.steady(speed) + 1e-4 * np.random.default_rng(0).normal(size=60)
    >>> table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    >>> found = sw.fit(sw.Gear(friction_input=law), table, ["friction_input.coulomb", "friction_input.viscous"])
    >>> print(minima(found, 3))
    Minima: 4 of 4 starts ended at friction_input.coulomb = 0.019979 N.m,
      friction_input.viscous = 0.00030112 N.m.s/rad
      cost of minimum 1                    0             above the least, 4 starts
      friction_input.coulomb (1)    0.019979  N·m
      friction_input.viscous (1)  0.00030112  N·m·s/rad
    """
    starts, random = arguments.whole("starts", starts, 1, MAX_STARTS), np.random.default_rng(arguments.whole("seed", seed, 0))
    problem, solution = solved_problem(found)
    unknowns, weights = found.plan.unknowns, problem.weights(solution)
    reached = [solution]
    with in_turn(progress, starts) as turn:
        for number in range(starts):
            turn(f"start {number + 1}")
            start = solution.copy()
            start[: len(unknowns)] *= MAX_START_FACTOR ** random.uniform(-1.0, 1.0, len(unknowns))
            with suppress(ValueError, FloatingPointError):  # a model that is not valid there
                reached.append(problem.solve(start, weights, ROUGH_TOLERANCE, trials=MAX_STEPS_OF_START))
    costs = [problem.cost(x, weights) for x in reached]
    lower = min(costs) < costs[0] - 1.0  # a standard deviation
    best = found
    if lower:
        best = solved_from(problem, reached[int(np.argmin(costs))])
        _, lowest = solved_problem(best)
        weights = problem.weights(lowest, weights)
        reached[int(np.argmin(costs))] = lowest
        costs = [problem.cost(x, weights) for x in reached]
    sigma = np.array(
        [max(each.sigma, MIN_RELATIVE_DISTANCE * abs(each.value)) or 1.0 for each in best.estimates[: len(unknowns)]]
    )
    ends = _ends(np.array(reached)[:, : len(unknowns)], np.array(costs) - min(costs), sigma)
    paths = [each.path for each in unknowns]
    described = tuple(End(dict(zip(paths, x.tolist(), strict=True)), cost, count) for x, cost, count in ends)
    return Minima(best, described, {each.path: each.unit for each in unknowns}, lower)


def _ends(reached: Array, costs: Array, sigma: Array) -> list[tuple[Array, float, int]]:
    """Return the ends, the rise of cost and the count of starts of each; one near an end of less cost is the same."""
    ends: list[tuple[Array, float, int]] = []
    for x, cost in sorted(zip(reached, costs.tolist(), strict=True), key=lambda each: each[1]):
        near = [bool(np.all(np.abs(x - end) < MIN_SEPARATION_SIGMA * sigma)) for end, *_ in ends]
        if any(near):
            place = near.index(True)
            end, least, count = ends[place]
            ends[place] = end, least, count + 1
        else:
            ends.append((x, cost, 1))
    return ends
