"""Files of robot arms are read, or refused with the option that settles it; the arm is of plain NumPy (tests.evidence.arms)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised, recognise
from strainwave.questions import QuestionError

from tests.evidence import arms
from tests.support.answers import options_of

JOINT = arms.Joint()


@pytest.fixture(scope="module")
def seen() -> dict[str, np.ndarray]:
    done = arms.run((JOINT,) * 3, arms.fourier(6.0, (0, 1, 2), seed=1))
    return arms.Recorder(rate=200.0)(done)


def is_joint(
    found: Recognised, seen: dict[str, np.ndarray], joint: int, effort: str = "motor_torque", resolution: float = 1e-3
) -> None:
    assert (found.kind, found.side) == ("log", "output")
    recording = found.recording
    assert recording["output_angle"] == pytest.approx(seen["q"][joint], abs=resolution)
    assert np.diff(recording["time"]) == pytest.approx(np.diff(seen["time"]), abs=1e-3)
    name = "current" if effort == "current" else "joint_torque"
    assert recording[name] == pytest.approx(seen[effort][joint], abs=resolution)


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


@pytest.mark.slow("identification")  # each of 28 answers is read
def test_a_table_without_names_is_read_by_its_layout(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    arms.headerless(tmp_path / "log.csv", seen)
    with pytest.raises(
        ValueError, match=r"column 1 is the time, columns 2 to 7 are the angle of joints, columns 8 to 13 "
    ) as refused:
        recognise(tmp_path / "log.csv")
    ways = [
        f"--joint 2 --column {channel}={block}" for block in ("block3", "block4") for channel in ("joint_torque", "current")
    ]
    assert options_of(refused.value) == ways, "both questions are answered at once, with the joint that moves most"
    assert "the others are 1, 2, 3, 4, 5, 6, all" in str(refused.value)
    is_joint(recognise(tmp_path / "log.csv", FileMapping(joint="2", columns={"current": "block3"})), seen, 1, "current")
    columns = {"time": "1", "output_angle": "3", "output_speed": "9", "current": "15"}
    is_joint(recognise(tmp_path / "log.csv", FileMapping(columns=columns)), seen, 1, "current")


def test_a_time_that_counts_milliseconds_is_found_by_the_speed(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    arms.kinova(tmp_path / "log.csv", arms.Recorder(rate=1000.0)(arms.run((JOINT,) * 3, arms.fourier(4.0, (1,), seed=2))))
    found = recognise(tmp_path / "log.csv", FileMapping(joint="2"))
    assert any("Time in ms as Velocity2 is then the slope of Position2" in remark for remark in found.remarks)
    assert found.recording["time"][-1] == pytest.approx(3.9, abs=0.01)


def test_of_duplicates_the_torque_from_the_current_is_taken(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    arms.kinova(tmp_path / "log.csv", arms.Recorder(rate=1000.0)(arms.run((JOINT,) * 3, arms.fourier(4.0, (1,), seed=2))))
    found = recognise(tmp_path / "log.csv", FileMapping(joint="2"))
    assert found.columns["joint_torque"] == "TorqueCur2"
    assert "current" not in found.recording.names
    assert any("--column joint_torque=NAME takes another one of " in remark for remark in found.remarks)
    other = recognise(tmp_path / "log.csv", FileMapping(joint="2", columns={"joint_torque": "Torque"}))
    assert other.columns["joint_torque"] == "Torque2"
    assert not any("takes another one of " in remark for remark in other.remarks)


def test_u_of_a_robot_may_be_anything_that_drives_it(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    arms.log_text(tmp_path / "log.log", seen)
    with pytest.raises(QuestionError, match=r"u2 may be a torque, a current or a voltage") as asked:
        recognise(tmp_path / "log.log", FileMapping(joint="2"))
    of_voltage = "--column voltage=u2 --constant resistance=NUMBER --constant torque_constant=NUMBER"
    assert options_of(asked.value) == ["--column joint_torque=u2", "--column current=u2", of_voltage]
    is_joint(recognise(tmp_path / "log.log", FileMapping(joint="2", columns={"joint_torque": "u2"})), seen, 1)


def test_a_single_number_is_the_rate_of_rows_without_time(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    arms.hand_driven(tmp_path / "hand.mat", seen)
    found = recognise(tmp_path / "hand.mat", FileMapping(side="output"))
    assert "fs = 200 is taken for the rate of its rows: 200 Hz" in found.remarks
    is_joint(found, seen, 1, "joint_torque")


def test_an_angle_that_no_gear_twists_by_is_no_torsion_loop(tmp_path: Path) -> None:
    angle = np.degrees(np.sin(np.linspace(0.0, 20.0, 400)))
    np.savetxt(
        tmp_path / "a.csv", np.column_stack([angle, angle**3 / 1e4]), "%.6f", ",", header="joint_angle_deg,torque", comments=""
    )
    with pytest.raises(QuestionError, match=r"joint_angle_deg moves by 2 rad, by which no gear twists") as asked:
        recognise(tmp_path / "a.csv")
    assert options_of(asked.value)[0] == "--constant rate=NUMBER"
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
    with pytest.raises(QuestionError, match=r"motor_angle_deg and motor_current go to and fro") as asked:
        recognise(tmp_path / "a.csv")
    assert options_of(asked.value) == ["--constant rate=NUMBER", "--kind presliding"]


def test_constant_speed_in_the_words_of_robots_is_at_the_output(tmp_path: Path) -> None:
    time = np.arange(0.0, 10.0, 0.01)
    rows = np.column_stack([0.3 * time, np.full(len(time), 0.3), np.full(len(time), 0.5)])
    np.savetxt(tmp_path / "a.csv", rows, "%.6f", ",", header="q,dq,current", comments="")
    found = recognise(tmp_path / "a.csv")
    assert (found.kind, found.side) == ("effort", "output")


def test_the_joint_that_moves_alone_is_taken_with_a_remark(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    alone = arms.Recorder(rate=200.0)(arms.run((JOINT,) * 3, arms.fourier(4.0, (2,), seed=1)))
    arms.mat(tmp_path / "one.mat", alone)
    found = recognise(tmp_path / "one.mat")
    is_joint(found, alone, 2)
    assert "joint 3 alone moves, and is taken" in found.remarks
    arms.mat(tmp_path / "all.mat", seen)
    with pytest.raises(QuestionError, match=r"it has 3 joints \(1, 2, 3\)") as asked:
        recognise(tmp_path / "all.mat")
    assert options_of(asked.value) == ["--joint 1", "--joint 2", "--joint 3", "--joint all"]


def written(path: Path, columns: dict[str, np.ndarray]) -> Path:
    np.savetxt(path, np.column_stack(list(columns.values())), "%.7f", ",", header=",".join(columns), comments="")
    return path


def joints(name: str, series: np.ndarray) -> dict[str, np.ndarray]:
    return {name.format(number): each for number, each in enumerate(series, start=1)}


def test_numbers_of_the_robot_are_none_of_its_joints(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    """Names and time as a KUKA LBR iiwa writes them: whole seconds, and nanoseconds beside."""
    time = {"ZeitInSec": np.floor(seen["time"]), "ZeitInNanoSec": np.round(seen["time"] % 1.0 * 1e9)}
    angles, torques = (
        joints(f"axis{what}Msr_LBR_iiwa_14_R820_1_A{{}}", seen[name]) for what, name in (("Q", "q"), ("Tau", "motor_torque"))
    )
    found = recognise(written(tmp_path / "a.csv", time | angles | torques), FileMapping(joint="2"))
    is_joint(found, seen, 1)


def test_degrees_that_begin_anew_have_the_slope_of_their_speed(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    angles = joints("actuator{}.position", np.degrees(seen["q"]) % 360.0)
    speeds = joints("actuator{}.velocity", np.degrees(seen["dq"]))
    columns = {"timestamp": seen["time"]} | angles | speeds | joints("actuator{}.torque", seen["motor_torque"])
    found = recognise(written(tmp_path / "a.csv", columns), FileMapping(joint="2"))
    assert (found.units["output_angle"], found.units["output_speed"]) == ("deg", "deg/s")
    assert found.recording["output_speed"] == pytest.approx(seen["dq"][1], abs=1e-6)


def test_the_sides_of_two_angles_are_determined_by_their_ranges(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    columns = {"time": seen["time"], "theta": seen["theta"][1], "q": seen["q"][1], "tau_J": seen["joint_torque"][1]}
    found = recognise(written(tmp_path / "a.csv", columns))
    assert (found.columns["input_angle"], found.columns["output_angle"]) == ("theta", "q")
    assert any("so it is that of the input" in why for why in found.why)
    scaled = {
        "time": seen["time"],
        "phi": columns["theta"] / JOINT.ratio,
        "theta": columns["q"],
        "tau_J": columns["tau_J"],
    }
    with pytest.raises(QuestionError, match=r"which of .* is that of the motor is not determined") as asked:
        recognise(written(tmp_path / "b.csv", scaled))
    sides = {f"--column input_angle={a} --column output_angle={b}" for a, b in (("phi", "theta"), ("theta", "phi"))}
    assert set(options_of(asked.value)) == sides


def test_the_q_of_a_motor_may_be_as_far_as_it_likes(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    columns = {"t": seen["time"], "qm": seen["theta"][1], "ql": seen["q"][1], "taum": seen["motor_torque"][1] / JOINT.ratio}
    found = recognise(written(tmp_path / "a.csv", columns))
    assert (found.units["input_angle"], found.units["output_angle"]) == ("rad", "rad")
    assert (found.columns["input_angle"], found.columns["input_torque"]) == ("qm", "taum")


def test_an_angle_without_a_unit_may_be_of_a_motor_or_of_a_joint_in_degrees(
    tmp_path: Path, seen: dict[str, np.ndarray]
) -> None:
    columns = {"t": seen["time"], "theta": np.degrees(seen["q"][1]), "tau": seen["joint_torque"][1]}
    path = written(tmp_path / "a.csv", columns)
    found = recognise(path)
    assert options_of(found.question) == ["--side input", "--side output --unit theta=deg"]
    assert [each.given["units"] for each in found.alternatives if each.given["side"] == "output"] == [{"theta": "deg"}]
    is_joint(recognise(path, FileMapping(side="output")), seen, 1, "joint_torque")
    assert recognise(path, FileMapping(side="input")).units["input_angle"] == "rad"
    fast = written(tmp_path / "b.csv", columns | {"theta": 20.0 * columns["theta"]})
    assert recognise(fast).side == "input"


def test_the_question_of_a_matrix_without_time_names_its_blocks(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    """Angles, speeds, accelerations and torques of all joints, as in data sets for learning inverse dynamics."""
    alone = arms.Recorder(rate=200.0)(arms.run((JOINT,) * 3, arms.fourier(4.0, (1,), seed=1)))
    rows = [*alone["q"], *alone["dq"], *np.gradient(alone["dq"], 0.005, axis=1), *alone["motor_torque"]]
    np.savetxt(tmp_path / "a.txt", np.column_stack(rows))
    with pytest.raises(ValueError, match="columns 1 to 3 are the angle of joints, columns 4 to 6 are the speed") as refused:
        recognise(tmp_path / "a.txt")
    assert "block4 = columns 10 to 12" in str(refused.value)
    assert options_of(refused.value)[0] == "--column joint_torque=block4 --constant rate=NUMBER"
    mapping = FileMapping(columns={"joint_torque": "block4"}, constants={"rate": 200.0})
    assert recognise(tmp_path / "a.txt", mapping).recording["output_angle"] == pytest.approx(alone["q"][1])
    np.savetxt(tmp_path / "b.txt", alone["current"][1])
    with pytest.raises(QuestionError, match="no column has a name that is known") as asked:
        recognise(tmp_path / "b.txt")
    assert "--column current=column_1 --constant speed=NUMBER" in options_of(asked.value)


def test_what_a_person_names_needs_no_choice_of_what_is_like_it(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    """Names of a benchmark of nonlinear systems: inputs and outputs, in degrees."""
    columns = joints("y_train_{}", np.degrees(seen["q"])) | joints("u_train_{}", seen["motor_torque"])
    mapping = FileMapping(columns={"output_angle": "y_train_2", "joint_torque": "u_train_2"}, units={"output_angle": "deg"})
    found = recognise(written(tmp_path / "a.csv", {"time_train": seen["time"]} | columns), mapping)
    is_joint(found, seen, 1)


def test_a_share_of_a_rated_torque_needs_the_rated_torque(tmp_path: Path, seen: dict[str, np.ndarray]) -> None:
    columns = {"t": seen["time"], "joint_pos_rad": seen["q"][1], "torque_permille": seen["current"][1]}
    path = written(tmp_path / "a.csv", columns)
    with pytest.raises(ValueError, match=r"of which rated value torque_permille is a share") as asked:
        recognise(path)
    assert options_of(asked.value) == ["--unit 'torque_permille=permille of NUMBER N.m'"]
    found = recognise(path, FileMapping(units={"torque": "permille of 0.4 N.m"}))
    assert found.recording["input_torque"] == pytest.approx(0.4e-3 * seen["current"][1], abs=1e-9)


def test_a_file_that_names_no_joint_is_of_the_one_that_is_asked_for(tmp_path: Path) -> None:
    """As a friction table among the logs of an arm."""
    speed = np.array([0.1, 0.2, 0.4, 0.8, -0.1, -0.2, -0.4, -0.8])
    path = written(tmp_path / "a.csv", {"joint speed [rad/s]": speed, "joint torque [N.m]": 5.0 * np.sign(speed) + speed})
    found = recognise(path, FileMapping(joint="2"))
    assert found.kind == "friction"
    assert "its columns name no joint: they are taken for those of joint 2" in found.remarks
