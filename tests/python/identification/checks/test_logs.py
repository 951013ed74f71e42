"""Numbers that a log determines in two ways: each pair that disagrees fails its check, and a pair that agrees does not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.gear_set import GearSet
from strainwave.identification.checks.logs import (
    another_ratio_of_shafts,
    held_out_error,
    inertias_of_load,
    motions_of_both_shafts,
    ratio_by_orders,
    ratio_of_encoders,
    speed_against_angle,
    speed_of_another_clock,
    torque_constant_by_voltage,
)
from strainwave.identification.identify import identify
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import recognise
from strainwave.identification.results.file_result import Check, HeldOut
from strainwave.orders.two_encoders import transmission_error

from tests.python.identification.candidates.test_motion import ANGLE, MOTOR, RATIO, SPEED, TIME, TRUTH, drive, record, torque

CONSTANT, RESISTANCE = 0.08, 0.4
CURRENT_NOISE = 0.02  # A
FULL_TURN = 2.0 * np.pi
STARTS = {"hfuc-20-80": 80.0, "csg-20-100": 100.0}


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


@pytest.mark.parametrize(("scale", "told"), [(1.0, ""), (1.0 / RATIO, "reflected_"), (2.5, "--constant ratio=2")])
@pytest.mark.parametrize("motions", [("angle", "speed"), ("speed", "angle"), ("speed", "speed")])
def test_a_motion_of_one_shaft_contradicts_one_of_the_other(
    tmp_path: Path, motions: tuple[str, str], scale: float, told: str
) -> None:
    """The motor's motion is recorded right, divided by the ratio, or that of another ratio. No shaft has angle and speed."""
    path, series, units = tmp_path / "log.csv", {"angle": ANGLE, "speed": SPEED}, {"angle": "rad", "speed": "rad/s"}
    columns = [TIME, scale * RATIO * series[motions[0]], series[motions[1]], 0.8 * torque(TRUTH)]
    header = f"t [s],{motions[0]}_motor [{units[motions[0]]}],{motions[1]}_link [{units[motions[1]]}],tau [N.m]"
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=header, comments="")
    (check,) = motions_of_both_shafts(recognise(path).at_ratio(RATIO), RATIO)
    is_reflected = motions == ("speed", "speed") and told == "reflected_"  # recognised by its numbers
    assert check.failed == (bool(told) and not is_reflected)
    times = float(check.message.partition("the input turns ")[2].partition(" ")[0])
    assert times == pytest.approx(abs(RATIO if is_reflected else scale * RATIO), rel=1e-3)
    assert check.message.endswith("the gear has a ratio of 80")
    assert is_reflected or told in check.remedy


def test_a_unit_that_reconciles_both_shafts_is_named(tmp_path: Path) -> None:
    """The speed of the motor is in 1/min, and stated in rad/s."""
    path = tmp_path / "log.csv"
    columns = [TIME, 30.0 / np.pi * RATIO * SPEED, ANGLE, 0.8 * torque(TRUTH)]
    header = "t [s],speed_motor [rad/s],angle_link [rad],tau [N.m]"
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=header, comments="")
    (check,) = motions_of_both_shafts(recognise(path), RATIO)
    assert check.failed
    assert "--unit speed_motor=rpm" in check.remedy


def test_a_ratio_that_a_swing_on_the_spring_may_explain_is_a_remark(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    columns = [TIME, 1.6 * RATIO * SPEED, ANGLE, 0.8 * torque(TRUTH)]
    header = "t [s],speed_motor [rad/s],angle_link [rad],tau [N.m]"
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=header, comments="")
    file = recognise(path)
    assert not any(check.failed for check in motions_of_both_shafts(file, RATIO))
    (remark,) = another_ratio_of_shafts(file, RATIO)
    assert "--constant ratio=128" in remark


@pytest.mark.parametrize("bias", [0.0, 0.01])
def test_a_load_that_swings_on_its_spring_and_a_biased_gyro_are_no_contradiction(tmp_path: Path, bias: float) -> None:
    """A chirp to 15 Hz below an antiresonance of 20 Hz: the slopes differ by a factor of 1.34."""
    time = np.arange(0.0, 20.0, 1e-3)
    lines = [(0.5 + 0.5 * k, 0.02 / (1.0 + k), 0.7 * k**2) for k in range(30)]
    motor = sum(size * np.sin(2.0 * np.pi * hertz * time + phase) for hertz, size, phase in lines)
    speeds = [(size / (1.0 - (hertz / 20.0) ** 2), 2.0 * np.pi * hertz, phase) for hertz, size, phase in lines]  # of the load
    load = sum(size * rate * np.cos(rate * time + phase) for size, rate, phase in speeds) + bias
    path = tmp_path / "log.csv"
    columns = [time, RATIO * motor, load, np.sin(time)]
    np.savetxt(
        path,
        np.column_stack(columns),
        delimiter=",",
        header="t [s],angle_motor [rad],speed_link [rad/s],tau [N.m]",
        comments="",
    )
    (check,) = motions_of_both_shafts(recognise(path), RATIO)
    assert check.value < 1.1


def test_two_encoders_have_a_check_of_their_own(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    header = "t [s],angle_motor [rad],angle_link [rad],speed_link [rad/s],tau [N.m]"
    columns = [TIME, 0.5 * RATIO * ANGLE, ANGLE, SPEED, 0.8 * torque(TRUTH)]
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=header, comments="")
    assert list(motions_of_both_shafts(recognise(path), RATIO)) == []


def test_noise_of_one_motion_is_no_contradiction(tmp_path: Path) -> None:
    """A differentiated encoder scatters as much as its shaft moves."""
    path = tmp_path / "log.csv"
    noisy = SPEED + 0.9 * np.std(SPEED) * np.random.default_rng(1).standard_normal(len(TIME))
    columns = [TIME, RATIO * SPEED, noisy, 0.8 * torque(TRUTH)]
    header = "t [s],speed_motor [rad/s],speed_link [rad/s],tau [N.m]"
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=header, comments="")
    (check,) = motions_of_both_shafts(recognise(path), RATIO)
    assert check.value < 1.1


def failed(recording: sw.Recording, start: str = "hfuc-20-80") -> dict[str, str]:
    """Messages of the failed checks of a log, by name."""
    inertia = MOTOR - GearSet.read(start).gear.input_inertia
    said = FileMapping(constants={"torque_constant": 0.08, "motor_inertia": max(inertia, 0.0)})
    found = identify(start, {"log": recording}, mapping=said)
    return {check.name: check.message for check in found.failed}


def with_channel(recording: sw.Recording, name: str, values: np.ndarray) -> sw.Recording:
    return recording.with_column(name, values, recording.unit(name))


@pytest.mark.slow("identification")
def test_a_right_log_fails_no_check() -> None:
    assert failed(record(TRUTH, CURRENT_NOISE)) == {}


@pytest.mark.slow("identification")
def test_revolutions_read_as_radians_show_in_the_sine_of_gravity() -> None:
    """Inertia and friction absorb a factor of the angle; gravity 10 N.m would come out as six times as much."""
    right = record(TRUTH, CURRENT_NOISE)
    message = failed(with_channel(right, "input_angle", right["input_angle"] / FULL_TURN))["angle in the sine of gravity"]
    assert "times what it leaves if the angle is in rev, not in rad" in message


@pytest.mark.slow("identification")
def test_the_angle_of_the_joint_named_as_that_of_the_motor_shows_likewise() -> None:
    right = record(TRUTH, CURRENT_NOISE)
    message = failed(with_channel(right, "input_angle", -right["input_angle"] / 80.0))["angle in the sine of gravity"]
    assert "if it is that of the output" in message


@pytest.mark.slow("identification")
def test_a_wrong_ratio_of_the_start_set_shows_in_a_log_of_one_encoder() -> None:
    message = failed(record(TRUTH, CURRENT_NOISE), "csg-20-100")["ratio by gravity"]
    assert message.startswith("gravity goes with the sine of the motor's angle over about ")
    found = float(message.partition("about ")[2].partition(",")[0])
    assert found == pytest.approx(80.0, rel=0.03)


@pytest.mark.slow("identification")
def test_a_log_without_gravity_shows_no_ratio() -> None:
    assert (
        not {"ratio by gravity", "angle in the sine of gravity"}
        & failed(record(TRUTH | {"gravity": 0.0}, CURRENT_NOISE), "csg-20-100").keys()
    )


@pytest.mark.slow("identification")
@pytest.mark.parametrize(("gravity", "checked"), [(0.0, False), (10.0, True)])
def test_the_angle_is_compared_with_gravity_only_where_there_is_gravity(gravity: float, checked: bool) -> None:
    """An upright axis in degrees was said to have a gravity that does not go with the sine of its angle."""
    said = FileMapping(constants={"torque_constant": 0.08})
    found = identify("hfuc-20-80", {"log": record(TRUTH | {"gravity": gravity}, CURRENT_NOISE)}, mapping=said)
    of_angle = [check for check in found.checks if check.name == "angle in the sine of gravity"]
    assert bool(of_angle) == checked
    assert all("no other unit or side" in check.message for check in of_angle)


@pytest.mark.slow("identification")
def test_milliseconds_read_as_seconds_make_a_pendulum_that_no_joint_is() -> None:
    right = record(TRUTH, CURRENT_NOISE)
    assert "gravity against inertia" in failed(with_channel(right, "time", 1e3 * right["time"]))


@pytest.mark.slow("identification")
def test_friction_that_drives_the_joint_is_not_clamped_without_a_word() -> None:
    """Plain least squares has it negative: a fit would end at zero."""
    message = failed(record(TRUTH | {"coulomb": -0.05, "viscous": 0.0}, CURRENT_NOISE))["estimates at bounds"]
    assert "a negative Coulomb friction of -0.0" in message


@pytest.mark.slow("identification")
def test_a_load_that_changes_on_the_way_shows_in_the_halves() -> None:
    light, heavy = record(TRUTH, CURRENT_NOISE), record(TRUTH | {"gravity": 14.0}, CURRENT_NOISE)
    half = len(light) // 2
    mixed = with_channel(light, "current", np.concatenate([light["current"][:half], heavy["current"][half:]]))
    message = failed(mixed)["halves of the record"]
    assert message.startswith("the halves of the motion have load.gravity_torque = ")


@pytest.mark.parametrize("rows", [3_000, 300_000])
def test_the_ratio_by_orders_takes_as_long_for_a_long_record(rows: int) -> None:
    """A record of 300 000 rows took 2.1 s."""
    time = np.linspace(0.0, 60.0, rows)
    angle = 2.0 * np.sin(0.31 * time) + 0.5 * np.sin(0.83 * time)
    speed = np.gradient(angle, time)
    current = 0.3 * np.sign(speed) + 0.4 * speed + 3.0 * np.sin(angle) + 0.05 * np.cos(160.0 * angle)
    columns = {"time": time, "output_angle": angle, "current": current + 0.02 * np.random.default_rng(0).standard_normal(rows)}
    record = sw.Recording(columns, {"time": "s", "output_angle": "rad", "current": "A"})
    (check,) = ratio_by_orders(sw.Drive(gear=sw.load("csg-20-100")), record, "log")
    assert check.failed
    assert "a ratio of 80 or 81" in check.message


@pytest.mark.slow("identification")
def test_a_log_of_current_names_what_none_of_its_checks_checks() -> None:
    """A log of one encoder without a voltage."""
    mapping = FileMapping(constants={"torque_constant": 0.08})
    found = identify("hfuc-20-80", {"log": record(TRUTH, CURRENT_NOISE)}, mapping=mapping)
    assert found.unchecked == {"ratio": "80", "torque constant": "0.08 N·m/A"}
    assert any(each.startswith("one encoder checks neither the ratio, 80, nor") for each in found.files[0].remarks)
