"""All files of an independent joint in one call, whose truth is known: `python -m tests.mixture --seeds 10`.

The joint and its measurements are a program that shares nothing with this package (STRAINWAVE_RIG points to its folder). Of
each seed the truth is varied, every file that it writes is identified together, and each number that they tell must lie within
two standard deviations of the truth in 90 % of the cases, as far apart as the intervals say (0.7 to 1.4).
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
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.identification.identify import Identified, identify

from tests.rig import COVERED, RIG, START

LEAST, MOST = 0.7, 1.4  # scatter over the standard deviation stated
NAMES = {
    **{f"gear.stiffness.{name}": name.upper() for name in ("k1", "k2", "k3", "t1", "t2")},
    "gear.friction_input.coulomb": "Fc", "gear.friction_input.breakaway": "Fs", "gear.friction_input.stribeck_speed": "vs",
    "gear.friction_input.viscous": "viscous", "gear.friction_mesh.driving_forward": "loadloss",
    "gear.kinematic_error.amplitude of order 2": "e2", "gear.kinematic_error.amplitude of order 4": "e4",
    "load.inertia": "Jl", "load.gravity_torque": "gravity",
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


def start(truth: dict[str, float]) -> GearSet:
    """The catalogue set with the motor as its data sheet has it, the torque constant to 2 %."""
    catalogue = GearSet.read(START)
    motor = sw.motor.DC(
        resistance=truth["R"], inductance=1e-5, torque_constant=truth["Kt"], back_emf=truth["Kt"],
        inertia=truth["Jm"] - catalogue.gear.input_inertia,
    )  # fmt: skip
    exact, constant = Entry("measured before", uncertainty=0.0), Entry("data sheet", uncertainty=0.02 * truth["Kt"])
    sources = {f"motor.{field['name']}": constant if field["name"] == "torque_constant" else exact for field in motor.fields}
    return catalogue.replace(motor=motor, sources={**catalogue.sources, **sources})


def found(folder: Path, seed: int) -> tuple[Identified, dict[str, float]]:
    """What the files of a seed tell, and the truth."""
    words = [f"{name}={value}" for name, value in varied(seed).items()]
    subprocess.run([sys.executable, RIG / "measure.py", folder, f"seed={seed}", *words], check=True)
    truth = json.loads((folder / "truth.json").read_text())
    return identify(start(truth), sorted(folder.rglob("*.csv"))), truth


def distances(told: Identified, truth: dict[str, float]) -> Iterator[tuple[str, str, float]]:
    """File, number and distance from the truth [1], of each number of each file that is no copy of another."""
    for finding in told.findings:
        known = truth | OTHER_LOADS.get(finding.name, {})
        for each in finding.told:
            if not finding.same_as and not each.why and each.path in NAMES:
                yield finding.name, each.path, (each.value - known[NAMES[each.path]]) / each.sigma


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=10, help="how many (10)")
    parser.add_argument("--first", type=int, default=0, help="the first seed (0)")
    wanted = parser.parse_args()
    by_number: dict[tuple[str, str], list[float]] = defaultdict(list)
    for seed in range(wanted.first, wanted.first + wanted.seeds):
        with tempfile.TemporaryDirectory() as folder:
            for name, path, distance in distances(*found(Path(folder), seed)):
                by_number[path, name].append(distance)
        print(f"seed {seed} done", flush=True)
    for (path, name), each in sorted(by_number.items()):
        rms = np.sqrt(np.mean(np.square(each)))
        worst = np.abs(each).max()
        print(f"{path:44} {name:20} {len(each):3}  mean {np.mean(each):+5.2f}  scatter {rms:4.2f}  worst {worst:5.1f}")
    all_of_them = np.array([each for list_ in by_number.values() for each in list_])
    within, scatter = float(np.mean(np.abs(all_of_them) < 2.0)), float(np.sqrt(np.mean(all_of_them**2)))
    told = f"{100.0 * within:.1f} % of {len(all_of_them)} numbers within two standard deviations"
    print(f"{told}; scatter over stated {scatter:.2f}")
    return int(within < COVERED or not LEAST < scatter < MOST)


if __name__ == "__main__":
    sys.exit(main())
