"""Tries an installed wheel: every kind of run with every instruction set of this machine, to the same bits, and a report.

`python3 dev.py wheel` runs it with the Python of an environment that has the wheel and what it needs, and no compiler.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

SETS = ("baseline", "avx2", "avx512")


def digest() -> str:
    """Of runs by each method, of an ensemble and of derivatives, with the instruction set that the environment names."""
    import numpy as np
    import strainwave as sw

    warnings.simplefilter("ignore")
    gear = sw.load("hfuc-25-100")
    control = sw.control.PID(proportional=2.0, derivative=0.05)
    drive = sw.Drive(gear=gear, control=control, load=sw.loads.Pendulum(inertia=0.5, gravity_torque=15.0))
    bristles = sw.friction.LuGre(
        coulomb=0.02, breakaway=0.03, stribeck_speed=2.0, bristle_stiffness=300.0, bristle_damping=0.05, viscous=1e-4
    )
    wave = sw.scenario.sine(amplitude=0.1, frequency=2.0, duration=0.3)
    numbers = hashlib.sha256()
    for friction in (gear.friction_input, bristles, sw.friction.Thermal(law=bristles, dry_fall=0.005, viscous_fall=0.02)):
        varied = drive.replace(gear=gear.replace(friction_input=friction))
        runs = [sw.simulate(varied, wave, method=method) for method in ("exponential", "moreau_jean", "rosenbrock")]
        runs.append(sw.simulate_adaptively(varied, wave))
        runs.append(sw.simulate_many(varied, wave, {"load.inertia": np.linspace(0.4, 0.6, 11)}, sample=1e-2))
        slopes = sw.derivatives(varied, wave, ["load.inertia", "gear.damping"], sample=1e-2)
        for values in (slopes.values, *(column for run in runs for column in run.columns.values())):
            numbers.update(np.ascontiguousarray(values).tobytes())
    return numbers.hexdigest()[:16]


def main() -> None:
    assert not any(map(shutil.which, ("cc", "c++", "g++", "clang++", "cmake", "ninja"))), "a compiler is found"
    found = {}
    for name in SETS:
        variables = dict(os.environ, STRAINWAVE_INSTRUCTION_SET=name)
        told = subprocess.run([sys.executable, "-I", __file__, name], env=variables, capture_output=True, text=True)
        if "is not one that this build and this machine have" in told.stderr:
            print(f"{name}: this machine has none", flush=True)
            continue
        assert told.returncode == 0, told.stderr
        found[name] = told.stdout.strip()
        print(f"{name}: {found[name]}", flush=True)
    assert len(set(found.values())) == 1, "instruction sets differ"
    with tempfile.TemporaryDirectory() as folder:
        command = shutil.which("strainwave")
        assert command, "the wheel brings no command"
        subprocess.run([command, "--version"], check=True)
        subprocess.run([command, "demo", "--out", folder], check=True, stdout=subprocess.DEVNULL)
        reports = [path.name for path in Path(folder).glob("*/report.html")]
        assert reports
    print("the wheel works")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        print(digest())
    else:
        main()
