"""`strainwave rig influence`: what it writes, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.rig.influence.cycle import cycle_to

from tests.python.command import refused, strainwave


@pytest.mark.slow("rig")
def test_the_command_writes_a_page_and_the_sweeps(tmp_path: Path) -> None:
    gear, loops = sw.load("csg-25-100"), []
    for torque in (20.0, 40.0, 60.0, 87.0):
        loop = cycle_to(gear, torque)
        columns = {"twist": loop.angle[::10], "torque": loop.torque[::10]}
        sw.Recording(columns, {"twist": "rad", "torque": "N.m"}).to_csv(tmp_path / f"{torque:g}.csv")
        loops += ["--loop", f"{torque:g}.csv,torque_max={torque:g}"]
    result = strainwave("rig", "influence", *loops, "--out", "found", folder=tmp_path)
    assert result.returncode == 0, result.stderr
    written = sorted(path.name for path in (tmp_path / "found").iterdir())
    sweeps = ["modulus.csv", "preload.csv", "report.html", "temperature.csv", "torque-level-document-t.csv", "torque-level.csv"]
    assert written == sweeps
    assert "contradicted: Of one size the catalogue’s stiffness" in result.stdout
    assert "measured, confirmed: loop area goes with the power" in " ".join(result.stdout.split())
    assert "40.csv" in (tmp_path / "found" / "report.html").read_text()
    sweep = sw.Recording.from_csv(tmp_path / "found" / "torque-level.csv")
    assert np.all(np.diff(sweep["area"]) >= 0.0)


@pytest.mark.slow("rig")
def test_wrong_options_are_refused_in_a_line(tmp_path: Path) -> None:
    (tmp_path / "series.csv").write_text("torque_max [N.m],speed [rpm]\n1,2\n")
    refused(tmp_path, ["rig", "influence", "none"], "none")
    refused(tmp_path, ["rig", "influence", "hfuc-25-100"], "has no rated torque")
    refused(tmp_path, ["rig", "influence", "--measured", "series.csv"], 'series.csv has a column "speed"')
    refused(tmp_path, ["rig", "influence", "--measured", "series.csv", "--loop", "a.csv,hours=1"], "--measured and --loop")
    refused(tmp_path, ["rig", "influence", "--torque", "0"], "torque = 0")
    refused(tmp_path, ["rig", "influence", "tilt-actuator", "--torque", "5"], "stages")
