"""Coverage of intervals of a misalignment from the current of drives: `python -m tests.evidence.recovered_misalignment`.

Each unit has other friction, stiffness, inertia, load and torque constant, drawn by what the set knows of them, other noise and
another misalignment: an eccentricity, a tilt, or both. The diagnosis has the numbers of the nominal drive and their spreads.
With `--spread 2` the units scatter twice as far as the set states, and the diagnosis assumes as much. With `--assumed 1` it
assumes what the set states.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from strainwave.diagnose.actuator_ramp import ActuatorRamp, noises, wave_generator
from strainwave.diagnose.geometry import Geometry, misalignment_from_current
from strainwave.diagnose.inversion import MisalignmentEstimate
from strainwave.diagnose.possible_drives import PossibleDrives, drawn_changes
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.tuning.drawn import DRAWN_PARTS, spread_of

UNITS, SEED = 200, 1000  # the diagnosis draws its drives with another seed
NOISE = 0.02  # A, root mean square of the noise of the recorded current, besides that in the loops
LEAST, MOST = 5e-6, 40e-6  # m, of the size of m
GENERATOR, GENERATOR_TILT = 10e-6, float(np.radians(0.1))  # m and rad, largest misalignment of the generator on its shaft
KINDS = ("eccentricity", "tilt", "both")


@dataclass(frozen=True)
class Unit:
    """A drive with a misalignment, and its diagnosis."""

    kind: str
    m: tuple[float, float]
    result: Geometry

    @property
    def error(self) -> tuple[float, float]:
        """Estimate less truth in size [m] and in direction [rad]; m and -m are the same."""
        estimate = self.end
        size = estimate.size - float(np.hypot(*self.m))
        turn = estimate.direction - float(np.arctan2(self.m[1], self.m[0]))
        return size, (turn + 0.5 * np.pi) % np.pi - 0.5 * np.pi

    @property
    def end(self) -> MisalignmentEstimate:
        """Estimate of the member of the class that the unit has: as a tilt, if it has nothing else."""
        return self.result.ends[self.kind == "tilt"]

    @property
    def inside(self) -> tuple[bool, bool, bool]:
        """True where truth is in the interval of the size, of the direction, and in the region of m."""
        low, high = self.result.size_interval
        size = float(np.hypot(*self.m))
        return low <= size <= high, abs(self.error[1]) <= self.end.half_widths[1], self.result.contains(self.m)

    @property
    def inside_by_noise(self) -> bool:
        """True if truth is in the ellipse of the noise of the record alone, as if the nominal drive were right."""
        return replace(self.result.estimate, covariance=self.result.noise_covariance).contains(self.m)


def widened(gear_set: GearSet, factor: float) -> GearSet:
    """Return a set whose numbers have a larger spread."""
    sources = {
        path: replace(entry, spread=factor * spread_of(gear_set, part))
        for part in DRAWN_PARTS
        for path, entry in gear_set.sources.items()
        if path == part or path.startswith(f"{part}.")
    }
    return gear_set.replace(sources={**gear_set.sources, **sources})


def units(
    gear_set: GearSet,
    ramp: ActuatorRamp,
    count: int,
    combine: str = "max",
    drives: PossibleDrives | None = None,
    seed: int = SEED,
) -> Iterator[Unit]:
    """Yield drawn units, each with a misalignment that the diagnosis does not know.

    Args:
        gear_set: by whose spreads the units are drawn
        ramp: the run, of the nominal drive
        count: number of units
        combine: how the lobes share
        drives: that the diagnosis takes for possible; by default those of the set
        seed: of all that is drawn
    """
    known = drives or PossibleDrives.of(gear_set, ramp)
    chance = np.random.default_rng(seed)
    law, _ = wave_generator(ramp.drive)
    law = law.replace(combine=combine)
    seeds = noises(ramp.drive, "seed")
    for unit, change in enumerate(drawn_changes(gear_set, ramp, count, seed)):
        kind = KINDS[unit % len(KINDS)]
        wrong = misaligned(law, kind, chance)
        own = {path: float(2 + unit * len(seeds) + place) for place, path in enumerate(seeds)}
        runs = ramp.with_error(wrong).many([{**change, **own}], ["current"])
        run = runs.member(0)
        current = run["current"] + NOISE * chance.standard_normal(len(run))
        columns = {"time": run.time, "input_angle": run["input_angle"], "current": current}
        record = Recording(columns, {"time": "s", "input_angle": "rad", "current": "A"})
        x, y = wrong.eccentricity
        yield Unit(kind, (float(x), float(y)), misalignment_from_current(record, gear_set, drives=known))


def misaligned(law: Any, kind: str, chance: np.random.Generator) -> Any:
    """Return the law with a drawn misalignment of a kind, and a generator that is off and tilted on its shaft."""
    size, way = LEAST * (MOST / LEAST) ** chance.uniform(), chance.uniform(-np.pi, np.pi)
    share = {"eccentricity": 1.0, "tilt": 0.0, "both": chance.uniform()}[kind]
    tilt = (1.0 - share) * size / float(law.offset)
    turn = chance.uniform(-np.pi, np.pi)
    return law.replace(
        housing_eccentricity=share * size,
        housing_direction=way,
        housing_tilt_x=tilt * float(np.cos(turn)),
        housing_tilt_y=tilt * float(np.sin(turn)),
        generator_eccentricity=GENERATOR * chance.uniform(),
        generator_direction=chance.uniform(-np.pi, np.pi),
        generator_tilt_x=GENERATOR_TILT * chance.uniform(-1.0, 1.0),
    )


def table(found: list[Unit]) -> str:
    """Return coverage by kind of misalignment."""
    lines = ["misalignment   units  size  direction  ellipse  ellipse, noise alone  median half width  median error"]
    for kind in (*KINDS, "all"):
        chosen = [unit for unit in found if kind in (unit.kind, "all")]
        size, direction, ellipse = (100.0 * np.mean([unit.inside[place] for unit in chosen]) for place in range(3))
        noise = 100.0 * np.mean([unit.inside_by_noise for unit in chosen])
        half = np.median([unit.result.estimate.half_widths[0] for unit in chosen]) * 1e6
        error = np.median([abs(unit.error[0]) for unit in chosen]) * 1e6
        lines.append(
            f"{kind:<13} {len(chosen):>6} {size:>4.0f}% {direction:>9.0f}% {ellipse:>7.0f}% {noise:>20.0f}% {half:>15.2f} um"
            f" {error:>10.2f} um"
        )
    outer = np.mean([unit.result.estimate.combine == "max" for unit in found])
    detected = np.mean([unit.result.detected for unit in found])
    lines.append(f"the outer lobe carries: {outer:.0%}, else one does, as c_x is larger than m; detected: {detected:.0%}")
    size, direction = np.max([unit.result.estimate.half_widths for unit in found], axis=0)[:2]
    lines.append(f"largest half width: {1e6 * size:.2f} um of the size, {np.degrees(direction):.1f} deg of the direction")
    return "\n".join(lines)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--units", type=int, default=UNITS)
    parser.add_argument("--drive", default="tilt-actuator-lumped")
    parser.add_argument("--stroke", type=float, default=90.0, help="deg")
    parser.add_argument("--time", type=float, default=5.0, help="s")
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--spread", type=float, default=1.0, help="of the units, over that of the set (1)")
    parser.add_argument(
        "--assumed", type=float, help="spread that the diagnosis assumes, over that of the set; that of the units"
    )
    asked = parser.parse_args()
    gear_set = GearSet.read(asked.drive)
    ramp = ActuatorRamp.of(gear_set.drive, float(np.radians(asked.stroke)), asked.time)
    drives = PossibleDrives.of(widened(gear_set, asked.spread if asked.assumed is None else asked.assumed), ramp)
    found = list(units(widened(gear_set, asked.spread), ramp, asked.units, drives=drives, seed=asked.seed))
    print(table(found))
    print(found[0].result.words())


if __name__ == "__main__":
    main()
