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


def with_filter(
    plant: HeldPlant, gains: Array, measured: int, output: Array, noise: Noise, ratio: float, limit: float
) -> control.StateSpace:
    """Return the law u = u_r + K (z_r - z) - d of the estimates z of the states and d of a constant actuation that disturbs.

    z_r and u_r are states and actuation of a motion at the commanded constant speed: a jump of the command does not excite the
    filter.

    Args:
        plant: of the drive at rest
        gains: K, with that of the input before, if it is a state
        measured: index of the state that is measured, the input angle
        output: the output angle as a sum of the states
        noise: what the filter does not know
        ratio: input angle per output angle
        limit: of the actuation

    Raises:
        ValueError: the law has more states than a `StateSpace`
    """
    count = len(plant.step)
    size = count + 1 + plant.is_late
    if size > MAX_STATES:
        raise ValueError(
            f"the filter has {size} states and control.StateSpace {MAX_STATES}: linearise a drive with fewer, without structure"
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
    seen = np.zeros(size)
    seen[measured] = 1.0
    known = count + 1  # what the filter estimates; the input before it knows
    process = np.zeros((known, known))
    process[:count, :count] = noise.effort**2 * np.outer(disturbs, disturbs)
    process[count, count] = noise.effort_rate**2 * plant.period
    corrects = np.zeros(size)
    corrects[:known] = filter_gain(step[:known, :known], seen[:known], process, noise.angle**2)
    after = np.eye(size) - np.outer(corrects, seen)
    closed = step - np.outer(now, feedback)
    per_angle, per_speed = _reference(plant, gains, output)
    inputs, direct = np.zeros((size, INPUTS)), np.zeros(INPUTS)
    # the angle measured is ratio times the command less the error, which is the first input; command and rate are the last
    inputs[:, 0], direct[0] = -closed @ corrects, feedback @ corrects
    inputs[:, -2], direct[-2] = ratio * closed @ corrects + now * per_angle, per_angle - ratio * feedback @ corrects
    inputs[:, -1], direct[-1] = now * per_speed, per_speed
    return control.StateSpace(
        A=((closed @ after - np.eye(size)) / plant.period).ravel().tolist(),
        B=(inputs / plant.period).ravel().tolist(),
        C=(-feedback @ after).tolist(),
        D=direct.tolist(),
        tracking=(now / plant.period).tolist(),
        limit=limit,
    )


def _reference(plant: HeldPlant, gains: Array, output: Array) -> tuple[float, float]:
    """Return K z_r + u_r per commanded angle and per commanded speed.

    Source: FranklinPowellEmamiNaeini2002, section 7.5, for a constant command; likewise for one of constant speed.
    """
    count = len(output)
    whole = np.zeros((count + 1, count + 1))
    whole[:count, :count], whole[:count, count] = plant.step - np.eye(count), plant.now + plant.late
    whole[count, :count] = output
    at_rest = np.linalg.solve(whole, np.append(np.zeros(count), 1.0))
    moved = plant.period * (at_rest[:count] + plant.late * at_rest[count])
    at_speed = np.linalg.solve(whole, np.append(moved, 0.0))
    before = at_rest[count], at_speed[count] - plant.period * at_rest[count]  # the input before, which lags by a period
    per_angle, per_speed = (
        float(gains[:count] @ motion[:count] + motion[count] + (gains[-1] * late if plant.is_late else 0.0))
        for motion, late in zip((at_rest, at_speed), before, strict=True)
    )
    return per_angle, per_speed
