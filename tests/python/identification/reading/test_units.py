"""Files that state no units, whose truth is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from strainwave.files.units import convert
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised, recognise

from tests.support.answers import options_of

FOLDER = settings(deadline=None, max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
TIME = np.arange(2000) * 0.002
ANGLE = 1.3 * np.sin(3.0 * TIME)  # rad
SPEED = 3.9 * np.cos(3.0 * TIME)  # rad/s


def log(folder: Path, header: str, *series: object) -> Recognised:
    path = folder / "log.csv"
    np.savetxt(path, np.column_stack([TIME, *series]), fmt="%.9g", delimiter=",", header=f"t,{header}", comments="")
    return recognise(path)


@FOLDER
@given(st.sampled_from(["rad", "deg", "rev"]), st.integers(8, 20))
def test_the_steps_of_an_encoder_determine_the_unit_of_its_angle(tmp_path: Path, unit: str, bits: int) -> None:
    turn = float(convert(1.0, "rev", unit))
    counted = np.round(ANGLE / (2.0 * np.pi) * 2.0**bits) * turn / 2.0**bits
    found = log(tmp_path, "theta_m,i", counted, SPEED)
    assert found.units["input_angle"] == unit
    assert found.recording["input_angle"] == pytest.approx(ANGLE, abs=2.0 * np.pi / 2.0**bits)
    assert f"theta_m in {unit} as its steps are those of an encoder of {bits} bits" in " ".join(found.remarks)


@FOLDER
@given(st.sampled_from(["rad/s", "deg/s", "rpm"]), st.sampled_from(["rad", "deg", "rev"]), st.booleans())
def test_an_angle_and_its_speed_determine_each_other_s_unit(
    tmp_path: Path, per_time: str, unit: str, angle_known: bool
) -> None:
    angle, speed = convert(ANGLE, "rad", unit), convert(SPEED, "rad/s", per_time)
    header = f"q [{unit}],dq,tau" if angle_known else f"q,dq [{per_time}],tau"
    noise = 1e-4 * np.random.default_rng(1).standard_normal(len(TIME))
    found = log(tmp_path, header, angle + noise, speed, SPEED)
    assert (found.units["output_angle"], found.units["output_speed"]) == (unit, per_time)


def test_a_joint_that_would_reach_too_far_is_in_degrees(tmp_path: Path) -> None:
    found = log(tmp_path, "q,dq,tau", np.degrees(ANGLE), np.degrees(SPEED), SPEED)
    assert found.units == {"time": "s", "output_angle": "deg", "output_speed": "deg/s", "joint_torque": "N.m"}
    assert "as a joint does not reach 74.48 rad, dq in deg/s as it fits q" in " ".join(found.remarks)


def test_radians_are_taken_if_nothing_determines_the_unit(tmp_path: Path) -> None:
    found = log(tmp_path, "theta_m,i", ANGLE, SPEED)
    assert found.units["input_angle"] == "rad"
    assert any(each.startswith("no unit is stated: t in s, theta_m in rad, i in A; otherwise add") for each in found.remarks)


def test_counts_are_asked_for(tmp_path: Path) -> None:
    counts = np.round(ANGLE * 1e4) * 3.0 + 7.0
    with pytest.raises(ValueError, match=r"how many counts a revolution has in theta_m") as asked:
        log(tmp_path, "theta_m,i", counts, SPEED)
    assert options_of(asked.value) == ["--unit theta_m=counts/NUMBER"]
    found = recognise(tmp_path / "log.csv", FileMapping(units={"input_angle": "counts/65536"}))
    assert found.recording["input_angle"] == pytest.approx(counts / 65536 * 2.0 * np.pi)


def test_counts_without_those_of_a_revolution_are_asked_for(tmp_path: Path) -> None:
    header = "Position actual value [cnt],Velocity actual value [cnt/s],current [A]"
    with pytest.raises(ValueError, match=r"Position actual value, Velocity actual value") as asked:
        log(tmp_path, header, ANGLE, SPEED, SPEED)
    units = "--unit 'Position actual value=counts/NUMBER' --unit 'Velocity actual value=counts/NUMBER/s'"
    assert options_of(asked.value) == [units]
    units = {"Position actual value": "inc/4096", "Velocity actual value": "inc/4096/s"}
    found = recognise(tmp_path / "log.csv", FileMapping(units=units, side="input", kind="log"))
    assert found.recording["input_speed"] == pytest.approx(SPEED / 4096 * 2.0 * np.pi)


def test_a_given_unit_goes_before_a_stated_one(tmp_path: Path) -> None:
    log(tmp_path, "theta_m [deg],i [A]", ANGLE, SPEED)
    found = recognise(tmp_path / "log.csv", FileMapping(units={"theta_m": "rad"}))
    assert found.recording["input_angle"] == pytest.approx(ANGLE)
    assert "theta_m is stated in deg, and taken in rad, as --unit has it" in found.remarks


@pytest.mark.parametrize(("factor", "unit"), [(1e3, "ms"), (1e6, "us"), (1e9, "ns")])
def test_time_since_1970_determines_its_unit(tmp_path: Path, factor: float, unit: str) -> None:
    path = tmp_path / "log.csv"
    stamps = np.round((1.7e9 + TIME) * factor)
    np.savetxt(path, np.column_stack([stamps, ANGLE, SPEED]), fmt="%.19g", delimiter=",", header="stamp,q,tau", comments="")
    found = recognise(path)
    assert found.units["time"] == unit
    assert np.ptp(found.recording.time) == pytest.approx(np.ptp(TIME), abs=1e-5)


def test_time_in_steps_of_one_is_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    np.savetxt(path, np.column_stack([np.arange(2000), ANGLE, SPEED]), delimiter=",", header="t,q,tau", comments="")
    with pytest.raises(ValueError, match=r'column "t" has no unit, and its steps do not determine it') as asked:
        recognise(path)
    assert options_of(asked.value) == ["--unit t=ms", "--unit t=us", "--unit t=s", "--constant rate=NUMBER"]
    assert recognise(path, FileMapping(units={"time": "ms"})).recording.time[-1] == pytest.approx(1.999)


def test_rpm_beside_revolutions_are_not_degrees_per_second_beside_radians(tmp_path: Path) -> None:
    """A speed in rpm is 1.047 times one in °/s with the angle in radians: near enough for a filtered speed, but not exact."""
    turns = ANGLE / (2.0 * np.pi)
    found = log(tmp_path, "joint_position,joint_velocity,joint_torque", turns, 60.0 * SPEED / (2.0 * np.pi), SPEED)
    assert (found.units["output_angle"], found.units["output_speed"]) == ("rev", "rpm")
