"""Initial values of a spring with Maxwell elements by the encoders at both sides of a gear: a convex problem.

Both angles give the twist, the motion of the output the torque. For given knees and slip twists the torque is linear in
positive stiffnesses (`torsion.springs`), so each kind of spring with each count of Maxwell elements has one answer. A
stiffening spring and a slipping element can imitate each other: they are chosen together.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, loads, stiffness
from strainwave._core import Gear
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.identification.candidates.torsion.dissipation import maxwell, pairs, unit_traces
from strainwave.identification.candidates.torsion.springs import (
    CUBIC,
    LINEAR,
    THREE_SEGMENT,
    Answer,
    Choice,
    Library,
    Piecewise,
    solve,
)
from strainwave.identification.experiments.motion import motion_of
from strainwave.identification.experiments.motion_log import MotionLog, inertia_of

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

MAX_ELASTIC_ELEMENTS = 2
TRIED_SLIPS = np.geomspace(0.02, 0.9, 24)  # of the largest twist: twists of slip that are tried
MAX_ROWS_OF_REGRESSION = 3000  # of the regression
MIN_START_DAMPING = 1e-3  # of critical damping: from where a fit can start
UNREACHED_TORQUE = 1e6  # N.m: a knee there does nothing
MIN_TORQUE_SHARE = 2e-3  # of the largest torque: an element that carries less is none


@dataclass(frozen=True, eq=False)
class ElasticStart(ComparedByFields):
    """A kind of spring with a count of Maxwell elements, by regression.

    Attributes:
        drive: with them
        error: rms error of the torque on data held out [N.m]
    """

    drive: Drive
    error: float


def elastic_starts(
    recording: Recording, log: MotionLog, drive: Drive, torque: Array, late: Array, blocks: Rows, *, by_gravity: bool
) -> list[ElasticStart]:
    """Return the best spring of each kind with each count of Maxwell elements, the smallest error first.

    Args:
        recording: `output_angle`, which counts in the sense of the drive's ratio
        log: the same along its motion
        drive: with the load by the log along its motion
        torque: that a rigid gear transmits along the motion [N.m], shape (m,)
        late: angle by which a delay of the output shifts the twist [rad], shape (m,)
        blocks: instants of the motion that take part, shape (m,); the others validate
        by_gravity: True if the torque counts from gravity, so that the inertia of the load is unknown; else gravity is
    """
    motion, ratio, load = log.motion, drive.gear.kinematics.ratio, inertia_of(drive)
    output = motion_of(recording.time, recording.values("output_angle", "rad"), motion.cutoff)
    angle, acceleration = (np.interp(motion.time, output.time, each) for each in (output.angle, output.acceleration))
    twist = motion.angle / ratio - angle - late - np.asarray(drive.gear.kinematic_error.error(motion.angle))
    used = motion.known & np.isfinite(twist)
    twist = twist - 0.5 * (twist[used].max() + twist[used].min())
    half = float(np.abs(twist[used]).max())
    rate = np.gradient(twist, motion.time)
    swing = np.sin(motion.angle / ratio), np.cos(motion.angle / ratio)
    free = [acceleration, swing[1]] if by_gravity else [*swing]
    free += [np.ones_like(twist), motion.speed]
    size = float(np.abs(torque[used]).max())
    scaled = [each * size / max(float(np.abs(each[used]).max()), 1e-300) for each in free]
    always = np.column_stack([rate, *scaled, *(-each for each in scaled)])
    needed = torque + load * (acceleration - motion.acceleration / ratio)
    rows = np.flatnonzero(used)
    rows = rows[:: -(-len(rows) // MAX_ROWS_OF_REGRESSION)]
    training = blocks[rows]
    memory = np.column_stack(unit_traces(twist, half * TRIED_SLIPS))
    starts = []
    for count in range(MAX_ELASTIC_ELEMENTS + 1):
        elements = _elements(memory[rows], half, count)
        for spring in TRIED_SPRINGS:
            libraries = [elements, spring.library(twist[rows], half, drive.gear)]
            try:
                (answer, *_) = solve(
                    needed[rows][training],
                    [replace(each, torques=each.torques[training]) for each in libraries],
                    always[rows][training],
                )
            except ValueError:
                continue
            gear: Any = answer.put(drive.gear)
            if len(pairs(gear)) < count:
                continue  # the same with fewer elements
            error = float(np.std((needed[rows] - _predicted(answer, libraries, always[rows]))[~training]))
            critical = 2.0 * float(np.sqrt(gear.stiffness.tangent(0.0) * load))
            gear = gear.replace(damping=max(float(answer.weights[-1][0]), MIN_START_DAMPING * critical))
            begun = drive.replace(gear=gear, load=_load(drive, answer.weights[-1], scaled, free, by_gravity))
            starts.append(ElasticStart(begun, error))
    if not starts:
        raise ValueError("no spring explains the angle between the shafts")
    return sorted(starts, key=lambda each: each.error)


class _TwoSegments(Piecewise):
    """Two segments, as the first two of three, whose last one the record does not reach."""

    words = "three-segment spring"

    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        two_segments = super().library(twist, half, gear)
        return Library(two_segments.torques, tuple(replace(each, put=_two_segments(each.put)) for each in two_segments.choices))


def _two_segments(put: Callable[[Gear, Array], Gear]) -> Callable[[Gear, Array], Gear]:
    def put_as_three(gear: Gear, weights: Array) -> Gear:
        spring: Any = put(gear, weights).stiffness
        k2 = spring.k1 + spring.k2
        bent = stiffness.ThreeSegment(k1=spring.k1, k2=k2, k3=k2, t1=spring.k1 * spring.knee, t2=UNREACHED_TORQUE)
        return gear.replace(stiffness=bent)

    return put_as_three


TRIED_SPRINGS = (LINEAR, CUBIC, _TwoSegments(), THREE_SEGMENT)


def _elements(torques: Array, half: float, count: int) -> Library:
    """Return the library of a count of elements that slip at different twists."""

    def choice(places: tuple[int, ...]) -> Choice:
        def put(gear: Gear, weights: Array) -> Gear:
            every = [(float(k), float(k) * half * float(TRIED_SLIPS[place])) for k, place in zip(weights, places, strict=True)]
            largest = float(np.abs(torques).max()) * max((k for k, _ in every), default=0.0)
            return gear.replace(hysteresis=maxwell([each for each in every if each[1] > MIN_TORQUE_SHARE * largest]))

        return Choice(places, put)

    return Library(torques, tuple(choice(places) for places in combinations(range(len(TRIED_SLIPS)), count)))


def _predicted(answer: Answer, libraries: list[Library], always: Array) -> Array:
    """Return the torque by an answer [N.m]."""
    parts = zip(libraries, answer.choices, answer.weights, strict=False)
    return sum((library.torques[:, list(choice.columns)] @ w for library, choice, w in parts), always @ answer.weights[-1])


def _load(drive: Drive, weights: Array, scaled: list[Array], free: list[Array], by_gravity: bool) -> loads.Pendulum | Any:
    """Return the load with the change of its inertia by the regression, which is less than what the motor has besides."""
    if not by_gravity:
        return drive.load
    count = len(free)
    shift = float(weights[1] - weights[1 + count]) * float(np.abs(scaled[0]).max() / max(np.abs(free[0]).max(), 1e-300))
    carried: Any = drive.load
    return carried.replace(inertia=max(carried.inertia - shift, 0.1 * carried.inertia))
