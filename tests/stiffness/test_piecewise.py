"""The spring of one knee against the formula as printed, straight springs, and areas below its torque."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given
from strainwave.stiffness import Linear, Piecewise, ThreeSegment

from tests.support.strategies import log_uniform, signed

stiffnesses = log_uniform(1e1, 1e5)
knees = log_uniform(1e-6, 1e-2)
twists = signed(log_uniform(1e-7, 1e-1))
SPRING = Piecewise(k1=8000.0, k2=2000.0, knee=0.001)


def test_torque_and_twist_on_either_side_of_the_knee() -> None:
    assert SPRING.torque([0.0005, 0.001, 0.003]) == pytest.approx([4.0, 8.0, 28.0], rel=1e-15)
    assert SPRING.twist([4.0, 8.0, 28.0]) == pytest.approx([0.0005, 0.001, 0.003], rel=1e-15)


def test_above_the_knee_the_slope_is_the_sum() -> None:
    """k2 is what is added, not the second slope (E-R9)."""
    assert SPRING.tangent([-0.003, -0.0005, 0.0, 0.001, 0.003]).tolist() == [10000.0, 8000.0, 8000.0, 8000.0, 10000.0]


@given(stiffnesses, stiffnesses, knees, twists)
def test_torque_is_the_formula_printed(k1: float, k2: float, knee: float, twist: float) -> None:
    size, sense = abs(Fraction(twist)), 1 if twist > 0.0 else -1
    past = max(size - Fraction(knee), Fraction(0))
    torque = sense * (Fraction(k1) * size + Fraction(k2) * past)
    energy = (Fraction(k1) * size**2 + Fraction(k2) * past**2) / 2
    spring = Piecewise(k1=k1, k2=k2, knee=knee)
    assert spring.torque(twist) == pytest.approx(float(torque), rel=1e-15)
    assert spring.energy(twist) == pytest.approx(float(energy), rel=1e-15)


@given(stiffnesses, stiffnesses, knees, signed(log_uniform(1e-4, 1e4)))
def test_twist_is_the_formula_solved(k1: float, k2: float, knee: float, torque: float) -> None:
    level, slope, bend = abs(Fraction(torque)), Fraction(k1), Fraction(k1) * Fraction(knee)
    twist = level / slope if level <= bend else Fraction(knee) + (level - bend) / (slope + Fraction(k2))
    assert Piecewise(k1=k1, k2=k2, knee=knee).twist(torque) == pytest.approx(float(twist) * np.sign(torque), rel=1e-15)


@given(stiffnesses, stiffnesses, knees, twists)
def test_energy_is_the_area_below_the_torque(k1: float, k2: float, knee: float, twist: float) -> None:
    spring = Piecewise(k1=k1, k2=k2, knee=knee)
    size = abs(twist)
    corners = np.unique(np.clip([0.0, knee, size], 0.0, size))
    torque = spring.torque(corners)
    area = np.sum(0.5 * (torque[1:] + torque[:-1]) * np.diff(corners))
    assert spring.energy(twist) == pytest.approx(area, rel=1e-14)


@given(stiffnesses, stiffnesses, knees, twists)
def test_it_is_a_catalogue_spring_without_a_third_segment(k1: float, k2: float, knee: float, twist: float) -> None:
    bend = k1 * knee
    assume(abs(abs(twist) - knee) > 1e-12 * knee)  # the two may round the place of the knee differently
    one = Piecewise(k1=k1, k2=k2, knee=knee)
    other = ThreeSegment(k1=k1, k2=k1 + k2, k3=k1 + k2, t1=bend, t2=2.0 * bend)
    assert one.torque(twist) == pytest.approx(other.torque(twist), rel=1e-14)
    assert one.energy(twist) == pytest.approx(other.energy(twist), rel=1e-14)
    assert one.tangent(twist) == other.tangent(twist)


@given(stiffnesses, stiffnesses, knees, twists)
def test_without_an_increment_or_without_a_knee_it_is_straight(k1: float, k2: float, knee: float, twist: float) -> None:
    assert Piecewise(k1=k1, k2=0.0, knee=knee).torque(twist) == Linear(k=k1).torque(twist)
    straight = Piecewise(k1=k1, k2=k2, knee=0.0)
    assert straight.torque(twist) == pytest.approx(Linear(k=k1 + k2).torque(twist), rel=1e-15)
    assert straight.twist(twist) == pytest.approx(Linear(k=k1 + k2).twist(twist), rel=1e-15)


@pytest.mark.parametrize(("field", "value"), [("k1", 0.0), ("k2", -1.0), ("knee", -1e-3)])
def test_a_spring_that_softens_or_has_no_stiffness_is_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"piecewise.{field} = "):
        SPRING.replace(**{field: value})
