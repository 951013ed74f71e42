"""All joints of an arm in one command: each as if it were asked for by itself."""

from __future__ import annotations

import csv
import json
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.identify import identify
from strainwave.identification.joints import identify_joints
from strainwave.identification.reading.joints import joints_of
from strainwave.identification.reading.mapping import FileMapping

from tests.evidence import arms
from tests.python.command import strainwave

JOINT = arms.Joint(loss=0.0)


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of an arm without masses beyond those of its base, whose third joint rests."""
    light = arms.Links(base=1.0, masses=(0.0, 0.0), inertias=(0.4, 0.1))
    done = arms.run((JOINT,) * 3, arms.fourier(10.0, (0, 1), seed=1), light)
    path: Path = tmp_path_factory.mktemp("arm") / "log.csv"
    arms.panda(path, arms.Recorder(rate=100.0)(done))
    return path


def _said(joint: str, path: Path) -> FileMapping:
    return FileMapping(joint=joint)


@pytest.mark.slow("identification")
def test_every_joint_that_moves_has_a_folder_and_stands_on_the_page(tmp_path: Path, log: Path) -> None:
    """So do files that determine no joint."""
    assert joints_of(log) == ("1", "2")
    (tmp_path / "table.csv").write_text("speed [rad/s],torque [N.m]\n" + "".join(f"{v},{0.05 + v}\n" for v in range(1, 9)))
    (tmp_path / "text.csv").write_text("nothing\n")
    files = (log, "table.csv", "text.csv")
    done = strainwave("identify", "hfuc-25-100", *files, "--joint", "all", "--out", "out", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    with (tmp_path / "out" / "joints.csv").open() as file:
        rows = list(csv.DictReader(file))
    page = (tmp_path / "out" / "report.html").read_text()
    for joint in ("1", "2"):
        alone = identify("hfuc-25-100", [log], mapping=partial(_said, joint))
        told = {each.estimate.path: each.estimate.value for each in alone.parameters}
        assert {row["path"]: float(row["value"]) for row in rows if row["joint"] == joint} == told
        assert told["gear.friction_input.coulomb"] == pytest.approx(JOINT.coulomb, rel=0.05)
        results = json.loads((tmp_path / "out" / f"joint-{joint}" / "results.json").read_text())
        assert {each["path"]: each["value"] for each in results["parameters"]} == told
        assert f'<a href="joint-{joint}/report.html">' in page
        assert f"joint {joint}: log.csv " in done.stdout
    for name in files[1:]:
        assert f"\n{name}: NOT USED: " in done.stdout
        assert f"{name} is not used" in page


def test_a_file_of_one_joint_is_that_of_all_joints(tmp_path: Path, log: Path) -> None:
    rows = np.loadtxt(log, delimiter=",", skiprows=1)[:, [0, 2, 5, 8]]
    np.savetxt(tmp_path / "one.csv", rows, "%.6f", ",", header="time,q,dq,tau_J", comments="")
    joints = identify_joints("hfuc-25-100", [tmp_path / "one.csv"])
    assert (list(joints.found), joints.left_out) == (["1"], {})


def test_more_joints_than_any_robot_has_are_refused(tmp_path: Path) -> None:
    """Each would be identified by itself, for hours."""
    names = [f"q_{joint} [rad]" for joint in range(101)]
    rows = [",".join(f"{row + joint}" for joint in range(101)) for row in range(20)]
    (tmp_path / "log.csv").write_text(
        "\n".join([",".join(["time [s]", *names]), *(f"{row / 100},{each}" for row, each in enumerate(rows))])
    )
    with pytest.raises(ValueError, match=r"^the files have 101 joints that move; at most 100 are taken: name one of them$"):
        identify_joints("hfuc-25-100", [tmp_path / "log.csv"])
