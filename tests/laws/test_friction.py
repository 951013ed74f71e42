"""What every friction law obeys."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.strategies import log_uniform, models, signed

laws = models("friction")
set_valued = models("friction", "hold")
with_memory = models("friction", "trace")
speeds = log_uniform(1e-6, 1e4)


@given(laws, speeds)
def test_steady_sliding_never_gives_power(law: Any, speed: float) -> None:
    assert law.steady(speed) >= 0.0


@given(laws, speeds)
def test_friction_is_odd_in_the_speed(law: Any, speed: float) -> None:
    assert law.steady(-speed) == -law.steady(speed)
    assert law.steady(0.0) == 0.0


@given(laws, st.lists(signed(speeds), min_size=1, max_size=5))
def test_an_array_of_speeds_gives_what_each_speed_gives(law: Any, speed: list[float]) -> None:
    assert law.steady([speed, speed]).tolist() == 2 * [[law.steady(v) for v in speed]]


@given(set_valued)
def test_what_sticks_holds_at_least_what_sliding_sets_in_with(law: Any) -> None:
    assert law.hold() >= 0.0
    assert law.steady(1e-300) <= law.hold() * (1.0 + 1e-15) + 1e-290  # the viscous part of so slow a motion


@given(with_memory, signed(speeds))
def test_a_bristle_settles_on_steady_sliding(law: Any, speed: float) -> None:
    assert law.trace([0.0, 1e15], [speed, speed])[-1] == pytest.approx(law.steady(speed), rel=1e-12)


@given(with_memory, signed(speeds), st.lists(st.floats(1e-3, 1.0), min_size=2, max_size=10))
def test_a_bristle_at_constant_speed_does_not_depend_on_the_step(law: Any, speed: float, steps: list[float]) -> None:
    time = np.append(0.0, np.cumsum(steps))
    fine = law.trace(time, np.full(time.shape, speed))
    coarse = law.trace(time[[0, -1]], [speed, speed])
    assert coarse[-1] == pytest.approx(fine[-1], rel=1e-12, abs=1e-12 * abs(law.steady(speed)))


@given(with_memory, st.lists(signed(speeds), min_size=2, max_size=10))
def test_a_bristle_is_odd_in_the_motion(law: Any, speed: list[float]) -> None:
    time = 0.1 * np.arange(len(speed))
    assert law.trace(time, np.negative(speed)).tolist() == np.negative(law.trace(time, speed)).tolist()


@given(with_memory)
def test_a_bristle_without_motion_stays_as_it_is(law: Any) -> None:
    bent = law.trace([0.0, 0.1, 0.2, 100.0], [1.0, 0.0, 0.0, 0.0])
    assert bent[1] == bent[2] == bent[3]
