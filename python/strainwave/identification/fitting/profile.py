"""Profile likelihood: the cost over one parameter, all others fitted anew."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.equality import ComparedByFields
from strainwave.identification.fitting.fit import REFIT_TOLERANCE, Fit, solved_problem
from strainwave.messages import listed, quoted
from strainwave.presentation import Pictured, Row
from strainwave.progress import Progress, in_turn
from strainwave.statistics.student import ONE_SIGMA, student

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
MAX_TRIALS = 24  # values tried to each side
LIMIT_TOLERANCE = 0.01  # of an end of the interval, relative in the root of the cost
MAX_RELATIVE_DISTANCE = 1e3  # from the estimate, over the size of the parameter


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
    for trial in range(MAX_TRIALS):
        if step <= 0.0:
            break
        root = distance(value + sense * step)
        if np.isfinite(root):
            tried.append(value + sense * step)
            costs.append(root**2)
            if abs(root - wanted) <= LIMIT_TOLERANCE * wanted:
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
