"""A linear-quadratic regulator: gains of a state feedback for a drive and the period of its controller."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, arguments, control
from strainwave.files.gear_set import GearSet
from strainwave.tuning.cascade import Plant, gear_set_of
from strainwave.tuning.linear_plant import LinearPlant

Array = NDArray[np.float64]


def regulator(
    drive: GearSet | Drive | str | Path,
    *,
    period: float = 1e-3,
    delay: float = 0.0,
    error: float = 1e-4,
    effort: float | None = None,
    speed_error: float | None = None,
) -> control.StateFeedback:
    r"""Return the state feedback that minimises a sum of squares of errors and effort, as a sampled controller can.

    .. math:: \sum_k (\theta_{out} / e)^2 + (\omega_{out} / v)^2 + (u / u_0)^2

    with e = error, v = speed_error, u_0 = effort: what is as bad as the other (Bryson's rule). The drive is linearised where it
    rests at the output angle 0, hanging down, with viscous friction alone; its input is held over each period. Put the result
    into `control.Sampled`, with a `Compensation` whose observer takes away constant disturbances, as it has no integral.

    Source: AstromWittenmark1997, section 11.2 (discrete regulator), FranklinPowellEmamiNaeini2002, section 7.6 (weights).

    Args:
        drive: with motor and load: a set, a drive, or the name or path of a file
        period, delay: of the controller [s]; the gains are those without delay, and tried with it
        error: of the output angle [rad]
        effort: of the motor, in what it takes [A] or [N.m]; a tenth of its limit if not given
        speed_error: of the output [rad/s]; its speed does not count if not given

    Raises:
        ValueError: as `compensate`; or the loop is not stable with this delay

    >>> law = regulator("robot-joint", error=1e-3)
    >>> law.input_angle != 0.0 and law.output_angle != 0.0
    True
    """
    plant = Plant.of(
        gear_set_of(drive),
        arguments.number("period", period, "s", low=0.0),
        arguments.number("delay", delay, "s", "[]", 0.0, period),
    )
    weight = 1.0 / arguments.number("error", error, "rad", low=0.0) ** 2
    limit = 0.1 * plant.limit if effort is None else arguments.number("effort", effort, plant.effort_unit, low=0.0)
    linear = LinearPlant.of(plant)
    states, output = linear.states, linear.output
    speed = 0.0 if speed_error is None else 1.0 / arguments.number("speed_error", speed_error, "rad/s", low=0.0) ** 2
    cost = weight * np.outer(output, output)
    cost[states.index("output_speed"), states.index("output_speed")] += speed
    gains = _gains(linear, cost, 1.0 / limit**2, plant.period)
    _check_with_delay(linear, gains, plant)
    found = dict(zip(states, gains, strict=True))
    of_twist = found["transmission_error"]
    return control.StateFeedback(
        input_angle=found["input_angle"] + of_twist / plant.ratio,
        input_speed=found["input_speed"],
        output_angle=-of_twist,
        output_speed=found["output_speed"],
        limit=plant.limit,
    )


def _gains(linear: LinearPlant, cost: Array, effort: float, period: float) -> Array:
    """Return the gains K of u = -K x that minimise the sum of squares, by the discrete Riccati equation."""
    from scipy.linalg import solve_discrete_are

    step, held = linear.held(period)
    try:
        value = solve_discrete_are(step, held[:, np.newaxis], cost, np.array([[effort]]))
    except np.linalg.LinAlgError as error:
        raise ValueError(f"no regulator is found for this drive and these weights: {error}") from None
    return np.asarray(held @ value @ step / (effort + held @ value @ held))


def _check_with_delay(linear: LinearPlant, gains: Array, plant: Plant) -> None:
    """
    Raises:
        ValueError: the loop is not stable where the output comes late
    """
    step, held = linear.held_late(plant.period, plant.delay)
    loop = step - np.outer(held, np.append(gains, 0.0))
    radius = float(np.abs(np.linalg.eigvals(loop)).max())
    if not radius < 1.0:
        raise ValueError(
            f"the loop is not stable with a delay of {plant.delay:g} s: its poles reach {radius:.4f} of the unit circle; "
            "take a larger error, a smaller effort or a shorter delay"
        )
