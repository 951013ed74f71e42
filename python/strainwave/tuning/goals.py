"""Goals of a controller: the motion that is asked for, and what is measured of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave.simulation import scenario
from strainwave.simulation.ensemble import Ensemble
from strainwave.simulation.scenario import Scenario

Array = NDArray[np.float64]

AROUND_REVERSAL = 0.1  # of a period, either side of a reversal
SETTLING_SHARE = 0.5  # of a run, left out at its begin
MAX_STICKING_SPEED_SHARE = 0.1  # of the commanded speed: below it the output rests
# Of the time, of a run that counts: an output that does not move has a ripple of 1, which is less than that of one that slips.
MAX_REST_SHARE = 0.9
UPPER_QUANTILE = 0.95  # of figures over drawn gears


@dataclass(frozen=True)
class Goal:
    """A motion, and what is measured of it.

    Attributes:
        name: of the goal
        judged_by: the figure that is to become small
        command: of the output
        figures: of an ensemble, each of shape (members,), by name
        units: of the figures
        pace: of the motion, the angular frequency at which it repeats [rad/s]; 0 if it does not
    """

    name: str
    judged_by: str
    command: Scenario
    figures: Callable[[Ensemble, Scenario], Mapping[str, Array]]
    units: Mapping[str, str]
    pace: float = 0.0


def position(travel: float, speed: float, effort_unit: str) -> Goal:
    """Return the goal of a position that goes to and fro: tracking and reversals.

    Args:
        travel: of the output, from end to end [rad]
        speed: largest, of the output [rad/s]
        effort_unit: of what the motor takes
    """
    period = np.pi * travel / speed
    command = scenario.sine(0.5 * travel, 1.0 / period, 2.0 * period, phase=-0.5 * np.pi, offset=0.5 * travel)
    units = {"tracking error": "rad", "largest error": "rad", "error at reversals": "rad", "effort of the motor": effort_unit}
    return Goal(
        "position", "tracking error", command, lambda runs, of: _of_position(runs, of, period), units, 2.0 * np.pi / period
    )


def speed(speed: float, duration: float, effort_unit: str) -> Goal:
    """Return the goal of a constant speed of the output [rad/s], over a duration [s]; the motor takes an `effort_unit`."""
    command = scenario.ramp(speed, duration)
    units = {"speed ripple": "1", "position error": "rad", "effort of the motor": effort_unit}
    return Goal("speed", "speed ripple", command, _of_speed, units)


def smooth(speed: float, duration: float, effort_unit: str) -> Goal:
    """Return the goal of a motion that creeps at a speed of the output [rad/s] without sticking, over a duration [s]."""
    command = scenario.ramp(speed, duration)
    units = {"speed ripple": "1", "time at rest": "1", "position error": "rad", "effort of the motor": effort_unit}
    return Goal("smooth", "speed ripple", command, _of_creeping, units)


def _of_position(runs: Ensemble, command: Scenario, period: float) -> dict[str, Array]:
    time = runs.time
    later = time >= SETTLING_SHARE * command.duration
    error = command.value(time) - runs["output_angle"]
    phase = (time / period) % 0.5
    near = later & (np.minimum(phase, 0.5 - phase) < AROUND_REVERSAL)
    return {
        "tracking error": _rms(error[:, later]),
        "largest error": np.abs(error[:, later]).max(axis=1),
        "error at reversals": np.abs(error[:, near]).max(axis=1),
        "effort of the motor": _rms(_effort(runs)[:, later]),
    }


def _of_speed(runs: Ensemble, command: Scenario) -> dict[str, Array]:
    later = runs.time >= SETTLING_SHARE * command.duration
    wanted = command.rate(runs.time)
    error = (command.value(runs.time) - runs["output_angle"])[:, later]
    ripple = (runs["output_speed"] / wanted - 1.0)[:, later]
    return {
        "speed ripple": _rms(ripple),
        "position error": _rms(error),
        "effort of the motor": _rms(_effort(runs)[:, later]),
    }


def _of_creeping(runs: Ensemble, command: Scenario) -> dict[str, Array]:
    later = runs.time >= SETTLING_SHARE * command.duration
    share = (runs["output_speed"] / command.rate(runs.time))[:, later]
    at_rest = np.mean(np.abs(share) < MAX_STICKING_SPEED_SHARE, axis=1)
    figures = _of_speed(runs, command) | {"time at rest": at_rest}
    return {name: np.where(at_rest > MAX_REST_SHARE, np.nan, values) for name, values in figures.items()}


def _effort(runs: Ensemble) -> Array:
    return runs.columns["motor_torque" if "motor_torque" in runs.columns else "current"]


def _rms(values: Array) -> Array:
    return np.asarray(np.sqrt(np.mean(values**2, axis=1)))
