"""Recordings of real arms and exports of recorders: read at the first command, or asked about with options that work."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised, recognise
from strainwave.identification.reading.several_files import consistent
from strainwave.identification.reading.source import MeasurementFile, MeasurementFiles, measurement_files
from strainwave.questions import QuestionError

from tests.support.answers import mapping_of

SHARED = Path(__file__).parents[3] / "shared"
ARMS = Path(os.environ.get("STRAINWAVE_DATA", SHARED / "data")) / "arms"
TRIALS = Path(os.environ.get("STRAINWAVE_TRIALS", SHARED / "trials"))

needs_arms = pytest.mark.skipif(not ARMS.is_dir(), reason=f"measured data not found: {ARMS} (set STRAINWAVE_DATA)")
needs_trials = pytest.mark.skipif(not TRIALS.is_dir(), reason=f"trials not found: {TRIALS} (set STRAINWAVE_TRIALS)")
MAX_QUESTIONS = 2  # until a file is read


def answered(file: MeasurementFile) -> tuple[Recognised, str]:
    """The file as it is read with the usual answers to its questions, and their options."""
    given, options = FileMapping(), list[str]()
    for _ in range(MAX_QUESTIONS + 1):
        try:
            return recognise(file, given), " ".join(options)
        except QuestionError as question:
            given = given.updated(mapping_of(question.answers[0]))
            options += question.answers[0].options
    raise AssertionError(options)


def files_of(path: Path) -> MeasurementFiles:
    return measurement_files([path])


ARM = {
    "ur10e/ur-20_01_22-joint_1.csv": ("1", {"time", "output_angle", "output_speed", "joint_torque"}, "block3"),
    "ur10e/ur-20_01_22-joint_2.csv": ("2", {"time", "output_angle", "output_speed", "joint_torque"}, "block3"),
    "ur10e/ur-20_01_22-joint_4.csv": ("4", {"time", "output_angle", "output_speed", "joint_torque"}, "block3"),
    "ur10e/ur-20_01_22-joint_5.csv": ("5", {"angle_of_joint_6"}, "block3"),
    "ur10e/ur-20_02_05-20sec_12harm.csv": ("1", {"angle_of_joint_2", "angle_of_joint_6"}, "--joint 1"),
    "ur10e/ur-20_02_19_14harm50secLoad.csv": ("1", {"angle_of_joint_2", "angle_of_joint_6"}, "--joint 1"),
    "ur10e/ur-20_01_17-ptp_10_points.csv": ("5", {"angle_of_joint_2", "angle_of_joint_6"}, "--joint 5"),  # moves most
    "kinova-gen3/joint_1_trapez.csv": ("1", {"time", "output_angle", "output_speed", "joint_torque", "temperature"}, ""),
    "kinova-gen3/joint_4_trapez.csv": ("4", {"time", "output_angle", "output_speed", "joint_torque", "temperature"}, ""),
    "kinova-gen3/joint_7_trapez.csv": ("7", {"time", "output_angle", "output_speed", "joint_torque", "temperature"}, ""),
    "kinova-gen3/RunTrajectory1.csv": ("1", {"angle_of_joint_2", "angle_of_joint_7", "joint_torque"}, "--joint 1"),
    "kinova-gen3/Trajectory1.csv": ("1", {"angle_of_joint_2", "angle_of_joint_7", "joint_torque"}, "--joint 1"),
    "icub/left-hip-pitch/idle.mat": ("", {"time", "output_angle", "output_speed", "joint_torque"}, "block3"),
    "icub/left-hip-pitch/ref.mat": ("", {"time", "output_angle", "output_speed", "joint_torque"}, "block3"),
    "icub/right-ankle-roll/Idle.mat": ("", {"time", "output_angle", "output_speed", "joint_torque"}, "block3"),
    "icub/right-knee/idle.mat": ("", {"time", "output_angle", "output_speed", "joint_torque"}, "block3"),
    "icub/right-knee/ref.mat": ("", {"time", "output_angle", "output_speed", "joint_torque"}, "block3"),
    "kuka-kr300/FF_A.mat": ("1", {"reflected_angle", "reflected_speed", "output_angle", "input_torque"}, "--joint 1"),
}


@needs_arms
@pytest.mark.slow("identification")
@pytest.mark.parametrize("name", ARM)
def test_a_recording_of_an_arm(name: str) -> None:
    (file,) = files_of(ARMS / name).files
    found, options = answered(file)
    joint, channels, part = ARM[name]
    assert found.joint == joint
    assert channels <= set(found.recording.names)
    assert part in options
    assert (options == "") == (part == "")


@needs_arms
def test_one_quantity_a_file() -> None:
    files = files_of(ARMS / "kinova-gen3-split").files
    assert [len(file.parts) for file in files] == [4, 4]
    for file in files:
        found, options = answered(file)
        assert "--joint 1" in options
        assert {"time", "output_angle", "output_speed", "joint_torque", "angle_of_joint_7"} <= set(found.recording.names)


@needs_arms
def test_one_channel_a_file_in_units_that_one_of_them_determines() -> None:
    """Angles up to 90 degrees in files of five seconds; the speeds in the names are in degrees a second."""
    opened = {file.path: file for file in files_of(ARMS / "direct-drive").files}
    found = consistent([recognise(file) for file in opened.values()], opened)
    assert len(found) == 23
    assert {unit for each in found for name, unit in each.units.items() if "angle" in name} == {"deg"}
    assert not any(each.question for each in found)


@needs_arms
def test_the_rate_of_rows_that_are_counted() -> None:
    found = recognise(ARMS / "kinova-gen3" / "joint_2_trapez.csv")
    assert found.recording["time"][-1] == pytest.approx(2.766)
    assert found.columns["joint_torque"] == "TorqueCur2"


TRIAL = {
    "belt150/log.csv": ("log", {"current", "input_angle", "output_angle"}, ""),
    "epos/permille.csv": ("log", {"input_angle", "input_speed", "input_torque"}, "Torque actual value=permille of NUMBER N.m"),
    "loadloss/dyno.csv": ("friction", {"speed", "torque", "output_torque"}, ""),
    "loadloss/dyno_driving_only.csv": ("friction", {"speed", "torque", "output_torque"}, ""),
    "loadloss/friction_load.csv": ("friction", {"speed", "torque", "load_torque"}, ""),
    "lostmotion/full.csv": ("torsion", {"twist", "torque"}, ""),
    "lostmotion/lost.csv": ("torsion", {"twist", "torque"}, ""),
    "moteus/output.csv": ("log", {"output_angle", "output_speed", "joint_torque"}, ""),
    "plotjuggler/export.csv": ("log", {"output_angle", "output_speed", "joint_torque"}, ""),
    "twincat/scope_single.csv": ("log", {"input_angle", "output_angle", "output_speed", "input_torque"}, "counts/1048576"),
}


@needs_trials
@pytest.mark.parametrize("name", TRIAL)
def test_an_export_of_a_recorder(name: str) -> None:
    kind, channels, part = TRIAL[name]
    found, options = answered(MeasurementFile(TRIALS / name))
    assert (found.kind, channels <= set(found.recording.names)) == (kind, True)
    assert part in options
    assert (options == "") == (part == "")


@needs_trials
def test_turns_and_the_side_of_a_drive_are_among_the_alternatives() -> None:
    found = recognise(TRIALS / "moteus" / "output.csv")
    assert found.question
    ways = {" ".join(each.options): each for each in found.alternatives}
    assert "--side input" in ways
    turns = ways["--side output --unit output_angle=rev --unit output_speed=rev/s"]
    assert recognise(TRIALS / "moteus" / "output.csv", mapping_of(turns)).units["output_angle"] == "rev"
