"""Gears of real joints, written and predicted with; `python -m tests.evidence.round_trip` measures all of them."""

from __future__ import annotations

import pytest

from tests.evidence import real_joints, round_trip

pytestmark = pytest.mark.skipif(
    not real_joints.ARMS.is_dir(), reason=f"measured data not found: {real_joints.ARMS} (set STRAINWAVE_DATA)"
)
CHOSEN = (  # a joint that moves with others, one in one direction, and one whose torque is measured behind the gear
    "ur10e/ur-20_01_17-ptp_10_points.csv 5",
    "kinova-gen3/joint_6_trapez.csv",
    "icub/left-hip-pitch/ref.mat",
)
RECORDS = [record for record in round_trip.joints() if record[0] in CHOSEN]


@pytest.mark.slow("identification")
@pytest.mark.parametrize("record", RECORDS, ids=lambda record: record[0])
def test_predict_has_the_error_that_the_gear_file_states(record: round_trip.Record) -> None:
    found = round_trip.round_trip(*record)
    assert found.problem == ""
    assert found.predicted == pytest.approx(found.stated, rel=1e-6)
