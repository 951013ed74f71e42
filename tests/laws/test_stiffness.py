"""Laws of every spring: it rises strictly and is invertible; energy and tangent belong to its torque. It is odd unless listed.

Of one with play all this holds beyond the play: a torque that is not zero has its twist there.
"""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, strategies as st

from tests.support.strategies import log_uniform, models, signed


def is_odd(spring: Any) -> bool:
    """False for a spring that differs between both senses of twist, and for one around such a spring."""
    return getattr(spring, "odd", True) and (not hasattr(spring, "law") or is_odd(spring.law))


springs = models("stiffness")
torques = signed(log_uniform(1e-3, 1e3))
STEP = 1e-4  # of the twist: what the difference quotients reach over


def mean_lies_between_the_ends(steps: tuple[float, float], values: tuple[float, float], slopes: tuple[float, float]) -> bool:
    """Mean value theorem, give or take the rounding of the places and of the values whose difference is taken."""
    (a, b), (at_a, at_b) = steps, values
    rounding = (2e-15 * max(map(abs, values)) + 1e-15 * max(map(abs, steps)) * max(map(abs, slopes))) / abs(b - a)
    return min(slopes) - rounding <= (at_b - at_a) / (b - a) <= max(slopes) + rounding


@given(springs, torques)
def test_twist_and_torque_undo_each_other(spring: Any, torque: float) -> None:
    """Up to the rounding of the one, times what the other makes of it."""
    twist = spring.twist(torque)
    stiffness = spring.tangent([twist * (1.0 - 1e-9), twist * (1.0 + 1e-9)])  # on both sides of a knee
    torque_rounding = 2e-15 * (abs(torque) + max(stiffness) * abs(twist))
    twist_rounding = 2e-15 * (abs(twist) + abs(torque) / min(stiffness))
    assert spring.torque(twist) == pytest.approx(torque, rel=0.0, abs=torque_rounding)
    assert spring.twist(spring.torque(twist)) == pytest.approx(twist, rel=0.0, abs=twist_rounding)


@given(springs.filter(is_odd), torques)
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
    """No spring's slope turns round within so short a step."""
    twist = spring.twist(torque)
    ends = (twist, spring.twist(torque * (1.0 + STEP)))
    assert mean_lies_between_the_ends(ends, tuple(map(spring.torque, ends)), tuple(map(spring.tangent, ends)))


@given(springs, torques)
def test_torque_is_the_slope_of_the_energy(spring: Any, torque: float) -> None:
    twist = spring.twist(torque)
    ends = (twist, spring.twist(torque * (1.0 + STEP)))
    assert mean_lies_between_the_ends(ends, tuple(map(spring.energy, ends)), tuple(map(spring.torque, ends)))


@given(springs, torques)
def test_energy_is_what_the_load_put_in(spring: Any, torque: float) -> None:
    """Strictly positive, and below torque times twist, as the torque rises from zero."""
    twist = spring.twist(torque)
    assert 0.0 < spring.energy(twist) < torque * twist


@given(springs, st.lists(torques, min_size=1, max_size=4))
def test_an_array_gives_what_each_number_gives(spring: Any, torque: list[float]) -> None:
    twist = [spring.twist(x) for x in torque]
    assert spring.twist([torque, torque]).tolist() == 2 * [twist]
    for verb in (spring.torque, spring.tangent, spring.energy):
        assert verb([twist, twist]).tolist() == 2 * [[verb(x) for x in twist]]
