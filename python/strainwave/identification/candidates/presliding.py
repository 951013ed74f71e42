"""Small motion at rest: elements of presliding loops, and the torque at which ramps break a shaft away."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import friction, hysteresis
from strainwave._core import PassivityWarning
from strainwave.analysis.branches import thinned, turning_points
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.identification.candidates.friction import MAX_CHANCE_OF_NUMBERS, by_chance, dissipating
from strainwave.identification.candidates.torsion.dissipation import unit_traces
from strainwave.identification.experiments.experiment import changing, sensible
from strainwave.identification.fitting.unknowns import Estimate
from strainwave.statistics.covariance import covariance_of
from strainwave.statistics.linear_fit import normal_inverse, solved
from strainwave.statistics.runs import runs_of
from strainwave.statistics.scale import ONE_SIGMA, noise_sigma, student

Array = NDArray[np.float64]

MAX_PRESLIDING_ELEMENTS = 4  # Maxwell
GRID_SIZE = 24  # reaches of elements that a start is chosen from
MAX_SHARE_LEFT = 0.98  # of the error: an element more that leaves more of it is the last tried
BRANCH_FOLDS = 4  # of the branches, each predicted from the others
WHOLE_TRIALS, PART_TRIALS = 40, 10  # steps of a fit to the whole loop, and of one that starts from there
MIN_RATES = 3  # different ramps, that determine how breakaway depends on the rate
MIN_BREAKAWAY_SIGMA = 6.0  # of the angle's noise: a smaller motion is none
MIN_SAMPLES_OF_RAMP = 8
FIRST_SHARE = 0.5  # of the largest torque of a ramp, below which a shaft is first taken to stick
MAX_LINES = 50  # tried for what a shaft follows while it sticks
SECOND_MARK = 4.0  # times as far: the second mark by which the beginning of the motion is found


# ---- Measurements ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class PreslidingLoop(ComparedByFields):
    """Torque over a slow motion to and fro that is too small, or turns too often, to be steady sliding.

    Args:
        angle: angle of the shaft [rad], shape (n,), monotone between its turning points
        torque: torque that moves it [N.m], shape (n,)
    """

    angle: Array
    torque: Array

    @classmethod
    def of(cls, recording: Recording) -> PreslidingLoop:
        """Return the loop of columns angle and torque, in the order in which they were measured.

        Raises:
            ValueError: no such columns, or a path that does not turn back twice
        """
        check_recording("recording", recording)
        angle, torque = changing(recording, "angle", "rad"), changing(recording, "torque", "N.m")
        path, held = thinned(angle, torque)
        return cls.along(path, held)

    @classmethod
    def along(cls, angle: Array, torque: Array) -> PreslidingLoop:
        """Return the loop of a path, each of its branches made one-way by least squares, which noise shifts neither way."""
        turns = turning_points(angle)
        if len(turns) < 2:
            raise ValueError(
                f"the angle turns back {len(turns)} times; a presliding loop must go to and fro at least once, best with "
                "several amplitudes, which show its torque over the way since the last reversal"
            )
        return cls(one_way(angle, turns), torque)

    @cached_property
    def turns(self) -> list[int]:
        """Samples at which the path turns back."""
        return turning_points(self.angle)


@dataclass(frozen=True)
class BreakawayPoint:
    """The point of a ramp of torque at which the shaft breaks away.

    Attributes:
        time: when [s]
        torque: torque at that time, of its sign [N.m]
        rate: how fast its size rose [N.m/s]
        bent: how far the shaft had moved before, elastically [rad]
    """

    time: float
    torque: float
    rate: float
    bent: float


def breakaways(recording: Recording) -> list[BreakawayPoint]:
    """Return where ramps of torque break a shaft away.

    A ramp is a stretch over which the size of the torque rises from small values. The shaft has broken away where its angle
    leaves the line that it followed along the ramp before, by more than it had bent elastically: bristles yield long before
    they slide. As it then accelerates from rest, the times t1 and t2 at which it is off by so much and by four times as much
    determine when it began, 2 t1 - t2 (a parabola).

    Args:
        recording: columns time, torque and angle; the angle may have any zero

    Returns:
        one entry for each ramp that broke the shaft away, in the order of time

    Raises:
        ValueError: no ramp broke the shaft away
    """
    check_recording("recording", recording)
    time, torque, angle = recording.time, sensible(recording, "torque", "N.m"), sensible(recording, "angle", "rad")
    steps = np.abs(np.diff(angle))
    of_noise, of_encoder = MIN_BREAKAWAY_SIGMA * noise_sigma(angle), 2.0 * float(steps[steps > 0.0].min(initial=np.inf))
    if np.mean(steps == 0.0) > 0.2 and np.isfinite(of_encoder):  # an encoder that stands still repeats itself
        of_noise = max(of_noise, of_encoder)
    smallest = max(of_noise, 1e-12)  # rad: the smallest motion
    points = [each for ramp in _ramps(torque) if (each := _broken(time[ramp], torque[ramp], angle[ramp], smallest)) is not None]
    if not points:
        raise ValueError(
            "no ramp of torque is followed by a motion: raise the torque slowly from zero until the shaft turns, let it come "
            "to rest, and repeat; columns are time, torque and angle"
        )
    return points


def one_way(path: Array, turns: list[int]) -> Array:
    """Return the path with each branch between its turning points monotone, as near to it as can be (isotonic regression).

    The running extreme would run ahead of noise on every branch, and so make every reversal longer than it was.

    >>> one_way(np.array([0.0, 1.0, 0.8, 2.0, 1.0, 1.2, 0.0]), [3]).tolist()
    [0.0, 0.9, 0.9, 2.0, 1.1, 1.1, 0.0]
    """
    from scipy.optimize import isotonic_regression

    smooth = path.copy()
    ends = [0, *turns, len(path) - 1]
    for first, last in pairwise(ends):
        branch = slice(first if first == 0 else first + 1, last + 1)
        smooth[branch] = isotonic_regression(path[branch], increasing=bool(path[last] > path[first])).x
    return smooth


def _ramps(torque: Array) -> list[slice]:
    """Return stretches of one sign, each from where its size was least to its end."""
    size, level = np.abs(torque), 0.1 * float(np.abs(torque).max())
    ramps = []
    for high in runs_of(size > level):
        before = high.start
        while before > 0 and size[before - 1] < size[before]:
            before -= 1
        if high.stop - before >= MIN_SAMPLES_OF_RAMP:
            ramps.append(slice(before, high.stop))
    return ramps


def _broken(time: Array, torque: Array, angle: Array, threshold: float) -> BreakawayPoint | None:
    way = np.sign(torque[len(torque) // 2])
    off = way * (angle - angle[0])
    top = int(np.argmax(np.maximum.accumulate(way * torque)))
    near = (np.arange(len(off)) <= top) & (way * torque <= FIRST_SHARE * way * torque[top])
    for _ in range(MAX_LINES):  # the line that the shaft follows while it sticks, from what is not off it
        if near.sum() < MIN_SAMPLES_OF_RAMP // 2:
            return None
        line = np.polynomial.Polynomial.fit(way * torque[near], off[near], 1, domain=[])
        away, bent = off - line(way * torque), line(way * torque) - line(way * torque[0])
        least = np.maximum(threshold, bent)
        gone = np.flatnonzero(_stays(away > least))
        if len(gone) == 0:
            return None
        before, near = near, near & (np.arange(len(off)) < gone[0])
        if np.array_equal(before, near):
            break
    farther = np.flatnonzero(_stays(away > SECOND_MARK * least[gone[0]]))
    first, second = float(time[gone[0]]), float(time[farther[0] if len(farther) else gone[0]])
    begun = max(2.0 * first - second, float(time[0]))
    rising = time <= first
    rate, level = np.polynomial.polynomial.polyfit(time[rising] - begun, way * torque[rising], 1)[::-1]
    return BreakawayPoint(begun, float(way * level), float(rate), float(line(level) - line(way * torque[0])))


def _stays(beyond: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """True from where it is true to the end."""
    return np.logical_and.accumulate(beyond[::-1])[::-1]


# ---- Fits ------------------------------------------------------------------------------------------------------------


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


def fit_presliding(loop: PreslidingLoop, elements: int = MAX_PRESLIDING_ELEMENTS) -> list[PreslidingCandidate]:
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
    tried = [_candidate("bristle", *_bristle(loop), loop, begun, branch)]
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
        return by_chance(before, left, more, len(best.estimates) + 1) > MAX_CHANCE_OF_NUMBERS

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
    torques = solved(jacobian, size)
    freedom = len(size) - len(torques)
    if freedom > 0:
        variance = float(np.sum((size - jacobian @ torques) ** 2)) / freedom
        sigma = student(ONE_SIGMA, freedom) * np.sqrt(variance * np.diag(normal_inverse(jacobian)))
    else:
        sigma = np.full(len(torques), np.inf)
    estimates = {
        name: Estimate(name, "N.m", float(value), float(value), float(off), False, float(max(freedom, 1)))
        for name, value, off in zip(names, torques, sigma, strict=True)
    }
    return BreakawayTorque(
        *(estimates.get(name) for name in ("breakaway forward", "breakaway reverse", "breakaway per decade of the rate"))
    )


Predict = Callable[[Array], Array]  # torque along the loop from the numbers of a model, its zero and its beginning


def _bristle(loop: PreslidingLoop) -> tuple[Predict, Array]:
    """Return the prediction of a bristle, and its initial values."""
    half, middle = 0.5 * float(np.ptp(loop.torque)), 0.5 * float(loop.torque.max() + loop.torque.min())
    behind = loop.angle[loop.turns[0]] - loop.angle[loop.turns[1]]
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

    return predict, np.array([4.0 * half / abs(behind), half, middle, np.sign(behind) * half])


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
    weights, _ = nnls(np.stack([*unit_traces(loop.angle, reach), one, -one], axis=1)[begun], loop.torque[begun])
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
    solution = _solved(predict, start, loop.torque, begun, count, WHOLE_TRIALS)
    predicted = predict(solution)
    held_out = predicted.copy()
    parts, again = branch % BRANCH_FOLDS, branch > branch[begun].min()  # the first branch determines the beginning
    for part in np.unique(parts[again]):
        left_out = again & (parts == part)
        if (begun & ~left_out).sum() > len(solution):
            by_others = _solved(predict, solution, loop.torque, begun & ~left_out, count, PART_TRIALS)
            held_out[left_out] = predict(by_others)[left_out]
    residual = (loop.torque - predicted)[begun]
    covariance, freedom = covariance_of(_slopes(predict, solution)[begun], residual[np.newaxis])
    sigma = np.sqrt(np.diag(covariance))
    paths = [f"{kind}[{i}]" if count > 2 else kind for kind in ("stiffness", "breakaway") for i in range(count // 2)]
    estimates = tuple(
        Estimate(path, "N.m/rad" if "stiffness" in path else "N.m", float(first), float(value), float(off), False, freedom)
        for path, first, value, off in zip(paths, start, solution, sigma, strict=False)
    )
    stiffness, level = solution[:count].reshape(2, -1)
    zero = float(solution[count])
    way = float(np.max(np.abs(np.diff(loop.angle[[0, *loop.turns, -1]]))))
    reaches = 3.0 if name == "bristle" else 1.0  # within which it slides
    slips = 2.0 * reaches * float(np.max(level / stiffness))
    error = float(np.sqrt(np.mean((loop.torque - held_out)[begun] ** 2)))
    return PreslidingCandidate(name, estimates, zero, predicted, held_out, error, way / slips)


def _solved(predict: Predict, start: Array, torque: Array, chosen: NDArray[np.bool_], positive: int, trials: int) -> Array:
    from scipy.optimize import least_squares

    low = np.where(np.arange(len(start)) < positive, 1e-6 * np.abs(start), -np.inf)

    def residuals(x: Array) -> Array:
        return np.asarray((predict(x) - torque)[chosen])

    def jacobian(x: Array) -> Array:
        return np.asarray(_slopes(predict, x)[chosen])

    solution = least_squares(residuals, start, jac=jacobian, bounds=(low, np.inf), x_scale="jac", max_nfev=trials)
    return np.asarray(solution.x, float)


def _slopes(predict: Predict, x: Array) -> Array:
    """Return derivatives by central differences, shape (n, len(x)): the laws have kinks, but are linear between them."""
    columns = []
    for i, value in enumerate(x):
        step = np.zeros_like(x)
        step[i] = 1e-6 * max(abs(value), 1e-3 * float(np.abs(x).max()) if value == 0.0 else 0.0)
        columns.append((predict(x + step) - predict(x - step)) / (2.0 * step[i]))
    return np.stack(columns, axis=1)
