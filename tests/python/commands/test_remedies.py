"""What a failed check says to do: each option that it prints is accepted with that file, and settles the check."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw

from tests.python.command import Result, strainwave
from tests.python.commands.test_questions import (
    ACCELERATION,
    ANGLE,
    FRICTION,
    NOISE,
    RATIO,
    RPM,
    SPEED,
    SWEEP,
    TIME,
    TORQUE,
    written,
)
from tests.python.identification.candidates.test_motion import TRUTH, record
from tests.python.identification.checks import test_unexplained
from tests.support.answers import outcomes, with_number

WAY = np.sign(np.gradient(SWEEP))
TURNS = 1.5 * ANGLE  # far enough for the sine of gravity to bend
WEIGHED = 1.5 * ACCELERATION + 20.0 * np.sin(TURNS) + 6.0 * np.sign(SPEED) + 4.0 * SPEED + 0.05 * NOISE[0]
LONG = np.arange(0.0, 40.0, 0.002)
ARM = 2.0 * np.sin(0.3 * LONG)
RIPPLE = 0.05 * np.cos(160.0 * ARM + 0.3) + 0.01 * np.random.default_rng(1).standard_normal(len(LONG))
STEADY = 0.3 * np.sign(np.cos(0.3 * LONG)) + 0.3 * np.cos(0.3 * LONG)


def of_recording(folder: Path, recording: sw.Recording, **names: str) -> str:
    """Write a recording, with other names for some of its columns."""
    header = ",".join(f"{names.get(name, name)} [{recording.unit(name)}]" for name in recording.names)
    return written(folder / "a.csv", header, *(recording[name] for name in recording.names))


def changed(recording: sw.Recording, name: str, factor: float) -> sw.Recording:
    return recording.with_column(name, factor * recording[name], recording.unit(name))


def from_rest(folder: Path, recording: sw.Recording, teeth: int = 100, **names: str) -> list[str]:
    """Identify a run from rest; the drive has a gear of half as many teeth as ratio."""
    kinematics = sw.kinematics.StrainWave(flexspline_teeth=teeth, circular_spline_teeth=teeth + 2)
    test_unexplained.start(kinematics=kinematics).save(folder / "start.toml")
    return ["identify", "start.toml", of_recording(folder, recording, **names), "--kind", "run"]


def identified(header: str, *columns: np.ndarray, given: str = "") -> Callable[[Path], list[str]]:
    return lambda folder: ["identify", "csg-20-100", written(folder / "a.csv", header, *columns), *shlex.split(given)]


def of_one_encoder(folder: Path, recording: sw.Recording) -> list[str]:
    constants = ["--constant", "torque_constant=0.08"]
    return ["identify", "hfuc-20-80", of_recording(folder, recording), *constants]


COMMANDS: dict[str, tuple[str, Callable[[Path], list[str]]]] = {
    "a table of the joint, named as of the motor": (
        "friction of the start set",
        identified("motor_speed [rpm],motor_torque [N.m]", RPM / 10.0, FRICTION / 20.0),
    ),
    "a table of the motor, named as of the joint": (
        "friction of the start set",
        identified("joint_speed [rpm],joint_torque [N.m]", RPM / 10.0, FRICTION / 1000.0),
    ),
    "a torsion loop as one before it slides": (
        "friction at rest",
        identified("angle [rad],torque [N.m]", 2e-3 * SWEEP, 50.0 * SWEEP + 2.0 * WAY, given="--kind presliding"),
    ),
    "a torsion loop of the input as one of the output": (
        "stiffness of the start set",
        identified("angle [rad],torque [N.m]", 0.05 * SWEEP, 0.14 * SWEEP + 0.01 * WAY, given="--side output"),
    ),
    "a torsion loop of the output, named as of the input": (
        "stiffness of the start set",
        identified("input_angle [rad],input_torque [N.m]", 2e-3 * SWEEP, 55.0 * SWEEP + 2.0 * WAY, given="--kind torsion"),
    ),
    "a torque of the joint, named as of the motor": (
        "friction of the start set",
        identified("t [s],q [rad],motor_torque [Nm]", TIME, ANGLE, TORQUE),
    ),
    "a torque of the motor, named as of the joint": (
        "friction of the start set",
        identified("t [s],q [rad],joint_torque [Nm]", TIME, ANGLE, TORQUE / RATIO),
    ),
    "thousandths as mN.m": (
        "unit of the torque",
        identified(
            "t [s],Position actual value [rad],Torque actual value", TIME, RATIO * ANGLE, np.round(TORQUE / 0.04),
            given="--unit 'Torque actual value=mN.m'",
        ),
    ),
    "a speed in another unit": (
        "speed against angle",
        identified("t [s],q [rad],dq [rad/s],tau [Nm]", TIME, ANGLE, np.degrees(SPEED), TORQUE),
    ),
    "an angle in another unit than its speed": (
        "speed against angle",
        identified("t [s],q [rad],dq [rad/s],tau [Nm]", TIME, np.degrees(ANGLE), SPEED, TORQUE),
    ),
    "two encoders of another ratio": (
        "ratio of two encoders",
        identified(
            "t [s],motor_angle [rad],joint_angle [rad],current [A]", TIME, 80.0 * ANGLE, ANGLE, TORQUE / 8.0,
            given="--constant torque_constant=0.1",
        ),
    ),
    "another torque constant than the voltage has": (
        "torque constant by the voltage",
        identified(
            "t [s],motor_angle [rad],current [A],voltage [V]", TIME, RATIO * ANGLE, TORQUE / 10.0,
            0.08 * TORQUE + 0.1 * RATIO * SPEED + 0.01 * NOISE[2], given="--constant torque_constant=0.2",
        ),
    ),
    "another ratio than gravity has": (
        "ratio by gravity",
        identified("t [s],motor_angle [rad],motor_torque [Nm]", TIME, 160.0 * TURNS, WEIGHED / 160.0),
    ),
    "another ratio than the ripple has": (
        "ratio by orders",
        identified("t [s],joint_angle [rad],current [A]", LONG, ARM, STEADY + RIPPLE),
    ),
    "revolutions as radians": (
        "angle in the sine of gravity",
        lambda folder: of_one_encoder(folder, changed(record(TRUTH, 0.02), "input_angle", 0.5 / np.pi)),
    ),
    "an angle of the joint, named as of the motor": (
        "angle in the sine of gravity",
        lambda folder: of_one_encoder(folder, changed(record(TRUTH, 0.02), "input_angle", -1.0 / 80.0)),
    ),
    "a run from rest in degrees as radians": (
        "error left unexplained",
        lambda folder: from_rest(folder, changed(test_unexplained.log(), "input_angle", 180.0 / np.pi)),
    ),
    "a run from rest with its encoders exchanged": (
        "error left unexplained",
        lambda folder: from_rest(
            folder, test_unexplained.log(), input_angle="joint_encoder", output_angle="motor_encoder"
        ),
    ),
    "a run from rest of another ratio": (
        "error left unexplained",
        lambda folder: from_rest(folder, test_unexplained.log(), teeth=80),
    ),
}  # fmt: skip


def failed(result: Result) -> str:
    """The names of the failed checks, as the summary of a file lists them."""
    return " ".join(line for line in result.stdout.splitlines() if line.lstrip().startswith("FAILED: ") and "see above" in line)


@pytest.mark.slow("commands")
@pytest.mark.parametrize("mistake", COMMANDS)
def test_an_option_of_a_remedy_settles_its_check(tmp_path: Path, mistake: str) -> None:
    check, command = COMMANDS[mistake]
    words = command(tmp_path)
    result = strainwave(*words, folder=tmp_path)
    assert result.returncode == 3, result.stderr
    assert check in failed(result)
    options = re.findall(
        r"(?:--(?:side|unit|constant|column|kind) (?:'[^']*'|[^\s;,:)]+) ?)+",
        " ".join(line for line in result.stdout.splitlines() if "what to do: " in line),
    )
    assert options, result.stdout
    for added in dict.fromkeys(options):
        again = [*words, *map(with_number, shlex.split(added))]
        settled = [other for _, other in outcomes(again, tmp_path) if other.returncode in (0, 3) and check not in failed(other)]
        assert settled, f"{added}: {strainwave(*again, folder=tmp_path)}"
