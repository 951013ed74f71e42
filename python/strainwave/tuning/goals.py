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
REST_AFTER_MOTION = 0.5  # s: longer than any loop of interest settles
SETTLING_BAND_SHARE = 5e-4  # of the travel, within which the error of a position that has settled stays
TORQUE_BAND_SHARE = 0.05  # of the torque, likewise
MAX_STICKING_SPEED_SHARE = 0.1  # of the commanded speed: below it the output rests
# Of the time, of a run that counts: an output that does not move has a ripple of 1, which is less than that of one that slips.
MAX_REST_SHARE = 0.9
SETTLING_TIME = "settling time"  # name of the figure
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
        speed: largest speed of the output [rad/s]
        secondary_figure: printed after that by which controllers are judged
        pace: of the motion, the angular frequency at which it repeats [rad/s]; 0 if it does not
        per_angle: factor of an error, the stiffness of a stop for a torque [N.m/rad]
    """

    name: str
    judged_by: str
    command: Scenario
    figures: Callable[[Ensemble, Scenario], Mapping[str, Array]]
    units: Mapping[str, str]
    speed: float
    secondary_figure: str
    pace: float = 0.0
    per_angle: float = 1.0


@dataclass(frozen=True)
class _ToAndFro:
    """A motion to and fro, twice, and to the other end, where it rests.

    Attributes:
        command: of the output
        period: of the motion [s]
        end: of the motion [s]
        scale: of the figures, per angle of the output
        band: of the error at rest, in the unit of the figures
    """

    command: Scenario
    period: float
    end: float
    scale: float
    band: float

    @classmethod
    def of(cls, travel: float, speed: float, sample: float, scale: float, band: float) -> _ToAndFro:
        """Return the motion in set-points of a sampled controller, each with value and rate of a sine."""
        samples = 2 * max(round(0.5 * np.pi * travel / speed / sample), 1)
        period = samples * sample
        time: Array = sample * np.arange(5 * samples // 2 + 1, dtype=np.float64)
        phase = 2.0 * np.pi * time / period
        level, slope = 0.5 * travel * (1.0 - np.cos(phase)), np.pi * travel / period * np.sin(phase)
        level[-1], slope[-1] = travel, 0.0
        return cls(Scenario(float(time[-1]) + REST_AFTER_MOTION, time, level, slope), period, float(time[-1]), scale, band)

    def figures(self, runs: Ensemble, error_name: str) -> dict[str, Array]:
        """Return the figures of the second motion and of the rest."""
        time, rest = runs.time, runs.time >= self.end
        later = (time >= self.period) & (time < 2.0 * self.period)
        error = self.scale * (self.command.value(time) - runs["output_angle"])
        phase = (time / self.period) % 0.5
        near = later & (np.minimum(phase, 0.5 - phase) < AROUND_REVERSAL)
        return {
            error_name: _rms(error[:, later]),
            "largest error": np.abs(error[:, later]).max(axis=1),
            "error at reversals": np.abs(error[:, near]).max(axis=1),
            SETTLING_TIME: _settling(time[rest] - self.end, error[:, rest], self.band),
            "effort of the motor": _rms(_effort(runs)[:, later]),
        }


def _settling(time: Array, error: Array, band: float) -> Array:
    """Return the time after which an error stays within a band; infinite if it ends outside."""
    outside = ~(np.abs(error) <= band)
    after_last = error.shape[1] - np.argmax(outside[:, ::-1], axis=1)
    settled = np.where(outside.any(axis=1), np.append(time, np.inf)[after_last], 0.0)
    return np.where(np.isnan(error).any(axis=1), np.nan, settled)


def to_and_fro(travel: float, speed: float) -> Scenario:
    """Return two periods of a sine from 0 to a travel [rad] and back, at up to a speed [rad/s]."""
    period = np.pi * travel / speed
    return scenario.sine(0.5 * travel, 1.0 / period, 2.0 * period, phase=-0.5 * np.pi, offset=0.5 * travel)


def position(travel: float, speed: float, effort_unit: str, sample: float = 1e-3) -> Goal:
    """Return the goal of a position that goes to and fro and then rests: tracking, reversals and settling.

    Args:
        travel: of the output, from end to end [rad]
        speed: largest, of the output [rad/s]
        sample: period of the set-points [s]
    """
    motion = _ToAndFro.of(travel, speed, sample, 1.0, SETTLING_BAND_SHARE * travel)
    return _goal_of_motion("position", "tracking error", "rad", motion, speed, effort_unit)


def torque(torque: float, stiffness: float, speed: float, effort_unit: str, sample: float = 1e-3) -> Goal:
    """Return the goal of a torque against a stop that goes to and fro and then rests at none.

    The command is the angle of the output at which the stop takes the torque that is wanted.

    Args:
        torque: from end to end [N.m]
        stiffness: of the stop [N.m/rad]
    """
    motion = _ToAndFro.of(torque / stiffness, speed, sample, stiffness, TORQUE_BAND_SHARE * torque)
    return _goal_of_motion("torque", "torque error", "N.m", motion, speed, effort_unit)


def _goal_of_motion(name: str, judged_by: str, unit: str, motion: _ToAndFro, speed: float, effort_unit: str) -> Goal:
    units = {
        judged_by: unit,
        "largest error": unit,
        "error at reversals": unit,
        SETTLING_TIME: "s",
        "effort of the motor": effort_unit,
    }
    return Goal(
        name, judged_by, motion.command, lambda runs, _: motion.figures(runs, judged_by), units, speed, SETTLING_TIME,
        2.0 * np.pi / motion.period, motion.scale,
    )  # fmt: skip


def speed(speed: float, duration: float, effort_unit: str) -> Goal:
    """Return the goal of a constant speed of the output [rad/s], over a duration [s]; the motor takes an `effort_unit`."""
    command = scenario.ramp(speed, duration)
    units = {"speed ripple": "1", "position error": "rad", "effort of the motor": effort_unit}
    return Goal("speed", "speed ripple", command, _of_speed, units, speed, "position error")


def smooth(speed: float, duration: float, effort_unit: str) -> Goal:
    """Return the goal of a motion that creeps at a speed of the output [rad/s] without sticking, over a duration [s]."""
    command = scenario.ramp(speed, duration)
    units = {"speed ripple": "1", "time at rest": "1", "position error": "rad", "effort of the motor": effort_unit}
    return Goal("smooth", "speed ripple", command, _of_creeping, units, speed, "time at rest")


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
