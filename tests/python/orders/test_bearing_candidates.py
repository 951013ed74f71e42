"""Bearings that explain orders of the wave generator, by the kinematics of RandallAntoni2011."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw

BALLS, BALL, PITCH = 23, 5.0, 44.0
PASSES = 1.0 - sw.orders.bearing_orders(BALLS, BALL, PITCH).cage  # of a ball past a lobe, per revolution


def is_in(bearings: sw.orders.BearingCandidates) -> bool:
    return any(bearing.balls == BALLS and abs(bearing.diameter_ratio - BALL / PITCH) < 0.01 for bearing in bearings.candidates)


def test_one_order_leaves_many_bearings() -> None:
    bearings = sw.orders.bearing_candidates([BALLS * PASSES - 1.0], [0.01])
    assert is_in(bearings)
    assert bearings.balls is None
    assert len({bearing.balls for bearing in bearings.candidates}) > 20
    assert "count the balls" in bearings.remarks[1]


@pytest.mark.slow("orders")
def test_accurate_orders_leave_few() -> None:
    orders = np.array([BALLS * PASSES, 2.0 * BALLS * PASSES + 3.0, 3.0 * BALLS * PASSES - 1.0, 5.0 * PASSES, 13.0 * PASSES])
    bearings = sw.orders.bearing_candidates(orders, np.full(5, 2e-4))
    coarse = sw.orders.bearing_candidates(orders, np.full(5, 2e-3))
    assert is_in(bearings)
    assert is_in(coarse)
    assert len(bearings.candidates) < 0.3 * len(coarse.candidates)


@pytest.mark.slow("orders")
def test_an_order_of_another_cause_does_not_hide_the_bearing() -> None:
    bearings = sw.orders.bearing_candidates([BALLS * PASSES, 2.0 * BALLS * PASSES, 8.0 * PASSES, 7.7331], np.full(4, 1e-3))
    assert is_in(bearings)


@pytest.mark.slow("orders")
def test_the_outer_ring_may_turn() -> None:
    turning = 1.0 - sw.orders.bearing_orders(BALLS, BALL, PITCH, outer_speed=-0.02).cage
    bearings = sw.orders.bearing_candidates([BALLS * turning, 3.0 * turning], [1e-4, 1e-4], outer_speed=-0.02)
    assert is_in(bearings)


@pytest.mark.slow("orders")
def test_random_orders_determine_no_bearing() -> None:
    random = np.random.default_rng(4)
    bearings = [sw.orders.bearing_candidates(random.uniform(0.3, 40.0, 3), np.full(3, 1e-3)) for _ in range(10)]
    assert all(bearing.balls is None for bearing in bearings)
    assert "determine no bearing" in bearings[0]._headline()
    exact = BALLS * PASSES * np.array([1.0, 2.0, 3.0, 4.0]) + [0.0, 3.0, -1.0, 2.0]
    assert sw.orders.bearing_candidates([*exact, 5.0 * PASSES, 13.0 * PASSES], np.full(6, 1e-4)).chance < 1e-3


@pytest.mark.parametrize(
    ("orders", "sigma", "reason"),
    [
        ([10.5], [0.1, 0.1], "sigma has 2 standard deviations for 1 orders"),
        ([-1.0], [0.1], "orders must be one series of positive numbers"),
        ([10.5], [0.0], "sigma must be one series of positive numbers"),
        ([], [], "orders must be one series of positive numbers"),
    ],
)
def test_series_that_do_not_fit_are_refused(orders: list[float], sigma: list[float], reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        sw.orders.bearing_candidates(orders, sigma)
