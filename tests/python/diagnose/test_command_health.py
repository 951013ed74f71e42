"""Remaining life against closed forms and draws: the maker's formula, and the trend with its interval."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.diagnose.health import WEIBULL_SLOPE, catalogue_life, trend

RNG = np.random.default_rng(0)


def test_the_life_scales_with_torque_and_speed_as_the_catalogue_states() -> None:
    csg, hfuc = sw.GearSet.read("csg-20-100"), sw.GearSet.read("hfuc-20-30")
    for gear_set, l10 in ((csg, 10000.0), (hfuc, 7000.0)):
        rated = gear_set.ratings["rated_torque"].value
        life = catalogue_life(gear_set, average_torque=rated, average_speed=2000.0)
        assert life.l10 == pytest.approx(l10)
        assert life.remaining[0] == pytest.approx(l10)
        assert life.remaining[1] == pytest.approx(5.0 * l10)
        assert catalogue_life(gear_set, average_torque=0.5 * rated, average_speed=1000.0).l10 == pytest.approx(16.0 * l10)


def test_what_remains_after_some_hours_is_that_of_drawn_bearings_that_still_work() -> None:
    gear_set = sw.GearSet.read("csg-20-100")
    rated = gear_set.ratings["rated_torque"].value
    life = catalogue_life(gear_set, average_torque=rated, average_speed=2000.0, hours=20000.0)
    drawn = RNG.weibull(WEIBULL_SLOPE, 400_000) * 10000.0 / np.log(1.0 / 0.9) ** (1.0 / WEIBULL_SLOPE)
    left = drawn[drawn > 20000.0] - 20000.0
    assert np.allclose(life.remaining, np.quantile(left, [0.1, 0.5, 0.9]), rtol=0.02)


def test_a_gear_without_rated_torque_has_no_life() -> None:
    bare = sw.GearSet.read("csg-20-100").replace(ratings={})
    with pytest.raises(ValueError, match=r"has no rated_torque in \[ratings\]; .* add it to the gear file"):
        catalogue_life(bare, average_torque=10.0, average_speed=1000.0)


def test_the_trend_is_the_line_of_least_squares() -> None:
    hours = np.array([0.0, 100.0, 250.0, 300.0, 480.0, 500.0])
    indicator = 0.2 + 0.004 * hours + RNG.normal(0.0, 0.05, len(hours))
    slope, level = np.polyfit(hours, indicator, 1)
    found = trend(hours.tolist(), indicator.tolist(), 5.0)
    assert found.slope == pytest.approx(slope)
    assert found.remaining == pytest.approx((5.0 - level) / slope - 500.0)


def test_the_interval_of_the_trend_contains_the_truth_in_95_of_100() -> None:
    hours = np.linspace(0.0, 500.0, 7)
    truth = (3.0 - 0.2) / 0.004 - 500.0
    inside = 0
    for _ in range(2000):
        found = trend(hours.tolist(), (0.2 + 0.004 * hours + RNG.normal(0.0, 0.2, len(hours))).tolist(), 3.0)
        inside += found.low <= truth <= found.high
    assert 0.935 < inside / 2000 < 0.965


def test_an_indicator_that_may_not_grow_has_no_end() -> None:
    hours = [0.0, 100.0, 200.0, 300.0, 400.0]
    assert trend(hours, [0.3, 0.1, 0.4, 0.2, 0.31], 3.0).high == np.inf
    assert trend(hours, [0.9, 0.8, 0.7, 0.6, 0.49], 3.0).remaining == np.inf


def test_few_recordings_or_one_hour_have_no_trend() -> None:
    with pytest.raises(ValueError, match=r"needs 5 compared recordings or more; there are 4"):
        trend([0.0, 1.0, 2.0, 3.0], [0.1, 0.2, 0.3, 0.4], 2.0)
    with pytest.raises(ValueError, match=r"all recordings are of hour 7"):
        trend([7.0] * 5, [0.1, 0.2, 0.3, 0.4, 0.5], 2.0)
