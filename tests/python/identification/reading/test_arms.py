"""Files of robot arms are read, or refused with the option that settles it; the arm is of plain NumPy (tests.arms)."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised, recognise

from tests import arms

JOINT = arms.Joint()


@pytest.fixture(scope="module")
def seen() -> dict[str, np.ndarray]:
    done = arms.run((JOINT,) * 3, arms.fourier(6.0, (0, 1, 2), seed=1))
    return arms.Recorder(rate=200.0)(done)


def is_joint(
    found: Recognised, seen: dict[str, np.ndarray], joint: int, effort: str = "motor_torque", told: float = 1e-3
) -> None:
    assert (found.kind, found.side) == ("log", "output")
    recording = found.recording
    assert recording["output_angle"] == pytest.approx(seen["q"][joint], abs=told)
    assert np.diff(recording["time"]) == pytest.approx(np.diff(seen["time"]), abs=1e-3)
    name = "current" if effort == "current" else "joint_torque"
    assert recording[name] == pytest.approx(seen[effort][joint], abs=told)


@pytest.mark.parametrize(
    ("write", "name", "joint", "effort"),
    [
        (arms.rtde, "log.csv", "1", "current"),
        (arms.panda, "log.csv", "2", "motor_torque"),
        (arms.mat, "log.mat", "2", "motor_torque"),
        (arms.npz, "log.npz", "2", "motor_torque"),
        (arms.json_columns, "log.json", "2", "motor_torque"),
        (arms.json_rows, "log.jsonl", "J2", "motor_torque"),
        (arms.joint_states, "bag", "shoulder_lift_joint", "motor_torque"),
    ],
)
def test_one_joint_of_an_arm(
    tmp_path: Path, seen: dict[str, np.ndarray], write: Callable[..., None], name: str, joint: str, effort: str
) -> None:
    if name == "bag":
        pytest.importorskip("rosbags")
    write(tmp_path / name, seen)
    is_joint(recognise(tmp_path / name, FileMapping(joint=joint)), seen, 1, effort)


def test_a_table_without_names_says_what_its_columns_seem_to_be(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    arms.headerless(tmp_path / "log.csv", seen)
    with pytest.raises(ValueError, match=re.escape("column 1 rises as a time does, and column ")) as refused:
        recognise(tmp_path / "log.csv", FileMapping(joint="2"))
    assert "--column time=1 --column output_angle=" in str(refused.value)
    columns = {"time": "1", "output_angle": "3", "output_speed": "9", "current": "15"}
    is_joint(recognise(tmp_path / "log.csv", FileMapping(columns=columns)), seen, 1, "current")


def test_a_time_that_counts_milliseconds_is_found_by_the_speed(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    arms.kinova(tmp_path / "log.csv", arms.Recorder(rate=1000.0)(arms.run((JOINT,) * 3, arms.fourier(4.0, (1,), seed=2))))
    with pytest.raises(ValueError, match=r"Torque.*2 may .*be the .*; say which, as with --column"):
        recognise(tmp_path / "log.csv", FileMapping(joint="2"))
    found = recognise(tmp_path / "log.csv", FileMapping(joint="2", columns={"joint_torque": "TorqueCur2"}))
    assert any("Time in ms as Position2 then moves as Velocity2 says" in remark for remark in found.remarks)
    assert found.recording["time"][-1] == pytest.approx(3.9, abs=0.01)
    assert "current" not in found.recording.names  # a person named what tells the torque


def test_u_of_a_robot_may_be_anything_that_drives_it(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    arms.log_text(tmp_path / "log.log", seen)
    with pytest.raises(ValueError, match=r"u2 may be a torque, a current or a voltage; say it with --column joint_torque=u2 "):
        recognise(tmp_path / "log.log", FileMapping(joint="2"))
    is_joint(recognise(tmp_path / "log.log", FileMapping(joint="2", columns={"joint_torque": "u2"})), seen, 1)


def test_a_single_number_tells_the_rate_of_rows_without_time(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    arms.hand_driven(tmp_path / "hand.mat", seen)
    found = recognise(tmp_path / "hand.mat", FileMapping(side="output"))
    assert "fs = 200 is taken for the rate of its rows: 200 Hz" in found.remarks
    is_joint(found, seen, 1, "joint_torque")


def test_an_angle_that_no_gear_twists_by_is_no_torsion_loop(tmp_path: Path) -> None:
    angle = np.degrees(np.sin(np.linspace(0.0, 20.0, 400)))
    np.savetxt(
        tmp_path / "a.csv", np.column_stack([angle, angle**3 / 1e4]), "%.6f", ",", header="joint_angle_deg,torque", comments=""
    )
    with pytest.raises(
        ValueError, match=r"joint_angle_deg moves by 2 rad, by which no gear twists: .*--constant rate=HZ; .*--kind torsion"
    ):
        recognise(tmp_path / "a.csv")
    assert recognise(tmp_path / "a.csv", FileMapping(constants={"rate": 100.0})).kind == "log"


def test_steady_stretches_of_samples_are_a_table(tmp_path: Path) -> None:
    random = np.random.default_rng(1)
    speeds = np.array([0.1, -0.1, 0.3, -0.3, 0.6, -0.6])
    speed = np.concatenate([np.concatenate([np.linspace(0.0, each, 100), np.full(1000, each)]) for each in speeds])
    torque = np.sign(speed) * 5.0 + 2.0 * speed + random.normal(0.0, 0.2, len(speed))
    rows = np.column_stack([speed + random.normal(0.0, 1e-3, len(speed)), torque])
    np.savetxt(tmp_path / "a.csv", rows, "%.6f", ",", header="dq [rad/s],tau [N.m]", comments="")
    found = recognise(tmp_path / "a.csv")
    assert (found.kind, found.side) == ("friction", "output")
    assert found.recording["speed"] == pytest.approx(speeds, rel=0.01)
    assert found.recording["torque"] == pytest.approx(np.sign(speeds) * 5.0 + 2.0 * speeds, abs=0.03)
    assert any("the means of 6 stretches at one speed are taken" in remark for remark in found.remarks)


def test_a_noisy_constant_speed_is_one_speed(tmp_path: Path) -> None:
    resting = arms.resting(5.0)
    resting[1] += 0.3 * np.arange(resting.shape[1]) / arms.FINE
    arms.constant_speed(tmp_path / "a.csv", arms.run((JOINT,) * 3, resting), 1, 500.0)
    assert recognise(tmp_path / "a.csv").kind == "effort"


def test_a_motor_that_goes_to_and_fro_without_time_is_asked_for(tmp_path: Path) -> None:
    angle = 90.0 * np.sin(np.linspace(0.0, 20.0, 400))
    rows = np.column_stack([angle, np.sign(angle)])
    np.savetxt(tmp_path / "a.csv", rows, "%.6f", ",", header="motor_angle_deg,motor_current", comments="")
    with pytest.raises(
        ValueError, match=r"motor_angle_deg and motor_current go to and fro .*--kind presliding, .*--constant rate=HZ"
    ):
        recognise(tmp_path / "a.csv")


def test_constant_speed_in_the_words_of_robots_is_at_the_output(tmp_path: Path) -> None:
    time = np.arange(0.0, 10.0, 0.01)
    rows = np.column_stack([0.3 * time, np.full(len(time), 0.3), np.full(len(time), 0.5)])
    np.savetxt(tmp_path / "a.csv", rows, "%.6f", ",", header="q,dq,current", comments="")
    found = recognise(tmp_path / "a.csv")
    assert (found.kind, found.side) == ("effort", "output")


def test_the_joint_that_moves_alone_is_taken_and_told(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    alone = arms.Recorder(rate=200.0)(arms.run((JOINT,) * 3, arms.fourier(4.0, (2,), seed=1)))
    arms.mat(tmp_path / "one.mat", alone)
    found = recognise(tmp_path / "one.mat")
    is_joint(found, alone, 2)
    assert "joint 3 alone moves, and is taken; --joint says another one" in found.remarks
    arms.mat(tmp_path / "all.mat", seen)
    with pytest.raises(
        ValueError, match=r"it holds 3 joints \(1, 2, 3\).* say which with --joint 1, or .* --column output_angle=q_1"
    ):
        recognise(tmp_path / "all.mat")
