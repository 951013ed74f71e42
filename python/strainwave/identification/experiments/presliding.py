"""Small motion at rest: loops of a hundredth of a turn, and ramps of torque until a shaft breaks away."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from strainwave.analysis.branches import thinned, turning_points
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.identification.experiments.experiment import changing, sensible
from strainwave.statistics.scale import noise_sigma

Array = NDArray[np.float64]

MIN_MOTION_SIGMA = 6.0  # of the angle's noise: a smaller motion is none
MIN_SAMPLES_OF_RAMP = 8
FIRST_SHARE = 0.5  # of the largest torque of a ramp, below which a shaft is first taken to stick
MAX_LINES = 50  # tried for what a shaft follows while it sticks
SECOND_MARK = 4.0  # times as far: the second mark by which the beginning of the motion is found


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
    threshold = _smallest_motion(angle)
    found = [each for ramp in _ramps(torque) if (each := _broken(time[ramp], torque[ramp], angle[ramp], threshold)) is not None]
    if not found:
        raise ValueError(
            "no ramp of torque is followed by a motion: raise the torque slowly from zero until the shaft turns, let it come "
            "to rest, and repeat; columns are time, torque and angle"
        )
    return found


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


def _smallest_motion(angle: Array) -> float:
    """Return the smallest motion [rad]: six standard deviations of the noise of the angle, or two of its steps."""
    steps = np.abs(np.diff(angle))
    smallest = float(steps[steps > 0.0].min(initial=np.inf))
    quantised = np.mean(steps == 0.0) > 0.2  # an encoder that stands still repeats itself
    return max(MIN_MOTION_SIGMA * noise_sigma(angle), 2.0 * smallest if quantised and np.isfinite(smallest) else 0.0, 1e-12)


def _ramps(torque: Array) -> list[slice]:
    """Return stretches of one sign, each from where its size was least to its end."""
    size, level = np.abs(torque), 0.1 * float(np.abs(torque).max())
    high = np.concatenate([[False], size > level, [False]])
    edges = np.flatnonzero(np.diff(high.astype(int)))
    ramps = []
    for first, last in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        before = first
        while before > 0 and size[before - 1] < size[before]:
            before -= 1
        if last - before >= MIN_SAMPLES_OF_RAMP:
            ramps.append(slice(before, last))
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
