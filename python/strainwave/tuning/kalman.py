"""A stationary Kalman filter around a linear-quadratic regulator, for a controller that measures one angle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import control
from strainwave.tuning.linear_plant import HeldPlant

Array = NDArray[np.float64]
MAX_STATES, INPUTS = 8, 8  # of control.StateSpace


@dataclass(frozen=True)
class Noise:
    """Standard deviations of what a filter does not know.

    Attributes:
        angle: of the measured angle [rad]
        effort: of the actuation over each period, in its unit
        effort_rate: by which a constant actuation changes in 1 s, in its unit
    """

    angle: float
    effort: float
    effort_rate: float


def filter_gain(step: Array, seen: Array, process: Array, measurement: float) -> Array:
    """Return the gain M of the stationary filter x <- x + M (y - seen x), for covariances of process and measurement.

    Source: AstromWittenmark1997, section 11.3.

    >>> filter_gain(np.array([[1.0]]), np.array([1.0]), np.array([[0.5]]), 1.0)
    array([0.5])
    """
    from scipy.linalg import solve_discrete_are

    covariance = solve_discrete_are(step.T, seen[:, np.newaxis], process, np.array([[measurement]]))
    return np.asarray(covariance @ seen / (seen @ covariance @ seen + measurement))


def with_filter(plant: HeldPlant, gains: Array, measured: int, noise: Noise, ratio: float, limit: float) -> control.StateSpace:
    """Return the law u = -K z - d of estimates: z of the deviations from the command, d of a constant actuation that disturbs.

    A feed-forward that moves the joint as commanded does not excite the filter, because it acts on deviations. A jump of the
    command changes the deviation of the input angle: the law subtracts it from the estimate, and its last state is the command.

    Args:
        plant: in deviations from the command
        gains: K, with that of the input before, if it is a state
        measured: index of the state that is measured, the input angle
        noise: what the filter does not know
        ratio: input angle per output angle
        limit: of the actuation

    Raises:
        ValueError: the law has more states than a `StateSpace`
    """
    count = len(plant.step)
    size = count + 1 + plant.is_late
    if size + 1 > MAX_STATES:
        raise ValueError(
            f"the law has {size + 1} states, and control.StateSpace has at most {MAX_STATES}: take the lumped gear "
            "(structure.Lumped)"
        )
    disturbs = plant.now + plant.late
    step, now = np.zeros((size, size)), np.zeros(size)
    step[:count, :count], step[:count, count], step[count, count] = plant.step, disturbs, 1.0
    now[:count] = plant.now
    feedback = np.zeros(size)
    feedback[:count], feedback[count] = gains[:count], 1.0
    if plant.is_late:  # the gains are those of input and disturbance together
        step[:count, -1], now[-1], feedback[-1] = plant.late, 1.0, gains[-1]
        feedback[count] += gains[-1]
    known = count + 1  # what the filter estimates; the input before it knows
    seen = np.zeros(size)
    seen[measured] = 1.0
    process = np.zeros((known, known))
    process[:count, :count] = noise.effort**2 * np.outer(disturbs, disturbs)
    process[count, count] = noise.effort_rate**2 * plant.period
    corrects = np.zeros(size)
    corrects[:known] = filter_gain(step[:known, :known], seen[:known], process, noise.angle**2)
    return _law(step - np.outer(now, feedback), now, feedback, corrects, ratio * seen, plant.period, limit)


def _law(
    closed: Array, now: Array, feedback: Array, corrects: Array, jumps: Array, period: float, limit: float
) -> control.StateSpace:
    """Return the law whose states are the estimates before each measurement and the command half a period later.

    Args:
        closed: step of the estimates under the feedback
        now: effect of the actuation on them
        feedback: of the estimates
        corrects: gain M of the filter
        jumps: by what the estimates fall, per jump of the command; the angle measured is one of them, times the ratio
        period: [s]
        limit: of the actuation
    """
    size, half = len(closed), 0.5 * period
    seen = (jumps != 0.0).astype(float)
    after = np.eye(size) - np.outer(corrects, seen)
    by_jump = after @ jumps
    step = np.zeros((size + 1, size + 1))
    step[:size, :size], step[:size, size] = closed @ after, closed @ by_jump
    inputs, direct = np.zeros((size + 1, INPUTS)), np.zeros(INPUTS)
    inputs[:size, 0], direct[0] = -closed @ corrects, feedback @ corrects
    # the jump is what command and rate differ by from the command of the instant before, carried on by both rates
    inputs[:size, -2], inputs[:size, -1] = -closed @ by_jump, half * closed @ by_jump
    inputs[size, -2:] = 1.0, half
    direct[-2], direct[-1] = feedback @ by_jump, -half * feedback @ by_jump
    return control.StateSpace(
        A=((step - np.eye(size + 1)) / period).ravel().tolist(),
        B=(inputs / period).ravel().tolist(),
        C=np.append(-feedback @ after, -feedback @ by_jump).tolist(),
        D=direct.tolist(),
        tracking=np.append(now / period, 0.0).tolist(),
        limit=limit,
    )
