"""Measurements that are not what they are taken for: a check of them fails, with what to do."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.gear_set import GearSet
from strainwave.identification.checks.sizes import friction_of_log
from strainwave.identification.identify import Identified
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import Side

RATIO = 80.0
LAW = sw.friction.Stribeck(coulomb=0.047, breakaway=0.062, stribeck_speed=3.0, viscous=2.9e-4)
SPEED = np.geomspace(0.5, 300.0, 13)


@cache
def start() -> GearSet:
    return GearSet.read("hfuc-20-80")


def table(speed: np.ndarray, torque: np.ndarray, unit: str = "N.m") -> sw.Recording:
    noise = 1.0 + 0.01 * np.random.default_rng(0).normal(size=len(speed))
    return sw.Recording({"speed": speed, "torque": torque * noise}, {"speed": "rad/s", "torque": unit})


def of_friction(measured: sw.Recording, side: Side | None = None) -> Identified:
    return sw.identify(start(), {"friction": measured}, mapping=FileMapping(side=side))


def at_the_joint() -> sw.Recording:
    return table(SPEED / RATIO, RATIO * LAW.steady(SPEED))


def test_a_table_from_the_input_fails_no_check() -> None:
    assert of_friction(table(SPEED, LAW.steady(SPEED))).failed == ()


@pytest.mark.parametrize("side", [None, "output"])
def test_a_table_from_the_joint_is_read_so_by_the_friction_of_the_start_set_or_as_said(side: str | None) -> None:
    found = of_friction(at_the_joint(), side)
    assert found.failed == ()
    assert found.gear_set.gear.friction_input.coulomb == pytest.approx(LAW.coulomb, rel=0.05)
    assert found.gear_set.gear.friction_input.viscous == pytest.approx(LAW.viscous, rel=0.05)


def test_a_table_from_the_joint_is_taken_as_said() -> None:
    confirmed = of_friction(at_the_joint(), "input")
    assert confirmed.failed == ()
    assert confirmed.gear_set.gear.friction_input.coulomb == pytest.approx(RATIO * LAW.coulomb, rel=0.05)


def test_a_table_from_the_input_called_one_from_the_joint_is_asked_about() -> None:
    check = of_friction(table(SPEED, LAW.steady(SPEED)), "output").failed[-1]
    assert check.remedy.startswith("if it was measured at the input, give --side input; ")


def test_millinewton_metres_called_newton_metres_are_named() -> None:
    (check,) = of_friction(table(SPEED, 1e3 * LAW.steady(SPEED))).failed
    assert "perhaps the torque is in mN.m, not in N.m" in check.remedy
    assert check.value == pytest.approx(1e3, rel=0.3)


@pytest.mark.slow("identification")
def test_a_log_of_a_moving_drive_is_no_table() -> None:
    time = np.linspace(0.0, 10.0, 500)
    speed = 100.0 * np.sin(2.0 * np.pi * time) + 120.0 * np.sin(1.3 * time) + 1.7
    torque = LAW.steady(speed) + 2e-4 * np.gradient(speed, time)
    (check,) = of_friction(table(speed, torque)).failed
    assert "this is a log of a moving drive" in check.message


@pytest.mark.parametrize("order", ["sorted", "shuffled"])
def test_a_long_table_is_none_though_its_speeds_follow_each_other(order: str) -> None:
    speed = np.concatenate((-np.geomspace(0.5, 300.0, 200)[::-1], np.geomspace(0.5, 300.0, 200)))
    if order == "shuffled":
        speed = np.random.default_rng(1).permutation(speed)
    assert of_friction(table(speed, LAW.steady(speed))).failed == ()


def loop(stiffness: float, breakaway: float, amplitude: float) -> sw.Recording:
    quarter = np.linspace(0.0, amplitude, 40)
    twist = np.concatenate((quarter, quarter[-2::-1], -quarter[1:], -quarter[-2::-1], quarter[1:]))
    element = sw.hysteresis.MaxwellSlip(stiffness=[20.0 * breakaway / amplitude], breakaway=[breakaway])
    return sw.Recording({"twist": twist, "torque": stiffness * twist + element.trace(twist)}, {"twist": "rad", "torque": "N.m"})


def from_the_input(ratio: float) -> sw.Recording:
    """A loop of the starting gear's stiffness, seen through this ratio."""
    twist = loop(stiffness=1.0, breakaway=1.0, amplitude=1e-3)["twist"]
    element = sw.hysteresis.MaxwellSlip(stiffness=[2e4], breakaway=[1.0])
    torque = start().gear.stiffness.torque(twist) + element.trace(twist)
    columns = {"input_angle": ratio * twist, "input_torque": torque / ratio}
    return sw.Recording(columns, {"input_angle": "rad", "input_torque": "N.m"})


@pytest.mark.parametrize(("ratio", "told"), [(RATIO, False), (0.8 * RATIO, True), (1.25 * RATIO, True)])
def test_a_loop_from_the_input_through_another_ratio_says_which_ratio_would_fit(ratio: float, told: bool) -> None:
    (result,) = sw.identify(start(), {"torsion": from_the_input(ratio)}).files
    hints = [remark for remark in result.remarks if "square of the ratio" in remark]
    assert len(hints) == told
    if told:
        fits = float(re.search(r"with a ratio of (\d+)", hints[0])[1])
        assert fits == pytest.approx(ratio, rel=0.1)


def test_friction_over_an_angle_is_no_torsion_loop() -> None:
    (check,) = sw.identify(start(), {"torsion": loop(stiffness=1.0, breakaway=5.0, amplitude=1.0)}).failed
    assert "a shaft behaves that turns against friction" in check.message


@pytest.mark.parametrize(
    ("scale", "named"),
    [
        (1.0, ""),
        (np.pi / 180.0, "the angle is in deg, not in rad"),
        (1e3, "the torque is in mN.m, not in N.m"),
        (1.0 / RATIO**2, "were measured at the input"),
    ],
)
def test_a_stiffness_that_no_gear_of_its_kind_has_fails_a_check_with_the_likely_mistake(scale: float, named: str) -> None:
    """A scale below one makes the twist too large, as degrees read as radians do; one above the torque."""
    larger = max(scale, 1.0)
    recording = loop(stiffness=2e4 * scale, breakaway=0.5 * larger, amplitude=2e-3 * larger / scale)
    found = sw.identify(start(), {"torsion": recording})
    if not named:
        assert found.failed == ()
    else:
        assert named in " ".join(check.remedy for check in found.failed)


@pytest.mark.parametrize(("largest", "fails"), [(0.05, False), (60.0, True)])
def test_a_loop_of_a_locked_gear_named_as_one_of_the_input_at_rest(largest: float, fails: bool) -> None:
    """60 N.m rest on no friction of a motor that slides at 0.058 N.m: it is the spring of the gear, loaded at the output."""
    turns = 1e-3 * np.array([0.0, 4.0, -4.0, 4.0, -4.0, 4.0])
    angle = np.interp(np.arange(0.0, len(turns) - 1, 0.02), np.arange(len(turns)), turns)
    law = sw.friction.LuGre(
        coulomb=largest, breakaway=largest, bristle_stiffness=500.0 * largest, bristle_damping=0.01, stribeck_speed=1.0
    )
    noise = 1e-3 * largest * np.random.default_rng(1).standard_normal(len(angle))
    columns = {"input_angle": angle, "input_torque": law.quasistatic(angle) + noise}
    recording = sw.Recording(columns, {"input_angle": "rad", "input_torque": "N.m"})
    found = sw.identify(start(), {"presliding": recording})
    assert ("friction at rest" in [check.name for check in found.failed]) == fails


@pytest.mark.parametrize("effort", ["current", "joint_torque"])
@pytest.mark.parametrize(("coulomb", "ratio", "failed"), [(1e-22, 100.0, []), (50.0, 100.0, [True]), (50.0, 1.0, [])])
def test_only_friction_of_a_gear_is_compared(effort: str, coulomb: float, ratio: float, failed: list[bool]) -> None:
    """Friction that vanished was printed as 1.79e-22 N.m, 3.32e-21 times that of the start set."""
    law = sw.friction.Coulomb(coulomb=coulomb, breakaway=coulomb, viscous=0.0)
    speeds = np.linspace(-100.0, 100.0, 50)
    checks = friction_of_log(law, start().gear.friction_input, speeds, effort, "log.csv", ratio=ratio)
    assert [check.failed for check in checks] == failed


def test_a_torque_constant_of_the_wrong_unit_is_named_with_the_right_one() -> None:
    law, speeds = sw.friction.Coulomb(coulomb=50.0, breakaway=50.0, viscous=0.0), np.linspace(-100.0, 100.0, 50)
    known = law.replace(coulomb=0.05, breakaway=0.05)
    (check,) = friction_of_log(law, known, speeds, "current", "log.csv", ratio=100.0, constant=75.5)
    assert "or between mN·m/A and N·m/A (--constant torque_constant=0.0755)" in check.remedy


def test_a_table_at_one_load_determines_coulomb_friction_and_loss_together_only() -> None:
    torque = 0.05 + 0.002 * 10.0 + 3e-4 * SPEED
    columns = {**table(SPEED, torque).columns, "load_torque": np.full(len(SPEED), 800.0)}
    measured = sw.Recording(columns, {"speed": "rad/s", "torque": "N.m", "load_torque": "N.m"})
    found = of_friction(measured)
    (coulomb,) = (each for each in found.files[0].estimates if each.path == "gear.friction_input.coulomb")
    assert coulomb.state == "identified in combination"
    assert any("all its rows are at one load" in remark for remark in found.files[0].remarks)
    assert not any("the loss is" in remark for remark in found.files[0].remarks)


def test_a_table_without_load_determines_no_loss() -> None:
    columns = {**table(SPEED, 0.05 + 3e-4 * SPEED).columns, "load_torque": np.zeros(len(SPEED))}
    measured = sw.Recording(columns, {"speed": "rad/s", "torque": "N.m", "load_torque": "N.m"})
    assert any("the loss under load is not determined" in remark for remark in of_friction(measured).files[0].remarks)


@pytest.mark.parametrize("factor", [0.1, 10.5])
def test_a_remedy_names_no_option_that_other_commands_lack(factor: float) -> None:
    assert not any("--accept" in check.remedy for check in of_friction(table(SPEED, factor * LAW.steady(SPEED))).checks)
