"""What files seem to be: files in the shapes that people have, each with what it must be taken for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised, recognise
from strainwave.questions import QuestionError

from tests.support.answers import options_of

RPM = np.array([-3000.0, 10.0, 100.0, 1000.0, -10.0, 200.0])
TIME = np.arange(400) * 0.002
SWING = np.sin(2.0 * np.pi * TIME)


def write(path: Path, header: str, *series: object, delimiter: str = ",", form: str = "%.9g") -> Path:
    rows = np.column_stack([np.asarray(each, float) for each in series])
    np.savetxt(path, rows, fmt=form, delimiter=delimiter, header=header, comments="")
    return path


def words_of(found: Recognised) -> str:
    return " | ".join((*found.why, *found.remarks))


@pytest.mark.parametrize(
    ("header", "side"),
    [
        ("rpm,torque [mNm]", "input"),
        ("Drehzahl [1/min],Reibmoment [mNm]", "input"),
        ("speed (U/min),moment (mNm)", "input"),
        ("n_rpm,torque_mNm", "input"),
        ("vitesse [rpm],couple [mN.m]", "input"),
        ("joint speed [rpm],joint torque [mNm]", "output"),
        ("dq [rpm],tau [mNm]", "output"),
        ("Abtriebsdrehzahl [1/min],Abtriebsmoment [mNm]", "output"),
    ],
)
def test_a_table_of_friction(tmp_path: Path, header: str, side: str) -> None:
    found = recognise(write(tmp_path / "table.csv", header, RPM, np.sign(RPM) * 50.0))
    assert (found.kind, found.side) == ("friction", side)
    assert found.recording["speed"] == pytest.approx(RPM * np.pi / 30.0)
    assert found.recording["torque"] == pytest.approx(np.sign(RPM) * 0.05)
    assert "a table of steady friction" in words_of(found)


def test_the_unit_of_the_speeds_of_a_table_is_asked(tmp_path: Path) -> None:
    path = write(tmp_path / "table.csv", "speed,torque [N.m]", RPM / 60.0, np.sign(RPM))
    with pytest.raises(ValueError, match=r"unit of speed is not stated, .* rev/s, 3000 1/min at most with") as asked:
        recognise(path)
    assert options_of(asked.value) == ["--unit speed=rad/s", "--unit speed=rpm", "--unit speed=rev/s"]
    assert recognise(path, FileMapping(units={"speed": "rev/s"})).recording["speed"] == pytest.approx(RPM * np.pi / 30.0)


def test_a_slow_table_has_a_remark_on_its_side(tmp_path: Path) -> None:
    path = write(tmp_path / "table.csv", "speed [rpm],torque [N.m]", RPM / 100.0, np.sign(RPM))
    assert recognise(path).side == "input"
    assert "--side output" in words_of(recognise(path))
    assert recognise(path, FileMapping(side="output")).side == "output"


@pytest.mark.parametrize(
    ("header", "names", "side"),
    [
        ("twist [arcmin],torque [N.m]", ("twist", "torque"), "output"),
        ("input_angle [deg],input_torque [N.m]", ("input_angle", "input_torque"), "input"),
        ("Antriebswinkel [deg],Antriebsmoment [Nm]", ("input_angle", "input_torque"), "input"),
        ("deflection_deg,motor_torque_output_side_Nm", ("twist", "torque"), "output"),
        ("Torsionswinkel [arcmin],Drehmoment [Nm]", ("twist", "torque"), "output"),
    ],
)
def test_a_torsion_loop_and_a_branch(tmp_path: Path, header: str, names: tuple[str, ...], side: str) -> None:
    angle = 10.0 * (SWING + 0.01 * np.sign(np.gradient(SWING)))  # of the input: less is friction before it slides
    loop = recognise(write(tmp_path / "loop.csv", header, angle, SWING))
    assert (loop.kind, loop.side, loop.recording.names) == ("torsion", side, names)
    assert "a torsion loop with 2 reversals" in words_of(loop)
    branch = recognise(write(tmp_path / "branch.csv", header, SWING[:100], SWING[:100]))
    assert (branch.kind, branch.side) == ("torsion", side)
    assert "one branch" in words_of(branch)


@pytest.mark.parametrize(
    ("header", "names"),
    [
        ("time [s],command [deg],current [A],motor_angle [deg]", ("time", "command", "current", "input_angle")),
        ("Zeit [s],Sollposition [°],Motorstrom [A],Motorwinkel [°]", ("time", "command", "current", "input_angle")),
        ("t [s],q_des [deg],i_q [A],theta_m [deg]", ("time", "command", "current", "input_angle")),
        ("t,q [deg],dq [deg/s],tau [N.m]", ("time", "output_angle", "output_speed", "joint_torque")),
        ("time,position,velocity,effort", ("time", "output_angle", "output_speed", "joint_torque")),
        ("stamp_s,joint1_pos_deg,joint1_vel_deg_s,joint1_current_A", ("time", "output_angle", "output_speed", "current")),
        ("t,u [V],theta_m [rad],theta_l [rad]", ("time", "voltage", "input_angle", "output_angle")),
    ],
)
def test_a_log(tmp_path: Path, header: str, names: tuple[str, ...]) -> None:
    found = recognise(write(tmp_path / "log.csv", header, TIME, SWING, np.gradient(SWING, TIME), np.cos(TIME)))
    assert found.kind == "log"
    assert set(found.recording.names) == set(names)


def test_two_angles_without_torque_are_those_of_two_encoders(tmp_path: Path) -> None:
    for header in (
        "motor [deg],link [deg]",
        "time [s],motor_encoder [deg],output_encoder [deg]",
        "encoder_1 [deg],encoder_2 [deg]",
    ):
        series = [TIME, 80.0 * SWING, SWING][-len(header.split(",")) :]
        found = recognise(write(tmp_path / "encoders.csv", header, *series))
        assert found.kind == "encoders"
        assert np.ptp(found.recording["input_angle"]) == pytest.approx(80.0 * np.ptp(found.recording["output_angle"]))


def test_torque_alone_or_at_one_speed(tmp_path: Path) -> None:
    alone = recognise(write(tmp_path / "torque.csv", "time_s,torque_Nm", TIME, SWING))
    assert alone.kind == "effort"
    assert "nothing that moves" in words_of(alone)
    steady = recognise(write(tmp_path / "steady.csv", "speed [rpm],torque [Nm]", 30.0 + 0.01 * SWING, SWING))
    assert steady.kind == "effort"
    assert "at one speed, 3.142 rad/s" in words_of(steady)


def test_crooked_rows_are_left_out_with_a_remark(tmp_path: Path) -> None:
    """A loop at 100 Hz whose stamps scatter, with rows that are repeated and rows that are missing."""
    random = np.random.default_rng(1)
    kept = np.sort(np.r_[np.delete(np.arange(1000), [200, 201, 500]), 100, 700])
    stamps = np.round(0.01 * kept + 6e-4 * random.standard_normal(len(kept)), 4)
    values = np.sin(0.01 * kept)
    found = recognise(write(tmp_path / "log.csv", "t,q,dq,tau", stamps, values, np.cos(0.01 * kept), values))
    assert len(found.recording) == 997
    assert found.recording["output_angle"] == pytest.approx(np.sin(found.recording.time), abs=2e-4)
    words = words_of(found)
    assert "2 rows repeat the row before and are left out" in words
    assert "3 rows are missing at 2 places, the longest: a gap of 0.03 s after 1.9" in words
    assert "about a clock of 100 Hz" in words


def test_several_joints_are_asked_for(tmp_path: Path) -> None:
    header = "time [s],q1 [rad],q2 [rad],tau1 [N.m],tau2 [N.m]"
    path = write(tmp_path / "arm.csv", header, TIME, SWING, 2.0 * SWING, SWING, 3.0 * SWING)
    with pytest.raises(ValueError, match=r"it has 2 joints \(1, 2\), as q1, q2") as asked:
        recognise(path)
    assert options_of(asked.value) == ["--joint 1", "--joint 2", "--joint all"]
    second = recognise(path, FileMapping(joint="2"))
    assert recognise(path, FileMapping(joint="J2")).columns == second.columns
    assert second.columns == {"time": "time", "output_angle": "q2", "joint_torque": "tau2"}
    assert recognise(path, FileMapping(columns={"output_angle": "q1", "joint_torque": "5"})).columns["joint_torque"] == "tau2"
    with pytest.raises(ValueError, match=r'has no joint "3"; it has 1, 2$'):
        recognise(path, FileMapping(joint="3"))
    axes = "Time [s],Position_A1 [deg],Position_A2 [deg],Torque_A1 [Nm],Torque_A2 [Nm]"
    found = recognise(write(tmp_path / "axes.csv", axes, TIME, SWING, SWING, SWING, SWING), FileMapping(joint="A2"))
    assert (found.side, found.columns["output_angle"], found.columns["joint_torque"]) == ("output", "Position_A2", "Torque_A2")


def test_a_column_without_any_number_is_left_out_with_a_remark(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("t [s],q [rad],tau [N.m],temperature [degC]\n" + "".join(f"{i / 10},{i},{i},nan\n" for i in range(2000)))
    found = recognise(path)
    assert len(found.recording) == 2000
    assert "temperature" not in found.recording


def test_a_side_that_nothing_determines_is_asked_for(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", "time [s],position [rad],current [A]", TIME, SWING, SWING)
    found = recognise(path)
    assert options_of(found.question) == ["--side output", "--side input"]
    assert (found.side, [each.given for each in found.alternatives]) == ("output", [{"side": "input"}])
    assert "output_angle" in recognise(path, FileMapping(side="output")).recording
    assert "input_angle" in recognise(path, FileMapping(columns={"input_angle": "position"})).recording
    fast = write(tmp_path / "fast.csv", "time [s],position [rad],current [A]", TIME, 300.0 * TIME, SWING)
    assert "reaches 2865 1/min, so it is at the input" in words_of(recognise(fast))


def test_a_speed_a_ratio_faster_than_its_angle_is_that_of_the_motor(tmp_path: Path) -> None:
    """As servo drives record the angle of the axis beside the speed of the motor."""
    angle, speed = np.degrees(0.5 * SWING), 80.0 * np.gradient(0.5 * SWING, TIME) * 30.0 / np.pi
    series = (TIME, angle, speed, np.sign(speed) + 0.01 * angle)
    names = "Time [s],ActPos [deg],ActVel [rpm],ActTorque [N.m]"
    found = recognise(write(tmp_path / "servo.csv", names, *series), FileMapping(columns={"input_torque": "ActTorque"}))
    assert found.columns == {"time": "Time", "output_angle": "ActPos", "input_speed": "ActVel", "input_torque": "ActTorque"}
    assert "ActVel runs 80 times as fast as ActPos, so it is at the input" in words_of(found)


def test_rows_without_time_need_a_rate(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", "q [rad],dq [rad/s],tau [N.m]", SWING, SWING, SWING)
    found = recognise(path, FileMapping(constants={"rate": 500.0}))
    assert found.recording.time == pytest.approx(TIME)


def test_what_is_no_measurement_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"no column has a name that is known: foo, bar"):
        recognise(write(tmp_path / "a.csv", "foo,bar", [1.0, 2.0], [1.0, 2.0]))
    with pytest.raises(ValueError, match=r"it has time, position, which is no measurement that is known"):
        recognise(write(tmp_path / "b.csv", "time [s],position [rad]", TIME, SWING))
    with pytest.raises(QuestionError, match="it is a frequency response, which is not read: give the record in time") as asked:
        recognise(write(tmp_path / "c.csv", "Frequency (Hz),Magnitude (dB),Phase (deg)", TIME[1:], TIME[1:], TIME[1:]))
    assert not asked.value.answers


def test_an_angle_that_begins_anew_with_each_revolution_runs_on(tmp_path: Path) -> None:
    turning = 100.0 * np.sin(3.0 * TIME) + 5.0 * TIME
    header = "time [s],motor_angle [deg],current [A]"
    found = recognise(write(tmp_path / "log.csv", header, TIME, np.degrees(turning) % 360.0, SWING))
    assert np.diff(found.recording["input_angle"]) == pytest.approx(np.diff(turning), abs=1e-6)
    assert "motor_angle begins anew with each revolution" in words_of(found)


def test_rows_that_lack_a_number_and_a_torn_end_are_left_out_with_a_remark(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(
        "time [s];q [rad];tau [N.m];mode\n" + "".join(f"{i / 100:.2f};{i};2,5;on\n" for i in range(5)).replace(".", ",")
    )
    with path.open("a") as file:
        file.write("0,05;;2,5;on\n0,06;6;2,5;on\n0,07;7;2")
    found = recognise(path)
    assert found.recording["output_angle"].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 6.0]
    words = words_of(found)
    assert 'its last row, line 9, ends too early and is left out: "0,07;7;2"' in words
    assert "1 row without a number in each column is left out, the first at line 7" in words
    assert "columns not used: mode" in words


def test_a_torn_row_in_the_middle_is_refused_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("time [s],q [rad],tau [N.m]\n0,1,2\n0.1,1\n0.2,1,2\n")
    with pytest.raises(ValueError, match=r"line 3: the number of cells is 2; the header has 3$"):
        recognise(path)


def test_a_file_without_a_header_is_read_by_numbers(tmp_path: Path) -> None:
    path = tmp_path / "log.txt"
    np.savetxt(path, np.column_stack([TIME, SWING, SWING]))
    columns = {"time": "1", "input_angle": "2", "current": "3"}
    found = recognise(path, FileMapping(columns=columns, units={"time": "s", "input_angle": "rad", "current": "A"}))
    assert found.columns == {"time": "column_1", "input_angle": "column_2", "current": "column_3"}
    np.savetxt(path, np.column_stack([TIME, SWING, SWING]), header="t [s] theta_m [rad] i [A]")
    assert recognise(path).columns == {"time": "t", "input_angle": "theta_m", "current": "i"}


def test_signs_are_turned_if_the_mapping_states_it(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", "t [s],q [rad],tau [N.m]", TIME, SWING, SWING)
    assert recognise(path, FileMapping(sign={"joint_torque": -1})).recording["joint_torque"] == pytest.approx(-SWING)


def test_the_torque_that_a_model_of_the_arm_gives_is_taken_where_it_is_named(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", "t [s],q [rad],tau [N.m],model [N.m]", TIME, SWING, SWING, 2.0 * SWING)
    found = recognise(path, FileMapping(columns={"rigid_torque": "model"}))
    assert found.columns == {"time": "t", "output_angle": "q", "joint_torque": "tau", "rigid_torque": "model"}
    assert found.recording["rigid_torque"] == pytest.approx(2.0 * SWING)


def test_a_joint_that_sticks_and_slips_under_a_wave_of_torque_is_a_log(tmp_path: Path) -> None:
    """Half of the time it rests under torques that rise and fall, which no ramp until it breaks away does."""
    time = np.arange(0.0, 60.0, 0.01)
    torque = 4.0 * np.sin(0.6 * time)
    slides = np.abs(torque) > 3.2
    angle = np.cumsum(np.where(slides, 0.05 * np.sign(torque), 0.0)) * 0.01
    rows = np.column_stack([time, angle, torque])
    path = tmp_path / "knee.csv"
    np.savetxt(path, rows, delimiter=",", header="time [s],joint_angle [rad],joint_torque [N.m]", comments="")
    assert recognise(path).kind == "log"


def arm(path: Path, angles: str, efforts: str) -> Path:
    """A log of two joints that move, with names of the columns by the number of the joint."""
    names = [name.format(joint) for joint in (1, 2) for name in (angles, efforts)]
    header = ",".join(["time [s]", *names])
    return write(path, header, TIME, SWING, 2.0 * SWING, np.cos(3.0 * TIME), 5.0 * SWING)


def test_units_of_columns_of_other_joints_are_taken_along(tmp_path: Path) -> None:
    path = arm(tmp_path / "log.csv", "q{} [rad]", "i{}")
    for joint, size in (("1", 2.0), ("2", 5.0)):
        found = recognise(path, FileMapping(units={"i1": "percent of 10 A", "i2": "percent of 10 A"}, joint=joint))
        assert found.recording["current"] == pytest.approx(0.1 * size * SWING)
    with pytest.raises(ValueError, match='a unit is given for "i3", which is not read'):
        recognise(path, FileMapping(units={"i3": "percent of 10 A"}, joint="1"))


@pytest.mark.parametrize("efforts", ["effort[{}]", "effort_{}", "effort{}"])
def test_a_column_of_a_joint_is_named_by_the_stem_of_its_name(tmp_path: Path, efforts: str) -> None:
    path = arm(tmp_path / "log.csv", "position[{}] [rad]", efforts)
    found = recognise(path, FileMapping(columns={"current": "effort"}, joint="2"))
    assert found.recording["current"] == pytest.approx(5.0 * SWING)
    with pytest.raises(ValueError, match=r'it has "effort" of 2 joints') as asked:
        recognise(path, FileMapping(columns={"current": "effort"}))
    assert options_of(asked.value) == ["--joint 1", "--joint 2", "--joint all"]
    with pytest.raises(ValueError, match='has no column "torque" to be the current'):
        recognise(path, FileMapping(columns={"current": "torque"}, joint="2"))


@pytest.mark.parametrize("sign", [{}, {"output_speed": 1}])
def test_a_speed_that_is_counted_against_its_angle_is_turned_round(tmp_path: Path, sign: dict[str, int]) -> None:
    speed = 2.0 * np.pi * np.cos(2.0 * np.pi * TIME)
    path = write(tmp_path / "log.csv", "t [s],q [rad],dq [rad/s],tau [N.m]", TIME, SWING, -speed, SWING)
    found = recognise(path, FileMapping(sign=sign))
    assert found.recording["output_speed"] == pytest.approx(-speed if sign else speed)  # unless a person gave its sign
    assert ("dq is counted against q: its sign is turned round" in found.remarks) == (not sign)


@pytest.mark.parametrize("with_speed", [True, False])
def test_a_file_whose_angle_jumps_is_of_two_recordings(tmp_path: Path, with_speed: bool) -> None:
    angle, speed = SWING.copy(), 2.0 * np.pi * np.cos(2.0 * np.pi * TIME)
    angle[250:] += 0.6
    header, columns = "t [s],q [rad],tau [N.m]", [TIME, angle, SWING]
    if with_speed:
        header, columns = f"{header},dq [rad/s]", [*columns, speed]
    found = recognise(write(tmp_path / "log.csv", header, *columns))
    assert len(found.recording) == 250
    assert "q jumps by 0.5" in words_of(found)
    assert "2 recordings in one file, of which the longest is taken, rows 0 to 249" in words_of(found)


def columns_of(folder: Path, *series: object) -> Path:
    return write(folder / "steps.csv", "time [s],input_angle [rad],input_torque [N.m]", *series)


@pytest.mark.parametrize(("interval", "kind"), [(60.0, "torsion"), (1.0, "torsion"), (0.01, "log")])
def test_a_spring_that_is_loaded_in_steps_is_a_torsion_loop_and_a_fast_one_may_be_a_log(
    tmp_path: Path, interval: float, kind: str
) -> None:
    twist = np.concatenate([np.linspace(a, b, 60) for a, b in ((0.2, -0.2), (-0.2, 0.2))])
    assert recognise(columns_of(tmp_path, interval * np.arange(len(twist)), twist, 4.0 * twist)).kind == kind


def test_a_fast_record_as_stiff_as_an_output_is_a_torsion_loop(tmp_path: Path) -> None:
    twist = np.concatenate([np.linspace(a, b, 60) for a, b in ((2e-3, -2e-3), (-2e-3, 2e-3))])
    loop = 1.5e4 * twist + np.repeat([-0.6, 0.6], 60)
    assert recognise(columns_of(tmp_path, 0.01 * np.arange(len(twist)), twist, loop)).kind == "torsion"


def test_a_slow_log_whose_torque_follows_the_speed_remains_a_log(tmp_path: Path) -> None:
    time = np.arange(300.0)
    angle = 2.0 * np.sin(0.2 * time)
    assert recognise(columns_of(tmp_path, time, angle, 0.1 * np.cos(0.2 * time) + 0.01 * angle)).kind == "log"


@pytest.mark.parametrize(
    ("remark", "ratio"),
    [
        ("# gear ratio: 50\n", 50.0),
        ("% Ratio = 1:80\n", 80.0),
        ("Untersetzung: 100:1\n\n", 100.0),
        ("# reduction ratio: 120\n", 120.0),
        ("# signal to noise ratio: 50\n", None),
        ("# gear ratio of the second stage: 50\n", None),
        ("", None),
    ],
)
def test_a_remark_states_the_ratio(remark: str, ratio: float | None, tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text(f"{remark}speed [rad/s],torque [N.m]\n10,0.05\n20,0.06\n40,0.07\n80,0.09\n160,0.12\n")
    assert recognise(path).ratio == ratio


def test_columns_that_a_person_does_not_want_are_not_used(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    rows = "10,0.05,20,0\n20,0.06,20,5\n40,0.07,21,0\n80,0.09,22,5\n160,0.12,22,0\n"
    path.write_text(f"speed [rad/s],torque [N.m],temperature [degC],load_torque [N.m]\n{rows}")
    assert set(recognise(path).recording.names) == {"speed", "torque", "temperature", "load_torque"}
    read = recognise(path, FileMapping(columns={"unused": "temperature, load_torque"}))
    assert set(read.recording.names) == {"speed", "torque"}
    assert "columns not used: temperature [degC], load_torque [N.m]" in read.remarks
    path.write_text(path.read_text().replace("10,0.05,20,0", "10,0.05,cold,0"))
    assert "columns not used: temperature [degC] (contains text)" in recognise(path).remarks
    with pytest.raises(ValueError, match='has no column "nothing" to be the unused'):
        recognise(path, FileMapping(columns={"unused": "nothing"}))
