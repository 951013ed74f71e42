"""Whether adaptive runs of random drives keep the tolerance asked, within a factor ten.

    python -m tests.tolerance                      two hundred drives
    python -m tests.tolerance --drives 1000 --first 5000

A drive has one motor and load and any gear of `tests.stress`, all models at all places, that reduces the speed, makes no
energy and has nothing faster than `FASTEST`. It is run to `RTOL` and compared with a run ten thousand times as tight. Set aside
is what says nothing of the method, by what tighter runs alone tell: drives that stand still, leave the range of a law, or are
not done in `MOST_STEPS` steps; and those that magnify a change of their inputs by `RTOL` more than tenfold, as one that is
about to lock or to break away may.
"""

from __future__ import annotations

import argparse
import multiprocessing
import warnings
from collections import Counter
from dataclasses import dataclass

import numpy as np
import strainwave as sw
from strainwave import _core

from tests.laws.test_gear import DRIVE, cannot_create_energy
from tests.stress import model

RTOL, TIGHTER, TIGHTEST = 1e-5, 1e-7, 1e-9
FASTEST = 1e4  # rad/s
MOST_STEPS = 20_000
DURATION = 0.03  # s
WITHIN = 10.0
COLUMNS = ("input_angle", "input_speed", "output_angle", "transmission_error", "output_speed", "torque")


@dataclass(frozen=True)
class Excited:
    """A drive and what acts on it."""

    drive: sw.drives.PositionDrive
    volts: float
    frequency: float
    load_torque: float

    @classmethod
    def drawn(cls, number: int) -> Excited:
        random = np.random.default_rng(number)
        while not calm(drive := DRIVE.replace(gear=model(sw.Gear, random))):
            pass
        return cls(drive, random.uniform(1.0, 48.0), random.uniform(10.0, 100.0), random.normal(0.0, 10.0))

    def run(self, rtol: float, change: float = 0.0) -> sw.Recording:
        """To a tolerance, its inputs changed by a share."""
        command = sw.scenario.sine(self.volts * (1.0 + change), self.frequency, DURATION)
        load = self.load_torque * (1.0 - change)
        return sw.simulate_adaptively(self.drive, command, rtol, sample=1e-3, load_torque=load, most_steps=MOST_STEPS)


def calm(drive: sw.drives.PositionDrive) -> bool:
    """Whether its gear reduces the speed, makes no energy, and vibrates with its bristles no faster than `FASTEST`."""
    fastest = max(_core.vibration(drive, 1e-3), _core.bristle_vibration(drive))
    return 30.0 <= abs(drive.gear.kinematics.ratio) <= 320.0 and fastest < FASTEST and cannot_create_energy(drive.gear)


def difference(run: sw.Recording, exact: sw.Recording) -> float:
    """The largest in any column, relative to the largest value in it."""
    return max(float(np.abs(run[name] - exact[name]).max() / max(np.abs(exact[name]).max(), 1e-300)) for name in COLUMNS)


@dataclass(frozen=True)
class Verdict:
    """How a drive did: its error and what a change of its inputs makes, in units of the tolerance; or why it was set aside."""

    number: int
    error: float = 0.0
    magnified: float = 0.0
    aside: str = ""

    @property
    def missed(self) -> bool:
        return self.error > WITHIN


def verdict(number: int) -> Verdict:
    with warnings.catch_warnings(action="ignore", category=_core.PassivityWarning):
        excited = Excited.drawn(number)
    try:
        exact = excited.run(TIGHTEST)
        changed = [excited.run(TIGHTER, change) for change in (-RTOL, RTOL)]
    except (ValueError, FloatingPointError) as error:
        return Verdict(number, aside=str(error).partition(" = ")[0])
    if not exact["input_speed"].any():
        return Verdict(number, aside="stands still")
    magnified = max(difference(run, exact) for run in changed) / RTOL
    if magnified > WITHIN:
        return Verdict(number, magnified=magnified, aside="magnifies")
    return Verdict(number, difference(excited.run(RTOL), exact) / RTOL, magnified)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--drives", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--processes", type=int, default=None)
    options = parser.parse_args()
    with multiprocessing.get_context("spawn").Pool(options.processes) as pool:
        verdicts = pool.map(verdict, range(options.first, options.first + options.drives), chunksize=4)
    compared = sorted((one for one in verdicts if not one.aside), key=lambda one: -one.error)
    missed = [one for one in compared if one.missed]
    for reason, count in Counter(one.aside for one in verdicts if one.aside).most_common():
        print(f"{count:5d} set aside: {reason}")
    print(f"{len(compared):5d} compared, {len(missed)} of them off by more than {WITHIN:g} times the tolerance")
    for one in compared[:10]:
        print(f"      drive {one.number}: error {one.error:.3g}, a change of the inputs {one.magnified:.3g} tolerances")
    raise SystemExit(bool(missed))


if __name__ == "__main__":
    main()
