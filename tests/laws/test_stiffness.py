"""What every spring obeys: odd, strictly rising, invertible, and its energy and tangent belong to its torque."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.strategies import log_uniform, models, signed

springs = models("stiffness")
torques = signed(log_uniform(1e-3, 1e3))
STEP = 1e-4  # of the twist: what the difference quotients reach over


def between(value: float, *bounds: float) -> bool:
    """Within the bounds, give or take the rounding of a difference quotient over STEP."""
    slack = 1e-11 * max(map(abs, bounds))
    return min(bounds) - slack <= value <= max(bounds) + slack


@given(springs, torques)
def test_twist_and_torque_undo_each_other(spring: Any, torque: float) -> None:
    twist = spring.twist(torque)
    assert spring.torque(twist) == pytest.approx(torque, rel=1e-13)
    assert spring.twist(spring.torque(twist)) == pytest.approx(twist, rel=1e-13)


@given(springs, torques)
def test_torque_and_twist_are_odd_tangent_and_energy_even(spring: Any, torque: float) -> None:
    twist = spring.twist(torque)
    assert spring.twist(-torque) == -twist
    assert spring.torque(-twist) == -spring.torque(twist)
    assert spring.tangent(-twist) == spring.tangent(twist)
    assert spring.energy(-twist) == spring.energy(twist)
    assert spring.torque(0.0) == spring.twist(0.0) == spring.energy(0.0) == 0.0


@given(springs, torques)
def test_stiffness_is_positive(spring: Any, torque: float) -> None:
    assert spring.tangent(spring.twist(torque)) > 0.0


@given(springs, torques)
def test_tangent_is_the_slope_of_the_torque(spring: Any, torque: float) -> None:
    """Mean value theorem; the ends bound the secant, for no spring's slope turns round within so short a step."""
    a = spring.twist(torque)
    b = a * (1.0 + STEP)
    secant = (spring.torque(b) - spring.torque(a)) / (b - a)
    assert between(secant, spring.tangent(a), spring.tangent(b))


@given(springs, torques)
def test_torque_is_the_slope_of_the_energy(spring: Any, torque: float) -> None:
    """Mean value theorem; the torque rises, so that its ends bound the secant."""
    a = spring.twist(torque)
    b = a * (1.0 + STEP)
    secant = (spring.energy(b) - spring.energy(a)) / (b - a)
    assert between(secant, spring.torque(a), spring.torque(b))


@given(springs, torques)
def test_energy_is_what_the_load_put_in(spring: Any, torque: float) -> None:
    """Strictly positive, and below torque times twist, as the torque rises from zero."""
    twist = spring.twist(torque)
    assert 0.0 < spring.energy(twist) < torque * twist


@given(springs, st.lists(torques, min_size=1, max_size=4))
def test_an_array_gives_what_each_number_gives(spring: Any, torque: list[float]) -> None:
    for verb in (spring.twist, spring.torque, spring.tangent, spring.energy):
        assert verb([torque, torque]).tolist() == 2 * [[verb(x) for x in torque]]
