"""A table of friction over angle and speed: its entries, what lies between them, and what it refuses."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.interpolate import RegularGridInterpolator
from strainwave.friction import AngleSpeedMap, Asymmetric

SPEED = [0.5, 2.0, 10.0, 50.0]
LEVEL = np.random.default_rng(1).uniform(0.02, 0.05, (len(SPEED), 12))
LAW = AngleSpeedMap(speed=SPEED, level=LEVEL.ravel().tolist(), static_ratio=1.2)


def test_its_entries_are_what_it_says() -> None:
    angle = 2.0 * np.pi * np.arange(12) / 12
    for speed, row in zip(SPEED, LEVEL, strict=True):
        for turn in (0.0, -6.0 * np.pi, 1e4 * np.pi):
            assert LAW.steady(speed, angle=angle + turn) == pytest.approx(row, rel=1e-9)
            assert LAW.steady(-speed, angle=angle + turn) == pytest.approx(-row, rel=1e-9)


@given(st.floats(0.5, 50.0), st.floats(0.0, 2.0 * np.pi))
def test_between_them_it_is_bilinear_as_scipy_has_it(speed: float, angle: float) -> None:
    closed = np.column_stack([LEVEL, LEVEL[:, 0]])
    grid = (np.array(SPEED), np.linspace(0.0, 2.0 * np.pi, 13))
    wanted = RegularGridInterpolator(grid, closed)([[speed, angle]])[0]
    assert LAW.steady(speed, angle=angle) == pytest.approx(wanted, rel=1e-10)


def test_beyond_its_speeds_it_stays_and_at_rest_it_holds() -> None:
    assert LAW.steady([0.01, 1e3]) == pytest.approx([LEVEL[0, 0], LEVEL[-1, 0]], rel=1e-12)
    assert LAW.hold(1.0) == pytest.approx(1.2 * LEVEL[0, 0], rel=1e-12)
    assert LAW.set_valued


def test_one_angle_is_a_curve_over_the_speed_alone() -> None:
    law = AngleSpeedMap(speed=[1.0, 3.0], level=[0.1, 0.3])
    assert law.steady(2.0, angle=[0.0, 1.0, 2.0, -2.5]) == pytest.approx(4 * [0.2], rel=1e-12)


def test_directions_are_told_apart_around_it() -> None:
    law = Asymmetric(law=LAW, dry_asymmetry=0.1)
    assert [law.steady(2.0), law.steady(-2.0)] == pytest.approx([1.1 * LEVEL[1, 0], -0.9 * LEVEL[1, 0]], rel=1e-12)


@pytest.mark.parametrize(
    ("speed", "level", "message"),
    [
        ([2.0, 1.0], [0.1, 0.2], "speed must increase"),
        ([1.0, 2.0], [0.1, 0.2, 0.3], "equally many elements for each speed"),
        ([1.0], [], "equally many elements for each speed"),
        ([], [0.1], "equally many elements for each speed"),
    ],
)
def test_a_table_that_is_none_is_refused(speed: list[float], level: list[float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        AngleSpeedMap(speed=speed, level=level)
