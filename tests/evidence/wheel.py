"""Tries an installed wheel: its contents, every kind of run, kernels of each instruction set of this machine, and a report.

`python3 dev.py wheel` runs it with the Python of an environment that has the wheel and what it needs, and no compiler. The
drives of the catalogue run by the kernels that the wheel carries, to the same bits as without.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

SETS = ("baseline", "avx2", "avx512")


def of_any_laws() -> str:
    """Of runs by each method, of an ensemble and of derivatives, of drives whose kernels the wheel does not carry."""
    import strainwave as sw

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
        for values in results(varied, wave, 1e-4):
            numbers.update(values)
    return numbers.hexdigest()[:16]


def of_the_catalogue() -> str:
    """Of runs of each drive of the catalogue, by kernels unless the environment switches them off."""
    import strainwave as sw
    from strainwave import _core
    from strainwave.files.ratings import drive_of
    from strainwave.native import kernels

    by_kernels = os.environ["STRAINWAVE_KERNELS"] != "off"
    numbers = hashlib.sha256()
    for name in sw.catalogue("drives"):
        drive = drive_of(sw.load(name))
        dt = min(1e-4, 0.25 / _core.max_rate(drive, 0.0))
        duration = 1.2 * kernels.LOOK_UP_SECONDS / kernels.STEP_SECONDS["simulate"] * dt
        numbers.update(sw.simulate(drive, sw.scenario.sine(0.02, 2.0 / duration, duration), dt)["twist"].tobytes())
        assert _core.loaded_jobs(drive) == (["simulate"] if by_kernels else []), name  # by itself, for so many steps
        for job in kernels.PUBLIC_JOBS:
            assert kernels.load(drive, job, compile_it=False) == by_kernels, (name, job)
        for values in results(drive, sw.scenario.sine(0.02, 2.0 / (1000.0 * dt), 1000.0 * dt), dt):
            numbers.update(values)
    return numbers.hexdigest()[:16]


def results(drive: Any, wave: Any, dt: float) -> Iterator[bytes]:
    """The numbers of runs by each method, of an ensemble and of derivatives."""
    import numpy as np
    import strainwave as sw
    from strainwave import _core

    parameters = [(path, number) for path, number, *_ in _core.parameters(drive) if number > 0.0][:6]
    members = {path: number * np.linspace(1.0, 1.01, 11) for path, number in parameters[-1:]}
    runs = [sw.simulate(drive, wave, dt, method=method) for method in ("exponential", "moreau_jean", "rosenbrock")]
    runs.append(sw.simulate_adaptively(drive, wave))
    runs.append(sw.simulate_many(drive, wave, members, dt, sample=10.0 * dt))
    yield sw.analysis.derivatives(drive, wave, [path for path, _ in parameters], dt, sample=10.0 * dt).values.tobytes()
    for run in runs:
        yield from (column.tobytes() for column in run.columns.values())


def check_contents() -> None:
    """Check that the wheel brings documentation, guide and stubs, and that `strainwave doctor` states what is there."""
    import strainwave as sw

    package = Path(sw.__file__).parent
    assert (package / "py.typed").is_file()
    assert "class Stribeck" in (package / "friction.pyi").read_text()
    page = Path(answer("docs", "--path"))
    assert page.parent == package / "docs"
    assert "strainwave" in page.read_text()
    assert answer("docs", "--agents") == (package / "AGENTS.md").read_text().strip()
    size = sum(path.stat().st_size for path in page.parent.rglob("*") if path.is_file())
    print(f"the documentation: {len(list(page.parent.rglob('*.html')))} pages, {size / 1e6:.1f} MB", flush=True)
    found = answer("doctor")
    print(found, flush=True)
    kernels = len(list((package / "kernels").glob("*.so")))
    assert kernels > 0
    for line in (
        f"package         {package}",
        "C++ compiler    none: ",
        f"shipped kernels {kernels}, ",
        f"documentation   {page.parent}; ",
    ):
        assert f"\n{line}" in found, line
    works, fails = found.splitlines()[-2:]
    assert works == "works: simulation, identification, reports"
    assert fails.startswith("does not work: kernels of any drive, ")


def answer(*words: str) -> str:
    """Return what the command of the wheel prints."""
    command = shutil.which("strainwave")
    assert command, "the wheel brings no command"
    return subprocess.run([command, *words], check=True, capture_output=True, text=True).stdout.strip()


def told(work: str, **variables: str) -> str:
    """What another process with these environment variables finds."""
    command = [sys.executable, "-I", "-W", "ignore", __file__, work]
    found = subprocess.run(command, env=os.environ | variables, capture_output=True, text=True)
    return found.stdout.strip() if found.returncode == 0 else found.stderr


def main() -> None:
    assert not any(map(shutil.which, ("cc", "c++", "g++", "clang++", "cmake", "ninja"))), "a compiler is found"
    check_contents()
    print(f"any laws: {told('of_any_laws')}", flush=True)
    general = told("of_the_catalogue", STRAINWAVE_KERNELS="off")
    print(f"drives of the catalogue, without kernels: {general}", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for name in SETS:
            found = told("of_the_catalogue", STRAINWAVE_KERNELS=f"{folder}/kernels", STRAINWAVE_INSTRUCTION_SET=name)
            if "is not one that this machine has" in found:
                print(f"{name}: this machine has none", flush=True)
                continue
            assert found == general, found
            print(f"by the kernels that the wheel carries, {name}: {found}", flush=True)
        assert not list(Path(folder).iterdir()), "a kernel was compiled"
        answer("demo", "--out", folder)
        reports = [path.name for path in Path(folder).glob("*/report.html")]
        assert reports
    print("the wheel works")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        print({"of_any_laws": of_any_laws, "of_the_catalogue": of_the_catalogue}[sys.argv[1]]())
    else:
        main()
