"""Exports of recorders without units, and a robot with the motor's angle in joint units: the numbers that are true of them."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from strainwave.files.gear_set import GearSet
from strainwave.identification.identify import Identified, identify, read_measurements
from strainwave.identification.kinds.kind import rank
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.source import measurement_files
from strainwave.questions import QuestionError

from tests.support.answers import mapping_of

SHARED = Path(__file__).parents[3] / "shared"
ARMS = Path(os.environ.get("STRAINWAVE_DATA", SHARED / "data")) / "arms"
TRIALS = Path(os.environ.get("STRAINWAVE_TRIALS", SHARED / "trials"))

needs_arms = pytest.mark.skipif(not ARMS.is_dir(), reason=f"measured data not found: {ARMS} (set STRAINWAVE_DATA)")
needs_trials = pytest.mark.skipif(not TRIALS.is_dir(), reason=f"trials not found: {TRIALS} (set STRAINWAVE_TRIALS)")


def identified(path: Path, given: FileMapping | None = None) -> Identified:
    """The gear of a file; if it asks, with the usual answer."""
    try:
        return identify("csg-20-100", [path], mapping=given)
    except QuestionError as question:
        return identified(path, (given or FileMapping()).updated(mapping_of(question.answers[0])))


def values(found: Identified) -> dict[str, float]:
    return {each.estimate.path: each.estimate.value for each in found.parameters}


@pytest.mark.slow("identification")
@needs_trials
@pytest.mark.parametrize(
    "name", ["moteus/output.csv", "epos/permille.csv", "twincat/scope_single.csv", "plotjuggler/export.csv"]
)
def test_a_joint_is_right_at_the_first_command_or_with_the_options_of_the_question(name: str) -> None:
    found = identified(TRIALS / name)
    assert not found.failed
    assert values(found)["load.gravity_torque"] == pytest.approx(25.0, rel=0.01)
    assert values(found)["gear.friction_input.coulomb"] == pytest.approx(0.060, rel=0.01)
    assert values(found)["gear.friction_input.viscous"] == pytest.approx(4e-4, rel=0.01)


@pytest.mark.slow("identification")
@needs_trials
def test_revolutions_at_the_output_are_decided_by_what_each_reading_leaves() -> None:
    (result,) = identify("csg-20-100", [TRIALS / "moteus" / "output.csv"]).files
    said = "read as rev, rev/s at the output, which leaves 1.4 % of TORQUE unexplained"
    assert any(each.startswith(said) for each in result.remarks)


@pytest.mark.slow("identification")
@needs_arms
def test_friction_of_a_robot_with_its_motor_in_joint_units() -> None:
    """Published for axis 1: 375 to 420 N.m and 1700 to 1900 N.m.s/rad at the joint; a single stroke tells it to some 8 %."""
    ratio = 1798.0 / 7.0
    found = identified(ARMS / "kuka-kr300" / "FF_A.mat", FileMapping(joint="1", constants={"ratio": ratio}))
    assert values(found)["gear.friction_input.coulomb"] * ratio == pytest.approx(397.0, rel=0.12)
    assert values(found)["gear.friction_input.viscous"] * ratio**2 == pytest.approx(1800.0, rel=0.12)
    assert found.files[0].held_out is not None
    assert found.files[0].held_out.relative < 0.5
    assert "friction of the start set" not in {each.name for each in found.failed}  # of another size, but the log is explained


@pytest.mark.slow("identification")
@needs_trials
def test_rank_reads_a_log_as_identify_does() -> None:
    read, start = read_measurements(measurement_files([TRIALS / "moteus" / "output.csv"]), None, GearSet.read("csg-20-100"))
    ((_, file),) = read.items()
    assert isinstance(file, Recognised)
    assert file.units["output_angle"] == "rev"
    assert rank(start, file)[0].error < 0.8  # N.m of 19; 0.98 in radians


@pytest.mark.slow("identification")
@needs_arms
@pytest.mark.parametrize("sign", [1, -1])
def test_a_sign_that_is_given_changes_no_number_of_a_joint_turned_by_hand(sign: int) -> None:
    """Published: 1.67 and 1.88 N.m one way and the other, .083 N.m.s/deg. The torque is counted against the motion."""
    mapping = FileMapping(columns={"joint_torque": "block3"}, sign={"joint_torque": sign})
    found = identify("csg-20-100", [ARMS / "icub" / "left-hip-pitch" / "idle.mat"], mapping=mapping)
    assert not found.failed
    assert values(found)["gear.friction_input.coulomb"] * 100.0 == pytest.approx(1.77, rel=0.06)
    assert values(found)["gear.friction_input.viscous"] * 100.0**2 == pytest.approx(0.083 * 57.3, rel=0.06)
