"""Logs of joints measured by others: delays, the pass band of a log in amperes, and outliers."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.candidates.motion import MAX_DELAY_SAMPLES
from strainwave.identification.experiments.motion_log import spoilt
from strainwave.identification.identify import identify
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import recognise

DATA = Path(os.environ.get("STRAINWAVE_DATA", Path(__file__).parents[3] / "shared" / "data")) / "arms"
MAX_OUTLIERS = 0.01  # of the samples of a channel without any

pytestmark = pytest.mark.skipif(not DATA.is_dir(), reason=f"measured data not found: {DATA} (set STRAINWAVE_DATA)")


@pytest.mark.parametrize("joint", ["left-hip-pitch", "right-knee"])
def test_the_delay_of_a_joint_turned_by_hand_is_bounded(joint: str) -> None:
    """Without a bound the torque of the hand comes 3.8 s, or 1.2 s, before the motion that it makes."""
    columns = {"output_angle": "out_1", "output_speed": "out_2", "joint_torque": "out_3"}
    said = FileMapping(kind="log", columns=columns)
    (file,) = identify("csg-20-100", [DATA / "icub" / joint / "idle.mat"], mapping=said, accept=True).files
    assert file.fit is not None
    assert file.recognised is not None
    step = float(np.median(np.diff(file.recognised.recording.time)))
    delays = [each.value for each in file.fit.estimates if each.path == "delay"]
    assert all(abs(delay) < MAX_DELAY_SAMPLES * step for delay in delays)


def test_friction_in_amperes_without_a_torque_constant_is_that_of_the_joint() -> None:
    """By stiffness in N.m/rad over inertia in A.s2/rad the pass band ends at 1.5 Hz: 0.55 A, where 1.8 A are right."""
    columns = {"time": "1", "output_angle": "2", "output_speed": "8", "current": "14"}
    said = FileMapping(columns=columns, constants={"ratio": 101.0})
    (file,) = identify("csg-20-100", [DATA / "ur10e" / "ur-20_01_22-joint_1.csv"], mapping=said).files
    coulomb = next(each for each in file.estimates if each.path.endswith("coulomb"))
    assert coulomb.unit == "A"
    assert abs(coulomb.value - 1.8) < 2.0 * coulomb.sigma < 0.2


@pytest.mark.parametrize("axis", [1, 2, 3, 4, 5, 6])
def test_ripple_that_grows_with_the_speed_has_no_outliers(axis: int) -> None:
    """A threshold from the whole record took 7 to 14 % of these torques for outliers."""
    columns = {"time": "rec.time_cont", "output_angle": "rec.act_pos_se_deg_{}", "input_torque": "rec.act_torque_abs_nm_{}"}
    said = {name: column.format(axis) for name, column in columns.items()}
    units = {"output_angle": "deg", "input_torque": "N.m"}
    found = recognise(DATA / "kuka-kr300" / "FF_A.mat", FileMapping(columns=said, units=units))
    assert np.mean(spoilt(found.recording["input_torque"])) < MAX_OUTLIERS
