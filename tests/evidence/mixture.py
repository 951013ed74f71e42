"""All files of an independent joint in one call, whose truth is known: `python -m tests.evidence.mixture --seeds 10`.

The joint and its measurements are a program that shares nothing with this package (STRAINWAVE_RIG points to its folder). Of
each seed the truth is varied, every file that it writes is identified together, and each number that they tell must lie within
two standard deviations of the truth in 90 % of the cases, as far apart as the intervals say (0.7 to 1.4). The torque constant
is given as far from the truth as a data sheet may have it, so that what it adds to the intervals is tested. The loops of the
gear that was found must be as wide as those measured, within 3 %.

The program's current is that at the beginning of each interval of its controller, which is more than the mean where the motor
speeds up: by that alone the inertia of the load comes out 0.02 kg.m2 too large (torque constant squared times half an interval
over the resistance, times the ratio squared).
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave.analysis.branches import turning_points
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.identify import Identified, identify
from strainwave.identification.reading.recognise import recognise

from tests.evidence.rig import COVERED, RIG, START

Array = NDArray[np.float64]
LEAST, MOST = 0.7, 1.4  # scatter over the standard deviation stated
SHEET = 0.02  # relative standard deviation of a torque constant
WIDE = 0.03  # of the width of a loop
MIDDLE = 0.7  # of the way from the middle of a loop to its ends: there everything slides
NAMES = {
    **{f"gear.stiffness.{name}": name.upper() for name in ("k1", "k2", "k3", "t1", "t2")},
    "gear.friction_input.coulomb": "Fc", "gear.friction_input.breakaway": "Fs", "gear.friction_input.stribeck_speed": "vs",
    "gear.friction_input.viscous": "viscous", "gear.friction_mesh.driving_forward": "loadloss",
    "gear.kinematic_error.amplitude of order 2": "e2", "gear.kinematic_error.amplitude of order 4": "e4",
    "gear.damping": "damping", "load.inertia": "Jl", "load.gravity_torque": "gravity",
}  # fmt: skip
OTHER_LOADS = {"light.csv": {"Jl": 0.3, "gravity": 0.0}, "heavy.csv": {"Jl": 1.6, "gravity": 25.0}}


def varied(seed: int) -> dict[str, float]:
    """Numbers of a joint near those that the program has."""
    random = np.random.default_rng(1000 + seed)
    usual = {
        "Fc": 0.047, "vs": 3.0, "viscous": 2.9e-4, "Jl": 0.85, "gravity": 11.0, "K1": 14200.0, "e2": 6.4e-5, "e4": 1.745e-5,
        "loadloss": 0.03, "Fh1": 0.6, "Fh2": 0.5,
    }  # fmt: skip
    truth = {name: float(value * np.exp(0.2 * random.standard_normal())) for name, value in usual.items()}
    truth["Fs"] = truth["Fc"] * float(random.uniform(1.1, 1.5))
    truth["K2"], truth["K3"] = truth["K1"] * float(random.uniform(1.4, 1.8)), truth["K1"] * float(random.uniform(2.0, 2.4))
    return truth | {"T1": float(random.uniform(5.0, 9.0)), "T2": float(random.uniform(20.0, 28.0))}


def start(truth: dict[str, float], seed: int) -> GearSet:
    """The catalogue set with the motor as its data sheet has it, the torque constant to 2 %."""
    catalogue = GearSet.read(START)
    stated = truth["Kt"] * (1.0 + SHEET * float(np.random.default_rng(2000 + seed).standard_normal()))
    motor = sw.motor.DC(
        resistance=truth["R"], inductance=1e-5, torque_constant=stated, back_emf=truth["Kt"],
        inertia=truth["Jm"] - catalogue.gear.input_inertia,
    )  # fmt: skip
    exact, constant = Entry("measured before", uncertainty=0.0), Entry("data sheet", uncertainty=SHEET * stated)
    sources = {f"motor.{field['name']}": constant if field["name"] == "torque_constant" else exact for field in motor.fields}
    sources["gear.input_inertia"] = exact  # motor and gear together are what turns there
    return catalogue.replace(motor=motor, sources={**catalogue.sources, **sources})


def found(folder: Path, seed: int) -> tuple[Identified, dict[str, float]]:
    """What the files of a seed tell, and the truth."""
    words = [f"{name}={value}" for name, value in varied(seed).items()]
    subprocess.run([sys.executable, RIG / "measure.py", folder, f"seed={seed}", *words], check=True)
    truth = json.loads((folder / "truth.json").read_text())
    return identify(start(truth, seed), sorted(folder.rglob("*.csv"))), truth


def distances(told: Identified, truth: dict[str, float]) -> Iterator[tuple[str, str, float]]:
    """File, number and distance from the truth [1], of each number of each file."""
    for finding in told.files:
        known = truth | OTHER_LOADS.get(finding.name, {})
        for each in finding.estimates:
            if not each.why and each.path in NAMES:
                yield finding.name, each.path, (each.value - known[NAMES[each.path]]) / each.sigma


def widths(gear: sw.Gear, folder: Path) -> Iterator[tuple[str, float, float]]:
    """Of both loops: the file, the width of what the gear makes over that measured, and how exactly that is known [1]."""
    for name in ("torsion_input.csv", "torsion_output.csv"):
        loop = TorsionLoop.of(recognise(folder / name).recording, gear)
        there = np.linspace(loop.twist.min(), loop.twist.max(), 2000) - loop.middle
        path = np.concatenate((there, there[::-1], there))
        torque = np.asarray(gear.trace(np.concatenate(([0.0], path))))[1:]
        if loop.input_ratio is not None:
            torque = torque + loop.input_ratio * np.asarray(gear.friction_input.quasistatic(loop.input_ratio * path))
        measured, sigma = width(loop.twist - loop.middle, loop.torque)
        yield name, width(path, torque)[0] / measured, sigma / measured


def width(twist: Array, torque: Array) -> tuple[float, float]:
    """Torque between the branches of a loop about its middle [N.m], and its standard deviation, by a cubic along both."""
    turns = [0, *turning_points(twist), len(twist) - 1]
    sense = np.repeat(np.sign(np.diff(twist[turns])), np.diff(turns))
    half = 0.5 * np.ptp(twist)
    here = np.abs(twist[: len(sense)]) < MIDDLE * half
    here &= np.arange(len(sense)) >= turns[1 if len(turns) > 3 else 0]  # the first loading is no branch of the loop
    at = twist[: len(sense)][here] / half
    columns = np.column_stack((0.5 * sense[here], *(at**n for n in range(4))))
    (found, *_), left, *_ = np.linalg.lstsq(columns, torque[: len(sense)][here], rcond=None)
    scale = np.sqrt(left[0] / (len(at) - columns.shape[1])) if len(left) else 0.0
    return float(found), float(scale * np.sqrt(np.linalg.inv(columns.T @ columns)[0, 0]))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=10, help="how many (10)")
    parser.add_argument("--first", type=int, default=0, help="the first seed (0)")
    wanted = parser.parse_args()
    by_number: dict[tuple[str, str], list[float]] = defaultdict(list)
    by_loop: dict[str, list[tuple[float, float]]] = defaultdict(list)
    for seed in range(wanted.first, wanted.first + wanted.seeds):
        with tempfile.TemporaryDirectory() as folder:
            told, truth = found(Path(folder), seed)
            for name, path, distance in distances(told, truth):
                by_number[path, name].append(distance)
            for name, ratio, sigma in widths(told.gear_set.gear, Path(folder)):
                by_loop[name].append((ratio, sigma))
        print(f"seed {seed} done", flush=True)
    for (path, name), each in sorted(by_number.items()):
        rms = np.sqrt(np.mean(np.square(each)))
        worst = np.abs(each).max()
        inside = 100.0 * np.mean(np.abs(each) < 2.0)
        print(
            f"{path:44} {name:20} {len(each):3}  {inside:5.1f} % within 2  mean {np.mean(each):+5.2f}  scatter {rms:4.2f}  "
            f"worst {worst:5.1f}"
        )
    off = {name: np.abs(np.array(each)[:, 0] - 1.0) for name, each in by_loop.items()}
    for name, loops in by_loop.items():
        ratios, sigmas = np.array(loops).T
        words = f"{ratios.mean():.3f} of the measured width, known to {100.0 * np.median(sigmas):.1f} %"
        near, most = 100.0 * np.mean(off[name] < WIDE), 100.0 * off[name].max()
        print(f"loop of {name}: {words}; {near:.0f} % within 3 %, worst {most:.1f} %")
    all_of_them = np.array([each for list_ in by_number.values() for each in list_])
    within, scatter = float(np.mean(np.abs(all_of_them) < 2.0)), float(np.sqrt(np.mean(all_of_them**2)))
    share = f"{100.0 * within:.1f} % of {len(all_of_them)} numbers within two standard deviations"
    print(f"{share}; scatter over stated {scatter:.2f}")
    wide = any(np.mean(each < WIDE) < COVERED for each in off.values())
    return int(within < COVERED or not LEAST < scatter < MOST or wide)


if __name__ == "__main__":
    sys.exit(main())
