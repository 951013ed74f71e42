"""Creeping of a pointing joint by each compensation, on gears that differ from the model: `python -m tests.evidence.creeping`.

Three cases: friction at the input that falls with the speed, under a controller of 100 Hz by a speed that lags behind by 5 ms,
and of 1 kHz by a lag of 0.5 ms; and such friction at the output as well, under the latter. Each compensation is tried in
cascades of several sharpnesses. Of these the one with the least 95 % of the ripple is printed: ripple and time at rest of the
joint as its numbers have it, and of drawn gears. Their friction, torsion and kinematic error differ by a factor of up to 1.3.
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
from collections.abc import Iterator

import numpy as np
import strainwave as sw
from strainwave.parameters import every
from strainwave.tuning.candidates import BRISTLE_GAIN, BRISTLE_SHARE, with_effects
from strainwave.tuning.cascade import Plant, Setting, bare, model_of, observer_of, tuned_law
from strainwave.tuning.drawn import drawn_gears
from strainwave.tuning.goals import MAX_REST_SHARE, MAX_STICKING_SPEED_SHARE, SETTLING_SHARE, UPPER_QUANTILE

COLD = {"gear.friction_input.reference_temperature": 293.15 + 40.0}  # K: friction as it is at -20 degC
SEAL = {"gear.friction_output": sw.friction.Stribeck(coulomb=0.3, breakaway=0.6, stribeck_speed=5e-4)}
RATIO = 100.0
LONGEST = 40.0  # s


@dataclasses.dataclass(frozen=True)
class Case:
    """A joint under a controller.

    Attributes:
        name: where its friction is
        plant: with its controller's period
        sharpnesses: of the cascades
        speeds: of the input [rad/s]
    """

    name: str
    plant: Plant
    sharpnesses: tuple[float, ...]
    speeds: tuple[float, ...]


@dataclasses.dataclass(frozen=True)
class CreepFigures:
    """Figures of a controller: ripple and share of the time at rest, first of the joint as it is stated, then of drawn ones."""

    ripple: np.ndarray
    at_rest: np.ndarray
    sharpness: float

    @property
    def upper(self) -> float:
        """Ripple that 95 % of the drawn gears stay below; infinite if more than a few hardly move."""
        moving = np.where(self.at_rest > MAX_REST_SHARE, np.inf, self.ripple)
        return float(np.quantile(moving[1:], UPPER_QUANTILE, method="higher"))

    def __str__(self) -> str:
        drawn = self.at_rest[1:]
        return (
            f"{self.ripple[0]:6.2f} {self.at_rest[0]:6.0%} {np.median(self.ripple[1:]):7.2f} {self.upper:6.2f} "
            f"{(drawn > 0.0).sum():6} {drawn.max():6.0%}   {self.sharpness:g}"
        )


def cases() -> Iterator[Case]:
    """Yield all cases."""
    yield Case("friction at the input", plant_of(0.01, 5e-3, COLD), (1.0, 0.5), (0.05, 0.1, 0.2, 0.4, 0.7, 1.0, 2.0))
    yield Case("friction at the input, 1 kHz", plant_of(1e-3, 5e-4, COLD), (0.5,), (0.05, 0.2, 0.7, 2.0))
    yield Case("friction at the output, too", plant_of(1e-3, 5e-4, COLD | SEAL), (0.5, 0.35, 0.25), (0.05, 0.1, 0.15, 0.2, 0.4))


def plant_of(period: float, lag: float, changes: dict[str, object]) -> Plant:
    """Return the pointing joint under a controller of this period [s], by a measured speed of this lag [s]."""
    plant = Plant.of(sw.GearSet.read("space-pointing-joint"), period=period, delay=0.0)
    sensors = sw.Sensors(input_speed=sw.sensor.FirstOrder(time_constant=lag))
    drive = plant.drive.replace(sensors=sensors, thermal=sw.thermal.Isothermal()).replace(changes)
    return dataclasses.replace(plant, drive=drive)


def controllers(plant: Plant, sharpness: float) -> Iterator[tuple[str, sw.Drive]]:
    """Yield the drive under each compensation."""
    setting = Setting(sharpness, "input", 0.5)
    law, gear, observer = tuned_law(plant, setting), plant.drive.gear, observer_of(plant, setting)
    line, model = model_of(plant, bare(gear)), model_of(plant, with_effects(gear, ("friction",)))
    bristles = sw.compensation.BristleObserver(
        friction=gear.friction_input,
        friction_share=BRISTLE_SHARE,
        bristle_gain=BRISTLE_GAIN,
        position_gain=law.position_gain,
    )
    dither = sw.compensation.Dither(amplitude=0.04, frequency=40.0)
    parts = {
        "cascade": sw.Compensation(feedforward=line),
        "cascade, disturbance observer": sw.Compensation(feedforward=line, observer=observer),
        "model of friction": sw.Compensation(feedforward=model),
        "model of friction, disturbance observer": sw.Compensation(feedforward=model, observer=observer),
        "bristle observer": sw.Compensation(feedforward=line, observer=bristles),
        "dither": sw.Compensation(feedforward=line, dither=dither),
    }
    for name, part in parts.items():
        yield name, plant.controlled(law, part.replace(actuation_per_torque=plant.actuation_per_torque))


def crept(drive: sw.Drive, speed: float, numbers: dict[str, np.ndarray], sharpness: float) -> CreepFigures:
    """Return the figures over the second half of a ramp."""
    duration = min(max(4.0, 6.0 / speed), LONGEST)
    command = sw.scenario.ramp(speed / RATIO, duration)
    runs = sw.simulate_many(drive, command, numbers, 2e-4, record=["output_speed"], sample=2e-3 if duration < 10.0 else 1e-2)
    share = RATIO * runs["output_speed"][:, runs.time > SETTLING_SHARE * duration] / speed
    at_rest = np.mean(np.abs(share) < MAX_STICKING_SPEED_SHARE, axis=1)
    return CreepFigures(np.sqrt(np.mean((share - 1.0) ** 2, axis=1)), at_rest, sharpness)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--members", type=int, default=40, help="gears drawn (40)")
    wanted = parser.parse_args()
    for case in cases():
        drive = case.plant.drive
        draws = drawn_gears(sw.GearSet.of(drive, name="pointing joint", source="assumed"), wanted.members, seed=3)
        numbers = {path: np.concatenate(([every(drive)[path].value], values)) for path, values in draws.items()}
        for speed in case.speeds:
            tried: dict[str, list[CreepFigures]] = {}
            for sharpness in case.sharpnesses:
                for name, each in controllers(case.plant, sharpness):
                    tried.setdefault(name, []).append(crept(each, speed, numbers, sharpness))
            print(f"\n{case.name}, {speed:g} rad/s of the input")
            print(f"{'':42} ripple   rest  median   95 % at rest longest   sharpness")
            for name, found in tried.items():
                print(f"{name:42} {min(found, key=lambda each: each.upper)}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
