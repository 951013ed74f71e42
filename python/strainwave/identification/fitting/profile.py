"""Profile likelihood: how far a parameter can go, when all others make up for it as well as they can."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.equality import ComparedByFields
from strainwave.identification.fitting.estimate import ONE_SIGMA, student
from strainwave.identification.fitting.fit import ROUGH, Fit, solved_problem
from strainwave.identification.fitting.loss import LOSSES
from strainwave.messages import listed, quoted

Array = NDArray[np.float64]
STEPS = 24  # values tried to each side, at most
NEAR = 0.01  # how near to the limit an end of the interval must come, relative in the root of the cost
FARTHEST = 1e3  # of the size of a parameter: farther out nobody looks


@dataclass(frozen=True, eq=False)
class Profile(ComparedByFields):
    """What the data say to each value of one parameter.

    Attributes:
        path: of the parameter
        unit: its unit
        values: tried, ascending, shape (n,)
        cost: rise of the cost above its least, the others fitted anew, shape (n,); where the model is linear the square of the
            distance in standard deviations
        limit: cost at the ends of the interval
        interval: between which the parameter lies with the confidence asked for; to a side where the data do not bound it, it
            ends at the limit of the law or of `bounds`, or is infinite
        open_below, open_above: whether the data do not bound it to that side

    >>> cost = np.array([4.0, 0.0, 1.0])
    >>> print(Profile("gear.damping", "N.m.s/rad", np.array([1.0, 2.0, 9.0]), cost, 4.0, (1.0, np.inf), False, True))
    gear.damping is above 1 N.m.s/rad; the data do not determine how large it is
    """

    path: str
    unit: str
    values: Array
    cost: Array
    limit: float
    interval: tuple[float, float]
    open_below: bool
    open_above: bool

    def __str__(self) -> str:
        low, high = self.interval
        if self.open_below and self.open_above:
            return f"{self.path} is not determined: the data bound it to neither side"
        if self.open_above:
            return f"{self.path} is above {low:.4g} {self.unit}; the data do not determine how large it is"
        if self.open_below:
            return f"{self.path} is below {high:.4g} {self.unit}; the data do not determine how small it is"
        return f"{self.path} lies between {low:.4g} and {high:.4g} {self.unit}"


def profile(found: Fit, path: str, *, confidence: float = 0.95) -> Profile:
    """The profile likelihood of one unknown of a fit: it is held at one value after the other, and all others are fitted anew.

    Unlike the interval of an estimate, which takes the model to be linear, this one need not be symmetric, and shows to which
    side the data do not bound a parameter. Its scale is adjusted so that near the least cost it agrees with the standard
    deviation of the estimate, which counts that residuals hang together.

    Args:
        found: what `fit` found
        path: of a free parameter, or an unknown of the measurement, as the estimates name it
        confidence: of the interval

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
    friction_input.coulomb lies between 0.01992 and 0.02003 N.m
    """
    path, confidence = arguments.text("path", path), arguments.number("confidence", confidence, low=0.0, high=1.0)
    problem, best = solved_problem(found)
    tied = {each.path for each in found.plan.tied}
    unknowns = [each for each in found.estimates if each.path not in tied]
    names = [each.path for each in unknowns]
    if path not in names:
        raise ValueError(f"the fit has no unknown {quoted(path)}; it has {listed(names)}")
    place = names.index(path)
    estimate, loss = unknowns[place], LOSSES[found.loss]
    weights = problem.weights(best, problem.first_weights(), loss)
    least = problem.cost(best, weights, loss)
    naive = problem.naive_sigma(best, weights, loss)[place]
    adjusted = (naive / estimate.sigma) ** 2 if np.isfinite(estimate.sigma) and estimate.sigma > 0.0 else 1.0
    limit = (student(confidence, estimate.freedom) / student(ONE_SIGMA, estimate.freedom)) ** 2
    low, high = problem.limits()[place]

    def towards(end: float) -> tuple[list[float], list[float], float, bool]:
        last = best.copy()

        def distance(value: float) -> float:
            """Root of the rise of the cost, infinite where the model is not valid."""
            nonlocal last
            start = last.copy()
            start[place] = value
            try:
                solved = problem.solve(start, weights, loss, ROUGH**2, held=[place])
                rise = problem.cost(solved, weights, loss) - least
            except (ValueError, FloatingPointError):
                return np.inf
            last = solved
            return float(np.sqrt(max(rise, 0.0) * adjusted))

        return _search(distance, estimate.value, estimate.sigma, end, float(np.sqrt(limit)), abs(estimate.start))

    below, of_below, first, open_below = towards(low)
    above, of_above, second, open_above = towards(high)
    values = np.array([*below, estimate.value, *above])
    cost = np.array([*of_below, 0.0, *of_above])
    order = np.argsort(values)
    return Profile(path, estimate.unit, values[order], cost[order], limit, (first, second), open_below, open_above)


def _search(
    distance: Callable[[float], float], value: float, sigma: float, end: float, wanted: float, size: float
) -> tuple[list[float], list[float], float, bool]:
    """Values and costs towards an end, where the distance is as wanted, and whether it nowhere is."""
    sense = 1.0 if end > value else -1.0
    size = max(abs(value), size) or 1.0
    farthest = min(abs(end - value), FARTHEST * size)
    step = min(0.5 * sigma if np.isfinite(sigma) and sigma > 0.0 else 0.1 * size, farthest)
    near, near_root, far, far_root = 0.0, 0.0, np.inf, np.inf
    tried, costs = [], []
    for trial in range(STEPS):
        if step <= 0.0:
            break
        root = distance(value + sense * step)
        if np.isfinite(root):
            tried.append(value + sense * step)
            costs.append(root**2)
            if abs(root - wanted) <= NEAR * wanted:
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
            step = 0.5 * (near + far) if trial % 2 else _between(near, near_root, far, far_root, wanted)
    if np.isfinite(far):
        return tried, costs, value + sense * far, False
    return tried, costs, end, True


def _between(near: float, near_root: float, far: float, far_root: float, wanted: float) -> float:
    """Where a line between two distances is as wanted; half way where the farther is infinite."""
    if not np.isfinite(far_root):
        return 0.5 * (near + far)
    share = (wanted - near_root) / (far_root - near_root)
    return near + float(np.clip(share, 0.05, 0.95)) * (far - near)
