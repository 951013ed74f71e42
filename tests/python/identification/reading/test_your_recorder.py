"""One small file of each recorder of the page "Your recorder", which enters at the first reading or by one question."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from strainwave.files.tables import open_table
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised, recognise
from strainwave.identification.reading.source import measurement_files, other_format

TIME = np.arange(0.0, 6.0, 0.005)
ANGLE = 0.9 * np.sin(1.7 * TIME) + 0.2 * np.sin(4.1 * TIME)
SPEED = np.gradient(ANGLE, TIME)
TORQUE = 25.0 * np.sin(ANGLE) + 6.0 * np.sign(SPEED) + 4.0 * SPEED  # N.m at the joint
RATIO = 100.0
OTHER = 0.3 * np.cos(TIME)


def text(folder: Path, name: str, header: str, columns: Sequence[np.ndarray], mark: str = ",") -> Path:
    folder.joinpath(name).parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(folder / name, np.column_stack(columns), "%.15g", mark, header=header, comments="")
    return folder / name


def numbered(form: str, *series: np.ndarray, first: int = 0) -> tuple[list[str], list[np.ndarray]]:
    return [form.format(place) for place in range(first, first + len(series))], list(series)


def joined(parts: Sequence[tuple[list[str], list[np.ndarray]]], mark: str = ",") -> tuple[str, list[np.ndarray]]:
    return mark.join(name for names, _ in parts for name in names), [each for _, columns in parts for each in columns]


def of_rtde(folder: Path) -> Path:
    """As of `record.py` of the RTDE client of Universal Robots."""
    parts = [(["timestamp"], [1e5 + TIME])]
    parts += [numbered("target_q_{}", ANGLE, OTHER), numbered("actual_q_{}", ANGLE, OTHER)]
    parts += [numbered("actual_qd_{}", SPEED, np.gradient(OTHER, TIME)), numbered("actual_current_{}", TORQUE / 10.0, OTHER)]
    return text(folder, "robot_data.csv", *joined(parts, " "), mark=" ")


def of_libfranka(folder: Path) -> Path:
    """As of `franka::logToCSV`, with a blank behind some commas of its header."""
    parts = [(["time", "success_rate"], [1e3 * TIME, np.ones_like(TIME)])]
    own = {"q": ANGLE, "q_d": ANGLE, "dq": SPEED, "dq_d": SPEED, "tau_J": TORQUE, "tau_ext_hat_filtered": OTHER}
    parts += [numbered(f"state.{name}[{{}}]", values, OTHER) for name, values in own.items()]
    parts += [numbered(f"cmd.{name}[{{}}]", ANGLE, OTHER) for name in ("q_d", "dq_d", "tau_J_d")]
    return text(folder, "log.csv", *joined(parts, ", "), mark=",")


def of_trajectory_controller(folder: Path) -> Path:
    """As `rostopic echo -p` writes the state of a controller of `control_msgs`."""
    parts = [(["%time", "field.header.seq"], [1e9 * (1.7e9 + TIME), np.arange(len(TIME))])]
    for what in ("desired", "actual", "error"):
        share = 0.01 if what == "error" else 1.0
        parts += [
            numbered(f"field.{what}.positions{{}}", share * ANGLE),
            numbered(f"field.{what}.velocities{{}}", share * SPEED),
        ]
    parts.append(numbered("field.actual.effort{}", TORQUE))
    header, columns = joined(parts)
    rows = [
        ",".join(f"{each:.0f}" if place < 2 else f"{each:.9g}" for place, each in enumerate(row))
        for row in zip(*columns, strict=False)
    ]
    (folder / "state.csv").write_text(header + "\n" + "\n".join(rows) + "\n")
    return folder / "state.csv"


def of_plotjuggler(folder: Path) -> Path:
    header = "__time,/joint_states/elbow/position,/joint_states/elbow/velocity,/joint_states/elbow/effort"
    return text(folder, "export.csv", header, [1.7e9 + TIME, ANGLE, SPEED, TORQUE])


def of_odrive(folder: Path) -> Path:
    """With the names of the properties that `odrivetool` reads, of firmware 0.6."""
    turns = RATIO / (2.0 * np.pi)
    names = "time,axis0.pos_vel_mapper.pos_rel,axis0.pos_vel_mapper.vel,axis0.motor.foc.Iq_measured"
    return text(folder, "odrive.csv", names, [TIME, turns * ANGLE, turns * SPEED, TORQUE / 10.0])


def of_moteus(folder: Path) -> Path:
    turns = 1.0 / (2.0 * np.pi)
    columns = [TIME, np.full_like(TIME, 10.0), turns * ANGLE, turns * SPEED, TORQUE, TORQUE / 10.0]
    return text(folder, "moteus.csv", "time,mode,position,velocity,torque,q_current", columns)


def of_echo(folder: Path) -> Path:
    """As `ros2 topic echo /joint_states` prints."""
    blocks = [
        f"header:\n  stamp:\n    sec: {int(time)}\n    nanosec: {round(1e9 * (time % 1.0))}\n  frame_id: ''\nname:\n- elbow\n"
        f"position:\n- {angle:.9f}\nvelocity:\n- {speed:.9f}\neffort:\n- {torque:.9f}\n---\n"
        for time, angle, speed, torque in zip(TIME, ANGLE, SPEED, TORQUE, strict=True)
    ]
    (folder / "echo.txt").write_text("".join(blocks))
    return folder / "echo.txt"


def of_print(folder: Path) -> Path:
    rows = zip(TIME, ANGLE, SPEED, TORQUE, strict=True)
    lines = [f"t: {time:.4f}, q: {angle:.9f}, dq: {speed:.9f}, tau: {torque:.9f}\n" for time, angle, speed, torque in rows]
    (folder / "drive.log").write_text("".join(lines))
    return folder / "drive.log"


def of_tiago(folder: Path) -> Path:
    for quantity, values in (("position", ANGLE), ("velocity", SPEED), ("effort", TORQUE)):
        header = f"t,- arm_1_joint_{quantity},- arm_2_joint_{quantity}"
        text(folder, f"run/run_{quantity}.csv", header, [TIME, values, 0.3 * values])
    return folder / "run"


def of_timetable(folder: Path) -> Path:
    """As MATLAB writes a timetable by `writetimetable`."""
    header = "Time,JointPosition_rad,JointVelocity_rad_s,JointTorque_Nm"
    rows = zip(TIME, ANGLE, SPEED, TORQUE, strict=True)
    lines = [f"{time:.4f} sec,{angle:.9g},{speed:.9g},{torque:.9g}\n" for time, angle, speed, torque in rows]
    (folder / "timetable.csv").write_text(header + "\n" + "".join(lines))
    return folder / "timetable.csv"


def of_legged_robot(folder: Path) -> Path:
    header = "time,joint_pos,joint_vel,tau_cal,tau_est"
    return text(folder, "leg.csv", header, [TIME, ANGLE, SPEED, 1.3 * TORQUE, TORQUE])


def of_yarp(folder: Path) -> Path:
    """As a dumper of YARP writes each port into `data.log` of a folder: count, stamp, values."""
    count = np.arange(len(TIME))
    for port, values in (("positions", np.degrees(ANGLE)), ("torques", TORQUE)):
        text(folder, f"leg/{port}/data.log", "", [count, 1.7e9 + TIME, values], mark=" ")
    return folder / "leg"


EFFORT = FileMapping(units={"joint_torque": "N.m"})
RECORDERS: dict[str, tuple[Callable[[Path], Path], FileMapping]] = {
    "UR RTDE": (of_rtde, FileMapping(joint="0")),
    "libfranka": (of_libfranka, FileMapping(joint="0")),
    "control_msgs": (of_trajectory_controller, EFFORT),
    "PlotJuggler": (of_plotjuggler, EFFORT),
    "ODrive": (of_odrive, FileMapping(side="input", units={"angle": "rev", "speed": "rev/s"})),
    "moteus": (of_moteus, FileMapping(side="output", units={"angle": "rev", "speed": "rev/s"})),
    "ros2 topic echo": (of_echo, EFFORT),
    "printed lines": (of_print, FileMapping()),
    "TIAGo": (of_tiago, FileMapping(joint="1")),
    "MATLAB timetable": (of_timetable, FileMapping()),
    "YARP": (of_yarp, FileMapping(units={"positions": "deg"})),
    "legged robot": (of_legged_robot, FileMapping()),
}


def read(path: Path, mapping: FileMapping) -> Recognised:
    (file,) = measurement_files([path]).files
    assert other_format(file.path) is None
    return recognise(file, mapping)


@pytest.mark.parametrize("name", RECORDERS)
def test_a_file_of_a_recorder_enters_by_one_answer(tmp_path: Path, name: str) -> None:
    write, answer = RECORDERS[name]
    found = read(write(tmp_path), answer)
    assert (found.kind, found.side) == ("log", answer.side or "output")
    rows = slice(len(TIME) - len(found.recording), None)
    time = found.recording.time - found.recording.time[0]
    assert time == pytest.approx(TIME[rows] - TIME[rows][0], abs=2e-6)
    angle = found.recording["output_angle"] if found.side == "output" else found.recording["input_angle"] / RATIO
    assert angle == pytest.approx(ANGLE[rows], abs=1e-6)
    if "current" in found.recording:
        assert found.recording["current"] == pytest.approx(TORQUE[rows] / 10.0, abs=1e-6)
    else:
        assert found.recording["joint_torque"] == pytest.approx(TORQUE[rows], abs=1e-6)


def test_the_samples_of_labview_are_refused_with_what_to_do(tmp_path: Path) -> None:
    (tmp_path / "log.tdms").write_bytes(b"TDSm")
    with pytest.raises(ValueError, match="npTDMS"):
        open_table(tmp_path / "log.tdms")


def test_numbers_of_joints_in_one_column_are_refused_with_what_to_do(tmp_path: Path) -> None:
    joints = np.stack([np.sin(TIME + 0.5 * place) + place for place in range(7)], axis=1)
    np.savetxt(tmp_path / "q.txt", joints.ravel())
    np.savetxt(tmp_path / "tau.txt", 3.0 * joints.ravel())
    with pytest.raises(ValueError, match=r"numbers of 7 joints follow each other in one column; .*reshape\(-1, 7\)"):
        read(tmp_path, FileMapping())
