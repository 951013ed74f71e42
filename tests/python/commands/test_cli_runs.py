"""Runs, comparisons and listings by the command: results as in Python; a mistake in one line, and nothing written."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw

from tests.python.command import GOOD_GEAR, interrupted, refused, start, strainwave

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
    expected = sw.simulation.ScenarioFile.read(folder / "ramp.toml", JOINT).simulate(JOINT.drive, sample=2e-3)
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


@pytest.mark.slow("commands")
@pytest.mark.parametrize(("name", "begins"), [("run.svg", b"<?xml"), ("run.png", b"\x89PNG"), ("run.pdf", b"%PDF")])
def test_a_picture_is_drawn_of_what_changes(name: str, begins: bytes, folder: Path) -> None:
    result = strainwave("simulate", "joint.toml", "--scenario", "ramp.toml", "--plot", name, folder=folder)
    assert (result.returncode, result.stderr) == (0, "")
    assert (folder / name).read_bytes().startswith(begins)
    assert result.stdout.endswith(f"wrote {name}\n")


@pytest.mark.slow("commands")
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


@pytest.mark.slow("commands")
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
        (["simulate"], ("Missing argument 'drive' of strainwave simulate [OPTIONS] {drive}", "see strainwave simulate --help")),
        (["identify", "a.csv", "a.csv"], ("a.csv holds measurements, where a gear is asked for", "as hfuc-25-100")),
        (["simulate", "joint.toml"], ("Missing option '--scenario'",)),
        (["simulate", "joint.toml", "--scenario"], ("'--scenario' requires an argument",)),
        (["simulate", "joint.toml", "--scenario", "none.toml"], ("none.toml cannot be read: No such file",)),
        (["simulate", "joint.toml", "--scenario", "none.csv"], ("none.csv", "No such file")),
        (["simulate", "joint.toml", "--scenario", "mine.toml"], ('mine.toml "kinematics" is not known; there are name, note',)),
        (["simulate", "joint.toml", "--scenario", "a.csv"], ("a.csv has no column command; it has time, torque",)),
        (["simulate", "mine.toml", "--scenario", "ramp.toml"], ("mine has no [motor] and no [load]",)),
        (["simulate", "position-driv", "--scenario", "ramp.toml"], ('"position-driv"', "`strainwave list drives`")),
        (["simulate", "none.toml", "--scenario", "ramp.toml"], ("none.toml cannot be read",)),
        ([*SIMULATE, "more"], ("unexpected extra argument", "more")),
        ([*SIMULATE, "--dtt", "1"], ("No such option: --dtt",)),
        ([*SIMULATE, "--dt", "short"], ("'--dt': \"short\" is no number; write digits",)),
        ([*SIMULATE, "--dt", "-1"], ("dt = -1.0 s must lie in (0, inf)",)),
        ([*SIMULATE, "--dt", "nan"], ("'--dt': \"nan\" is no number",)),
        ([*SIMULATE, "--sample", "\u0661\u0662"], ("'--sample': \"\u0661\u0662\" is no number",)),
        ([*SIMULATE, "--sample", 5000 * "9"], ("'--sample': \"999", "is too large a number")),
        ([*SIMULATE, "--dt", "1e-15"], ("more than 1e+08 steps of 1e-15 s",)),
        ([*SIMULATE, "--sample", "0"], ("sample = 0.0 s must lie in (0, inf)",)),
        ([*SIMULATE, "--sample", "1e-12"], ("1e-12 s",)),
        ([*SIMULATE, "--tolerance", "1"], ("--tolerance 1.0 must lie in [1e-11, 0.01]",)),
        ([*SIMULATE, "--tolerance", "1e-6", "--dt", "1e-3"], ("--dt 0.001 and --tolerance 1e-06 exclude each other",)),
        ([*SIMULATE, "--record", "torqe"], ("record = ['torqe'] must list outputs of this drive: command,",)),
        ([*SIMULATE, "--set", "load.inertia"], ("--set load.inertia: write it as --set load.inertia=0.6",)),
        ([*SIMULATE, "--set", "=1"], ("--set =1: write it as",)),
        ([*SIMULATE, "--set", "load.inertia=-1"], ("inertia.inertia = -1 kg.m2 must lie in (0, inf)",)),
        ([*SIMULATE, "--set", "load.inertia=nan"], ('"nan" is no number',)),
        ([*SIMULATE, "--set", "load.inertia=\u0661\u0662"], ('"\u0661\u0662" is no number',)),
        ([*SIMULATE, "--set", f"load.inertia=1{400 * '0'}"], ("is too large a number",)),
        ([*SIMULATE, "--set", "load.inertia=heavy"], ('"heavy" must be a number and its unit, as "1.2 kg.m2"',)),
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
        (["compare", "a.csv", "b.csv", "--stroke", "5"], ("--measured and --stroke run two drives",)),
        (["compare", "position-drive", "position-drive", "--stroke", "0"], ("stroke = 0.0 deg must lie in (0, inf)",)),
        (["compare", "position-drive", "position-drive", "--measured", "a.csv"], ('a.csv has no column "command"',)),
        (["compare", "a.csv", "nan.csv"], ('nan.csv line 3, column "torque": nan is not finite',)),
        (["compare", "a.csv", "later.csv"], ("no time in common: 0 s to 1 s and 5 s to 6 s; shift the time of one",)),
        (["compare", "a.csv", "speed.csv"], ('column "torque": cannot convert "rad/s" to "N.m"; name the columns',)),
        (["compare", "joint.toml", "mine.toml", "--column", "x"], ("--column x: of gears and drives all",)),
        (["compare", "hfuc-25-100", "hfuc-25-101"], ('"hfuc-25-101"', "no ratio of 101, but 30")),
        (["show"], ("Missing argument 'name'",)),
        (["show", "nothing"], ('no set "nothing"',)),
        (["show", "joint.toml", "--run", "none.csv"], ("none.csv cannot be read",)),
        (["show", "a.csv"], ("a.csv holds measurements",)),
        (["list", "drives", "nonsense"], ('has "nonsense" in its name', "`strainwave list drives` lists all")),
        (["simulat"], ("No such command 'simulat'", "simulate", "see strainwave --help")),
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
    (folder / "bare.csv").write_text("time [s],command,speed,torque\n0,0,0,0\n1,1,1,1\n")
    result = strainwave(*arguments, folder=folder)
    assert result.returncode == 2
    assert result.stderr.endswith("has no unit; write it behind the name, as in torque [N.m]\n")


def test_memory_that_is_not_there_is_told_in_one_line(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise MemoryError("2e+09 samples take 16 GB, more memory than there is; sample less often")

    monkeypatch.setattr(sw.simulation.ScenarioFile, "simulate", full)
    refused(folder, SIMULATE, "2e+09 samples take 16 GB", "sample less often")


def test_memory_that_python_lacks_is_told_in_words(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise MemoryError

    monkeypatch.setattr(sw.simulation.ScenarioFile, "simulate", full)
    refused(folder, SIMULATE, "this takes more memory than there is")


@pytest.mark.parametrize("error", [OverflowError("math range error"), ZeroDivisionError("float division by zero")])
def test_arithmetic_that_no_bound_foresaw_is_told_in_one_line(
    folder: Path, monkeypatch: pytest.MonkeyPatch, error: ArithmeticError
) -> None:
    def overflowing(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(sw.simulation.ScenarioFile, "simulate", overflowing)
    refused(folder, SIMULATE, f"a number is too large or too small to compute with: {error}")


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
    listed = strainwave("list", "drives", folder=tmp_path).stdout.splitlines()
    assert [line.split()[0] for line in listed] == sw.catalogue("drives")
    assert listed[0].split(maxsplit=1)[1] == sw.GearSet.read(sw.catalogue("drives")[0]).name
    assert strainwave("list", "drives", "position-drive", folder=tmp_path).stdout.startswith("position-drive ")


@pytest.mark.slow("commands")
@pytest.mark.parametrize("caught", ["raise", "pass", "raise ImportError('cannot be imported') from None"])
def test_an_interrupt_of_a_run_leaves_nothing(folder: Path, caught: str) -> None:
    """The picture is drawn before anything is written, with a package that waits here, and may swallow the interrupt."""
    waits = f"try:\n    os.write(1, b'here\\n')\n    time.sleep(30.0)\nexcept BaseException:\n    {caught}\n"
    (folder / "matplotlib.py").write_text(f"import os, time\n{waits}")
    environment = os.environ | {"PYTHONPATH": str(folder)}
    process = start(*SIMULATE, "-o", "run.csv", "--plot", "run.svg", cwd=folder, stdout=subprocess.PIPE, env=environment)
    interrupted(process)
    assert not (folder / "run.csv").exists()
