"""Whether adaptive runs of random drives keep the tolerance asked, within a factor ten.

    python -m tests.evidence.tolerance                      two hundred drives compared, some minutes on one core
    python -m tests.evidence.tolerance --drives 1000 --first 5000

A drive is any of `tests.evidence.stress`, all models at all places, controlled or not, whose gear has one spring, reduces the
speed, makes no energy and has nothing faster than `FASTEST`; and a tolerance of its own, from 1e-7 to 1e-4. It is run to that
and compared with a run ten thousand times as tight: what is recorded of the motion, and the torque of friction that rests on
bristles, which is all that shows them. That of set-valued friction jumps at events, where any shift in time is as large as
the jump.

Drives are drawn until enough are compared. Set aside is what says nothing of the method, by what tighter runs alone tell:
drives that stand still, leave the range of a law, or are not done within `MOST_STEPS`; and those that magnify a change of
their inputs by the tolerance more than tenfold, as one that is about to lock or to break away may.
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import warnings
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import count
from multiprocessing.pool import Pool
from typing import Any

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave import _core
from strainwave.simulation.signals import actuation, load_input, outputs

from tests.evidence.stress import model
from tests.laws.test_gear import PLACES, cannot_create_energy, has_memory

LOOSEST, TIGHTEST = 1e-4, 1e-7
TIGHTER, EXACT = 1e-2, 1e-4  # times the tolerance
FASTEST = 1e4  # rad/s
ATOL = 1e-15  # so small that the relative one counts
MOST_STEPS = 40_000  # of the tightest run
DURATION = 0.03  # s
WITHIN = 10.0
BATCH = 64
NOTHING = 1e-12  # in any unit: a column that is smaller is 0
COLUMNS = ("input_angle", "input_speed", "output_angle", "transmission_error", "output_speed", "torque")


@dataclass(frozen=True)
class Excited:
    """A drive, what acts on it, and the tolerance it is to keep."""

    drive: sw.Drive
    amplitude: float  # of the command
    frequency: float
    load_torque: float
    rtol: float

    @classmethod
    def drawn(cls, number: int) -> Excited:
        random = np.random.default_rng(number)
        while not calm(drive := of_one_spring(model(sw.Drive, random))):
            pass
        while jumps(drive.sensors):
            drive = drive.replace(sensors=model(sw.Sensors, random))
        acting = random.uniform(1.0, 48.0), random.uniform(10.0, 100.0), random.normal(0.0, 10.0)
        return cls(drive, *acting, math.exp(random.uniform(math.log(TIGHTEST), math.log(LOOSEST))))

    def run(self, share: float = 1.0, change: float = 0.0, max_steps: int = MOST_STEPS) -> sw.Recording:
        """To a share of the tolerance, its inputs changed by a share."""
        command = sw.scenario.sine(self.amplitude * (1.0 + change), self.frequency, DURATION)
        load = self.load_torque * (1.0 - change)
        limits: dict[str, Any] = {"rtol": self.rtol * share, "atol": ATOL, "max_steps": max_steps}
        return sw.simulate_adaptively(self.drive, command, sample=1e-3, inputs=self.acting(load), **limits)

    def run_in_steps(self, dt: float) -> sw.Recording:
        """In steps of `dt` [s]."""
        command = sw.scenario.sine(self.amplitude, self.frequency, DURATION)
        return sw.simulate(self.drive, command, dt, sample=1e-3, inputs=self.acting(self.load_torque), method="exponential")

    def acting(self, load: float) -> dict[str, float]:
        """On the output: this torque [N.m], or where it is put, an angle of some arc seconds."""
        name = load_input(self.drive)
        return {name: load if name == "load_torque" else 1e-5 * load}

    @property
    def columns(self) -> tuple[str, ...]:
        """What is held to the tolerance."""
        current = ("current",) if "current" in outputs(self.drive) else ()
        return (*COLUMNS, *current, *(place for place in PLACES if has_memory(getattr(self.drive.gear, place))))


def at_limit(drive: sw.Drive, run: sw.Recording) -> bool:
    """Whether controller or motor is seen at a limit of what is given, where that can switch."""
    law = getattr(drive.control, "law", drive.control)
    given = run[actuation(drive).name]
    limit = getattr(law, "limit", getattr(law, "voltage_limit", np.inf))
    return bool(
        (np.abs(given) >= limit).any()
        or any(np.isclose(given, each, rtol=1e-12, atol=1e-12).any() for each in motor_limits(drive.motor, run))
    )


def motor_limits(motor: Any, run: sw.Recording) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The least and the largest voltage [V] that a motor may have at each sample, of what supply and current allow."""
    unlimited = np.full(run.time.size, np.inf)
    if not isinstance(motor, sw.motor.BrushlessDC | sw.motor.PMSM):
        return -unlimited, unlimited
    warm = run["winding_temperature" if "winding_temperature" in run.names else "temperature"]
    resistance = motor.resistance * np.maximum(1.0 + motor.resistance_rise * (warm - 293.15), 0.01)
    if isinstance(motor, sw.motor.BrushlessDC):
        induced, reach, current = motor.torque_constant * run["input_speed"], motor.supply_voltage, motor.current_limit
    else:
        direct = run["direct_current"]
        induced = motor.pole_pairs * run["input_speed"] * (motor.direct_inductance * direct + motor.flux_linkage)
        reach = np.sqrt(np.maximum(motor.supply_voltage**2 / 3.0 - run["direct_voltage"] ** 2, 0.0))
        along = np.maximum(np.abs(direct), abs(motor.direct_current))
        current = np.sqrt(np.maximum(motor.current_limit**2 - along**2, 0.0))
    most = resistance * current
    return np.clip(induced - most, -reach, reach), np.clip(induced + most, -reach, reach)


def of_one_spring(drive: sw.Drive) -> sw.Drive:
    """The drive without stages: hardly any drawn at random are slow enough."""
    return drive.replace(gear=drive.gear.replace(structure=sw.structure.Lumped()))


def jumps(sensors: sw.Sensors) -> bool:
    """Whether a sensor jumps with each count."""
    each = [repr(getattr(sensors, field["name"])) for field in sw.Sensors.fields]
    return any(jumping in sensor for sensor in each for jumping in ("Encoder", "Quantised"))


def calm(drive: sw.Drive) -> bool:
    """Whether its gear reduces the speed, makes no energy, and vibrates with its bristles no faster than `FASTEST`."""
    fastest = max(_core.natural_frequency(drive, 1e-3), _core.bristle_frequency(drive))
    return 30.0 <= abs(drive.gear.kinematics.ratio) <= 320.0 and fastest < FASTEST and cannot_create_energy(drive.gear)


def difference(run: sw.Recording, exact: sw.Recording, columns: Sequence[str] = COLUMNS) -> float:
    """The largest in any column, relative to the largest value in it."""
    return max(float(np.abs(run[name] - exact[name]).max() / max(np.abs(exact[name]).max(), NOTHING)) for name in columns)


def errors(run: sw.Recording, exact: sw.Recording, rtol: float, columns: Sequence[str]) -> dict[str, float]:
    """The largest in each column, in units of what is tolerated."""
    tolerated = {name: rtol * np.abs(exact[name]).max() + ATOL for name in columns}
    return {name: float(np.abs(run[name] - exact[name]).max() / tolerated[name]) for name in columns}


@dataclass(frozen=True)
class Verdict:
    """How a drive did: its error and what a change of its inputs makes, in units of the tolerance; or why it was set aside."""

    number: int
    rtol: float
    error: float = 0.0
    column: str = ""
    magnified: float = 0.0
    aside: str = ""

    @property
    def missed(self) -> bool:
        return not self.error <= WITHIN


def verdict(number: int) -> Verdict:
    with warnings.catch_warnings(action="ignore", category=_core.PassivityWarning):
        excited = Excited.drawn(number)
    rtol, columns = excited.rtol, excited.columns
    try:
        changed = [excited.run(TIGHTER, change, MOST_STEPS // 5) for change in (-rtol, rtol)]
        exact = excited.run(EXACT) if any(moves(run) for run in changed) else changed[0]
    except (ValueError, FloatingPointError) as error:
        return Verdict(number, rtol, aside=str(error).partition(" = ")[0])
    if not moves(exact):
        return Verdict(number, rtol, aside="stands still")
    magnified = max(max(errors(run, exact, rtol, columns).values()) for run in changed)
    if magnified > WITHIN:
        return Verdict(number, rtol, magnified=magnified, aside="magnifies")
    try:
        found = errors(excited.run(), exact, rtol, columns)
    except (ValueError, FloatingPointError) as refusal:
        return Verdict(number, rtol, math.inf, str(refusal), magnified)
    column = max(found, key=lambda name: found[name])
    return Verdict(number, rtol, found[column], column, magnified)


def moves(run: sw.Recording) -> bool:
    return bool(run["input_speed"].any())


def until(compared: int, verdicts: Iterable[Verdict]) -> list[Verdict]:
    """The first verdicts, as many as it takes."""
    taken: list[Verdict] = []
    for one in verdicts:
        taken.append(one)
        compared -= not one.aside
        if compared == 0:
            break
    return taken


def in_batches(pool: Pool, first: int) -> Iterator[Verdict]:
    """The verdicts of all drives from one on, in order."""
    for start in count(first, BATCH):
        yield from pool.map(verdict, range(start, start + BATCH), chunksize=1)


def tell(verdicts: list[Verdict]) -> bool:
    """Prints what was found; whether all that were compared kept their tolerance."""
    compared = sorted((one for one in verdicts if not one.aside), key=lambda one: -one.error)
    missed = [one for one in compared if one.missed]
    print(f"{len(verdicts):5d} drawn")
    for reason, number in Counter(one.aside for one in verdicts if one.aside).most_common():
        print(f"{number:5d} set aside: {reason}")
    print(f"{len(compared):5d} compared, {len(missed)} of them off by more than {WITHIN:g} times the tolerance")
    for one in compared[: max(10, len(missed))]:
        said = f"{one.column} off by {one.error:.3g}, a change of the inputs makes {one.magnified:.3g}"
        print(f"      drive {one.number} to {one.rtol:.2g}: {said} tolerances")
    return not missed


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--drives", type=int, default=200, help="how many to compare")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--processes", type=int, default=None)
    options = parser.parse_args()
    with multiprocessing.get_context("spawn").Pool(options.processes) as pool:
        verdicts = until(options.drives, in_batches(pool, options.first))
    raise SystemExit(not tell(verdicts))


if __name__ == "__main__":
    main()
