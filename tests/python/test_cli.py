"""The command as its users meet it: results where asked for; bad input in one line, exit code 2, and nothing written."""

from __future__ import annotations

import errno
import os
import re
import signal
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import BytesIO, StringIO, TextIOWrapper
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave import _core, cli
from strainwave.cli import main
from strainwave.files import gear_set

GOOD_TABLE = "speed [rad/s],torque [N.m]\n1,0.021\n5,0.024\n10,0.026\n20,0.031\n50,0.046\n100,0.07\n"
GOOD_LOOP = "twist [mrad],torque [N.m]\n" + "".join(
    f"{np.cos(a):.6f},{20 * np.cos(a) - 2 * np.sin(a):.6f}\n" for a in np.linspace(0.0, 2.0 * np.pi, 80)
)
GOOD_GEAR = """name = "mine"
[kinematics]
model = "plain_ratio"
reduction = { value = 100, unit = "1", source = "assumed: example" }
[stiffness]
model = "linear"
k = { value = 3e4, unit = "N.m/rad", source = "assumed: example" }
"""


@dataclass(frozen=True)
class Result:
    returncode: int
    stdout: str
    stderr: str


def strainwave(*arguments: object, folder: Path) -> Result:
    """The command, run in this process, as in `folder`."""
    stdout, stderr = StringIO(), StringIO()
    with chdir(folder), redirect_stdout(stdout), redirect_stderr(stderr), pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["strainwave", *map(str, arguments)])
        with pytest.raises(SystemExit) as end:
            main()
    return Result(int(end.value.code or 0), stdout.getvalue(), stderr.getvalue())


def refused(folder: Path, arguments: Sequence[object], *expected: str) -> None:
    """The run ends with code 2 and one line that contains what is expected, and leaves no file behind."""
    before = sorted(folder.rglob("*"))
    result = strainwave(*arguments, folder=folder)
    assert result.returncode == 2, result.stderr
    assert result.stdout == ""
    lines = result.stderr.strip().splitlines()
    assert len(lines) == 1, result.stderr
    for text in expected:
        assert text in lines[0], f"{text!r} is not in {lines[0]!r}"
    assert sorted(folder.rglob("*")) == before


def test_a_table_and_a_loop_become_a_gear_file_and_a_report(tmp_path: Path) -> None:
    (tmp_path / "table.csv").write_text(GOOD_TABLE)
    (tmp_path / "loop.csv").write_text(GOOD_LOOP)
    result = strainwave(
        "twin",
        "--gear",
        "hfuc-25-100",
        "--friction",
        "table.csv",
        "--torsion",
        "loop.csv",
        "--out",
        "mine",
        folder=tmp_path,
    )
    assert result.returncode == 0, result.stderr
    assert sorted(path.name for path in (tmp_path / "mine").iterdir()) == ["gear.toml", "report.html"]
    assert "rms error on data held out" in result.stdout
    gear = sw.load(tmp_path / "mine" / "gear.toml")
    assert gear.friction_input.coulomb == pytest.approx(0.0208, abs=5e-4)
    assert gear.friction_input.viscous == pytest.approx(4.95e-4, rel=0.03)


def test_crooked_columns_are_named_on_the_command_line(tmp_path: Path) -> None:
    (tmp_path / "table.csv").write_text(
        "Operator;Drehzahl (rpm);Moment\n" + "".join(f"A;{10 * i};{4.0 + 0.01 * i}\n".replace(".", ",") for i in range(1, 9))
    )
    result = strainwave(
        "twin", "--gear", "hfuc-25-100", "--friction", "table.csv",
        "--column", "speed=Drehzahl", "--column", "torque=Moment", "--unit", "torque=N.cm", folder=tmp_path,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    gear = sw.load(tmp_path / "twin" / "gear.toml")
    assert gear.friction_input.coulomb == pytest.approx(0.04, rel=1e-6)
    assert gear.friction_input.viscous == pytest.approx(1e-4 / (10.0 * 2.0 * np.pi / 60.0), rel=1e-6)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", ("table.csv", "empty")),
        ("speed [rad/s],torque [N.m]\n", ("table.csv",)),
        (GOOD_TABLE + "200,abc\n", ("table.csv", "line 8", "torque", '"abc"', "number")),
        (GOOD_TABLE + "200,nan\n", ("table.csv", "line 8", "torque", "nan", "finite")),
        (GOOD_TABLE + "200\n", ("table.csv", "line 8")),
        ("speed,torque [N.m]\n1,2\n2,3\n3,4\n", ("table.csv", '"speed"', "unit")),
        ("speed [rad/s],torque [rad]\n1,2\n2,3\n3,4\n", ("rad", "N.m")),
        ("speed [rad/s],torque [furlong]\n1,2\n2,3\n3,4\n", ("table.csv", "furlong")),
        ("velocity [rad/s],torque [N.m]\n1,2\n2,3\n3,4\n", ("table.csv", "speed and torque", "velocity", "--column")),
        ("speed [rad/s],torque [N.m]\n1,0.1\n2,0.2\n", ("at least 4 speeds", "2")),
    ],
)  # fmt: skip
def test_a_bad_friction_table_is_refused(tmp_path: Path, text: str, expected: tuple[str, ...]) -> None:
    (tmp_path / "table.csv").write_text(text)
    refused(tmp_path, ["twin", "--gear", "hfuc-25-100", "--friction", "table.csv"], *expected)


@pytest.mark.parametrize("hostile", ["\x1b[31mred", "\x9b31m", "\u202e", 10_000 * "x", "two\x0blines"])
def test_what_a_file_holds_reaches_no_terminal_as_it_is(tmp_path: Path, hostile: str) -> None:
    hostile_name = tmp_path / f"{hostile[:20]}.csv"
    for text in (
        f"{hostile},torque\n1,2\n",
        f"speed [{hostile}],torque [N.m]\n1,2\n",
        f"speed [rpm],torque [N.m]\n1,{hostile}\n",
    ):
        hostile_name.write_text(text)
        result = strainwave("twin", "--gear", "hfuc-25-100", "--friction", hostile_name.name, folder=tmp_path)
        assert result.returncode == 2
        assert result.stderr.removesuffix("\n").isprintable()
        assert len(result.stderr) < 700
    refused(tmp_path, ["models", hostile], "there is no model")


def test_a_truncated_parquet_file_is_refused(tmp_path: Path) -> None:
    speed = np.arange(1.0, 50.0)
    whole = sw.Recording({"speed": speed, "torque": 0.1 * speed}, {"speed": "rad/s", "torque": "N.m"})
    whole.to_parquet(tmp_path / "whole.parquet")
    data = (tmp_path / "whole.parquet").read_bytes()
    (tmp_path / "cut.parquet").write_bytes(data[: len(data) // 2])
    refused(tmp_path, ["twin", "--gear", "hfuc-25-100", "--friction", "cut.parquet"], "cut.parquet")


def test_time_running_backwards_is_refused(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("time [s],command [V],position [rad]\n0,0,0\n0.1,1,0\n0.05,1,0.1\n0.2,1,0.2\n")
    refused(tmp_path, ["twin", "--gear", "hfuc-25-100", "--log", "log.csv"], "log.csv", "line 4", "0.05", "0.1")


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (("3e4", "-3e4"), ("mine.toml", "k", "-30000", "N.m/rad", "(0, inf)")),
        (("3e4", "nan"), ("mine.toml", "k", "nan")),
        (("3e4", '"stiff"'), ("mine.toml", "k", "stiff")),
        (("k =", "kk ="), ("mine.toml", "kk")),
        (("[stiffness]", "[stifness]"), ("mine.toml", "stifness")),
        (('"linear"', '"quadratic"'), ("mine.toml", "quadratic", '"linear" or "piecewise" or "three_segment" or "cubic"')),
        ((', unit = "N.m/rad"', ""), ("mine.toml", "k", "unit")),
        (('"N.m/rad"', '"N.m"'), ("mine.toml", "k", "N.m/rad")),
        (("[stiffness]", "[stiffness"), ("mine.toml", "line 5")),
        ((GOOD_GEAR, ""), ("mine.toml",)),
    ],
)
def test_a_bad_gear_file_is_refused(tmp_path: Path, change: tuple[str, str], expected: tuple[str, ...]) -> None:
    (tmp_path / "mine.toml").write_text(GOOD_GEAR.replace(*change))
    (tmp_path / "table.csv").write_text(GOOD_TABLE)
    refused(tmp_path, ["twin", "--gear", "mine.toml", "--friction", "table.csv"], *expected)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["twin", "--gear", "hfuc-25-101", "--friction", "table.csv"], ("hfuc-25-101", "hfuc-25-100")),
        (["twin", "--gear", "nowhere.toml", "--friction", "table.csv"], ("nowhere.toml",)),
        (["twin", "--gear", "hfuc-25-100", "--friction", "nowhere.csv"], ("nowhere.csv",)),
        (["twin", "--gear", "hfuc-25-100"], ("at least one measurement",)),
        (
            ["twin", "--gear", "hfuc-25-100", "--friction", "table.csv", "--unit", "spee=rpm"],
            ("spee", "speed, temperature, torque"),
        ),
        (
            ["twin", "--gear", "hfuc-25-100", "--friction", "table.csv", "--column", "speed"],
            ("--column speed", "name=value"),
        ),
    ],
)
def test_a_bad_command_line_is_refused(tmp_path: Path, arguments: list[str], expected: tuple[str, ...]) -> None:
    (tmp_path / "table.csv").write_text(GOOD_TABLE)
    refused(tmp_path, arguments, *expected)


def test_an_unwritable_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "table.csv").write_text(GOOD_TABLE)
    (tmp_path / "out").write_text("in the way")
    refused(tmp_path, ["twin", "--gear", "hfuc-25-100", "--friction", "table.csv", "--out", "out"], "out")


def test_gears_lists_the_catalogue(tmp_path: Path) -> None:
    result = strainwave("gears", "hfuc-25", folder=tmp_path)
    assert result.returncode == 0
    assert "hfuc-25-100" in result.stdout.split()


def test_gears_that_the_catalogue_does_not_have_are_refused_with_those_near(tmp_path: Path) -> None:
    none = 'none of the gears that come with the package has "hfuc-25-101" in its name'
    refused(tmp_path, ["gears", "hfuc-25-101"], none, "hfuc-25-100")
    refused(tmp_path, ["gears", "nonsense"], '"nonsense"', "`strainwave gears` lists all")


def test_the_version_is_that_of_the_package(tmp_path: Path) -> None:
    version = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"]["version"]
    result = strainwave("--version", folder=tmp_path)
    assert (result.returncode, result.stdout, result.stderr) == (0, f"strainwave {version}\n", "")


def test_a_terminal_that_lacks_letters_is_no_failure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gear_set, "catalogue", lambda of: ("größe-100",))
    monkeypatch.setattr(sys, "argv", ["strainwave", "gears"])
    terminal = TextIOWrapper(BytesIO(), encoding="ascii")
    with redirect_stdout(terminal), pytest.raises(SystemExit) as end:
        main()
    assert (end.value.code or 0, terminal.buffer.getvalue()) == (0, b"gr??e-100\n")  # type: ignore[attr-defined]


# As a process


def start(*arguments: object, **others: Any) -> subprocess.Popen[bytes]:
    return subprocess.Popen([sys.executable, "-m", "strainwave", *map(str, arguments)], stderr=subprocess.PIPE, **others)


def test_the_command_is_installed_and_its_exit_code_reaches_the_shell(tmp_path: Path) -> None:
    command = Path(sys.executable).with_name("strainwave")
    arguments = [command, "twin", "--gear", "nowhere.toml", "--friction", "table.csv"]
    result = subprocess.run(arguments, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert (result.returncode, result.stdout) == (2, "")
    assert "nowhere.toml" in result.stderr


@pytest.mark.parametrize("verb", [("gears",), ("models",), ("--help",)])
def test_a_reader_that_has_seen_enough_is_no_failure(verb: tuple[str, ...]) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "wb") as pipe:
        process = start(*verb, stdout=pipe)
    _, wrong = process.communicate(timeout=60)
    assert (process.returncode, wrong) == (0, b"")


def test_output_that_is_lost_is_told_and_does_not_turn_success_into_failure() -> None:
    if not Path("/dev/full").exists():
        pytest.skip("this system has no /dev/full")
    with open("/dev/full", "wb") as full:
        process = start("gears", stdout=full)
    _, wrong = process.communicate(timeout=60)
    assert (process.returncode, wrong) == (0, b"strainwave: the output cannot be printed: No space left on device\n")


def interrupted(process: subprocess.Popen[bytes], written: str = "nothing") -> None:
    """Presses Ctrl-C once the process says that it is there: one line, and exit code 130."""
    assert process.stdout is not None
    assert process.stdout.readline() == b"here\n"
    process.send_signal(signal.SIGINT)
    _, wrong = process.communicate(timeout=60.0)
    assert wrong.decode() == f"strainwave: interrupted; {written} written\n"
    assert process.returncode == 130


@pytest.mark.parametrize("phase", ["typer", "pydantic", "pyarrow", "scipy", "jinja2"])
def test_an_interrupt_ends_in_one_line_with_nothing_written(phase: str, tmp_path: Path) -> None:
    """In each phase a package is imported: for the command itself, to read gear and table, to fit, to report."""
    (tmp_path / "table.csv").write_text(GOOD_TABLE)
    (tmp_path / f"{phase}.py").write_text("import os, time\nos.write(1, b'here\\n')\ntime.sleep(30.0)")
    arguments = ["twin", "--gear", "hfuc-25-100", "--friction", "table.csv", "--out", "mine"]
    interrupted(start(*arguments, cwd=tmp_path, stdout=subprocess.PIPE, env=os.environ | {"PYTHONPATH": str(tmp_path)}))
    assert not (tmp_path / "mine").exists()


WROTE = """
from pathlib import Path
from strainwave import __main__, cli
import strainwave as sw
import time
def run():
    cli._write(Path("first"), sw.GearSet.read("hfuc-25-100"), "report")
    print("here", flush=True)
    time.sleep(30.0)
cli.main = run
__main__.main()
"""


def test_an_interrupt_says_what_was_written_before(tmp_path: Path) -> None:
    process = subprocess.Popen([sys.executable, "-c", WROTE], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    interrupted(process, "first")
    assert sorted(path.name for path in (tmp_path / "first").iterdir()) == ["gear.toml", "report.html"]


RUNNING = """
from strainwave import __main__, cli
import strainwave as sw
def run():
    print("here", flush=True)
    inertia = {"load.inertia": [0.01] * 100_000}
    sw.simulate_many(sw.Drive(), sw.scenario.constant(1.0, 10.0), inertia, record=["torque"], sample=10.0)
cli.main = run
__main__.main()
"""


def test_an_interrupt_ends_what_runs_in_the_core_too() -> None:
    interrupted(subprocess.Popen([sys.executable, "-c", RUNNING], stdout=subprocess.PIPE, stderr=subprocess.PIPE))


# Writing

MINE = sw.GearSet.of(sw.Gear(), name="mine", source="assumed: example")


def test_an_interrupt_that_comes_while_files_are_written_comes_too_late(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    replace = os.replace

    def press(*arguments: Any) -> None:
        replace(*arguments)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(os, "replace", press)
    cli._write(tmp_path / "mine", MINE, "report")
    assert sorted(path.name for path in (tmp_path / "mine").iterdir()) == ["gear.toml", "report.html"]
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)  # it is heeded again


@pytest.mark.parametrize("name", ["gear.toml", "report.html"])
def test_neither_file_is_written_where_one_cannot_be(name: str, tmp_path: Path) -> None:
    (tmp_path / "mine" / name).mkdir(parents=True)
    with pytest.raises(IsADirectoryError, match=rf"/mine/{name} cannot be written: it is a folder$"):
        cli._write(tmp_path / "mine", MINE, "report")
    assert [path.name for path in (tmp_path / "mine").iterdir()] == [name]


def test_without_a_gear_the_report_is_written_alone(tmp_path: Path) -> None:
    cli._write(tmp_path, None, "report")
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"report.html": "report"}


def test_a_full_disk_leaves_neither_files_nor_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match=r"/mine/new/report\.html cannot be written: No space left on device$"):
        cli._write(tmp_path / "mine" / "new", MINE, "report")
    assert list(tmp_path.iterdir()) == []


# Models


def test_every_model_is_listed_with_its_family_and_what_it_is(tmp_path: Path) -> None:
    families = strainwave("models", folder=tmp_path).stdout.split("\n")
    for family, members in _core.families.items():
        start = families.index(family) + 1
        listed = [line.split(maxsplit=1) for line in families[start : start + len(members)]]
        assert [name for name, _ in listed] == list(members)
        assert all(
            said == kind.__doc__.strip().splitlines()[0] for (_, said), kind in zip(listed, members.values(), strict=True)
        )


def test_a_model_is_described_in_full(tmp_path: Path) -> None:
    said = strainwave("models", "lugre", folder=tmp_path).stdout
    for field in sw.friction.LuGre.fields:
        assert f"{field['name']}: {field['doc']}" in said


def test_a_model_that_does_not_exist_is_refused_with_those_that_do(tmp_path: Path) -> None:
    refused(tmp_path, ["models", "lugree"], "there is no model lugree", "near to it is lugre", "strainwave models lists all")


def test_a_doubted_measurement_is_told_first_and_no_gear_is_written_until_it_is_accepted(tmp_path: Path) -> None:
    speeds = np.geomspace(1.0, 300.0, 12) / 80.0
    rows = "".join(f"{speed},{80.0 * 0.05 + 6400.0 * 3e-4 * speed}\n" for speed in speeds)
    (tmp_path / "joint.csv").write_text(f"Speed [rad/s],Torque [N.m]\n{rows}")
    words = ["twin", "--gear", "hfuc-20-80", "--friction", "joint.csv", "--out", "mine"]
    doubted = strainwave(*words, folder=tmp_path)
    assert doubted.returncode == 3
    assert doubted.stdout.startswith("DOUBT: joint.csv: ")
    assert "--side output" in doubted.stdout
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["report.html"]
    assert "Doubts: settle these" in (tmp_path / "mine" / "report.html").read_text()
    accepted = strainwave(*words, "--accept", folder=tmp_path)
    assert accepted.returncode == 0
    assert sw.load(tmp_path / "mine" / "gear.toml").friction_input.coulomb == pytest.approx(4.0, rel=0.02)
    told = strainwave(*words, "--side", "output", folder=tmp_path)
    assert (told.returncode, "DOUBT" in told.stdout) == (0, False)
    assert "gear.friction_input.coulomb" in told.stdout, "what was fitted is printed"
    assert sw.load(tmp_path / "mine" / "gear.toml").friction_input.coulomb == pytest.approx(0.05, rel=0.02)


def test_a_single_branch_gives_the_spring(tmp_path: Path) -> None:
    twist = np.linspace(0.0, 1e-3, 50)
    (tmp_path / "branch.csv").write_text(
        "twist [rad],torque [N.m],room [degC]\n" + "".join(f"{t},{2e4 * t},22\n" for t in twist)
    )
    result = strainwave("twin", "--gear", "hfuc-20-80", "--torsion", "branch.csv", folder=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "branch.csv: columns not used: room" in result.stdout


# Runs

RAMP = """name = "Ramp and push"
duration = 0.2
[command]
kind = "ramp"
rate = { value = 30.0, unit = "deg/s" }
[load_torque]
kind = "step"
amplitude = 2.0
start = 0.1
"""
JOINT = sw.GearSet.read("csg-25-100").with_parts(
    motor=sw.motor.DC(resistance=0.3, torque_constant=0.12, back_emf=0.12, inertia=1e-4),
    control=sw.control.PID(proportional=6.0, derivative=0.1, limit=48.0),
    load=sw.loads.Inertia(inertia=3.0),
    source="assumed: example",
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """With a scenario, a joint, a gear without motor and load, and two recordings."""
    (tmp_path / "ramp.toml").write_text(RAMP)
    (tmp_path / "points.csv").write_text("time [ms],command [deg]\n0,0\n200,6\n")
    (tmp_path / "mine.toml").write_text(GOOD_GEAR)
    (tmp_path / "nan.csv").write_text("time [s],torque [N.m]\n0,0\n1,nan\n")
    (tmp_path / "later.csv").write_text("time [s],torque [N.m]\n5,0\n6,1\n")
    (tmp_path / "speed.csv").write_text("time [s],torque [rad/s]\n0,0\n1,1\n")
    JOINT.save(tmp_path / "joint.toml")
    time = np.linspace(0.0, 1.0, 101)
    for name, shift in (("a", 0.0), ("b", 0.25)):
        columns = {"time": time, "torque": np.sin(2.0 * np.pi * time) + shift}
        sw.Recording(columns, {"time": "s", "torque": "N.m"}).to_csv(tmp_path / f"{name}.csv")
    return tmp_path


@pytest.mark.parametrize("kind", ["parquet", "csv"])
def test_a_drive_runs_through_a_scenario_as_in_python(kind: str, folder: Path) -> None:
    words = ["simulate", "joint.toml", "--scenario", "ramp.toml", "-o", f"run.{kind}", "--sample", "0.002"]
    result = strainwave(*words, folder=folder)
    assert (result.returncode, result.stderr) == (0, "")
    run = sw.Recording.read(folder / f"run.{kind}")
    expected = sw.ScenarioFile.read(folder / "ramp.toml", JOINT).simulate(JOINT.drive, sample=2e-3)
    assert all(np.array_equal(run[name], expected[name]) for name in expected.names)
    assert run.title == "CSG-25-100: Ramp and push"
    lines = result.stdout.splitlines()
    assert lines[0] == "CSG-25-100: Ramp and push"
    assert lines[1].startswith("101 samples from 0 s to 0.2 s, exponential Runge-Kutta, ")
    (torque,) = (line.split() for line in lines if line.startswith("torque "))
    assert torque == ["torque", "N.m", *(f"{x:.5g}" for x in (run["torque"].min(), run["torque"].max(), run["torque"][-1]))]
    assert lines[-1] == f"wrote run.{kind}"


def test_a_run_has_the_columns_the_numbers_and_the_tolerance_that_are_asked_for(folder: Path) -> None:
    words = ["simulate", "joint.toml", "--scenario", "points.csv", "-o", "run.csv", "--tolerance", "1e-7"]
    words += ["--set", "load.inertia=2", "--set", "control.feedback=output", "--record", "output_angle", "--record", "torque"]
    result = strainwave(*words, folder=folder)
    assert (result.returncode, result.stderr) == (0, "")
    changed = JOINT.drive.replace({"load.inertia": 2.0, "control.feedback": "output"})
    command = sw.scenario.table([0.0, 0.2], [0.0, np.radians(6.0)])
    expected = sw.simulate_adaptively(changed, command, 1e-7, record=["output_angle", "torque"])
    run = sw.Recording.read(folder / "run.csv")
    assert run.names == ("time", "output_angle", "torque")
    assert np.allclose(run["torque"], expected["torque"], rtol=1e-12, atol=1e-12)
    assert "CSG-25-100: points" in result.stdout
    assert "adaptive, rtol 1e-07" in result.stdout


@pytest.mark.parametrize(("name", "begins"), [("run.svg", b"<?xml"), ("run.png", b"\x89PNG"), ("run.pdf", b"%PDF")])
def test_a_picture_is_drawn_of_what_changes(name: str, begins: bytes, folder: Path) -> None:
    result = strainwave("simulate", "joint.toml", "--scenario", "ramp.toml", "--plot", name, folder=folder)
    assert (result.returncode, result.stderr) == (0, "")
    assert (folder / name).read_bytes().startswith(begins)
    assert result.stdout.endswith(f"wrote {name}\n")


def test_a_run_in_which_nothing_changes_is_drawn_too(folder: Path) -> None:
    (folder / "rest.toml").write_text("duration = 0.1\ncommand = 0.0")
    result = strainwave("simulate", "position-drive", "--scenario", "rest.toml", "--plot", "run.svg", folder=folder)
    assert (result.returncode, result.stderr) == (0, "")
    assert (folder / "run.svg").exists()


def test_ratings_that_a_run_exceeds_are_told(folder: Path) -> None:
    (folder / "jump.toml").write_text("duration = 0.1\ncommand = 0.6")
    result = strainwave("simulate", "joint.toml", "--scenario", "jump.toml", "-o", "jump.csv", folder=folder)
    assert (result.returncode, result.stderr) == (0, "")
    told = [line for line in result.stdout.splitlines() if line.startswith("rating: ")]
    assert any(
        re.match(r"rating: peak torque: [\d.]+ N\.m exceeds the limit of 204 N\.m, first at t = 0\.\d+ s", line)
        for line in told
    )
    shown = strainwave("show", "joint.toml", "--run", "jump.csv", folder=folder).stdout
    peak = np.abs(sw.Recording.read(folder / "jump.csv")["torque"]).max()
    beyond = f"exceeds the limit by {100.0 * (peak / 204.0 - 1.0):.3g} %, first at t = "
    assert re.search(rf"\n  peak_torque +{peak:.4g}  N\.m  {re.escape(beyond)}", shown.split("\njump.csv\n")[1].join("\n\n"))


def test_ratings_are_told_whatever_is_recorded(folder: Path) -> None:
    (folder / "jump.toml").write_text("duration = 0.1\ncommand = 0.6")
    words = ["simulate", "joint.toml", "--scenario", "jump.toml", "-o", "jump.csv", "--record", "motor.current"]
    result = strainwave(*words, folder=folder)
    assert "rating: peak torque: " in result.stdout
    assert sw.Recording.read(folder / "jump.csv").names == ("time", "current")


def test_warnings_are_told_in_one_line(folder: Path) -> None:
    bristle = sw.friction.LuGre(
        coulomb=0.05, breakaway=0.07, stribeck_speed=0.1, bristle_stiffness=50.0, bristle_damping=5e-5, viscous=4e-4
    )
    gear = JOINT.gear.replace(friction_input=bristle)
    sw.GearSet.of(JOINT.drive.replace(gear=gear), name="x", source="assumed: example").save(folder / "active.toml")
    text = (folder / "active.toml").read_text()
    (folder / "active.toml").write_text(text.replace("value = 5e-05", "value = 0.02"))
    process = start("show", "active.toml", cwd=folder, stdout=subprocess.DEVNULL)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 0
    assert len(said.splitlines()) == 1
    assert said.startswith(b"strainwave: warning: lugre can create energy: ")


SIMULATE = ["simulate", "joint.toml", "--scenario", "ramp.toml"]


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["simulate"], ("Missing argument 'drive'", "strainwave simulate --help tells more")),
        (["simulate", "joint.toml"], ("Missing option '--scenario'",)),
        (["simulate", "joint.toml", "--scenario"], ("'--scenario' requires an argument",)),
        (["simulate", "joint.toml", "--scenario", "none.toml"], ("none.toml cannot be read: No such file",)),
        (["simulate", "joint.toml", "--scenario", "none.csv"], ("none.csv", "No such file")),
        (["simulate", "joint.toml", "--scenario", "mine.toml"], ('mine.toml "kinematics" is not known; there are name, note',)),
        (["simulate", "joint.toml", "--scenario", "a.csv"], ("a.csv has no column command; it has time, torque",)),
        (["simulate", "mine.toml", "--scenario", "ramp.toml"], ("mine has no [motor] and no [load]",)),
        (["simulate", "position-driv", "--scenario", "ramp.toml"], ('"position-driv"', "`strainwave drives`")),
        (["simulate", "none.toml", "--scenario", "ramp.toml"], ("none.toml cannot be read",)),
        ([*SIMULATE, "more"], ("unexpected extra argument", "more")),
        ([*SIMULATE, "--dtt", "1"], ("No such option: --dtt",)),
        ([*SIMULATE, "--dt", "short"], ("'--dt'", "valid number")),
        ([*SIMULATE, "--dt", "-1"], ("dt = -1.0 s must lie in (0, inf)",)),
        ([*SIMULATE, "--dt", "nan"], ("dt = nan s must lie in (0, inf)",)),
        ([*SIMULATE, "--dt", "1e-15"], ("more than 1e+09 steps of 1e-15 s",)),
        ([*SIMULATE, "--sample", "0"], ("sample = 0.0 s must lie in (0, inf)",)),
        ([*SIMULATE, "--sample", "1e-12"], ("1e-12 s",)),
        ([*SIMULATE, "--tolerance", "1"], ("--tolerance 1.0 must lie in [1e-11, 0.01]",)),
        ([*SIMULATE, "--tolerance", "1e-6", "--dt", "1e-3"], ("--dt 0.001 and --tolerance 1e-06 exclude each other",)),
        ([*SIMULATE, "--record", "torqe"], ("record = ['torqe'] must list outputs of this drive: command,",)),
        ([*SIMULATE, "--set", "load.inertia"], ("--set load.inertia: write it as --set load.inertia=0.6",)),
        ([*SIMULATE, "--set", "=1"], ("--set =1: write it as",)),
        ([*SIMULATE, "--set", "load.inertia=-1"], ("inertia.inertia = -1 kg.m2 must lie in (0, inf)",)),
        ([*SIMULATE, "--set", "load.inertia=nan"], ("inertia.inertia = nan kg.m2 must lie in (0, inf)",)),
        ([*SIMULATE, "--set", "load.inertia=heavy"], ("inertia.inertia must be a number, not 'heavy'",)),
        ([*SIMULATE, "--set", "load.mass=1"], ("inertia has no parameter 'mass'; it has inertia",)),
        ([*SIMULATE, "--set", "gear.stiffness.k1=1e18"], ("dt = 0.0002 s is too coarse for this drive",)),
        ([*SIMULATE, "-o", "run.xls"], ("--out run.xls must end in .parquet or .csv",)),
        ([*SIMULATE, "-o", "none/run.csv"], ("--out none/run.csv cannot be written: there is no folder none",)),
        ([*SIMULATE, "--plot", "run.gif"], ("--plot run.gif must end in .svg or .png or .pdf",)),
        ([*SIMULATE, "--plot", "none/run.svg"], ("--plot none/run.svg cannot be written: there is no folder none",)),
        (["simulate", "joint.toml", "--scenario", "points.csv", "-o", "points.csv"], ("points.csv is the file of",)),
        (["compare"], ("Missing argument 'first'",)),
        (["compare", "a.csv", "joint.toml"], ("a.csv is a recording, joint.toml a gear or drive; give two of one kind",)),
        (["compare", "hfuc-25-100", "a.csv"], ("a.csv is a recording, hfuc-25-100 a gear or drive",)),
        (["compare", "a.csv", "none.csv"], ("none.csv cannot be read: No such file",)),
        (["compare", "a.csv", "b.csv", "--column", "speed"], ('no column "speed"; there are time, torque',)),
        (["compare", "a.csv", "points.csv"], ("no column in common",)),
        (["compare", "a.csv", "nan.csv"], ('nan.csv line 3, column "torque": nan is not finite',)),
        (["compare", "a.csv", "later.csv"], ("no time in common: 0 s to 1 s and 5 s to 6 s; shift the time of one",)),
        (["compare", "a.csv", "speed.csv"], ('column "torque": cannot convert "rad/s" to "N.m"; name the columns',)),
        (["compare", "joint.toml", "mine.toml", "--column", "x"], ("--column x: of gears and drives all",)),
        (["compare", "hfuc-25-100", "hfuc-25-101"], ('"hfuc-25-101"', "hfuc-25-100")),
        (["show"], ("Missing argument 'gear'",)),
        (["show", "nothing"], ('no set "nothing"',)),
        (["show", "joint.toml", "--run", "none.csv"], ("none.csv cannot be read",)),
        (["show", "a.csv"], ('"a.csv"',)),
        (["drives", "nonsense"], ('has "nonsense" in its name', "`strainwave drives` lists all")),
        (["simulat"], ("No such command 'simulat'", "simulate", "strainwave --help tells more")),
        (["--bogus"], ("No such option: --bogus",)),
    ],
)  # fmt: skip
def test_a_mistake_on_the_command_line_is_told_in_one_line(
    folder: Path, arguments: list[str], expected: tuple[str, ...]
) -> None:
    refused(folder, arguments, *expected)


@pytest.mark.parametrize(
    "arguments",
    [
        ["simulate", "joint.toml", "--scenario", "bare.csv"],
        ["compare", "a.csv", "bare.csv"],
        ["show", "joint.toml", "--run", "bare.csv"],
    ],
    ids=lambda words: words[0],
)
def test_no_option_is_advised_that_the_verb_does_not_have(folder: Path, arguments: list[str]) -> None:
    (folder / "bare.csv").write_text("time [s],command,torque\n0,0,0\n1,1,1\n")
    result = strainwave(*arguments, folder=folder)
    assert result.returncode == 2
    assert result.stderr.endswith("has no unit; write it behind the name, as in torque [N.m]\n")
    assert "--unit" in strainwave("twin", "--gear", "joint.toml", "--torsion", "bare.csv", folder=folder).stderr


def test_memory_that_is_not_there_is_told_in_one_line(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise MemoryError("2e+09 samples take 16 GB, more memory than there is; sample less often")

    monkeypatch.setattr(sw.ScenarioFile, "simulate", full)
    refused(folder, SIMULATE, "2e+09 samples take 16 GB", "sample less often")


def test_without_a_verb_help_is_shown(tmp_path: Path) -> None:
    result = strainwave(folder=tmp_path)
    assert (result.returncode, result.stdout) == (0, strainwave("--help", folder=tmp_path).stdout)
    for verb in ("twin", "demo", "simulate", "compare", "show", "gears", "drives", "models"):
        assert f"\n  {verb} " in result.stdout


# Comparisons and listings


def test_two_recordings_are_compared_column_by_column(folder: Path) -> None:
    result = strainwave("compare", "a.csv", "b.csv", folder=folder)
    assert (result.returncode, result.stderr) == (0, "")
    samples, _, header, row = result.stdout.splitlines()
    assert samples == "101 samples compared"
    assert header.split(maxsplit=3)[:3] == ["unit", "rms", "largest"]
    name, unit, rms, largest, _, correlation = row.split()
    assert (name, unit, rms, largest, correlation) == ("torque", "N.m", "0.25", "0.25", "1")
    alone = strainwave("compare", "a.csv", "b.csv", "--column", "torque", folder=folder)
    assert alone.stdout == result.stdout


def test_two_sets_are_compared_number_by_number(folder: Path) -> None:
    result = strainwave("compare", "csg-25-100", "joint.toml", folder=folder)
    assert [line.split() for line in result.stdout.splitlines()] == [
        ["first", "second", "unit", "change"],
        ["motor", "nothing", "dc"],
        ["control", "nothing", "pid"],
        ["load", "nothing", "inertia"],
    ]
    assert strainwave("compare", "joint.toml", "joint.toml", folder=folder).stdout == "equal, number by number\n"


def test_a_drive_is_shown_with_every_number(folder: Path) -> None:
    result = strainwave("show", "joint.toml", folder=folder)
    assert (result.returncode, result.stderr) == (0, "")
    for part in JOINT.left_out:
        assert f"\n[{part}] not given\n" in result.stdout
    for path in JOINT.sources:
        part, _, name = path.rpartition(".")
        if part in JOINT.left_out:
            continue
        assert re.search(rf"^  {re.escape(name)} ", result.stdout, re.MULTILINE), path


def test_drives_are_listed_with_what_they_are(tmp_path: Path) -> None:
    listed = strainwave("drives", folder=tmp_path).stdout.splitlines()
    assert [line.split()[0] for line in listed] == sw.catalogue("drives")
    assert listed[0].split(maxsplit=1)[1] == sw.GearSet.read(sw.catalogue("drives")[0]).name
    assert strainwave("drives", "position-drive", folder=tmp_path).stdout.startswith("position-drive ")


def test_an_interrupt_of_a_run_leaves_nothing(folder: Path) -> None:
    """The picture is drawn before anything is written, with a package that waits here."""
    (folder / "matplotlib.py").write_text("import os, time\nos.write(1, b'here\\n')\ntime.sleep(30.0)")
    environment = os.environ | {"PYTHONPATH": str(folder)}
    process = start(*SIMULATE, "-o", "run.csv", "--plot", "run.svg", cwd=folder, stdout=subprocess.PIPE, env=environment)
    interrupted(process)
    assert not (folder / "run.csv").exists()
