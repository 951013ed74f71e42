"""A linear-quadratic regulator for a drive and the period of its controller: by all that is measured, or by the input alone."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Literal, overload

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, arguments, control
from strainwave.files.gear_set import GearSet
from strainwave.tuning.cascade import Plant
from strainwave.tuning.kalman import Noise, with_filter
from strainwave.tuning.linear_plant import LinearPlant

Array = NDArray[np.float64]
USUAL_RESOLUTION = 2.0 * np.pi / 2**14  # rad: an encoder of 14 bit on the motor
NOISE_SHARE = 0.01  # of the torque limit, as the standard deviation of the torque over a period
RATE_SHARE = 1.0  # of the torque limit, by which the disturbance wanders in 1 s


@overload
def lqg(
    drive: GearSet | Drive | str | Path,
    *,
    period: float = ...,
    delay: float = ...,
    error: float = ...,
    effort: float | None = ...,
    speed_error: float | None = ...,
    encoder: Literal["output"] = ...,
) -> control.StateFeedback: ...


@overload
def lqg(
    drive: GearSet | Drive | str | Path,
    *,
    period: float = ...,
    delay: float = ...,
    error: float = ...,
    effort: float | None = ...,
    speed_error: float | None = ...,
    encoder: Literal["input"],
    resolution: float = ...,
    torque_noise: float | None = ...,
    disturbance_rate: float | None = ...,
) -> control.StateSpace: ...


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
    _check_with_delay(linear, gains, plant)
    return _state_feedback(plant, dict(zip(linear.states, gains.tolist(), strict=True)))


def _state_feedback(plant: Plant, gains: Mapping[str, float]) -> control.StateFeedback:
    """Return the law of both shafts that has these gains of the states."""
    of_twist = gains["transmission_error"]
    return control.StateFeedback(
        input_angle=gains["input_angle"] + of_twist / plant.ratio,
        input_speed=gains["input_speed"],
        output_angle=-of_twist,
        output_speed=gains["output_speed"],
        limit=plant.limit,
    )


def _noise(plant: Plant, resolution: float, torque_noise: float | None, disturbance_rate: float | None) -> Noise:
    """Return the noise of an encoder and of the torque, in the unit of the actuation."""
    per_torque, largest = plant.actuation_per_torque, plant.limit / plant.actuation_per_torque
    return Noise(
        angle=arguments.number("resolution", resolution, "rad", low=0.0) / np.sqrt(12.0),
        effort=per_torque * _or_share("torque_noise", torque_noise, "N.m", NOISE_SHARE * largest),
        effort_rate=per_torque * _or_share("disturbance_rate", disturbance_rate, "N.m/s^(1/2)", RATE_SHARE * largest),
    )


def _or_share(name: str, value: float | None, unit: str, usual: float) -> float:
    return usual if value is None else arguments.number(name, value, unit, low=0.0)


def _check_with_delay(linear: LinearPlant, gains: Array, plant: Plant) -> None:
    """
    Raises:
        ValueError: the loop is not stable where the output comes late
    """
    step, driven = linear.held(plant.period, plant.delay).extended
    loop = step - np.outer(driven, np.append(gains, 0.0))
    radius = float(np.abs(np.linalg.eigvals(loop)).max())
    if not radius < 1.0:
        raise ValueError(
            f"the loop is not stable with a delay of {plant.delay:g} s: its poles reach {radius:.4f} of the unit circle; "
            "take a larger error, a smaller effort or a shorter delay"
        )
