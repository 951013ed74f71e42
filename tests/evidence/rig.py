"""Gears identified from an independent joint, whose truth is known: `python -m tests.evidence.rig --seeds 10`.

The joint and its measurements are a program that shares nothing with this package (STRAINWAVE_RIG points to its folder). Of
each seed a friction table, the torsion loop of one rig from both sides, a loading branch and a run from rest under its voltage
are identified. The estimates must lie within two standard deviations of the truth in 90 % of the cases, and the loops of these
gears make must be as wide as the true ones, within 3 %.
"""

from __future__ import annotations

import argparse
import atexit
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.identification.identify import Identified

Array = NDArray[np.float64]
RIG = Path(os.environ.get("STRAINWAVE_RIG", Path(__file__).parents[3] / "shared" / "independent-rig"))
START = "hfuc-20-80"
WHEEL = 360.0 / 16384.0  # deg, a count of the motor's encoder
LOCKED = 1e13  # kg.m2: what nothing moves
COVERED, WIDE = 0.9, 0.03  # what must be reached


@dataclass(frozen=True)
class Case:
    """A result, and its distance from the truth.

    Attributes:
        name: what it was made of
        distances: of each parameter identified, alone or in combination, in standard deviations
        widths: of its loop over that of the truth, by side
        found: itself
    """

    name: str
    distances: dict[str, float]
    widths: dict[str, float]
    found: Identified


@cache
def measured(seed: int) -> Path:
    """Return the folder with the measurement files of a seed, written once in a process; no test changes what is in it."""
    folder = Path(tempfile.mkdtemp(prefix="independent-joint-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    subprocess.run([sys.executable, RIG / "measure.py", folder, f"seed={seed}"], check=True, capture_output=True)
    return folder


def cases(folder: Path, seed: int) -> Iterator[Case]:
    """Yield the results of one seed."""
    subprocess.run([sys.executable, RIG / "measure.py", folder, f"seed={seed}"], check=True)
    truth = json.loads((folder / "truth.json").read_text())
    given: dict[str, dict[str, Any]] = {
        "friction": {"friction": folder / "friction.csv"},
        "input side, with friction": {"friction": folder / "friction.csv", "torsion": folder / "torsion_input.csv"},
        "input side": {"torsion": folder / "torsion_input.csv"},
        "output side": {"torsion": folder / "torsion_output.csv"},
        "branch": {"torsion": folder / "branch.csv"},
        "run": {"run": voltage_log(folder, truth, seed)},
    }
    for name, measurements in given.items():
        start = _start(truth) if name == "run" else GearSet.read(START)
        found = sw.identify(start, measurements)
        yield Case(name, dict(_distances(found, truth)), dict(_widths(name, found, truth)), found)


def _distances(found: Identified, truth: dict[str, float]) -> Iterator[tuple[str, float]]:
    names = {
        "stiffness.k1": "K1", "stiffness.k2": "K2", "stiffness.k3": "K3", "stiffness.t1": "T1", "stiffness.t2": "T2",
        "friction_input.coulomb": "Fc", "friction_input.breakaway": "Fs", "friction_input.stribeck_speed": "vs",
        "friction_input.viscous": "viscous", "kinematic_error.amplitude[1]": "e2", "kinematic_error.amplitude[2]": "e4",
    }  # fmt: skip
    last = {each.path: each for result in found.files for each in result.estimates}
    for each in last.values():
        name = names.get(each.path.removeprefix("gear."))
        if name is not None and each.state.startswith("identified"):
            yield each.path, (each.value - truth[name]) / each.sigma


def _widths(name: str, found: Identified, truth: dict[str, float]) -> Iterator[tuple[str, float]]:
    inside = 2.0 * (truth["Fh1"] + truth["Fh2"])
    if name == "output side":
        yield "output", width(from_output(found.gear_set.gear)) / inside
    elif name.startswith("input side"):
        yield "input", width(from_input(found.gear_set.gear)) / (inside + 2.0 * truth["N"] * truth["Fs"])


def from_input(gear: sw.Gear) -> tuple[Array, Array]:
    """Twist and torque at the output of that rig simulated: the output locked, a servo turns the input slowly to and fro."""
    ratio = gear.kinematics.ratio
    motor = sw.motor.DC(resistance=1.0, inductance=0.0, torque_constant=1.0, back_emf=0.0, inertia=1e-3)
    # by angle, as the rig does: by torque, the friction that falls with speed makes the input stick and slip
    servo = sw.control.PID(proportional=1e3, derivative=1.0, limit=1e3)
    drive = sw.Drive(gear=gear, motor=motor, control=servo, load=sw.loads.Inertia(inertia=LOCKED))
    run = sw.simulate(drive, sw.scenario.sine(amplitude=2.2e-3, frequency=0.02, duration=100.0), sample=1e-2)
    later = run.time > 30.0
    return run["input_angle"][later] / ratio, ratio * run["current"][later]


def from_output(gear: sw.Gear) -> tuple[Array, Array]:
    """The same of the other side: the input locked, the output loaded."""
    motor = sw.motor.DC(resistance=1.0, inductance=0.0, torque_constant=1.0, back_emf=0.0, inertia=LOCKED)
    drive = sw.Drive(gear=gear, motor=motor, load=sw.loads.Inertia(inertia=0.1))
    load = sw.scenario.sine(amplitude=60.0, frequency=0.1, duration=20.0)
    run = sw.simulate(drive, sw.scenario.constant(0.0, duration=20.0), load_torque=load, sample=1e-2)
    later = run.time > 10.0
    return run["twist"][later], run["torque"][later]


def width(loop: tuple[Array, Array]) -> float:
    """Torque between the two branches of a loop, half way between its ends [N.m]."""
    twist, torque = loop
    middle = 0.5 * (twist.max() + twist.min())
    crossings = np.flatnonzero(np.diff(np.sign(twist - middle)))
    at = []
    for i in crossings:
        share = (middle - twist[i]) / (twist[i + 1] - twist[i])
        at.append(torque[i] + share * (torque[i + 1] - torque[i]))
    return float(max(at) - min(at))


def voltage_log(folder: Path, truth: dict[str, float], seed: int) -> sw.Recording:
    """What encoders and a current sensor see of the joint from rest on, under the voltage of its controller."""
    program = folder / "joint"
    subprocess.run(["cc", "-O2", RIG / "joint.c", "-lm", "-o", program], check=True)
    words = [f"{name}={value}" for name, value in truth.items()]
    printed = subprocess.run([program, *words, "end=12"], check=True, capture_output=True, text=True).stdout
    time, voltage, current, motor, _, link, *_ = np.loadtxt(printed.splitlines()).T
    random = np.random.default_rng(seed)
    columns = {
        "time": time - time[0],
        "command": voltage,
        "current": current + 0.06 * random.standard_normal(len(time)),
        "input_angle": np.round(np.degrees(motor) / WHEEL) * WHEEL,
        "output_angle": np.degrees(link) + 6e-4 * random.standard_normal(len(time)),
    }
    return sw.Recording(columns, {"time": "s", "command": "V", "current": "A", "input_angle": "deg", "output_angle": "deg"})


def _start(truth: dict[str, float]) -> GearSet:
    """The catalogue set with the motor and the load as somebody has measured them."""
    known = Entry("measured before", uncertainty=0.0)
    catalogue = GearSet.read(START)
    motor = sw.motor.DC(
        resistance=truth["R"], inductance=1e-5, torque_constant=truth["Kt"], back_emf=truth["Kt"],
        inertia=truth["Jm"] - catalogue.gear.input_inertia,
    )  # fmt: skip
    load = sw.loads.Pendulum(inertia=truth["Jl"], gravity_torque=truth["gravity"])
    sources = {f"{part}.{field['name']}": known for part, model in (("motor", motor), ("load", load)) for field in model.fields}
    return catalogue.replace(motor=motor, load=load, sources={**catalogue.sources, **sources})


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=10, help="how many (10)")
    parser.add_argument("--first", type=int, default=0, help="the first seed (0)")
    wanted = parser.parse_args()
    distances: list[float] = []
    widths: list[float] = []
    for seed in range(wanted.first, wanted.first + wanted.seeds):
        with tempfile.TemporaryDirectory() as folder:
            for case in cases(Path(folder), seed):
                distances += case.distances.values()
                widths += case.widths.values()
                told = ", ".join(f"{path.rpartition('.')[2]} {distance:+.1f}" for path, distance in case.distances.items())
                wide = "".join(f"; {side} loop {ratio:.3f} of the true width" for side, ratio in case.widths.items())
                print(f"seed {seed}, {case.name}: {told}{wide}; {len(case.found.failed)} failed checks", flush=True)
    within = float(np.mean(np.abs(distances) < 2.0))
    off = float(np.abs(np.array(widths) - 1.0).max())
    told = f"{100.0 * within:.1f} % of {len(distances)} parameters within two standard deviations"
    print(f"{told}; widths off by {100.0 * off:.1f} % at most")
    return int(within < COVERED or off > WIDE)


if __name__ == "__main__":
    sys.exit(main())
