"""Controllers judged by their figures on gears that a drive may have."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core
from strainwave.parameters import every
from strainwave.presentation import Presented
from strainwave.simulation.ensemble import EnsembleWarning, simulate_many
from strainwave.simulation.excitation import ROOM_TEMPERATURE
from strainwave.tuning import goals
from strainwave.tuning.candidates import GEAR_EFFECTS, ControllerCandidate
from strainwave.tuning.cascade import Plant, steady_torque
from strainwave.tuning.drawn import scales
from strainwave.tuning.goals import Goal

Array = NDArray[np.float64]

MIN_SHARE_OF_LIMIT = 0.999  # actuation over the limit of the motor, from which on the motor is at its limit
MAX_SHARE_AT_LIMIT = 0.01  # of the time, of a run that counts
AT_LIMIT = "the motor is at its limit"  # reason of a run that failed
MAX_STEP = 2e-4  # s, of the simulation
STEP_OF_VIBRATION = 0.7  # rad of the fastest vibration in a step, so that a stiffer gear is followed, too
OTHER_PACES = {"half the speed": 0.5, "1.5 times the speed": 1.5}
OTHER_INERTIAS = {"half the inertia of the load": 0.5, "1.5 times the inertia of the load": 1.5}
OTHER_TEMPERATURES = {"cold, 0 °C": 273.15, "warm, 60 °C": 333.15}  # K
INITIAL_TEMPERATURE = "thermal.initial_temperature"  # of a gear that heats up; that of any other is the temperature around it
SMALLER_BY = (1.25, 1.5, 2.0, 3.0)  # factors of an effect, of which the drive has less than the model
SPEED_OF_FRICTION = 20.0  # rad/s of the input, at which friction is compared between temperatures


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

    @property
    def settles(self) -> bool:
        """True if the output comes to rest on more than half of the drawn gears, or if its goal has no rest."""
        return goals.SETTLING_TIME not in self.figures or bool(np.isfinite(self.median(goals.SETTLING_TIME)))

    def is_as_good_as(self, other: Judged, name: str) -> bool:
        """True if a figure exceeds that of another controller, on the same gears, by no more than the difference scatters."""
        excess = self._or_infinite(name) - other._or_infinite(name)
        return bool(np.isfinite(excess).all() and excess.mean() <= excess.std())

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
    of_drive = every(drive)
    return {path: of_drive[path].value for path in paths}


@dataclass(frozen=True)
class ConditionResult(Presented):
    """Both controllers, neither tuned anew, under another condition.

    Attributes:
        name: of the condition
        baseline, chosen: the cascade and the controller chosen, on the same drawn gears
    """

    name: str
    baseline: Judged
    chosen: Judged


def conditions(
    controllers: tuple[Judged, Judged], goal_at: Callable[[float], Goal], draws: Mapping[str, Array], plant: Plant
) -> Iterator[ConditionResult]:
    """Yield cascade and controller at other speeds, load inertias and temperatures.

    Args:
        goal_at: the goal at a speed, as a share of that by which they were chosen
    """

    def at(name: str, goal: Goal, drawn: Mapping[str, Array], **changes: float) -> ConditionResult:
        return ConditionResult(name, *(judged(each.candidate, goal, drawn, plant, **changes) for each in controllers))

    usual = goal_at(1.0)
    for name, pace in OTHER_PACES.items():
        yield at(name, goal_at(pace), draws)
    numbers, members = every(plant.drive), len(controllers[0].figures[usual.judged_by])
    inertia = draws.get("load.inertia", np.full(members, numbers["load.inertia"].value))
    for name, factor in OTHER_INERTIAS.items():
        yield at(name, usual, {**draws, "load.inertia": factor * inertia})
    if depends_on_temperature(plant.drive):
        for name, temperature in OTHER_TEMPERATURES.items():
            start = {INITIAL_TEMPERATURE: np.full(members, temperature)} if INITIAL_TEMPERATURE in numbers else {}
            yield at(name, usual, {**draws, **start}, temperature=temperature)


def depends_on_temperature(drive: Drive) -> bool:
    """True if friction, spring or kinematic error of a gear change with its temperature."""
    cold, warm = (
        steady_torque(drive.gear, SPEED_OF_FRICTION, temperature=each).friction for each in OTHER_TEMPERATURES.values()
    )
    return bool(cold != warm) or any(
        number.value and number.unit in ("1/K", "rad/K")
        for path, number in every(drive).items()
        if path.startswith(("gear.softening", "gear.kinematic_error"))
    )


@dataclass(frozen=True)
class OverCompensation(Presented):
    """Cascade and controller on a drive that has less of an effect than the model.

    Attributes:
        effect: of which there is less
        factors: by which there is less, shape (n,)
        baseline, chosen: figure of cascade and controller at each factor, shape (n,); not a number where the run failed
    """

    effect: str
    factors: Array
    baseline: Array
    chosen: Array

    @property
    def gains_up_to(self) -> float:
        """Largest factor up to which the figure stays below that of the cascade; 1 if it does at none."""
        return self._up_to(self.chosen < self.baseline)

    @property
    def stable_up_to(self) -> float:
        """Largest factor up to which no run fails; 1 if the first does."""
        return self._up_to(~np.isnan(self.chosen))

    def _up_to(self, holds: NDArray[np.bool_]) -> float:
        count = int(np.argmin(np.append(holds, False)))
        return float(self.factors[count - 1]) if count else 1.0


def over_compensation(controllers: tuple[Judged, Judged], goal: Goal, plant: Plant) -> Iterator[OverCompensation]:
    """Yield for each effect that the model of a controller has, cascade and controller on drives that have less of it."""
    factors = np.array(SMALLER_BY)
    for effect in controllers[1].candidate.effects:
        drives = smaller_effect(plant.drive, effect, factors)
        before, after = (judged(each.candidate, goal, drives, plant).figures[goal.judged_by] for each in controllers)
        yield OverCompensation(effect, factors, before, after)


def smaller_effect(drive: Drive, effect: str, factors: Array) -> dict[str, Array]:
    """Return numbers of drives of which an effect is smaller by factors: a spring has less twist if its torques are larger."""
    begins = tuple(f"gear.{part}." for part in GEAR_EFFECTS[effect])
    there = {
        path: number
        for path, number in every(drive).items()
        if path.startswith(begins) and number.value and scales(path, number.unit)
    }
    return {
        path: np.clip(
            number.value * (factors if effect == "torsion" and number.unit != "rad" else 1.0 / factors), number.low, number.high
        )
        for path, number in there.items()
    }
