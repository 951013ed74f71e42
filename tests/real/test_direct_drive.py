"""A direct-drive arm measured by others: constant speeds from 0.1 to 90 deg/s, loops inside stiction, and a slow ramp.

Recordings of github jorgevchin/Friction-Identification. Its own report is not used: gravity and friction are compared with
what one regression over all rows that move gives, which shares nothing with the project.
"""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
import pytest
from strainwave.identification.identify import Identified, identify
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.results.file_result import FileEstimate

DATA = Path(os.environ.get("STRAINWAVE_DATA", Path(__file__).parents[3] / "shared" / "data"))
FOLDER = DATA / "arms" / "direct-drive"

pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason=f"measured data not found: {FOLDER} (set STRAINWAVE_DATA)")


@cache
def pairs() -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Time, angle [rad] and torque of each record, whose channels are files of their own."""
    found = {}
    for path in sorted(FOLDER.glob("*_pos1_*")):
        time, angle = np.loadtxt(path).T
        found[path.stem.replace("_pos1", "")] = time, np.radians(angle), np.loadtxt(str(path).replace("pos1", "tau1"))[:, 1]
    return found


@cache
def arm() -> Identified:
    folder = Path(mkdtemp())
    for name, series in pairs().items():
        header = "time [s],joint_position [rad],joint_torque [N.m]"
        np.savetxt(folder / f"{name}.csv", np.column_stack(series), delimiter=",", header=header, comments="")
    return identify("csg-20-100", sorted(folder.glob("*.csv")), mapping=lambda _: FileMapping(constants={"ratio": 1.0}))


def number(path: str) -> FileEstimate:
    """Return an estimate of the records at constant speed, or else of the first file that has it."""
    found = [each for each in arm().parameters if each.estimate.path == path]
    return next((each.estimate for each in found if each.source == "records at constant speed"), found[0].estimate)


@pytest.mark.slow("identification")
def test_friction_and_gravity_are_those_of_a_regression_over_all_moving_rows() -> None:
    rows = []
    for name, (time, angle, torque) in pairs().items():
        if name.startswith("cin"):
            speed = np.gradient(angle, time)
            moving = (np.abs(speed) > 0.3 * np.median(np.abs(speed[np.abs(speed) > 1e-4]))) & (time > 0.5)
            waves = np.column_stack((np.sin(angle), np.cos(angle)))
            way = np.sign(speed)[:, np.newaxis]
            rows.append(np.column_stack((way, speed, waves, way * waves, torque))[moving])
    table = np.concatenate(rows)
    coulomb, viscous, sine, cosine, *_ = np.linalg.lstsq(table[:, :6], table[:, 6], rcond=None)[0]
    gravity, phase = number("load.gravity_torque"), number("load.gravity_phase")
    assert abs(gravity.value - np.hypot(sine, cosine)) < 2.0 * gravity.sigma < 0.08 * gravity.value
    assert phase.value == pytest.approx(np.arctan2(cosine, sine), abs=0.05)
    friction = number("steady_friction")
    speed = float(friction.law.split()[1])  # the one where it is known best
    assert friction.law == f"at {speed:.3g} rad/s of the input"
    assert friction.value == pytest.approx(coulomb + viscous * speed, rel=0.02)
    assert friction.sigma < 0.5


def test_sweeps_with_irregular_speed_and_rest_at_the_end_are_runs_at_constant_speed() -> None:
    runs = [each for each in arm().files if each.part_of]
    assert len(runs) >= 18
    assert not any(each.refused for each in runs)


@pytest.mark.slow("identification")
def test_loops_inside_stiction_are_presliding_and_a_ramp_breaks_away_behind_them() -> None:
    kinds = {each.name: each.recognised.kind for each in arm().files if each.recognised is not None}
    loops = [each for each in arm().files if each.name.startswith("sig0")]
    assert [kinds[each.name] for each in loops] == ["presliding", "presliding"]
    for each in loops:
        assert "stays below" in " ".join(each.remarks)
        assert all(one.why for one in each.estimates if "stiffness" not in one.path)
    assert 1.2e5 < number("gear.friction_input.bristle_stiffness").value < 1.6e5  # slope behind a reversal: 1.4e5 N.m/rad
    (ramp,) = (each for each in arm().files if each.name.startswith("est"))
    assert "forward: 9.7" in " ".join(ramp.remarks)  # its angle jumps at 10 N.m for the first time
