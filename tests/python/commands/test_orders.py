"""The command `strainwave orders`: from crooked files to a report, or one line that says what is missing."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.commands.output import write_report

from tests.python.command import refused, strainwave


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A record of two encoders with current, one of a joint's torque, one of a motor at constant speed without time."""
    place = tmp_path_factory.mktemp("orders")
    rng = np.random.default_rng(4)
    time = np.arange(0.0, 20.0, 0.004)
    theta = 40.0 * np.sin(0.5 * time) + 8.0 * np.sin(1.3 * time)
    link = -theta / 80.0 - 2e-4 * np.sin(2.0 * theta + 0.4) + rng.normal(0.0, 1e-5, len(time))
    current = 0.5 * np.sign(np.gradient(theta)) + 0.1 * np.cos(2.0 * theta) + rng.normal(0.0, 0.05, len(time))
    rows = np.column_stack([time, np.degrees(theta) + 777.0, np.degrees(link) - 12.0, current])
    header = "time [s],motor_angle [deg],link_angle [deg],current [A]"
    np.savetxt(place / "both.csv", rows, fmt="%.9g", delimiter=",", header=header, comments="")
    torque = 4.0 * np.sign(np.gradient(link)) + 0.3 * np.cos(200.0 * link) + rng.normal(0.0, 0.3, len(time))
    lines = ["Zeit [s];Gelenkwinkel [deg];Drehmoment [Nm]"]
    lines += [f"{t:.4f};{np.degrees(q):.6f};{m:.5f}".replace(".", ",") for t, q, m in zip(time, link, torque, strict=True)]
    (place / "joint.csv").write_text("\n".join(lines) + "\n")
    steady = 0.05 + 0.004 * np.cos(2.0 * 0.06 * np.arange(6000)) + rng.normal(0.0, 0.004, 6000)
    speed = np.full(6000, 30.0)
    np.savetxt(
        place / "steady.csv", np.column_stack([speed, steady]), delimiter=",", header="speed [rad/s],torque [N.m]", comments=""
    )
    return place


@pytest.mark.whole_path("orders")
def test_several_files_become_lines_a_page_numbers_and_spectra(folder: Path) -> None:
    result = strainwave("orders", "both.csv", "joint.csv", "--out", "found", folder=folder)
    assert result.returncode == 0, result.stderr
    assert "ratio −80" in result.stdout
    assert "order 2: " in result.stdout
    assert "order line 2.00" in result.stdout
    assert "ratio from these lines: 100" in result.stdout
    assert max(map(len, result.stdout.splitlines())) < 130
    names = {path.name for path in (folder / "found").iterdir()}
    assert names == {"report.html", "results.json", "both-error.csv", "both-spectrum.csv", "joint-spectrum.csv"}
    numbers = json.loads((folder / "found" / "results.json").read_text())["recordings"]
    assert numbers[0]["law"]["order"] == [2.0]
    assert numbers[0]["law"]["amplitude"][0] == pytest.approx(2e-4, rel=0.1)
    assert numbers[1]["ripple"]["lines"][0]["order"] == pytest.approx(200.0, abs=0.5)
    assert numbers[1]["ripple"]["candidates"][0]["ratio"] == 100
    page = (folder / "found" / "report.html").read_text()
    assert page.count("<svg") == 6
    assert ">nan" not in page
    spectrum = sw.Recording.read(folder / "found" / "joint-spectrum.csv")
    assert spectrum.names == ("order", "amplitude", "floor", "threshold")


def test_a_constant_speed_without_time_needs_a_rate_and_says_what_it_cannot_tell(folder: Path) -> None:
    result = strainwave("orders", "steady.csv", "--rate", 500, "--side", "input", "--out", "steady", folder=folder)
    assert result.returncode == 0, result.stderr
    assert "order or time line 2.0" in result.stdout
    assert "a second run at another speed settles it" in result.stdout.replace("\n    ", " ")


@pytest.mark.slow("commands")
def test_what_cannot_be_is_refused_in_one_line(folder: Path) -> None:
    refused(folder, ["orders", "joint.csv", "--column", "torque=Nothing"], "Nothing")
    refused(folder, ["orders", "both.csv", "--ratio", 100], "both.csv", "is not that of the angles")
    refused(folder, ["orders", "both.csv", "--ratio", 0], "--ratio = 0.0 must lie in [0.1, 10000] or [-10000, -0.1]")
    refused(folder, ["orders", "both.csv", "--highest", "1e300"], "--highest = 1e+300 must lie in (0, 100000]")
    refused(folder, ["orders", "both.csv", "--rate", "-5"], "--rate = -5.0 Hz must lie in [1e-06, 1e+09]")
    refused(folder, ["orders", "both.csv", "--rate", "inf"], "'--rate': \"inf\" is no number")
    refused(folder, ["orders", "none.csv"], "none.csv")
    refused(folder, ["orders", "hfuc-20-80", "joint.csv"], "hfuc-20-80 is a gear set", "leave it out")
    asked = strainwave("orders", "steady.csv", folder=folder)
    assert (asked.returncode, asked.stdout) == (2, "")
    assert asked.stderr.splitlines()[2].strip() == "strainwave orders steady.csv --constant rate=NUMBER"
    refused(folder, ["orders", "both.csv", "--side", "left"], "--side left must be one of input, output")


@pytest.mark.slow("commands")
def test_a_ratio_given_as_a_constant_is_that_of_the_option(folder: Path) -> None:
    for option in (["--ratio", 80], ["--constant", "ratio=80"]):
        result = strainwave("orders", "both.csv", *option, "--out", "given", folder=folder)
        assert "ratio −80 (measured" in result.stdout, result.stderr
        numbers = json.loads((folder / "given" / "results.json").read_text())["recordings"]
        assert numbers[0]["ripple"]["ratio"] == 80.0


def test_many_files_of_a_report_are_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_report(tmp_path, {**{f"{place}-error.csv": "" for place in range(10)}, "report.html": ""}, "summary")
    assert capsys.readouterr().out.endswith(
        "report.html, and beside it " + "".join(f"{place}-error.csv, " for place in range(8)) + "2 more\n"
    )
