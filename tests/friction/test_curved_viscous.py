"""Curved viscous friction: numbers of its equation, and the laws that it contains."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from strainwave.friction import CurvedViscous, Stribeck

from tests.support.strategies import log_uniform

LAW = CurvedViscous(coulomb=0.02, breakaway=0.035, stribeck_speed=3.0, viscous_torque=0.04, exponent=0.6, reference_speed=150.0)


@pytest.mark.parametrize(
    ("speed", "torque"),
    [  # the documented equation, worked out in decimals of 40 digits
        (0.5, 0.035894598306559861599356),
        (3, 0.029343601616731782766791),
        (20, 0.031940519805174481191465),
        (150, 0.060000000000000000000000),
        (400, 0.092051202054432715383161),
    ],
)
def test_numbers_at_high_precision(speed: float, torque: float) -> None:
    assert LAW.steady(speed) == pytest.approx(torque, rel=1e-13)
    assert LAW.steady(-speed) == -LAW.steady(speed)


@given(log_uniform(1e-2, 1e4), st.floats(0.0, 0.1))
def test_an_exponent_of_one_is_stribeck_s_law(speed: float, viscous: float) -> None:
    curved = LAW.replace(viscous_torque=150.0 * viscous, exponent=1.0)
    straight = Stribeck(coulomb=0.02, breakaway=0.035, stribeck_speed=3.0, viscous=viscous)
    assert curved.steady(speed) == pytest.approx(straight.steady(speed), rel=1e-12)


@given(log_uniform(1e-1, 1e3), st.floats(0.1, 4.0))
def test_twice_the_speed_is_two_to_the_exponent_times_the_torque(speed: float, exponent: float) -> None:
    law = CurvedViscous(coulomb=0.0, viscous_torque=0.04, exponent=exponent, reference_speed=150.0)
    assert law.steady(2.0 * speed) == pytest.approx(2.0**exponent * law.steady(speed), rel=1e-12)


def test_without_a_breakaway_nothing_falls() -> None:
    law = CurvedViscous(coulomb=0.02, viscous_torque=0.04, exponent=0.6, reference_speed=150.0)
    assert law.hold() == 0.02
    assert np.all(np.diff(law.steady(np.geomspace(1e-9, 1e3, 200))) > 0.0)


def test_near_rest_the_viscous_part_is_linear() -> None:
    law = CurvedViscous(coulomb=0.0, viscous_torque=1.0, exponent=0.1, reference_speed=1.0)
    assert law.steady([0.0, 1e-7, 1e-6]) == pytest.approx([0.0, 0.1 * 1e-6**0.1, 1e-6**0.1], rel=1e-12)
