"""Measurements that are not what they are taken for: doubted, with what to do, and not refused."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.gear_set import GearSet

RATIO = 80.0
LAW = sw.friction.Stribeck(coulomb=0.047, breakaway=0.062, stribeck_speed=3.0, viscous=2.9e-4)
SPEED = np.geomspace(0.5, 300.0, 13)


@cache
def start() -> GearSet:
    return GearSet.read("hfuc-20-80")


def table(speed: np.ndarray, torque: np.ndarray, unit: str = "N.m") -> sw.Recording:
    noise = 1.0 + 0.01 * np.random.default_rng(0).normal(size=len(speed))
    return sw.Recording({"speed": speed, "torque": torque * noise}, {"speed": "rad/s", "torque": unit})


def at_the_joint() -> sw.Recording:
    return table(SPEED / RATIO, RATIO * LAW.steady(SPEED))


def test_a_table_from_the_input_is_not_doubted() -> None:
    assert sw.twin(start(), friction=table(SPEED, LAW.steady(SPEED))).doubts == ()


def test_a_table_from_the_joint_is_asked_about_and_taken_as_said() -> None:
    (doubt,) = sw.twin(start(), friction=at_the_joint()).doubts
    assert "--side output" in doubt.remedy
    found = sw.twin(start(), friction=at_the_joint(), side="output")
    assert found.doubts == ()
    assert found.gear_set.gear.friction_input.coulomb == pytest.approx(LAW.coulomb, rel=0.05)
    assert found.gear_set.gear.friction_input.viscous == pytest.approx(LAW.viscous, rel=0.05)
    confirmed = sw.twin(start(), friction=at_the_joint(), side="input")
    assert confirmed.doubts == ()
    assert confirmed.gear_set.gear.friction_input.coulomb == pytest.approx(RATIO * LAW.coulomb, rel=0.05)


def test_a_table_from_the_input_called_one_from_the_joint_is_asked_about() -> None:
    (doubt,) = sw.twin(start(), friction=table(SPEED, LAW.steady(SPEED)), side="output").doubts
    assert doubt.remedy.startswith("if it was measured at the input, leave --side output out; ")


def test_a_side_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match=r'^side = "joint" must be one of input, output$'):
        sw.twin(start(), friction=at_the_joint(), side="joint")  # type: ignore[arg-type]


def test_millinewton_metres_called_newton_metres_are_named() -> None:
    (doubt,) = sw.twin(start(), friction=table(SPEED, 1e3 * LAW.steady(SPEED))).doubts
    assert "perhaps the torque is in mN.m, not in N.m" in doubt.remedy


def test_a_log_of_a_moving_drive_is_no_table() -> None:
    time = np.linspace(0.0, 10.0, 500)
    speed = 100.0 * np.sin(2.0 * np.pi * time) + 120.0 * np.sin(1.3 * time) + 1.7
    torque = LAW.steady(speed) + 2e-4 * np.gradient(speed, time)
    (doubt,) = sw.twin(start(), friction=table(speed, torque)).doubts
    assert "this is a log of a moving drive" in doubt.what


@pytest.mark.parametrize("order", ["sorted", "shuffled"])
def test_a_long_table_is_none_though_its_speeds_follow_each_other(order: str) -> None:
    speed = np.concatenate((-np.geomspace(0.5, 300.0, 200)[::-1], np.geomspace(0.5, 300.0, 200)))
    if order == "shuffled":
        speed = np.random.default_rng(1).permutation(speed)
    assert sw.twin(start(), friction=table(speed, LAW.steady(speed))).doubts == ()


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
    (evidence,) = sw.twin(start(), torsion=from_the_input(ratio)).evidence
    hints = [remark for remark in evidence.remarks if "square of the ratio" in remark]
    assert len(hints) == told
    if told:
        fits = float(re.search(r"with a ratio of (\d+)", hints[0])[1])
        assert fits == pytest.approx(ratio, rel=0.1)


def test_friction_over_an_angle_is_no_torsion_loop() -> None:
    (doubt,) = sw.twin(start(), torsion=loop(stiffness=1.0, breakaway=5.0, amplitude=1.0)).doubts
    assert "a shaft behaves that turns against friction" in doubt.what


@pytest.mark.parametrize(
    ("scale", "named"),
    [
        (1.0, ""),
        (np.pi / 180.0, "the angle is in deg, not in rad"),
        (1e3, "the torque is in mN.m, not in N.m"),
        (1.0 / RATIO**2, "were measured at the input"),
    ],
)
def test_a_stiffness_that_no_gear_of_its_kind_has_is_doubted_with_the_likely_mistake(scale: float, named: str) -> None:
    """A scale below one makes the twist too large, as degrees read as radians do; one above the torque."""
    larger = max(scale, 1.0)
    recording = loop(stiffness=2e4 * scale, breakaway=0.5 * larger, amplitude=2e-3 * larger / scale)
    found = sw.twin(start(), torsion=recording)
    if not named:
        assert found.doubts == ()
    else:
        assert named in " ".join(doubt.remedy for doubt in found.doubts)
