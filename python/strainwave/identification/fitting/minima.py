"""Other minima of a fit: fits with other initial values, and their ends."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.equality import ComparedByFields
from strainwave.identification.fitting.fit import ROUGH_TOLERANCE, Fit, solved_from, solved_problem
from strainwave.messages import listed
from strainwave.presentation import Pictured, Presented, Row
from strainwave.progress import Progress, in_turn

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
MAX_START_FACTOR = 2.0  # between the end of a fit and the initial value of another one
DEFAULT_STARTS = 8
MAX_STARTS = 10_000
MAX_TRIALS = 15  # steps of a fit with other initial values
MAX_RIVAL_COST = 9.0  # rise of the cost three standard deviations off, if the model is linear
MIN_DISTANCE_SIGMA = 5.0  # standard deviations between two minima: with so small a rise no linear model has it
MIN_RELATIVE_DISTANCE = 1e-3  # of a parameter: fits without noise end as near as that


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
    problem, given = solved_problem(found)
    unknowns, weights = found.plan.unknowns, problem.weights(given)
    reached = [given]
    with in_turn(progress, starts) as turn:
        for number in range(starts):
            turn(f"start {number + 1}")
            start = given.copy()
            start[: len(unknowns)] *= MAX_START_FACTOR ** random.uniform(-1.0, 1.0, len(unknowns))
            with suppress(ValueError, FloatingPointError):  # a model that is not valid there
                reached.append(problem.solve(start, weights, ROUGH_TOLERANCE, trials=MAX_TRIALS))
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
        near = [bool(np.all(np.abs(x - end) < MIN_DISTANCE_SIGMA * sigma)) for end, *_ in ends]
        if any(near):
            place = near.index(True)
            end, least, count = ends[place]
            ends[place] = end, least, count + 1
        else:
            ends.append((x, cost, 1))
    return ends
