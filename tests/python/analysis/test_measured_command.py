"""A measured run from rest, and drives under its command."""

from __future__ import annotations

from pathlib import Path

import pytest
import strainwave as sw
from strainwave.analysis.strokes import move_of

from tests.python.command import strainwave


def test_a_run_of_a_drive_is_recognised_as_its_own(tmp_path: Path) -> None:
    drive = sw.load("position-drive")
    own = sw.simulate(drive, move_of(0.3), sample=1e-3)
    own.select(["time", "command", "output_angle"]).to_csv(tmp_path / "own.csv")
    run = sw.analysis.MeasuredCommand.read(tmp_path / "own.csv")
    assert run.recording.title == "own.csv"
    assert run.agreement(drive).rms < 2e-5
    assert run.agreement(sw.load("position-drive-full-friction")).rms > 1e-4
    result = strainwave("compare", "position-drive-full-friction", "position-drive", "--measured", "own.csv", folder=tmp_path)
    assert result.returncode == 0, result.stderr
    shown = [float(line.split()[2]) for line in result.stdout.splitlines() if line.startswith("output_angle")]
    assert shown[0] == pytest.approx(run.agreement(sw.load("position-drive-full-friction")).rms, rel=1e-3)
    assert shown[1] < 2e-5


def test_a_run_of_one_row_is_refused(tmp_path: Path) -> None:
    (tmp_path / "row.csv").write_text("time [s],command [rad],output_angle [rad]\n0,0,0\n")
    with pytest.raises(ValueError, match=r"row\.csv has 1 rows; a run needs 2 or more"):
        sw.analysis.MeasuredCommand.read(tmp_path / "row.csv")
