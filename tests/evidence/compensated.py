"""Gain of each compensation over a tuned cascade, on gears unlike the model: `python -m tests.evidence.compensated`.

Two plants: that of the conservative Lagrangian with bristles and Maxwell elements, and the robot joint of the catalogue. Of
each, 200 gears are drawn whose parts have up to 0, 10 and 30 % more or less than the model has. Printed are median and 95 % of
the tracking error and of the error at reversals of a motion to and fro, for the cascade with feed-forward and disturbance
observer, tuned for each encoder as `sw.compensate` does it, and for each compensation, and how many runs failed.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator

import strainwave as sw
from strainwave.files.entries import Entry
from strainwave.tuning.candidates import candidates
from strainwave.tuning.cascade import Plant
from strainwave.tuning.compensate import best_cascade
from strainwave.tuning.drawn import drawn_gears
from strainwave.tuning.goals import Goal, position
from strainwave.tuning.judging import Judged, judged

SPREADS = (0.0, 0.1, 0.3)
FIGURES = ("tracking error", "error at reversals")
TUNED = 20  # gears of the draw, on which the cascade is tuned
MANUFACTURED = sw.Drive(
    gear=sw.Gear(
        kinematics=sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline"),
        stiffness=sw.stiffness.Cubic(a1=8000.0, a3=4e7),
        hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[2000.0, 1000.0], breakaway=[0.2, 0.3]),
        kinematic_error=sw.kinematic_error.Fourier(order=[2.0, 4.0], amplitude=[3e-4, 0.8e-4], phase=[0.3, -1.1]),
        friction_input=sw.friction.LuGre(
            coulomb=0.05, breakaway=0.07, stribeck_speed=0.5, bristle_stiffness=50.0, bristle_damping=0.0, viscous=4e-4
        ),
        damping=2.0,
        input_inertia=0.5e-4,
    ),
    motor=sw.motor.TorqueSource(inertia=1e-4),
    load=sw.loads.Inertia(inertia=0.05),
)


def plants() -> Iterator[tuple[str, sw.GearSet]]:
    """Yield name and set of each plant; every number is taken to be measured."""
    yield "manufactured", sw.GearSet.of(MANUFACTURED, name="manufactured", source="stated")
    yield "robot joint", sw.GearSet.read("robot-joint").replace(sensors=None, sources=_without_sensors())


def _without_sensors() -> dict[str, Entry]:
    sources = sw.GearSet.read("robot-joint").sources
    return {path: entry for path, entry in sources.items() if not path.startswith("sensors.")}


def spread(gear_set: sw.GearSet, by: float) -> sw.GearSet:
    """Return the set with this spread of every number, and none of them assumed."""
    return gear_set.replace(sources={path: Entry("measured", spread=max(by, 1e-9)) for path in gear_set.sources})


def line(each: Judged) -> str:
    """Return the figures of a controller in microradians."""
    values = (f"{1e6 * value:8.1f}" for name in FIGURES for value in (each.median(name), each.upper(name)))
    return f"{each.candidate.name:98} {' '.join(values)} {each.failures:4}"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--members", type=int, default=200, help="gears drawn (200)")
    parser.add_argument("--travel", type=float, default=0.1, help="of the output, rad (0.1)")
    wanted = parser.parse_args()
    failures = 0
    for name, gear_set in plants():
        plant = Plant.of(gear_set, 1e-3, 0.0)
        goal: Goal = position(wanted.travel, 0.2, plant.effort_unit)
        for by in SPREADS:
            print(f"\n{name}, parts of the gear up to {by:.0%} more or less than in the model")
            print(f"{'urad':98} {'tracking':>8} {'95 %':>8} {'reversal':>8} {'95 %':>8} fail", flush=True)
            draws = drawn_gears(spread(gear_set, by), wanted.members)
            few = {path: values[:TUNED] for path, values in draws.items()}
            cascades = [best_cascade(plant, goal, few, encoder).candidate for encoder in ("input", "output")]
            others = candidates(plant, [each.setting for each in cascades], goal, few)
            for candidate in (*cascades, *others):
                found = judged(candidate, goal, draws, plant)
                failures += found.failures
                print(line(found), flush=True)
    return int(failures > 0)


if __name__ == "__main__":
    sys.exit(main())
