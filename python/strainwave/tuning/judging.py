"""Controllers judged by their figures on gears that a drive may have."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core
from strainwave.parameters import every
from strainwave.presentation import Presented
from strainwave.simulation.ensemble import EnsembleWarning, simulate_many
from strainwave.simulation.excitation import ROOM_TEMPERATURE
from strainwave.tuning import goals
from strainwave.tuning.candidates import ControllerCandidate
from strainwave.tuning.cascade import Plant
from strainwave.tuning.goals import Goal

Array = NDArray[np.float64]

MIN_SHARE_OF_LIMIT = 0.999  # actuation over the limit of the motor, from which on the motor is at its limit
MAX_SHARE_AT_LIMIT = 0.01  # of the time, of a run that counts
AT_LIMIT = "the motor is at its limit"  # reason of a run that failed
MAX_STEP = 2e-4  # s, of the simulation
STEP_OF_VIBRATION = 0.7  # rad of the fastest vibration in a step, so that a stiffer gear is followed, too


@dataclass(frozen=True)
class Judged(Presented):
    """A controller, and its figures on drawn gears.

    Attributes:
        candidate: the controller
        figures: on each drawn gear, shape (members,), by name; not a number where a run did not end
        nominal: on the gear as its numbers have it, by name
        reason: why a run failed; empty if none did
    """

    candidate: ControllerCandidate
    figures: Mapping[str, Array]
    nominal: Mapping[str, float]
    reason: str = ""

    @property
    def failures(self) -> int:
        """Number of runs that failed."""
        return int(np.isnan(next(iter(self.figures.values()))).sum())

    def median(self, name: str) -> float:
        """Return the median of a figure; infinite if half of the runs did not end."""
        return float(np.median(self._or_infinite(name)))

    def upper(self, name: str) -> float:
        """Return what 95 % of the drawn gears stay below."""
        return float(np.quantile(self._or_infinite(name), goals.UPPER_QUANTILE, method="higher"))

    def _or_infinite(self, name: str) -> Array:
        values = self.figures[name]
        return np.where(np.isnan(values), np.inf, values)

    def _headline(self) -> str:
        return f"{self.candidate.name}: {self.reason}" if self.reason else self.candidate.name


def judged(
    candidate: ControllerCandidate, goal: Goal, draws: Mapping[str, Array], plant: Plant, temperature: float = ROOM_TEMPERATURE
) -> Judged:
    """Return a controller with its figures on drawn gears; the gear as its numbers have it is run first among them.

    A run fails if it does not end, if the goal has no figures for it, or if it drives the motor at its limit for more than a
    hundredth of the time, as a loop does that is not stable.
    """
    nominal = numbers(candidate.drive, draws)
    whole = {path: np.concatenate(([nominal[path]], values)) for path, values in draws.items()}
    step = min(MAX_STEP, STEP_OF_VIBRATION / _core.max_rate(candidate.drive, 0.0))
    effort = "current" if candidate.drive.motor.name == "current_source" else "motor_torque"
    recorded = ["output_angle", "output_speed", effort]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EnsembleWarning)  # failures are counted
        runs = simulate_many(
            candidate.drive, goal.command, whole, step, record=recorded, sample=plant.period, temperature=temperature
        )
    later = runs.time >= goals.SETTLING_SHARE * goal.command.duration
    at_limit = np.mean(np.abs(runs[effort][:, later]) > MIN_SHARE_OF_LIMIT * plant.limit, axis=1) > MAX_SHARE_AT_LIMIT
    with np.errstate(over="ignore", invalid="ignore"):  # of a run that grows without bound
        measured = goal.figures(runs, goal.command)
    figures = {name: np.where(at_limit, np.nan, values) for name, values in measured.items()}
    stopped = AT_LIMIT if at_limit.any() else "the output does not move"
    reason = next(iter(runs.failures.values()), stopped if np.isnan(figures[goal.judged_by]).any() else "")
    return Judged(
        candidate,
        {name: values[1:] for name, values in figures.items()},
        {name: float(values[0]) for name, values in figures.items()},
        reason,
    )


def numbers(drive: Drive, paths: Mapping[str, Array]) -> dict[str, float]:
    """Return the numbers of a drive that have these paths."""
    known = every(drive)
    return {path: known[path].value for path in paths}
