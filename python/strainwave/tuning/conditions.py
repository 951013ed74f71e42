"""Other conditions than those by which a controller is chosen: speeds, loads and temperatures, and less of an effect."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.parameters import every
from strainwave.presentation import Presented
from strainwave.tuning.candidates import EFFECTS
from strainwave.tuning.cascade import Plant
from strainwave.tuning.drawn import scales
from strainwave.tuning.goals import Goal
from strainwave.tuning.judging import Judged, judged
from strainwave.tuning.steady_torque import steady_torque

Array = NDArray[np.float64]

PACES = {"half the speed": 0.5, "1.5 times the speed": 1.5}
INERTIAS = {"half the inertia of the load": 0.5, "1.5 times the inertia of the load": 1.5}
TEMPERATURES = {"cold, 0 °C": 273.15, "warm, 60 °C": 333.15}  # K
INITIAL_TEMPERATURE = "thermal.initial_temperature"  # of a gear that heats up; that of any other is the temperature around it
SMALLER_BY = (1.25, 1.5, 2.0, 3.0)  # factors of an effect, of which the drive has less than the model
SPEED_OF_FRICTION = 20.0  # rad/s of the input, at which friction is compared between temperatures


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
        controllers: cascade and controller
        goal_at: the goal at a speed, as a share of that by which they were chosen
        draws: numbers of drawn gears, by path
        plant: the drive
    """

    def at(name: str, goal: Goal, drawn: Mapping[str, Array], **changes: float) -> ConditionResult:
        return ConditionResult(name, *(judged(each.candidate, goal, drawn, plant, **changes) for each in controllers))

    usual = goal_at(1.0)
    for name, pace in PACES.items():
        yield at(name, goal_at(pace), draws)
    numbers, members = every(plant.drive), len(controllers[0].figures[usual.judged_by])
    inertia = draws.get("load.inertia", np.full(members, numbers["load.inertia"].value))
    for name, factor in INERTIAS.items():
        yield at(name, usual, {**draws, "load.inertia": factor * inertia})
    if depends_on_temperature(plant.drive):
        for name, temperature in TEMPERATURES.items():
            start = {INITIAL_TEMPERATURE: np.full(members, temperature)} if INITIAL_TEMPERATURE in numbers else {}
            yield at(name, usual, {**draws, **start}, temperature=temperature)


def depends_on_temperature(drive: Drive) -> bool:
    """True if friction or spring of a gear change with its temperature."""
    cold, warm = (steady_torque(drive.gear, SPEED_OF_FRICTION, temperature=each).friction for each in TEMPERATURES.values())
    return bool(cold != warm) or any(
        number.value and number.unit == "1/K" for path, number in every(drive).items() if path.startswith("gear.softening")
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
    begins = tuple(f"gear.{part}." for part in EFFECTS[effect])
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
