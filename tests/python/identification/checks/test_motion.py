"""Logs whose angle, time, sign or load is not what it is taken for, of torques written down by hand."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.gear_set import GearSet
from strainwave.identification.checks.logs import ratio_by_orders
from strainwave.identification.identify import identify
from strainwave.identification.reading.mapping import FileMapping

from tests.python.identification.candidates.test_motion import MOTOR, TRUTH, record

NOISE = 0.02  # A
TURN = 2.0 * np.pi
STARTS = {"hfuc-20-80": 80.0, "csg-20-100": 100.0}


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
    assert failed(record(TRUTH, NOISE)) == {}


@pytest.mark.slow("identification")
def test_revolutions_read_as_radians_show_in_the_sine_of_gravity() -> None:
    """Inertia and friction absorb a factor of the angle; gravity 10 N.m would come out as six times as much."""
    right = record(TRUTH, NOISE)
    message = failed(with_channel(right, "input_angle", right["input_angle"] / TURN))["angle in the sine of gravity"]
    assert "times what it leaves if the angle is in rev, not in rad" in message


@pytest.mark.slow("identification")
def test_the_angle_of_the_joint_named_as_that_of_the_motor_shows_likewise() -> None:
    right = record(TRUTH, NOISE)
    message = failed(with_channel(right, "input_angle", -right["input_angle"] / 80.0))["angle in the sine of gravity"]
    assert "if it is that of the output" in message


@pytest.mark.slow("identification")
def test_a_wrong_ratio_of_the_start_set_shows_in_a_log_of_one_encoder() -> None:
    message = failed(record(TRUTH, NOISE), "csg-20-100")["ratio by gravity"]
    assert message.startswith("gravity goes with the sine of the motor's angle over about ")
    found = float(message.partition("about ")[2].partition(",")[0])
    assert found == pytest.approx(80.0, rel=0.03)


@pytest.mark.slow("identification")
def test_a_log_without_gravity_shows_no_ratio() -> None:
    assert (
        not {"ratio by gravity", "angle in the sine of gravity"}
        & failed(record(TRUTH | {"gravity": 0.0}, NOISE), "csg-20-100").keys()
    )


@pytest.mark.slow("identification")
@pytest.mark.parametrize(("gravity", "checked"), [(0.0, False), (10.0, True)])
def test_the_angle_is_compared_with_gravity_only_where_there_is_gravity(gravity: float, checked: bool) -> None:
    """An upright axis in degrees was said to have a gravity that does not go with the sine of its angle."""
    said = FileMapping(constants={"torque_constant": 0.08})
    found = identify("hfuc-20-80", {"log": record(TRUTH | {"gravity": gravity}, NOISE)}, mapping=said)
    of_angle = [check for check in found.checks if check.name == "angle in the sine of gravity"]
    assert bool(of_angle) == checked
    assert all("no other unit or side" in check.message for check in of_angle)


@pytest.mark.slow("identification")
def test_milliseconds_read_as_seconds_make_a_pendulum_that_no_joint_is() -> None:
    right = record(TRUTH, NOISE)
    assert "gravity against inertia" in failed(with_channel(right, "time", 1e3 * right["time"]))


@pytest.mark.slow("identification")
def test_friction_that_drives_the_joint_is_not_clamped_without_a_word() -> None:
    """Plain least squares has it negative: a fit would end at zero."""
    message = failed(record(TRUTH | {"coulomb": -0.05, "viscous": 0.0}, NOISE))["estimates at bounds"]
    assert "a negative Coulomb friction of -0.0" in message


@pytest.mark.slow("identification")
def test_a_load_that_changes_on_the_way_shows_in_the_halves() -> None:
    light, heavy = record(TRUTH, NOISE), record(TRUTH | {"gravity": 14.0}, NOISE)
    half = len(light) // 2
    mixed = with_channel(light, "current", np.concatenate([light["current"][:half], heavy["current"][half:]]))
    message = failed(mixed)["halves of the record"]
    assert message.startswith("the halves of the motion have load.gravity_torque = ")


@pytest.mark.parametrize("rows", [3_000, 300_000])
def test_the_ratio_by_orders_takes_as_long_for_a_long_record(rows: int) -> None:
    """Of 300 000 rows it took 2.1 s."""
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
    found = identify("hfuc-20-80", {"log": record(TRUTH, NOISE)}, mapping=FileMapping(constants={"torque_constant": 0.08}))
    assert found.unchecked == {"ratio": "80", "torque constant": "0.08 N·m/A"}
    assert any(each.startswith("one encoder checks neither the ratio, 80, nor") for each in found.files[0].remarks)
