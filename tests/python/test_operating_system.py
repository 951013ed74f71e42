"""The package on Windows, as far as another system can show: in a process without what Windows lacks."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.dataset import runners
from strainwave.dataset.make import make

from tests.python.dataset.plans import write

AS_WINDOWS = Path(__file__).parent / "as_windows.py"
MAX_SECONDS = 400.0  # of the process, beside other tests
FRICTION = sw.friction.Stribeck(coulomb=0.02, breakaway=0.03, stribeck_speed=20.0, viscous=1e-4)
TORQUE_NOISE = 2e-5  # N.m
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="open files are looked up in /proc")

SCRIPT = """
import contextlib, hashlib, importlib, io, json, pkgutil, sys
from pathlib import Path
import strainwave as sw
from strainwave.commands import cli
from strainwave.dataset import runners
from strainwave.dataset.make import make
from strainwave.files.writing import claiming, replacing, write_all

templates = "strainwave.export.drive_node", "strainwave.export.newton.runtime"  # of what an export writes
modules = [each.name for each in pkgutil.walk_packages(sw.__path__, "strainwave.")]
for name in modules:
    if name not in templates:
        importlib.import_module(name)

drive = sw.load("tilt-actuator")
run = sw.simulate(drive, sw.scenario.sine(0.1, 2.0, 0.2), 1e-4)
for _ in range(2):  # the second replaces the first
    run.to_csv("run.csv")
    run.to_parquet("run.parquet")
    write_all({Path("text.txt"): "ä\\n", Path("bytes.bin"): b"b\\r\\n"})
same = (sw.Recording.read("run.parquet")["torque"] == run["torque"]).all()
with contextlib.suppress(KeyError), replacing("broken.txt") as file:
    file.write(b"half")
    raise KeyError

claims = []
for _ in range(2):
    with claiming(Path()):
        try:
            with claiming(Path("..", Path.cwd().name)):
                claims.append("twice")
        except BlockingIOError as error:
            claims.append(str(error))

sw.simulation.simulate_to("ensemble", drive, sw.scenario.sine(0.1, 2.0, 0.1), {"motor.resistance": [1.0, 1.1]}, 1e-4)
make("plan.toml", "set", runner="slurm", workers=1).unlink()
made = runners.work("set", parent=1)

def command(*words):
    sys.argv, output = ["strainwave", *words], io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.suppress(SystemExit):
        cli.main()
    return output.getvalue()

command("identify", "hfuc-25-100", "friction.csv", "--out", "out")
print(json.dumps({
    "modules": modules, "torque": hashlib.sha256(run["torque"].tobytes()).hexdigest(), "same": bool(same), "claims": claims,
    "made": made, "cache": command("doctor", "kernels"), "doctor": command("doctor"),
}))
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a plan of a data set and a table of friction, in which the script has run; what it printed is in a file."""
    place = tmp_path_factory.mktemp("windows")
    (place / "script.py").write_text(SCRIPT, "utf-8")
    write(place)
    speeds = np.concatenate([-np.geomspace(2.0, 300.0, 15)[::-1], np.geomspace(2.0, 300.0, 15)])
    torques = FRICTION.steady(speeds) + np.random.default_rng(1).normal(0.0, TORQUE_NOISE, len(speeds))
    lines = [f"{speed:.6g},{torque:.6g}" for speed, torque in zip(speeds, torques, strict=True)]
    (place / "friction.csv").write_text("\n".join(["Speed [rad/s],Torque [N.m]", *lines, ""]), "utf-8")
    flags = ["-X", "warn_default_encoding", *(["-S"] if sys.flags.no_site else [])]
    command = [sys.executable, *flags, str(AS_WINDOWS), "script.py"]
    done = subprocess.run(command, cwd=place, capture_output=True, text=True, timeout=MAX_SECONDS, check=False)
    assert done.returncode == 0, done.stderr
    (place / "printed.json").write_text(done.stdout, "utf-8")
    return place


@pytest.fixture
def printed(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "printed.json").read_text("utf-8"))
    return found


@pytest.mark.slow("physics")
def test_every_module_is_imported(printed: dict[str, Any]) -> None:
    package = Path(sw.__file__).parent
    files = {path.relative_to(package).with_suffix("") for path in package.rglob("*.py")} - {Path("__init__")}
    names = {".".join(("strainwave", *(each for each in path.parts if each != "__init__"))) for path in files}
    assert set(printed["modules"]) - {"strainwave._core"} == names


@pytest.mark.slow("physics")
def test_a_run_has_the_same_bits(printed: dict[str, Any]) -> None:
    run = sw.simulate(sw.load("tilt-actuator"), sw.scenario.sine(0.1, 2.0, 0.2), 1e-4)
    assert printed["torque"] == hashlib.sha256(run["torque"].tobytes()).hexdigest()


@pytest.mark.slow("physics")
def test_files_are_written_and_replaced_and_no_draft_is_left(folder: Path, printed: dict[str, Any]) -> None:
    assert printed["same"]
    assert (folder / "text.txt").read_bytes() == "ä\n".encode()
    assert (folder / "bytes.bin").read_bytes() == b"b\r\n"
    assert not (folder / "broken.txt").exists()
    assert not list(folder.rglob(".strainwave*"))


@pytest.mark.slow("physics")
def test_a_claimed_folder_is_refused_to_others(printed: dict[str, Any]) -> None:
    refusal = f"{Path('..')}/windows0 is being written by another process; wait until it ends"
    assert printed["claims"] == [refusal, refusal]


@pytest.mark.slow("physics")
def test_a_data_set_is_the_same(folder: Path, printed: dict[str, Any], tmp_path: Path) -> None:
    """Its list of digests names all files, as on this system. The worker goes on though its parent is another process."""
    make(folder / "plan.toml", tmp_path / "set", runner="slurm", workers=1).unlink()
    assert runners.work(tmp_path / "set") == printed["made"]
    assert (folder / "set" / "SHA256SUMS").read_bytes() == (tmp_path / "set" / "SHA256SUMS").read_bytes()


@pytest.mark.slow("physics")
def test_an_ensemble_is_complete(folder: Path) -> None:
    assert sw.Ensemble.read(folder / "ensemble").parameters["motor.resistance"].tolist() == [1.0, 1.1]


@pytest.mark.slow("physics")
def test_a_gear_is_identified(folder: Path) -> None:
    written = {path.name for path in (folder / "out").iterdir()} - {"workbench.html"}  # only if it was built
    assert written == {"gear.toml", "numbers.csv", "report.html", "results.json"}
    friction = sw.load(folder / "out" / "gear.toml").friction_input
    assert friction.coulomb == pytest.approx(FRICTION.coulomb, rel=0.05)


@pytest.mark.slow("physics")
def test_the_command_states_that_no_kernel_is_used(printed: dict[str, Any]) -> None:
    reason = "there are none on Windows; the general code gives the same numbers"
    assert printed["cache"] == f"no kernel is used: {reason}\n"
    lines = printed["doctor"].splitlines()
    assert f"cached kernels  not used: {reason}" in lines
    assert "kernels of any drive" in lines[-1]
