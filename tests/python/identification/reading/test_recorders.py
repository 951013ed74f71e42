"""Exports of recorders, in the layouts of their makers: a joint that swings, with numbers of plain NumPy."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from strainwave.identification.checks.logs import unit_of_torque
from strainwave.identification.identify import identify
from strainwave.identification.joints import identify_joints
from strainwave.identification.reading.joints import joints_of
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised, recognise
from strainwave.identification.reading.several_files import consistent
from strainwave.identification.reading.source import MeasurementFile, measurement_files, with_parts

from tests.support.answers import options_of

Array = NDArray[np.float64]

TIME = np.arange(0.0, 8.0, 0.004)
ANGLE = 0.9 * np.sin(1.7 * TIME) + 0.2 * np.sin(4.1 * TIME)
SPEED = 0.9 * 1.7 * np.cos(1.7 * TIME) + 0.2 * 4.1 * np.cos(4.1 * TIME)
TORQUE = 25.0 * np.sin(ANGLE) + 6.0 * np.sign(SPEED) + 4.0 * SPEED  # N.m at the joint
RATIO = 100.0


def written(path: Path, header: str, columns: Sequence[Array], mark: str = ",", decimal: str = ".") -> Path:
    rows = [
        mark.join("" if np.isnan(each) else f"{each:.9g}".replace(".", decimal) for each in row)
        for row in zip(*columns, strict=True)
    ]
    path.write_text(header + "\n".join(rows) + "\n", encoding="utf-8")
    return path


def check_joint(found: Recognised, angle: Array = ANGLE, torque: Array = TORQUE, time: Array = TIME) -> None:
    assert (found.kind, found.side) == ("log", "output")
    assert found.recording["time"] - found.recording["time"][0] == pytest.approx(time - time[0], abs=1e-6)
    assert found.recording["output_angle"] == pytest.approx(angle, abs=1e-6)
    assert found.recording["joint_torque"] == pytest.approx(torque, abs=1e-6)


# ---- Scopes of drives


def test_a_scope_of_twincat_with_one_time(tmp_path: Path) -> None:
    header = (
        "Name\tBench\nFile\tC:\\x.csv\nStarttime of export\t132959733843760000\tMontag, 2. Mai 2022\t15:56:24.376\n\n\n"
        "Name\tAxis1.ActPos\tAxis1.ActVelo\tMotor position\tAxis1.ActTorque\nSymbolComment\t\t\t\t\n"
        "Data-Type\tREAL64\tREAL64\tREAL64\tREAL64\nSampleTime[ms]\t4\t4\t4\t4\n"
        "Unit\t° (Angle)\t°/s (Angular velocity)\t(None)\t(None)\nOffset\t0\t0\t0\t0\n\n"
    )
    counts = np.round(ANGLE * RATIO / (2.0 * np.pi) * 2**20)
    share = np.round(TORQUE / RATIO / 0.4e-3)
    columns = [1e3 * TIME, np.degrees(ANGLE), np.degrees(SPEED), counts, share]
    path = written(tmp_path / "scope.csv", header, columns, "\t", ",")
    lacks = r"how many counts .* Motor position and of which rated value Axis1.* 1048576 at a ratio of 100"
    with pytest.raises(ValueError, match=lacks) as asked:
        recognise(path)
    options = "--unit 'Motor position=counts/1048576' --unit 'Axis1.ActTorque=permille of NUMBER N.m'"
    assert options_of(asked.value) == [options]
    (answer,) = asked.value.answers
    assert answer.gives.endswith(f"input_torque to {np.abs(share).max():.3g} permille of NUMBER N.m")  # of no invented value
    units = {"Motor position": "counts/1048576", "Axis1.ActTorque": "permille of 0.4 N.m"}
    found = recognise(path, FileMapping(units=units))
    assert found.recording["input_angle"] == pytest.approx(RATIO * ANGLE, abs=1e-5)
    assert found.recording["output_angle"] == pytest.approx(ANGLE, abs=1e-6)
    assert found.recording["input_torque"] == pytest.approx(TORQUE / RATIO, abs=3e-4)
    assert found.recording["time"] == pytest.approx(TIME, abs=1e-9)


FULL_STAMPS = 1.32959733843760000e17 + 1e7 * TIME  # tenths of a microsecond since 1601


@pytest.mark.parametrize(("mark", "time"), [("\t", 1e3 * TIME), (",", 1e3 * TIME), ("\t", FULL_STAMPS)])
def test_a_scope_of_twincat_with_a_time_for_each_channel(tmp_path: Path, mark: str, time: Array) -> None:
    rows = [
        ["Name", "Scope"],
        ["Name", "Joint.ActPos", "Name", "Joint.ActTorque"],
        ["Data-Type", "REAL64", "Data-Type", "REAL64"],
        ["SampleTime[ms]", "4", "SampleTime[ms]", "4"],
        ["Unit", "rad", "Unit", "Nm"],
    ]
    header = "\n".join(mark.join(row) for row in rows) + "\n\n"
    path = tmp_path / "scope.csv"
    rows_of = zip(time, ANGLE, time, TORQUE, strict=True)
    path.write_text(header + "\n".join(mark.join(f"{each:.18g}" for each in row) for row in rows_of) + "\nEOF\n")
    check_joint(recognise(path))


def test_a_recorder_of_servo_drives_with_pairs_of_columns_of_several_rates(tmp_path: Path) -> None:
    """The slower channel ends earlier: its cells are empty."""
    slow = np.full((2, len(TIME)), np.nan)
    slow[:, : len(TIME) // 4] = 1e3 * TIME[::4], TORQUE[::4]
    header = "Time [ms];Joint position [rad];Time [ms];Joint torque [Nm]\n"
    found = recognise(written(tmp_path / "epos.csv", header, [1e3 * TIME, ANGLE, *slow], ";", ","))
    check_joint(found, ANGLE[::4], TORQUE[::4], TIME[::4])
    assert any("linear interpolation" in remark for remark in found.remarks)


def test_shares_of_a_rated_torque_are_those_of_the_motor(tmp_path: Path) -> None:
    header = "Timestamp [ms]\tStatusword\tPosition actual value [Inc]\tVelocity actual value [RPM]\tTorque actual value [‰]\n"
    counts, rpm = np.round(RATIO * ANGLE / (2.0 * np.pi) * 4096), RATIO * SPEED * 30.0 / np.pi
    columns = [1e3 * TIME, np.full_like(TIME, 4663.0), counts, rpm, TORQUE / RATIO / 0.4e-3]
    path = written(tmp_path / "log.txt", header, columns, "\t")
    with pytest.raises(ValueError, match="does not contain of which rated value Torque actual value is a share"):
        recognise(path)
    found = recognise(path, FileMapping(units={"torque": "‰ of 0.4 Nm"}))
    assert "a revolution has 4096 counts of Position actual value, as its speed shows" in found.remarks
    assert (found.kind, found.side) == ("log", "input")
    assert found.recording["input_torque"] == pytest.approx(TORQUE / RATIO, abs=1e-7)
    assert found.recording["input_angle"] == pytest.approx(RATIO * ANGLE, abs=1e-3)


def test_the_estimates_of_a_drive_count_where_nothing_else_does(tmp_path: Path) -> None:
    header = "time,axis0.encoder.pos_estimate,axis0.encoder.vel_estimate,axis0.motor.current_control.Iq_measured\n"
    turns = [ANGLE * RATIO / (2.0 * np.pi), SPEED * RATIO / (2.0 * np.pi)]
    path = written(tmp_path / "odrive.csv", header, [TIME, *turns, TORQUE / 30.0])
    found = recognise(path, FileMapping(side="input", units={"angle": "turns", "speed": "turns/s"}))
    assert found.recording["input_angle"] == pytest.approx(RATIO * ANGLE, abs=1e-6)
    assert found.recording["current"] == pytest.approx(TORQUE / 30.0, abs=1e-6)
    assert any(each.options[-1].endswith("input_speed=rev/s") for each in recognise(path).alternatives)


def test_arrays_of_a_controller(tmp_path: Path) -> None:
    names = [f"GVL.axis[{n}].{what}" for what in ("fActPos [rad]", "fActVelo [rad/s]", "fActTorque [Nm]") for n in (1, 2)]
    columns = [TIME, ANGLE, 2.0 * ANGLE, SPEED, 2.0 * SPEED, TORQUE, 3.0 * TORQUE]
    path = written(tmp_path / "plc.csv", ";".join(["time [s]", *names]) + "\n", columns, ";")
    check_joint(recognise(path, FileMapping(joint="2")), 2.0 * ANGLE, 3.0 * TORQUE)


# ---- ROS


def test_a_topic_of_ros_as_text(tmp_path: Path) -> None:
    names = [f"field.{what}{n}" for what in ("name", "position", "velocity", "effort") for n in (0, 1)]
    header = ",".join(["%time", "field.header.seq", "field.header.stamp", "field.header.frame_id", *names]) + "\n"
    stamps = [1_600_000_000_000_000_000 + round(1e9 * each) for each in TIME]
    rows = [
        f"{stamp},{n},{stamp},,elbow,wrist,{q:.9g},0.5,{dq:.9g},0,{tau:.9g},0.1"
        for n, (stamp, q, dq, tau) in enumerate(zip(stamps, ANGLE, SPEED, TORQUE, strict=True))
    ]
    path = tmp_path / "joint_states.csv"
    path.write_text(header + "\n".join(rows) + "\n")
    check_joint(recognise(path))


def test_a_table_of_several_topics(tmp_path: Path) -> None:
    """Rows of two topics in turn: every row has empty cells."""
    times = np.sort(np.concatenate([TIME, TIME[:-1:10] + 0.001]))
    own = np.isin(times, TIME)
    q, tau = np.full(len(times), np.nan), np.full(len(times), np.nan)
    q[own], tau[own] = ANGLE, TORQUE
    temperature = np.where(own, np.nan, 31.0)
    header = "__time,/joint_states/elbow/position,/joint_states/elbow/effort,/diagnostics/temp\n"
    found = recognise(written(tmp_path / "plot.csv", header, [times, q, tau, temperature]))
    check_joint(found)
    assert found.recording["temperature"] == pytest.approx(np.full_like(TIME, 304.15))


def test_the_unit_of_an_angle_is_determined_beside_another_topic(tmp_path: Path) -> None:
    """The speed in the middle of two angles may be an empty cell."""
    times = np.sort(np.concatenate([TIME, TIME[:-1:10] + 0.001]))
    own = np.isin(times, TIME)
    q, dq, tau = (np.full(len(times), np.nan) for _ in range(3))
    q[own], dq[own], tau[own] = np.degrees(0.1 * ANGLE), np.degrees(0.1 * SPEED), TORQUE
    header = "__time,q,dq [deg/s],tau,temp\n"
    found = recognise(written(tmp_path / "plot.csv", header, [times, q, dq, tau, np.where(own, np.nan, 31.0)]))
    assert found.units["output_angle"] == "deg"


# ---- Matrices


@pytest.mark.parametrize("interleaved", [False, True])
@pytest.mark.parametrize("first", ["", "inf", "nan"])
def test_a_matrix_without_names(tmp_path: Path, interleaved: bool, first: str) -> None:
    one, other = [ANGLE, SPEED, TORQUE], [np.cos(TIME), -np.sin(TIME), 0.1 * TORQUE]
    columns = [*one, *other] if interleaved else [each for pair in zip(one, other, strict=True) for each in pair]
    path = written(tmp_path / "matrix.csv", "", [TIME, *columns])
    if first:
        begin, rest = path.read_text().split(",", 2)[0], path.read_text().split(",", 2)[2]
        path.write_text(f"{begin},{first},{rest}")
    with pytest.raises(ValueError, match=r"columns 2(?: to 3|, 5) are the angle of joints") as asked:
        recognise(path)
    assert options_of(asked.value)[0] == "--joint 1 --column joint_torque=block3"
    found = recognise(path, FileMapping(joint="1", columns={"joint_torque": "block3"}))
    rows = slice(1 if first else 0, None)
    check_joint(found, ANGLE[rows], TORQUE[rows], TIME[rows])
    assert set(found.neighbours) == {"2"}


def test_a_matrix_of_one_joint_beside_its_time(tmp_path: Path) -> None:
    from scipy.io import savemat

    savemat(
        tmp_path / "log.mat", {"out": np.stack([np.degrees(ANGLE) - 60.0, np.degrees(SPEED), TORQUE], axis=1), "time": TIME}
    )
    for name in ("block3", "out:3", "out_3"):
        found = recognise(tmp_path / "log.mat", FileMapping(columns={"joint_torque": name}))
        check_joint(found, ANGLE - np.radians(60.0))


@pytest.mark.parametrize("names", [[], ["t [s]", "q1 [rad]", "tau1 [Nm]"]])
def test_a_table_with_a_row_for_each_channel(tmp_path: Path, names: list[str]) -> None:
    rows = [
        ",".join([*names[place : place + 1], *(f"{each:.9g}" for each in series)])
        for place, series in enumerate([TIME, ANGLE, TORQUE])
    ]
    path = tmp_path / "sideways.csv"
    path.write_text("\n".join(rows) + "\n")
    columns = {} if names else {"time": "1", "output_angle": "2", "joint_torque": "3"}
    check_joint(recognise(path, FileMapping(columns=columns)))


# ---- One quantity a file


def test_a_recording_with_one_file_for_each_quantity(tmp_path: Path) -> None:
    both = {"t": [TIME], "q": [ANGLE, np.cos(TIME)], "q_d": [SPEED, -np.sin(TIME)], "tau": [TORQUE, 0.1 * TORQUE]}
    for name, columns in both.items():
        np.savetxt(tmp_path / f"{name}_run_1.csv", np.stack(columns, axis=1), fmt="%.9g")
    (file,) = measurement_files([tmp_path]).files
    check_joint(recognise(file, FileMapping(joint="1")))
    with pytest.raises(ValueError, match="one quantity of a recording") as asked:
        recognise(tmp_path / "q_run_1.csv")
    assert options_of(asked.value) == [" ".join(str(tmp_path / f"{name}_run_1.csv") for name in ("q_d", "t", "tau"))]


def test_angles_of_both_shafts_are_no_part_of_a_recording(tmp_path: Path) -> None:
    angles = np.stack([TIME, 100.0 * ANGLE, ANGLE], axis=1)
    header = "time [s],input_angle [rad],output_angle [rad]"
    np.savetxt(tmp_path / "run_pos.csv", angles, fmt="%.9g", delimiter=",", header=header, comments="")
    header = "time [s],joint_torque [N.m]"
    np.savetxt(
        tmp_path / "run_tau.csv", np.stack([TIME, TORQUE], axis=1), fmt="%.9g", delimiter=",", header=header, comments=""
    )
    assert recognise(tmp_path / "run_pos.csv").kind == "encoders"
    with pytest.raises(ValueError, match="one quantity of a recording"):
        recognise(tmp_path / "run_tau.csv")


def test_files_of_one_channel_with_a_time_of_their_own(tmp_path: Path) -> None:
    for speed in ("10", "n10"):
        np.savetxt(tmp_path / f"run_pos1_{speed}.t", np.stack([TIME, ANGLE], axis=1), fmt="%.9g")
        np.savetxt(tmp_path / f"run_tau1_{speed}.t", np.stack([TIME, TORQUE], axis=1), fmt="%.9g")
    files = measurement_files([tmp_path]).files
    assert [len(file.parts) for file in files] == [2, 2]
    for file in files:
        check_joint(recognise(file))


@pytest.mark.parametrize("named", [True, False])
def test_files_of_one_quantity_with_a_time_and_named_joints(tmp_path: Path, named: bool) -> None:
    """Files as TIAGo writes them: the names of the columns contain the quantity, or the name of the file does."""
    quantities = {"position": (ANGLE, "rad"), "velocity": (SPEED, "rad/s"), "effort": (TORQUE, "Nm")}
    for quantity, (values, unit) in quantities.items():
        end = f"_{quantity}" if named else ""
        header = f"t,arm_1_joint{end} [{unit}],arm_2_joint{end} [{unit}]\n"
        written(tmp_path / f"run_{quantity}.csv", header, [TIME, values, 0.5 * values])
    (file,) = measurement_files([tmp_path]).files
    check_joint(recognise(file, FileMapping(joint="1")))
    assert list(joints_of(file)) == ["1", "2"]


def test_parts_with_different_numbers_of_rows_are_refused(tmp_path: Path) -> None:
    np.savetxt(tmp_path / "q_a.csv", ANGLE)
    np.savetxt(tmp_path / "tau_a.csv", TORQUE[:-3])
    (file,) = with_parts([MeasurementFile(path) for path in sorted(tmp_path.iterdir())])
    with pytest.raises(ValueError, match=r"the same number of rows; q_a.csv has 2000, tau_a.csv has 1997"):
        recognise(file)


def test_what_one_file_of_a_recorder_excludes_holds_for_all(tmp_path: Path) -> None:
    """Degrees without a unit: a range of 4 may be radians, one of 200 may be a motor's radians or a joint's degrees."""
    for name, scale in (("a", 4.0), ("b", 200.0)):
        written(tmp_path / f"{name}.csv", "t,pos,tau\n", [TIME, scale * np.sin(TIME), TORQUE])
    opened = {file.path: file for file in measurement_files([tmp_path]).files}
    read = [recognise(file) for file in opened.values()]
    assert [file.question is not None for file in read] == [False, True]
    assert [file.units["output_angle"] for file in consistent(read, opened)] == ["deg", "deg"]


# ---- Channels


def test_a_motor_angle_in_units_of_the_joint_is_scaled_by_the_ratio(tmp_path: Path) -> None:
    wound = ANGLE + 1e-4 * TORQUE
    header = "t [s],motor_angle [rad],link_angle [rad],motor_torque [Nm]\n"
    path = written(tmp_path / "log.csv", header, [TIME, wound, ANGLE, TORQUE / RATIO])
    found = recognise(path)
    assert found.recording["reflected_angle"] == pytest.approx(wound, abs=1e-6)
    assert "input_angle" not in found.recording
    assert found.at_ratio(RATIO).recording["input_angle"] == pytest.approx(RATIO * wound, abs=1e-4)
    columns = {"reflected_angle": "motor_angle"}
    assert recognise(path, FileMapping(columns=columns)).columns["reflected_angle"] == "motor_angle"


@pytest.mark.parametrize(("name", "both"), [("output_torque", True), ("load_torque", False)])
def test_a_torque_under_load_is_that_of_the_motor_or_of_the_friction(tmp_path: Path, name: str, both: bool) -> None:
    speed, load = (each.ravel() for each in np.meshgrid([20.0, 80.0, 200.0, -20.0, -80.0, -200.0], [-40.0, 0.0, 40.0]))
    friction = np.sign(speed) * (0.05 + 0.002 * np.abs(load)) + 3e-4 * speed
    columns = [speed, friction + both * load / RATIO, load]
    found = recognise(written(tmp_path / "table.csv", "motor speed [rad/s],torque [Nm],output torque [Nm]\n", columns))
    assert (found.kind, found.side, found.columns[name]) == ("friction", "input", "output torque")


def test_values_that_a_slow_bus_holds_are_not_rest(tmp_path: Path) -> None:
    fine = np.arange(0.0, 8.0, 0.001)
    held = np.interp(np.floor(fine / 0.015 + 1e-9) * 0.015, TIME, ANGLE)
    found = recognise(written(tmp_path / "log.csv", "t [s],q [rad],tau [Nm]\n", [fine, held, np.interp(fine, TIME, TORQUE)]))
    assert np.median(np.diff(found.recording["time"])) == pytest.approx(0.015)
    assert any("q holds each value for 15 rows: it was sampled at 66.7 Hz" in remark for remark in found.remarks)


def test_coarse_steps_of_an_encoder_are_not_held_values(tmp_path: Path) -> None:
    coarse = np.round(ANGLE / 0.01) * 0.01
    assert len(recognise(written(tmp_path / "log.csv", "t [s],q [rad],tau [Nm]\n", [TIME, coarse, TORQUE])).recording) == len(
        TIME
    )


# ---- Joints of several files


@pytest.mark.slow("identification")
def test_files_of_different_joints_are_not_one_gear(tmp_path: Path) -> None:
    for joint in (2, 7):
        written(tmp_path / f"q{joint}_run.csv", "t [s],position [rad],effort [Nm]\n", [TIME, ANGLE, joint * TORQUE])
    assert [joints_of(path) for path in sorted(tmp_path.iterdir())] == [("2",), ("7",)]
    with pytest.raises(ValueError, match=r"q2_run.csv of joint 2, q7_run.csv of joint 7") as asked:
        identify("csg-20-100", [tmp_path])
    assert options_of(asked.value) == ["--joint 2", "--joint 7", "--joint all"]
    with pytest.raises(ValueError, match="by its name it is of joint 7, and not of joint 2"):
        recognise(tmp_path / "q7_run.csv", FileMapping(joint="2"))
    found = identify_joints("csg-20-100", [tmp_path]).found
    gravity = {joint: {each.estimate.path: each.estimate.value for each in gear.parameters} for joint, gear in found.items()}
    assert gravity["2"]["load.gravity_torque"] == pytest.approx(50.0, rel=0.05)
    assert gravity["7"]["load.gravity_torque"] == pytest.approx(175.0, rel=0.05)


def test_the_joint_in_the_name_of_a_file_goes_before_others_that_move(tmp_path: Path) -> None:
    header = "t [s],q_1 [rad],q_2 [rad],tau_1 [Nm],tau_2 [Nm]\n"
    path = written(tmp_path / "joint_2.csv", header, [TIME, 0.3 * np.sin(TIME), ANGLE, 0.1 * TORQUE, TORQUE])
    found = recognise(path)
    check_joint(found)
    assert (found.joint, set(found.neighbours)) == ("2", {"1"})


@pytest.mark.slow("identification")
def test_each_file_is_opened_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from strainwave.commands.file_options import FileOptions
    from strainwave.identification.reading import source

    header = "t [s],q_1 [rad],q_2 [rad],tau_1 [Nm],tau_2 [Nm]\n"
    path = written(tmp_path / "arm.csv", header, [TIME, np.sin(TIME), ANGLE, 0.1 * TORQUE, TORQUE])
    opened = list[Path]()

    def counted(path: Path) -> object:
        opened.append(path)
        return open_table(path)

    open_table = source.open_table
    monkeypatch.setattr(source, "open_table", counted)
    files = measurement_files([path])
    mapping = FileOptions(column=["joint_torque=tau"], unit=["torque=N.m"]).mapping_of(files.files)
    identify_joints("csg-20-100", files, mapping=mapping)
    assert opened == [path]


@pytest.mark.parametrize("rate", [125.0, 250.0, 500.0, 1000.0])
def test_a_time_that_counts_rows_gets_their_rate_from_angle_and_speed(tmp_path: Path, rate: float) -> None:
    time = np.arange(0.0, 8.0, 1.0 / rate)
    angle, speed, torque = (np.interp(time, TIME, each) for each in (ANGLE, SPEED, TORQUE))
    path = written(tmp_path / "log.csv", "Time,q,dq,tau\n", [np.arange(len(time)), angle, speed, torque])
    check_joint(recognise(path), angle, torque, time)


def test_the_counts_that_a_person_gives_go_before_those_that_the_speed_shows(tmp_path: Path) -> None:
    counts, rpm = np.round(RATIO * ANGLE / (2.0 * np.pi) * 4096), RATIO * SPEED * 30.0 / np.pi
    path = written(tmp_path / "log.csv", "t [s],motor position,motor speed [rpm],current [A]\n", [TIME, counts, rpm, TORQUE])
    assert recognise(path).units["input_angle"] == "counts/4096"
    assert recognise(path, FileMapping(units={"angle": "counts/5000"})).units["input_angle"] == "counts/5000"


@pytest.mark.parametrize(
    ("header", "unit", "fails"),
    [
        ("Torque actual value", "mN.m", [True]),
        ("Torque actual value", "permille of 0.4 N.m", []),
        ("Torque actual value [mNm]", "", []),
        ("motor torque", "mN.m", []),
    ],
)
def test_the_object_of_cia_402_is_in_thousandths_of_the_rated_torque(
    header: str, unit: str, fails: list[bool], tmp_path: Path
) -> None:
    counts, rpm = np.round(RATIO * ANGLE / (2.0 * np.pi) * 4096), RATIO * SPEED * 30.0 / np.pi
    columns = [1e3 * TIME, counts, rpm, np.round(TORQUE / RATIO / 0.4e-3)]
    names = f"Time [ms];Position actual value [inc];Velocity actual value [rpm];{header}\n"
    given = FileMapping(units={"torque": unit} if unit else {})
    found = recognise(written(tmp_path / "log.csv", names, columns, ";"), given)
    assert "input_torque" in found.columns
    assert [check.failed for check in unit_of_torque(found)] == fails


# ---- Raw registers and names of what was commanded


def dynamixel(path: Path, velocity_count: float) -> Path:
    columns = [np.round(values) for values in (2048.0 + ANGLE * 4096.0 / (2.0 * np.pi), SPEED * 30.0 / np.pi / velocity_count)]
    columns.append(np.round(TORQUE / 50.0 / 2.69e-3))
    return written(path, "time,present_position,present_velocity,present_current\n", [TIME, *columns])


def test_registers_of_dynamixel_are_in_the_counts_of_their_manual(tmp_path: Path) -> None:
    found = recognise(dynamixel(tmp_path / "servo.csv", 0.229), FileMapping(side="output"))
    assert found.recording["output_angle"] - np.pi == pytest.approx(ANGLE, abs=np.pi / 4096.0)
    assert found.recording["output_speed"] == pytest.approx(SPEED, abs=0.0121)
    assert found.recording["current"] == pytest.approx(TORQUE / 50.0, abs=1.4e-3)
    assert any("raw registers of Dynamixel X" in remark for remark in found.remarks)


def test_registers_whose_speed_is_no_slope_of_the_angle_by_the_manual_are_asked_about(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="how many counts a revolution has in present_position"):
        recognise(dynamixel(tmp_path / "servo.csv", 0.01))


def test_the_measured_torque_is_taken_and_not_the_calculated_one(tmp_path: Path) -> None:
    path = written(
        tmp_path / "leg.csv", "time,joint_pos,joint_vel,tau_cal,tau_est\n", [TIME, ANGLE, SPEED, 1.3 * TORQUE, TORQUE]
    )
    check_joint(recognise(path))


@pytest.mark.parametrize(("name", "size"), [("vel_rps", 2.0 * np.pi), ("vel_deg_s", np.pi / 180.0), ("vel_rpm", np.pi / 30.0)])
def test_units_at_the_end_of_a_name(tmp_path: Path, name: str, size: float) -> None:
    path = written(tmp_path / "joint.csv", f"t_s,pos_deg,{name},torque_Nm\n", [TIME, np.rad2deg(ANGLE), SPEED / size, TORQUE])
    found = recognise(path, FileMapping(side="output"))
    check_joint(found)
    assert found.recording["output_speed"] == pytest.approx(SPEED, abs=1e-6)


def test_the_unit_in_the_name_of_a_column_that_a_person_names(tmp_path: Path) -> None:
    path = written(tmp_path / "two.csv", "time_s,drive_deg,table_deg\n", [TIME, np.rad2deg(RATIO * ANGLE), np.rad2deg(ANGLE)])
    found = recognise(path, FileMapping(columns={"input_angle": "drive_deg", "output_angle": "table_deg"}))
    assert found.recording["output_angle"] == pytest.approx(ANGLE, abs=1e-7)
    assert found.units["input_angle"] == found.units["output_angle"] == "deg"


# ---- Several recordings in one file, and clocks ----------------------------------------------------------------------


def test_each_recording_of_a_text_whose_time_begins_anew_is_read(tmp_path: Path) -> None:
    time, angle, torque = np.tile(TIME, 2), np.concatenate([ANGLE, 0.5 * ANGLE]), np.concatenate([TORQUE, 0.5 * TORQUE])
    path = written(tmp_path / "log.csv", "time [s],joint_pos [rad],joint_torque [Nm]\n", [time, angle, torque])
    first, second = measurement_files([path]).files
    assert [first.path.name, second.path.name] == ["log.csv(1)", "log.csv(2)"]
    assert recognise(second).recording["output_angle"] == pytest.approx(0.5 * ANGLE, abs=1e-8)
    assert recognise(first).recording["joint_torque"] == pytest.approx(TORQUE, abs=1e-6)


def test_a_counter_of_16_bits_runs_on(tmp_path: Path) -> None:
    stamps = (63_000.0 + np.round(1e3 * TIME)) % 65_536.0
    path = written(tmp_path / "log.csv", "time [ms],joint_pos [rad],joint_torque [Nm]\n", [stamps, ANGLE, TORQUE])
    (file,) = measurement_files([path]).files
    found = recognise(file)
    assert found.recording.time - found.recording.time[0] == pytest.approx(TIME, abs=1e-6)
    assert "time begins anew after 65536: it is taken to run on" in found.remarks


def test_files_of_one_quantity_each_keep_the_units_of_their_headers(tmp_path: Path) -> None:
    for name, header, values in (
        ("t", "t [ms]", 1e3 * TIME),
        ("q", "q [deg]", np.degrees(ANGLE)),
        ("tau", "tau [mNm]", TORQUE),
    ):
        written(tmp_path / f"{name}_run.csv", header + "\n", [values])
    (file,) = measurement_files([tmp_path]).files
    found = recognise(file)
    assert found.recording["output_angle"] == pytest.approx(ANGLE, abs=1e-8)
    assert found.recording["joint_torque"] == pytest.approx(1e-3 * TORQUE, abs=1e-8)
    assert found.recording.time[-1] == pytest.approx(TIME[-1])


def test_a_row_of_units_at_the_end_is_left_out(tmp_path: Path) -> None:
    path = written(tmp_path / "log.csv", "time,joint_pos [rad],joint_torque [Nm]\n", [TIME, ANGLE, TORQUE])
    path.write_text(path.read_text() + '"s","rad","Nm"\n')
    found = recognise(path)
    assert len(found.recording) == len(TIME)
    assert any(f"line {len(TIME) + 2}, has no number" in remark for remark in found.remarks)


def test_one_element_of_a_message_is_read(tmp_path: Path) -> None:
    names = ",".join(f"/joint_states/{name}[2]" for name in ("position", "velocity", "effort"))
    found = recognise(written(tmp_path / "bag.csv", f"__time,{names}\n", [1.7e9 + TIME, ANGLE, SPEED, TORQUE]))
    assert found.columns["joint_torque"] == "/joint_states/effort[2]"


def test_the_current_of_a_bus_is_none_of_the_motor(tmp_path: Path) -> None:
    path = written(tmp_path / "log.csv", "time,motor_rpm,bus_current_A\n", [TIME, 900.0 * SPEED, np.abs(TORQUE)])
    with pytest.raises(ValueError, match="which is no measurement that is known"):
        recognise(path)


def test_of_two_angles_that_run_alike_that_of_a_robot_is_the_joint_s(tmp_path: Path) -> None:
    path = written(tmp_path / "log.csv", "time,theta,q,tau_J\n", [TIME, ANGLE + 1e-4 * TORQUE / 25.0, ANGLE, TORQUE])
    found = recognise(path)
    assert (found.columns["reflected_angle"], found.columns["output_angle"]) == ("theta", "q")


def test_a_message_of_many_columns_is_short(tmp_path: Path) -> None:
    names = [f"part{number}_angle" for number in range(40)]
    path = written(tmp_path / "log.csv", ",".join(names) + "\n", [ANGLE * number for number in range(40)])
    with pytest.raises(ValueError, match="more") as refused:
        recognise(path, FileMapping(kind="encoders"))
    assert len(str(refused.value)) < 1000


def test_a_share_of_a_rated_torque_is_that_of_the_motor_whatever_the_side_of_the_angle(tmp_path: Path) -> None:
    columns = [TIME, np.degrees(ANGLE), np.round(100.0 * TORQUE / RATIO / 0.4)]
    path = written(tmp_path / "log.csv", "time [s],ActualPosition [deg],ActualTorque [%]\n", columns, ",")
    found = recognise(path, FileMapping(side="output", units={"ActualTorque": "% of 0.4 N.m"}))
    assert found.recording["output_angle"] == pytest.approx(ANGLE, abs=1e-4)
    assert found.recording["input_torque"] == pytest.approx(TORQUE / RATIO, abs=2.1e-3)
