"""The command `strainwave diagnose joint`: from files to verdicts, a page and numbers, or one line of what is missing."""

from __future__ import annotations

import json
import re
from math import tau
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw

from tests.python.command import refused, strainwave

JOINT = ("--gear", "csg-20-100")


def write(path: Path, seed: int, lines: dict[float, float], load: float = 1.0, noise: float = 0.03) -> None:
    """A motor to and fro, whose current has a load, and lines in proportion to it."""
    time = np.arange(0.0, 40.0, 0.005)
    angle = 30.0 * tau * np.sin(tau * time / 20.0) / 2.0
    carried = load * (1.0 + 0.6 * np.sin(angle / 100.0))
    ripple = sum((size * np.cos(order * angle + order) for order, size in lines.items()), np.zeros_like(time))
    current = 0.4 * np.sign(np.cos(tau * time / 20.0)) + carried * (1.0 + ripple)
    current += np.random.default_rng(seed).normal(0.0, noise, len(time))
    rows = np.column_stack([time, angle, current])
    np.savetxt(path, rows, fmt="%.8g", delimiter=",", header="time [s],motor_angle [rad],current [A]", comments="")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("diagnose")
    (place / "healthy").mkdir()
    (place / "empty").mkdir()
    for day in range(3):
        write(place / "healthy" / f"day-{day}.csv", day, {2.0: 0.05})
    write(place / "later.csv", 10, {2.0: 0.05})
    write(place / "crack.csv", 11, {2.0: 0.05, 6.06: 0.06})
    for k in range(6):
        write(place / f"wear-{k}.csv", 20 + k, {2.0: 0.05, 4.0: 0.012 * k})
    write(place / "idle.csv", 12, {}, load=0.001, noise=0.05)
    time = np.arange(0.0, 10.0, 0.01)
    still = np.column_stack([time, np.full_like(time, 0.3), np.random.default_rng(0).normal(0.5, 0.05, len(time))])
    np.savetxt(place / "rest.csv", still, delimiter=",", header="time [s],motor_angle [rad],current [A]", comments="")
    return place


def results(folder: Path, name: str) -> dict[str, dict[str, object]]:
    (joint,) = json.loads((folder / name / "results.json").read_text())["joints"]
    return {each["name"]: each for each in joint["recordings"]}


@pytest.mark.whole_path("diagnose")
def test_a_change_is_an_alarm_with_its_cause_and_a_later_healthy_day_is_none(folder: Path) -> None:
    done = strainwave(
        "diagnose", "joint", "later.csv", "crack.csv", *JOINT, "--baseline", "healthy", "--out", "a", folder=folder
    )
    assert done.returncode == 3, done.stderr
    found = results(folder, "a")
    assert found["later.csv"]["verdict"] == "no change found"
    assert found["crack.csv"]["verdict"] == "changed"
    assert "over one place of the flexspline" in " ".join(done.stdout.split())
    assert max(map(len, done.stdout.splitlines())) < 130
    page = (folder / "a" / "report.html").read_text()
    assert "alarm" in page
    assert page.count("<svg") >= 4
    assert ">nan" not in page
    alarms = [each for each in found["crack.csv"]["comparison"]["changes"] if each["alarm"]]  # type: ignore[index]
    assert {round(each["order"], 1) for each in alarms} == {6.1}
    for each in alarms:  # 0.06 of the load's mean, and nothing before
        assert each["low"] < 0.06 < each["high"]


@pytest.mark.slow("diagnose")
def test_a_quiet_recording_ends_with_exit_code_0_and_states_the_smallest_change(folder: Path) -> None:
    done = strainwave("diagnose", "joint", "later.csv", *JOINT, "--baseline", "healthy", "--out", "b", folder=folder)
    assert done.returncode == 0, done.stderr
    limit, seen = re.findall(
        r"smallest change that would be an alarm is ([\d.]+) % of an amplitude; from ([\d.]+) % on, a true change is one with "
        "probability 0.9",
        " ".join(done.stdout.split()),
    )[0]
    assert 1.1 * float(limit) < float(seen) < 2.0 * float(limit)
    assert "healthy:" not in done.stdout


def test_without_a_baseline_lines_stand_against_noise_and_expected_values(folder: Path) -> None:
    done = strainwave("diagnose", "joint", "later.csv", *JOINT, "--out", "c", folder=folder)
    assert done.returncode == 0, done.stderr
    found = results(folder, "c")["later.csv"]
    assert found["verdict"] == "lines found"
    assert found["wave_generator"]["order"] == pytest.approx(2.0, abs=0.02)  # type: ignore[index]
    assert "without a baseline" in done.stdout
    assert "expected" in done.stdout
    cells = found["wave_generator"]["cells"]  # type: ignore[index]
    assert {each["direction"] for each in cells} == {"forward", "backward"}


def test_a_run_without_load_is_insensitive_and_not_healthy(folder: Path) -> None:
    done = strainwave("diagnose", "joint", "idle.csv", *JOINT, "--out", "d", folder=folder)
    found = results(folder, "d")["idle.csv"]
    assert found["verdict"] == "insensitive"
    assert "arc minutes would be seen at this load" in found["reason"]  # type: ignore[operator]
    assert done.returncode == 0


@pytest.mark.slow("diagnose")
def test_a_recording_at_rest_is_refused_beside_those_that_are_used(folder: Path) -> None:
    done = strainwave("diagnose", "joint", "rest.csv", "later.csv", *JOINT, "--out", "e", folder=folder)
    assert done.returncode == 0, done.stderr
    assert "rest.csv: refused: at rest: input_angle moves by 0 rad" in done.stdout
    assert "<li>rest.csv: at rest" in (folder / "e" / "report.html").read_text()
    refused(folder, ("diagnose", "joint", "rest.csv", *JOINT), " rest.csv: at rest")
    with pytest.raises(AssertionError):
        refused(folder, ("diagnose", "joint", "rest.csv", *JOINT), "rest.csv: rest.csv")


def test_without_a_ratio_the_page_states_that_the_amplitude_per_error_is_not_known(folder: Path) -> None:
    done = strainwave("diagnose", "joint", "later.csv", "--out", "i", folder=folder)
    assert done.returncode == 0, done.stderr
    page = " ".join((folder / "i" / "report.html").read_text().split())
    assert "is detected with probability 0.9. It is not known without the ratio of the gear." in page


@pytest.mark.slow("diagnose")
def test_recordings_of_one_name_in_several_folders_have_hours_and_reasons_of_their_own(folder: Path) -> None:
    for day, name in enumerate(("later.csv", "rest.csv", "rest.csv")):
        (folder / f"d{day}").mkdir()
        (folder / f"d{day}" / "run.csv").write_bytes((folder / name).read_bytes())
    names = [f"d{day}/run.csv" for day in range(3)]
    done = strainwave("diagnose", "joint", *names, *JOINT, "--hours", "0,100,200", "--out", "j", folder=folder)
    assert done.returncode == 0, done.stderr
    assert "d1/run.csv: refused: at rest" in done.stdout
    (joint,) = json.loads((folder / "j" / "results.json").read_text())["joints"]
    assert [each["name"] for each in joint["recordings"]] == ["d0/run.csv"]
    assert list(joint["refused"]) == ["d1/run.csv", "d2/run.csv"]


@pytest.mark.slow("diagnose")
def test_a_growing_line_has_a_trend_with_an_interval(folder: Path) -> None:
    names = [f"wear-{k}.csv" for k in range(6)]
    options = ("--hours", "0,100,200,300,400,500", "--threshold", "20", "--baseline", "healthy", "--out", "f")
    done = strainwave("diagnose", "joint", *names, *JOINT, *options, folder=folder)
    assert "remaining life by the trend" in done.stdout, done.stderr
    (joint,) = json.loads((folder / "f" / "results.json").read_text())["joints"]
    assert joint["trend"]["slope"] > 0.0
    assert joint["trend"]["low"] <= joint["trend"]["remaining"]
    few = strainwave(
        "diagnose", "joint", *names[:3], *JOINT, "--hours", "0,1,2", "--threshold", "20", "--baseline", "healthy", folder=folder
    )
    assert "no trend: a trend needs 5 compared recordings or more; there are 3" in " ".join(few.stdout.split())


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("later.csv", "--hours", "1,2"), "--hours has 2 numbers for 1 recordings"),
        (("later.csv", "--threshold", "2"), "--threshold needs the hours of operation"),
        ((), "Missing argument 'FILE…'"),
        (("later.csv", "--hours", "a"), '--hours a: "a" is no number'),
        (("later.csv", "--hours", "-5"), "--hours -5: hours = -5.0 h must lie in [0, inf)"),
        (("later.csv", "--threshold", "-2", "--hours", "1"), "--threshold = -2.0 must lie in (0, inf)"),
        (("later.csv", "--rate", "-4"), "--rate = -4.0 Hz must lie in"),
        (("healthy/day-1.csv", "--baseline", "healthy"), "day-1.csv is diagnosed and is in the baseline, too"),
        (("nosuch",), "nosuch does not exist"),
        (("later.csv", "--baseline", "empty"), "empty is a folder without a file of measurements"),
        (("later.csv", "--false-alarm", "2"), "false-alarm"),
        (("later.csv", *JOINT, "--geometry"), "--geometry needs --gear with a drive"),
        (("later.csv", "--ratio", "50", *JOINT), "--ratio and --gear are given"),
    ],
)
def test_options_that_do_not_fit_are_refused_in_one_line(folder: Path, words: tuple[str, ...], reason: str) -> None:
    refused(folder, ("diagnose", "joint", *words), reason)


@pytest.mark.slow("diagnose")
def test_a_record_that_is_no_ramp_has_a_note_and_no_misalignment(folder: Path) -> None:
    drive = ("--gear", "tilt-actuator-lumped", "--geometry", "--out", "g")
    done = strainwave("diagnose", "joint", "later.csv", *drive, folder=folder)
    assert done.returncode == 0, done.stderr
    (found,) = results(folder, "g").values()
    assert found["misalignment"] is None
    assert "no misalignment is estimated" in done.stdout


def test_a_limit_needs_a_drive_and_its_record(folder: Path) -> None:
    refused(folder, ("diagnose", "limit", "tilt-actuator"), "Missing option '--speed'")
    record = ("--speed", "10", "--duration", "20", "--noise", "0.05")
    refused(folder, ("diagnose", "limit", "csg-20-100", *record), "has no [motor]", "list drives")


@pytest.mark.slow("diagnose")
def test_a_plan_prints_the_limit_of_each_order(folder: Path) -> None:
    drive = sw.GearSet.read("csg-20-100").with_parts(
        motor=sw.motor.CurrentSource(torque_constant=0.05, inertia=1.5e-4),
        control=sw.control.PI(proportional=4.0, integral=100.0, limit=50.0),
        load=sw.loads.Inertia(inertia=0.05),
        source="a test",
    )
    drive.save(folder / "drive.toml")
    options = ("--speed", "10", "--duration", "20", "--noise", "0.05", "--rate", "500", "--order", "2")
    loaded = strainwave("diagnose", "limit", "drive.toml", *options, "--torque", "20", "--out", "g", folder=folder)
    idle = strainwave("diagnose", "limit", "drive.toml", *options, "--out", "h", folder=folder)
    limits = [json.loads((folder / name / "results.json").read_text())["limits"][0]["arcminutes"] for name in ("g", "h")]
    assert limits[0] < 1.0 < limits[1]
    assert "(insensitive)" in idle.stdout
    assert "(insensitive)" not in loaded.stdout
    assert "Detection limit" in (folder / "g" / "report.html").read_text()
