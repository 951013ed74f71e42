"""A stationary Kalman filter around a linear-quadratic regulator, for a controller that measures one angle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import control

Array = NDArray[np.float64]
MAX_STATES, INPUTS = 8, 8  # of control.StateSpace


def held(a: Array, b: Array, time: float) -> tuple[Array, Array]:
    """Return the transition over a time [s] and the effect of an input that is held over it."""
    from scipy.linalg import expm

    count = len(a)
    whole = np.zeros((count + 1, count + 1))
    whole[:count, :count], whole[:count, count] = a, b
    exact = expm(whole * time)
    return exact[:count, :count], exact[:count, count]


@dataclass(frozen=True)
class HeldPlant:
    """A linear plant from one sampling instant to the next, x + = F x + G_1 v + G_0 u, with v the input of the instant before.

    Attributes:
        step: F
        late: G_1, zero without delay
        now: G_0
        period: [s]
    """

    step: Array
    late: Array
    now: Array
    period: float

    @classmethod
    def of(cls, a: Array, b: Array, period: float, delay: float) -> HeldPlant:
        """Return the plant of dx/dt = a x + b u, whose input comes a delay [s] after the instant."""
        (first, before), (rest, after) = held(a, b, delay), held(a, b, period - delay)
        return cls(rest @ first, rest @ before, after, period)

    @property
    def is_late(self) -> bool:
        """True if the input of the instant before is a state."""
        return bool(self.late.any())

    @property
    def whole(self) -> tuple[Array, Array]:
        """F and G of the states with the input before as the last of them, if it is one."""
        if not self.is_late:
            return self.step, self.now
        count = len(self.step)
        step = np.zeros((count + 1, count + 1))
        step[:count, :count], step[:count, count] = self.step, self.late
        return step, np.append(self.now, 1.0)

    def gains(self, cost: Array, effort: float) -> Array:
        """Return the gains K of u = -K x that minimise x' cost x + effort u^2, by the discrete Riccati equation.

        Raises:
            ValueError: there are none
        """
        from scipy.linalg import solve_discrete_are

        step, now = self.whole
        weights = np.zeros_like(step)
        weights[: len(cost), : len(cost)] = cost
        try:
            value = solve_discrete_are(step, now[:, np.newaxis], weights, np.array([[effort]]))
        except np.linalg.LinAlgError as error:
            raise ValueError(f"no regulator is found for this drive and these weights: {error}") from None
        return np.asarray(now @ value @ step / (effort + now @ value @ now))


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
            f"the law has {size + 1} states and control.StateSpace {MAX_STATES}: give a drive with fewer, without structure"
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
