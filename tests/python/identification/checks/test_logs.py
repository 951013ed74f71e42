"""Numbers that a log determines in two ways: each pair that disagrees fails its check, and a pair that agrees does not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.checks.logs import (
    held_out_error,
    inertias_of_load,
    ratio_of_encoders,
    speed_against_angle,
    speed_of_another_clock,
    torque_constant_by_voltage,
)
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import recognise
from strainwave.identification.results.file_result import Check, HeldOut
from strainwave.orders.two_encoders import transmission_error

from tests.python.identification.candidates.test_motion import ANGLE, RATIO, SPEED, TIME, TRUTH, drive, torque

CONSTANT, RESISTANCE = 0.08, 0.4


def by_voltage(constant: float, noise: float = 0.05) -> list[Check]:
    """Of a motor of 0.08 N.m/A that is taken for one of another constant."""
    current = torque(TRUTH) / CONSTANT
    voltage = RESISTANCE * current + CONSTANT * RATIO * SPEED + noise * np.random.default_rng(1).standard_normal(len(TIME))
    columns = {"time": TIME, "current": current, "voltage": voltage}
    recording = sw.Recording(columns, {"time": "s", "current": "A", "voltage": "V"})
    return list(torque_constant_by_voltage(recording, RATIO * SPEED, constant, "log.csv"))


@pytest.mark.parametrize(("given", "fails"), [(0.08, False), (0.078, False), (0.04, True), (0.16, True)])
def test_the_voltage_that_a_motor_induces_determines_its_torque_constant(given: float, fails: bool) -> None:
    (check,) = by_voltage(given)
    assert check.failed == fails
    assert "--constant torque_constant=0.08" in check.remedy


def test_a_voltage_that_is_noise_is_no_check() -> None:
    assert by_voltage(0.04, noise=200.0) == []


@pytest.mark.parametrize(("true", "fails"), [(80.0, False), (100.0, True), (150.0, True), (80.2, False)])
def test_two_encoders_contradict_a_gear_of_another_ratio(true: float, fails: bool) -> None:
    """As of a pulley of 1.5 before a gear of 100, or of a start set of another ratio."""
    random = np.random.default_rng(0)
    columns = {
        "time": TIME,
        "input_angle": -true * ANGLE + 1e-3 * random.standard_normal(len(TIME)),
        "output_angle": ANGLE + 1e-5 * random.standard_normal(len(TIME)),
    }
    recording = sw.Recording(columns, {"time": "s", "input_angle": "rad", "output_angle": "rad"})
    (check,) = ratio_of_encoders(transmission_error(recording).ratio, drive(), "log.csv")
    assert check.failed == fails


@pytest.mark.parametrize(("by_torque", "fails"), [(0.9, False), (0.678, True), (0.135, True), (2.5, True)])
def test_two_inertias_of_a_load_contradict_each_other(by_torque: float, fails: bool) -> None:
    """By the winding up of the gear 0.85 kg.m2; by the torque of a motor whose constant is half of the truth 0.135."""
    assert inertias_of_load((0.85, 0.01), (by_torque, 0.02), "kg.m2", "log.csv").failed == fails


def test_inertias_that_nothing_determines_contradict_nothing() -> None:
    assert not inertias_of_load((0.85, 0.3), (0.2, 0.3), "kg.m2", "log.csv").failed


@pytest.mark.parametrize(("error", "plain", "failed"), [(0.3, 0.4, []), (0.6, 0.7, [0]), (0.3, 0.2, [1]), (0.6, 0.2, [0, 1])])
def test_a_model_explains_half_and_no_less_than_plain_least_squares(error: float, plain: float, failed: list[int]) -> None:
    checks = list(held_out_error(HeldOut("last 30 % of the motion", "current", "A", error, 1.0, plain, 100), "log.csv"))
    assert [place for place, check in enumerate(checks) if check.failed] == failed


@pytest.mark.parametrize(
    ("joints", "told"), [((), "give their angles as other_angles"), (("2", "3"), "the motion of joints 2")]
)
def test_the_remedy_names_no_angle_that_was_given(joints: tuple[str, ...], told: str) -> None:
    held_out = HeldOut("last 30 % of the motion", "current", "A", 0.7, 1.0, np.nan, 100)
    (check,) = held_out_error(held_out, "log.csv", joints)
    assert told in check.remedy
    assert ("other_angles" in check.remedy) == (joints == ())


@pytest.mark.parametrize(("unit", "fails"), [("rad/s", False), ("rev/s", True), ("rpm", True)])
def test_a_speed_in_a_wrong_unit_contradicts_its_angle(tmp_path: Path, unit: str, fails: bool) -> None:
    """The speed is recorded in rad/s; what is stated of its unit is checked by the slope of the angle."""
    path = tmp_path / "log.csv"
    rows = np.column_stack([TIME, ANGLE, SPEED, 0.8 * torque(TRUTH)])
    np.savetxt(path, rows, delimiter=",", header=f"t [s],q [rad],dq [{unit}],tau [N.m]", comments="")
    (check,) = speed_against_angle(recognise(path, FileMapping(side="output")))
    assert check.failed == fails
    assert not fails or "--unit dq=rad/s" in check.remedy


def test_a_speed_twice_the_slope_of_its_angle_is_no_other_unit(tmp_path: Path) -> None:
    """A published record of a joint has a clock that runs twice as long as its motion took."""
    path = tmp_path / "log.csv"
    rows = np.column_stack([2.0 * TIME, ANGLE, SPEED, 0.8 * torque(TRUTH)])
    np.savetxt(path, rows, delimiter=",", header="t [s],q [rad],dq [rad/s],tau [N.m]", comments="")
    file = recognise(path, FileMapping(side="output"))
    assert not any(check.failed for check in speed_against_angle(file))
    (remark,) = speed_of_another_clock(file)
    assert "which no unit makes" in remark
