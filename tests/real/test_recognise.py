"""Files of others, and of an independent joint, each recognised without a word said of it, where that can be."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import recognise

from tests.evidence.rig import RIG, measured

SHARED = Path(__file__).parents[3] / "shared"
DATA = Path(os.environ.get("STRAINWAVE_DATA", SHARED / "data"))

needs_data = pytest.mark.skipif(not DATA.is_dir(), reason=f"measured data not found: {DATA} (set STRAINWAVE_DATA)")
needs_rig = pytest.mark.skipif(
    not (RIG / "measure.py").is_file() or shutil.which("cc") is None,
    reason=f"no independent joint: {RIG} (set STRAINWAVE_RIG), or no cc",
)

# Kind, side and channels of each file that measure.py writes.
JOINT = {
    "friction.csv": ("friction", "input", {"speed", "torque"}),
    "friction_de.csv": ("friction", "input", {"speed", "torque"}),
    "torsion_input.csv": ("torsion", "input", {"input_angle", "input_torque"}),
    "torsion_output.csv": ("torsion", "output", {"twist", "torque"}),
    "branch.csv": ("torsion", "output", {"twist", "torque"}),
    "log.csv": ("log", "input", {"time", "command", "current", "input_angle"}),
    "log_outliers.csv": ("log", "input", {"time", "command", "current", "input_angle"}),
    "log_full.csv": ("log", None, {"time", "command", "voltage", "current", "input_angle", "output_angle"}),
    "log_link.csv": ("log", "output", {"time", "output_angle", "output_speed", "joint_torque"}),
    "log_torque_sign.csv": ("log", "output", {"time", "output_angle", "output_speed", "joint_torque"}),
    "two_loads/light.csv": ("log", None, {"time", "current", "input_angle", "output_angle"}),
    "two_loads/middle.csv": ("log", None, {"time", "current", "input_angle", "output_angle"}),
    "two_loads/heavy.csv": ("log", None, {"time", "current", "input_angle", "output_angle"}),
}


@pytest.fixture(scope="module")
def joint() -> Path:
    return measured(3)


@needs_rig
@pytest.mark.parametrize("name", JOINT)
def test_files_of_an_independent_joint(joint: Path, name: str) -> None:
    found = recognise(joint / name)
    kind, side, channels = JOINT[name]
    assert (found.kind, found.side, set(found.recording.names)) == (kind, side, channels)


@needs_rig
def test_the_clock_of_the_link_side_is_put_right(joint: Path) -> None:
    """100 Hz with stamps that scatter by 0.6 ms; 57 of 2850 rows stand twice, 150 of 3000 are missing."""
    found = recognise(joint / "log_link.csv")
    steps = np.diff(found.recording.time)
    assert len(found.recording) == 2850
    assert np.round(steps, 2) == pytest.approx(steps, abs=1e-6)
    assert "57 rows repeat the row before and are left out" in found.remarks
    assert "150 rows are missing at 1" in " ".join(found.remarks)
    scatter = next(float(word.split()[4]) for word in found.remarks if word.startswith("time stamps scatter by"))
    assert scatter == pytest.approx(0.6, abs=0.03)


@needs_data
@pytest.mark.parametrize("name", ["DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"])
def test_the_positioning_system(name: str) -> None:
    found = recognise(DATA / "emps" / name)
    assert found.kind == "log"
    assert found.columns == {"time": "t", "input_angle": "qm", "voltage": "vir", "command": "qg"}
    assert len(found.recording) == 24_841
    assert any("gtau = 35.15" in remark for remark in found.remarks)


@needs_data
def test_loops_of_printed_gears() -> None:
    files = sorted((DATA / "cycloidal-loops").glob("*.csv"))
    whole = [path for path in files if len(path.read_text().splitlines()) > 5]
    assert len(whole) > 50
    for path in whole:
        found = recognise(path)
        assert (found.kind, found.side, found.recording.names) == ("torsion", "output", ("twist", "torque")), path.name
        assert any("torque of the motor, counted at the output" in remark for remark in found.remarks)


@needs_data
def test_the_joints_of_a_robot_arm() -> None:
    (path,) = (DATA / "cobot-temperature").glob("*.csv")
    with pytest.raises(ValueError, match=r"it has 6 joints \(0, 1, 2, 3, 4, 5\), as Current_J0, .* --joint 0 "):
        recognise(path)
    found = recognise(path, FileMapping(joint="3"))
    assert found.columns == {
        "time": "Timestamp", "output_speed": "Speed_J3", "current": "Current_J3", "temperature": "Temperature_J3",
    }  # fmt: skip
    assert len(found.recording) == 7355
    assert 300.0 < found.recording["temperature"].min() < found.recording["temperature"].max() < 330.0


@needs_data
def test_locked_torque_moves_nothing() -> None:
    for path in (DATA / "locked-torque").glob("*.csv"):
        found = recognise(path)
        assert (found.kind, found.recording.names) == ("effort", ("time", "torque")), path.name
        assert "nothing that moves: the output was locked" in found.why[0]
