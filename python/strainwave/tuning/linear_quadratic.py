"""A linear-quadratic regulator for a drive and the period of its controller: by all that is measured, or by the input alone."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, arguments, control
from strainwave.files.gear_set import GearSet
from strainwave.tuning.cascade import Plant
from strainwave.tuning.linear_plant import HeldPlant, LinearPlant

Array = NDArray[np.float64]

USUAL_RESOLUTION = 2.0 * np.pi / 2**14  # rad: an encoder of 14 bit on the motor
NOISE_SHARE = 0.01  # of the torque limit, as the standard deviation of the torque over a period
RATE_SHARE = 1.0  # of the torque limit, by which the disturbance wanders in 1 s
MAX_STATES, MAX_INPUTS = 8, 8  # of control.StateSpace


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
        ratio: input angle per output angle

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
    estimated = count + 1  # what the filter estimates; the input before it knows
    seen = np.zeros(size)
    seen[measured] = 1.0
    process = np.zeros((estimated, estimated))
    process[:count, :count] = noise.effort**2 * np.outer(disturbs, disturbs)
    process[count, count] = noise.effort_rate**2 * plant.period
    corrects = np.zeros(size)
    corrects[:estimated] = filter_gain(step[:estimated, :estimated], seen[:estimated], process, noise.angle**2)
    return _law(step - np.outer(now, feedback), now, feedback, corrects, ratio * seen, plant.period, limit)


def _law(
    closed: Array, now: Array, feedback: Array, corrects: Array, jumps: Array, period: float, limit: float
) -> control.StateSpace:
    """Return the law whose states are the estimates before each measurement and the command half a period later.

    `closed` is their step under the feedback, `now` the effect of the actuation on them, `corrects` the gain M of the filter.
    They fall by `jumps` per jump of the command; the angle measured is one of them, times the ratio.
    """
    size, half = len(closed), 0.5 * period
    seen = (jumps != 0.0).astype(float)
    after = np.eye(size) - np.outer(corrects, seen)
    by_jump = after @ jumps
    step = np.zeros((size + 1, size + 1))
    step[:size, :size], step[:size, size] = closed @ after, closed @ by_jump
    inputs, direct = np.zeros((size + 1, MAX_INPUTS)), np.zeros(MAX_INPUTS)
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


def lqg(
    drive: GearSet | Drive | str | Path,
    *,
    period: float = 1e-3,
    delay: float = 0.0,
    error: float = 1e-4,
    effort: float | None = None,
    speed_error: float | None = None,
    encoder: Literal["output", "input"] = "output",
    resolution: float = USUAL_RESOLUTION,
    torque_noise: float | None = None,
    disturbance_rate: float | None = None,
) -> control.StateFeedback | control.StateSpace:
    r"""Return the state feedback that minimises a sum of squares of errors and effort, as a sampled controller can.

    .. math:: \sum_k (\theta_{out} / e)^2 + (\omega_{out} / v)^2 + (u / u_0)^2

    with e = error, v = speed_error, u_0 = effort: what is as bad as the other (Bryson's rule). The drive is linearised where it
    rests at the output angle 0, hanging down, with viscous friction alone; its input is held over each period. Put the result
    into `control.Sampled` of the same period and delay.

    Its actuation is a current, or a torque if the motor is a `TorqueSource`: the current loop of any other motor is taken as
    ideal. To simulate it, replace such a motor by `motor.CurrentSource`.

    With encoder="output" all is measured, and the result is a `StateFeedback`. It has no integral: add a `Compensation` whose
    observer takes away constant disturbances.

    With encoder="input" the angle of the motor alone is measured, and the result is a `StateSpace`: a stationary Kalman filter
    estimates the motion of motor and output and a constant torque at the motor, which the law takes away. The design contains
    the delay: put the law into a controller of the same period and delay, where the joint begins at the angle 0. A load torque
    at the output is estimated as one at the motor, so the twist that it causes stays as an error.

    Source: AstromWittenmark1997, sections 11.2 (discrete regulator) and 11.3 (Kalman filter), FranklinPowellEmamiNaeini2002,
    section 7.6 (weights).

    Args:
        drive: with motor and load: a set, a drive, or the name or path of a file
        period, delay: of the controller [s]; the gains are those without delay, and tried with it
        error: of the output angle [rad]
        effort: of the motor, in what it takes [A] or [N.m]; a tenth of its limit if not given
        speed_error: of the output [rad/s]; its speed does not count if not given
        encoder: shafts that are measured: the input and the output, or the input alone
        resolution: step of the input encoder [rad]; its noise is that of rounding
        torque_noise: standard deviation of the motor torque that the model lacks, over each period [N.m]; 1 % of its limit if
            not given
        disturbance_rate: standard deviation by which the constant torque changes in 1 s [N.m/s^(1/2)]; the limit if not
            given. A larger one takes disturbances away faster

    Returns:
        A `StateFeedback`, or a `StateSpace` with encoder="input". Its actuation is a current [A] or a torque [N.m].

    Raises:
        ValueError: as `compensate`; or the loop is not stable with this delay; or the drive has states that its encoders do
            not measure, or more than a `StateSpace`
        TypeError: `drive` is no drive

    >>> law = lqg("robot-joint", error=1e-3)
    >>> law.input_angle != 0.0 and law.output_angle != 0.0
    True
    >>> len(lqg("robot-joint", error=1e-3, encoder="input").C)
    6
    """
    plant = Plant.read(drive, period, delay)
    limit = 0.1 * plant.limit if effort is None else arguments.number("effort", effort, plant.effort_unit, low=0.0)
    by_input = arguments.one_of("encoder", encoder, ("output", "input")) == "input"
    linear = LinearPlant.of(plant)
    cost = linear.cost(error, speed_error)
    if by_input:
        late, noise = linear.held(plant.period, plant.delay), _noise(plant, resolution, torque_noise, disturbance_rate)
        measured = linear.states.index("input_angle")
        return with_filter(late, late.gains(cost, limit), measured, noise, plant.ratio, plant.limit)
    gains = linear.measured_by_encoders().held(plant.period).gains(cost, limit)
    step, driven = linear.held(plant.period, plant.delay).extended
    radius = float(np.abs(np.linalg.eigvals(step - np.outer(driven, np.append(gains, 0.0)))).max())
    if not radius < 1.0:
        raise ValueError(
            f"the loop is not stable with a delay of {plant.delay:g} s: its poles reach {radius:.4f} of the unit circle; "
            "take a larger error, a smaller effort or a shorter delay"
        )
    by_state = dict(zip(linear.states, gains.tolist(), strict=True))
    of_twist = by_state["transmission_error"]
    return control.StateFeedback(
        input_angle=by_state["input_angle"] + of_twist / plant.ratio,
        input_speed=by_state["input_speed"],
        output_angle=-of_twist,
        output_speed=by_state["output_speed"],
        limit=plant.limit,
    )


def _noise(plant: Plant, resolution: float, torque_noise: float | None, disturbance_rate: float | None) -> Noise:
    """Return the noise of an encoder and of the torque, in the unit of the actuation."""
    per_torque, largest = plant.actuation_per_torque, plant.limit / plant.actuation_per_torque
    angle = arguments.number("resolution", resolution, "rad", low=0.0) / np.sqrt(12.0)
    torque, rate = NOISE_SHARE * largest, RATE_SHARE * largest
    if torque_noise is not None:
        torque = arguments.number("torque_noise", torque_noise, "N.m", low=0.0)
    if disturbance_rate is not None:
        rate = arguments.number("disturbance_rate", disturbance_rate, "N.m/s^(1/2)", low=0.0)
    return Noise(angle=angle, effort=per_torque * torque, effort_rate=per_torque * rate)
