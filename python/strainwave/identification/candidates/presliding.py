"""Bristle or Maxwell elements from presliding loops, and breakaway torque from ramps."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import friction, hysteresis
from strainwave._core import PassivityWarning
from strainwave.equality import ComparedByFields
from strainwave.identification.candidates.friction import MAX_CHANCE, by_chance, dissipating
from strainwave.identification.experiments.presliding import BreakawayPoint, PreslidingLoop
from strainwave.identification.fitting.estimate import Estimate
from strainwave.statistics.covariance import covariance_of
from strainwave.statistics.linear_fit import normal_inverse, solved
from strainwave.statistics.scale import ONE_SIGMA, student

Array = NDArray[np.float64]

MAX_ELEMENTS = 4  # Maxwell
GRID_SIZE = 24  # reaches of elements that a start is chosen from
MAX_SHARE_LEFT = 0.98  # of the error: an element more that leaves more of it is the last tried
FOLD_COUNT = 4  # of the branches, each predicted from the others
WHOLE_TRIALS, PART_TRIALS = 40, 10  # steps of a fit to the whole loop, and of one that starts from there
MIN_RATES = 3  # different ramps, that determine how breakaway depends on the rate


@dataclass(frozen=True, eq=False)
class PreslidingCandidate(ComparedByFields):
    """One model of friction before it slides, fitted to a loop.

    Attributes:
        name: of the model
        estimates: its numbers; of Maxwell elements their stiffness and the torque at which each slips
        zero: zero of the torque [N.m]
        predicted: torque along the loop [N.m], shape (n,); also before the first reversal, where nothing is compared
        held_out: the same, each part predicted from the others
        error: rms of measured less `held_out` [N.m]
        reach: greatest motion since a reversal over that at which its last element slips [1]; below 1 the loop never slid, and
            its torque levels are lower bounds
    """

    name: str
    estimates: tuple[Estimate, ...]
    zero: float
    predicted: Array
    held_out: Array
    error: float
    reach: float

    @property
    def stiffness(self) -> float:
        """Torque per angle behind a reversal [N.m/rad]."""
        return sum(each.value for each in self.estimates if "stiffness" in each.path)

    @property
    def breakaway(self) -> float:
        """Torque at which it slides [N.m]."""
        return sum(each.value for each in self.estimates if "breakaway" in each.path)

    def law(self, known: Any, *, slid: bool = True) -> Any:
        """Return the law; what a loop does not determine, sliding and the viscous part, comes from another one.

        Args:
            known: law of the same friction when it slides, as from a table
            slid: False if the loop stayed below the torque of `known`, whose levels are then taken
        """
        sliding = {name: getattr(known, name, other) for name, other in (("stribeck_speed", 1.0), ("viscous", 0.0))}
        breakaway = self.breakaway if slid else max(known.breakaway, known.coulomb)
        coulomb = min(getattr(known, "coulomb", breakaway), breakaway)
        levels = {"coulomb": coulomb, "breakaway": breakaway}
        with warnings.catch_warnings(action="ignore", category=PassivityWarning):
            if len(self.estimates) == 2:
                damping = getattr(known, "bristle_damping", 0.0)
                return dissipating(
                    friction.LuGre(bristle_stiffness=self.stiffness, bristle_damping=damping, **levels, **sliding)
                )
            stiffness, share = np.array([each.value for each in self.estimates]).reshape(2, -1).tolist()
            attraction = getattr(known, "attraction", breakaway)
            return friction.MaxwellSlipFriction(stiffness=stiffness, share=share, attraction=attraction, **levels, **sliding)


@dataclass(frozen=True)
class BreakawayTorque:
    """Breakaway torque from ramps, in both directions.

    Attributes:
        forward: torque that breaks away towards positive angles [N.m], None if no ramp went there
        reverse: the same towards negative angles, as a positive torque
        slope: change of the torque for each decade of the ramp's rate [N.m], None if the rates are too few
    """

    forward: Estimate | None
    reverse: Estimate | None
    slope: Estimate | None


def fit_presliding(loop: PreslidingLoop, elements: int = MAX_ELEMENTS) -> list[PreslidingCandidate]:
    """Fit a bristle (LuGre, Dahl) and up to four Maxwell elements to a loop of slow motion.

    The bristle follows its law in the limit of slowness, T = s F + (T0 - s F) exp(-k |x - x0| / F) since the last reversal; an
    element clips at its level. Samples before the first reversal are not compared, as the state of the friction is not known
    there; the zero of the torque is an unknown.

    Intervals count the noise of the torque. That of the angle makes reversals look longer and the stiffness smaller: an encoder
    whose step is a tenth of the reach F / k lowers it by three percent.

    Args:
        loop: torque over angle
        elements: largest count of Maxwell elements tried

    Returns:
        candidates, best first: the one with fewest numbers whose error of branches left out lies within one standard error of
        the least, or is larger by what may be chance; behind it the others by their error

    Raises:
        ValueError: fewer samples than unknowns
    """
    begun = np.arange(len(loop.angle)) >= loop.turns[0]
    branch = np.searchsorted(loop.turns, np.arange(len(loop.angle)), "right")
    if begun.sum() <= 2 * elements + 1:
        raise ValueError(
            f"{begun.sum()} samples behind the first reversal do not determine a presliding loop; record it more densely"
        )
    tried = [_candidate("bristle", _bristle(loop), _bristle_start(loop), loop, begun, branch)]
    for count in range(1, elements + 1):
        name = f"{count} Maxwell element{'s' if count > 1 else ''}"
        tried.append(_candidate(name, _elements(loop), _elements_start(loop, begun, count), loop, begun, branch))
        if count > 1 and tried[-1].error > MAX_SHARE_LEFT * tried[-2].error:
            break
    best = min(tried, key=lambda candidate: candidate.error)

    def as_good(candidate: PreslidingCandidate) -> bool:
        worse = (loop.torque - candidate.held_out) ** 2 - (loop.torque - best.held_out) ** 2
        means = np.array([worse[begun & (branch == each)].mean() for each in np.unique(branch[begun])])
        within = len(means) > 1 and bool(means.mean() <= means.std(ddof=1) / np.sqrt(len(means)))
        more = len(best.estimates) - len(candidate.estimates)
        if candidate is best or within or more <= 0:
            return candidate is best or within
        before, left = ((loop.torque - each.predicted)[begun] for each in (candidate, best))
        return by_chance(before, left, more, len(best.estimates) + 1) > MAX_CHANCE

    first = min((each for each in tried if as_good(each)), key=lambda each: (len(each.estimates), each.error))
    return [first, *sorted((each for each in tried if each is not first), key=lambda each: each.error)]


def breakaway_torque(ramps: Sequence[BreakawayPoint]) -> BreakawayTorque:
    """Return the breakaway torque of each direction, with its interval, and how it depends on the rate of the ramps.

    Raises:
        ValueError: no ramp
    """
    if not ramps:
        raise ValueError("there is no ramp; give at least one that broke the shaft away")
    size = np.array([abs(ramp.torque) for ramp in ramps])
    way, rate = np.sign([ramp.torque for ramp in ramps]), np.log10([ramp.rate for ramp in ramps])
    forward, reverse = (way > 0.0).astype(float), (way < 0.0).astype(float)
    columns, names = [], []
    for column, name in ((forward, "breakaway forward"), (reverse, "breakaway reverse")):
        if column.any():
            columns.append(column)
            names.append(name)
    spread = len(np.unique(rate.round(1)))
    if spread >= MIN_RATES and len(ramps) > len(columns) + 1:
        columns.append(rate - rate.mean())
        names.append("breakaway per decade of the rate")
    jacobian = np.stack(columns, axis=1)
    found = solved(jacobian, size)
    freedom = len(size) - len(found)
    if freedom > 0:
        variance = float(np.sum((size - jacobian @ found) ** 2)) / freedom
        sigma = student(ONE_SIGMA, freedom) * np.sqrt(variance * np.diag(normal_inverse(jacobian)))
    else:
        sigma = np.full(len(found), np.inf)
    estimates = {
        name: Estimate(name, "N.m", float(value), float(value), float(off), False, float(max(freedom, 1)))
        for name, value, off in zip(names, found, sigma, strict=True)
    }
    return BreakawayTorque(
        *(estimates.get(name) for name in ("breakaway forward", "breakaway reverse", "breakaway per decade of the rate"))
    )


Predict = Callable[[Array], Array]  # torque along the loop from the numbers of a model, its zero and its beginning


def _bristle(loop: PreslidingLoop) -> Predict:
    first = loop.turns[0]
    ends = [first, *(turn for turn in loop.turns if turn > first), len(loop.angle) - 1]

    def predict(x: Array) -> Array:
        stiffness, level, zero, carried = x
        torque = np.full_like(loop.angle, carried)
        for start, end in pairwise(ends):
            way = loop.angle[start : end + 1] - loop.angle[start]
            full = np.sign(way[-1]) * level
            torque[start : end + 1] = full + (carried - full) * np.exp(-stiffness * np.abs(way) / level)
            carried = torque[end]
        torque += zero
        return torque

    return predict


def _bristle_start(loop: PreslidingLoop) -> Array:
    half, middle = 0.5 * float(np.ptp(loop.torque)), 0.5 * float(loop.torque.max() + loop.torque.min())
    behind = loop.angle[loop.turns[0]] - loop.angle[loop.turns[1]]
    return np.array([4.0 * half / abs(behind), half, middle, np.sign(behind) * half])


def _elements(loop: PreslidingLoop) -> Predict:
    def predict(x: Array) -> Array:
        stiffness, level = x[:-1].reshape(2, -1).tolist()
        torque: Array = hysteresis.MaxwellSlip(stiffness=stiffness, breakaway=level).trace(loop.angle)
        torque += x[-1]
        return torque

    return predict


def _elements_start(loop: PreslidingLoop, begun: NDArray[np.bool_], count: int) -> Array:
    """Return elements of a grid of reaches with torques by non-negative least squares, merged to `count`."""
    from scipy.optimize import nnls

    largest = 0.5 * float(np.max(np.abs(np.diff(loop.angle[[0, *loop.turns, -1]]))))
    reach = np.geomspace(0.01, 1.0, GRID_SIZE) * largest
    one = np.ones(len(loop.angle))
    bent = [np.asarray(hysteresis.MaxwellSlip(stiffness=[1.0], breakaway=[float(each)]).trace(loop.angle)) for each in reach]
    weights, _ = nnls(np.stack([*bent, one, -one], axis=1)[begun], loop.torque[begun])
    groups = [[k, k * float(r)] for k, r in zip(weights[:-2].tolist(), reach, strict=True) if k > 0.0]
    if not groups:
        groups = [[0.5 * float(np.ptp(loop.torque)) / largest, 0.5 * float(np.ptp(loop.torque))]]
    while len(groups) < count:  # the one of the largest torque in two
        k, level = groups.pop(int(np.argmax([level for _, level in groups])))
        groups += [[0.7 * k, 0.4 * level], [0.3 * k, 0.6 * level]]
    groups.sort(key=lambda group: group[1] / group[0])
    while len(groups) > count:  # those whose merging changes least: of near reaches, or of small torque (Ward1963)
        k, level = np.array(groups).T
        change = level[1:] * level[:-1] / (level[1:] + level[:-1]) * np.diff(np.log(level / k)) ** 2
        nearest = int(np.argmin(change))
        merged = groups.pop(nearest + 1)
        groups[nearest] = [groups[nearest][0] + merged[0], groups[nearest][1] + merged[1]]
    return np.array([*(k for k, _ in groups), *(level for _, level in groups), float(weights[-2] - weights[-1])])


def _candidate(
    name: str, predict: Predict, start: Array, loop: PreslidingLoop, begun: NDArray[np.bool_], branch: NDArray[np.int_]
) -> PreslidingCandidate:
    count = len(start) - (2 if name == "bristle" else 1)
    found = _solved(predict, start, loop.torque, begun, count, WHOLE_TRIALS)
    predicted = predict(found)
    held_out = predicted.copy()
    parts, again = branch % FOLD_COUNT, branch > branch[begun].min()  # the first branch determines the beginning
    for part in np.unique(parts[again]):
        left_out = again & (parts == part)
        if (begun & ~left_out).sum() > len(found):
            held_out[left_out] = predict(_solved(predict, found, loop.torque, begun & ~left_out, count, PART_TRIALS))[left_out]
    residual = (loop.torque - predicted)[begun]
    covariance, freedom = covariance_of(_slopes(predict, found)[begun], residual[np.newaxis])
    sigma = np.sqrt(np.diag(covariance))
    paths = [f"{kind}[{i}]" if count > 2 else kind for kind in ("stiffness", "breakaway") for i in range(count // 2)]
    estimates = tuple(
        Estimate(path, "N.m/rad" if "stiffness" in path else "N.m", float(first), float(value), float(off), False, freedom)
        for path, first, value, off in zip(paths, start, found, sigma, strict=False)
    )
    stiffness, level = found[:count].reshape(2, -1)
    zero = float(found[count])
    way = float(np.max(np.abs(np.diff(loop.angle[[0, *loop.turns, -1]]))))
    reaches = 3.0 if name == "bristle" else 1.0  # within which it slides
    slips = 2.0 * reaches * float(np.max(level / stiffness))
    error = float(np.sqrt(np.mean((loop.torque - held_out)[begun] ** 2)))
    return PreslidingCandidate(name, estimates, zero, predicted, held_out, error, way / slips)


def _solved(predict: Predict, start: Array, torque: Array, chosen: NDArray[np.bool_], positive: int, trials: int) -> Array:
    from scipy.optimize import least_squares

    low = np.where(np.arange(len(start)) < positive, 1e-6 * np.abs(start), -np.inf)

    def residuals(x: Array) -> Array:
        left: Array = (predict(x) - torque)[chosen]
        return left

    def jacobian(x: Array) -> Array:
        slopes: Array = _slopes(predict, x)[chosen]
        return slopes

    solution = least_squares(
        residuals,
        start,
        jac=jacobian,
        bounds=(low, np.inf),
        x_scale="jac",
        max_nfev=trials,
    )
    return np.asarray(solution.x, float)


def _slopes(predict: Predict, x: Array) -> Array:
    """Return derivatives by central differences, shape (n, len(x)): the laws have kinks, but are linear between them."""
    columns = []
    for i, value in enumerate(x):
        step = np.zeros_like(x)
        step[i] = 1e-6 * max(abs(value), 1e-3 * float(np.abs(x).max()) if value == 0.0 else 0.0)
        columns.append((predict(x + step) - predict(x - step)) / (2.0 * step[i]))
    return np.stack(columns, axis=1)
