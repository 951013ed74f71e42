"""A loop at the other shaft, and without the friction that another measurement tells."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from strainwave.rig import Loop, Value, analyse, friction_at_rest, referred, without_friction

from tests.python.rig.loops import loop_of_table, parallelogram


def test_stiffness_grows_with_the_square_of_the_ratio_towards_the_output() -> None:
    at_input = loop_of_table(angle_sigma=1e-4, torque_sigma=1e-3, friction_sigma=1e-3, compliance_sigma=1e-2)
    at_output = referred(at_input, 100.0, "output")
    one, other = analyse(at_input), analyse(at_output)
    for before, after in zip(one.stiffnesses, other.stiffnesses, strict=True):
        assert after.name == before.name
        assert after.softest.value == pytest.approx(1e4 * before.softest.value, rel=1e-6)
        assert after.softest.random == pytest.approx(1e4 * before.softest.random, rel=1e-3)
        assert after.softest.shared == pytest.approx(1e4 * before.softest.shared, rel=1e-6)
    assert other.hysteresis is not None
    assert np.degrees(other.hysteresis.width.value) == pytest.approx(0.505, abs=1e-3)  # smaller, not larger (erratum E-T3)
    assert one.area is not None
    assert other.area is not None
    assert other.area.value == pytest.approx(one.area.value)  # energy is the same at either shaft
    assert other.area.sigma == pytest.approx(one.area.sigma)


@settings(max_examples=20, deadline=None)
@given(ratio=st.floats(30.0, 160.0), sign=st.sampled_from([-1.0, 1.0]))
def test_there_and_back_is_the_same_loop(ratio: float, sign: float) -> None:
    loop = loop_of_table(angle_sigma=1e-4, torque_sigma=1e-3, friction_sigma=1e-3, compliance_sigma=1e-2)
    back = referred(referred(loop, sign * ratio, "output"), sign * ratio, "input")
    for name in ("angle", "torque", "angle_sigma", "torque_sigma", "friction_sigma", "compliance_sigma"):
        assert getattr(back, name) == pytest.approx(getattr(loop, name), rel=1e-12)


def test_a_negative_ratio_exchanges_the_regimes() -> None:
    other = analyse(referred(loop_of_table(), -100.0, "output"))
    found = other.stiffness_by("negative_unloading", "softest")
    assert found is not None
    assert found.value == pytest.approx(4.51e4, rel=1e-4)


def test_a_loop_as_the_twin_takes_it_is_referred_as_the_twin_refers_it() -> None:
    loop, gear = loop_of_table(), sw.load("hfuc-25-100")
    known = referred(loop, gear.kinematics.ratio, "output").recording()
    theirs = loop.recording()
    assert known["twist"] == pytest.approx(theirs["input_angle"] / gear.kinematics.ratio)
    assert known["torque"] == pytest.approx(theirs["input_torque"] * gear.kinematics.ratio)


def test_friction_told_by_a_table_leaves_the_loop_of_the_gear() -> None:
    """A gear behind dry friction: torque at the shaft is that of the gear and the friction, which turns over first."""
    angle, gear = parallelogram(k=10.0, spring=2.0, slip=0.5, amplitude=1.0)
    held, turn = 0.2, len(angle) // 2
    falling = np.arange(1, turn + 1)
    torque = gear + held
    torque[falling] = gear[falling] - held
    angles = np.insert(angle, [1, turn + 1], angle[[0, turn]])
    torques = np.insert(torque, [1, turn + 1], [gear[0] - held, gear[turn] + held])
    at_input = Loop(angles, torques, side="input", name="behind friction")
    alone = without_friction(at_input, Value(held, 0.01, "a table"))
    assert alone.torque == pytest.approx(np.insert(gear, [1, turn + 1], gear[[0, turn]]), abs=1e-12)
    assert alone.friction_sigma == 0.01
    assert "at the input, is subtracted (a table)" in alone.corrections[-1]
    whole, without = analyse(at_input), analyse(alone)
    assert whole.area is not None
    assert without.area is not None
    # friction loses 2 F for each angle turned either way
    assert whole.area.value - without.area.value == pytest.approx(held * np.abs(np.diff(angle)).sum())
    assert any("friction of the wave generator is inside the loop" in remark for remark in whole.remarks)
    assert not any("friction of the wave generator is inside the loop" in remark for remark in without.remarks)


def test_a_friction_table_tells_the_friction_at_rest() -> None:
    speed = np.array([0.5, 1.0, 2.0, 5.0, 10.0, 20.0])
    table = sw.Recording({"speed": speed, "torque": 0.05 + 3e-4 * speed}, {"speed": "rad/s", "torque": "N.m"})
    found = friction_at_rest(table, sw.load("hfuc-25-100"))
    assert found.value == pytest.approx(0.05, rel=1e-6)
    assert found.sigma < 1e-6


def test_what_holds_no_friction_is_refused() -> None:
    loop = loop_of_table()
    with pytest.raises(ValueError, match="holds no friction of the wave generator"):
        without_friction(referred(loop, 100.0, "output"), Value(0.1))
    with pytest.raises(ValueError, match=r"friction of ±0\.4 N\.m holds all of the loop's torque"):
        without_friction(loop, Value(0.4))
    with pytest.raises(ValueError, match="ratio = 0"):
        referred(loop, 0.0, "output")
    with pytest.raises(ValueError, match=r'side = "left"'):
        referred(loop, 100.0, "left")  # type: ignore[arg-type]


def test_a_ratio_that_no_gear_has_is_refused() -> None:
    with pytest.raises(ValueError, match=r"ratio = 1e\+300"):
        referred(loop_of_table(), 1e300, "output")
