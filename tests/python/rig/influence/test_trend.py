"""Trends of measured series: the textbook regression, Holm, and how often the tests are wrong where the truth is known."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats
from strainwave.rig.influence.trend import Design, holm, lack_of_fit, regress, shuffled, trends

Array = NDArray[np.float64]


def design(**columns: Array) -> Design:
    laws = {"torque_max": "power", "temperature": "exponential", "hours": "exponential"}
    n = len(next(iter(columns.values())))
    return Design({name: laws[name] for name in columns}, columns, ("",) * n)  # type: ignore[misc]


def test_a_single_slope_is_that_of_linear_regression() -> None:
    """Against scipy.stats.linregress: slope, its standard deviation and its probability."""
    random = np.random.default_rng(5)
    x = random.uniform(0.0, 3.0, 12)
    y = 0.4 * x + random.normal(size=12)
    slope, expected = regress(np.column_stack((np.ones(12), x)), y)[1], stats.linregress(x, y)
    assert slope.value == pytest.approx(expected.slope, rel=1e-12)
    assert slope.sigma == pytest.approx(expected.stderr, rel=1e-12)
    assert slope.p == pytest.approx(expected.pvalue, rel=1e-9)


def test_holm_is_that_of_its_paper() -> None:
    """Holm 1979 by hand: 4 x 0.005, 3 x 0.01, then no less than before."""
    assert holm([0.01, 0.2, 0.005, 0.9]) == pytest.approx([0.03, 0.4, 0.02, 0.9])
    assert holm([0.5, 0.6]) == [1.0, 1.0]


def test_too_few_measurements_are_refused() -> None:
    with pytest.raises(
        ValueError, match="2 measurements do not determine 2 coefficients with an interval; 3 or more are needed"
    ):
        trends(design(torque_max=np.array([1.0, 2.0])), {"area": np.array([1.0, 2.0])})


def test_exact_laws_are_found_side_by_side() -> None:
    torque, warm = (each.ravel() for each in np.meshgrid([0.1, 0.2, 0.3], [280.0, 300.0, 320.0]))
    area = 2.0 * torque**1.5 * np.exp(-0.01 * (warm - 300.0))
    by_torque, by_warmth = trends(design(torque_max=torque, temperature=warm), {"area": area})
    assert by_torque.slope.value == pytest.approx(1.5, rel=1e-9)
    assert by_warmth.slope.value == pytest.approx(-0.01, rel=1e-9)
    assert by_torque.significant
    assert by_warmth.significant


def test_lack_of_fit_is_the_ratio_of_two_variances() -> None:
    """Against analysis of variance by hand: groups of unequal size, a straight line."""
    random = np.random.default_rng(8)
    x = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 3.0, 3.0, 3.0, 3.0])
    y = 0.3 * x**2 + 0.2 * random.normal(size=10)
    groups = [y[x == each] for each in (0.0, 1.0, 2.0, 3.0)]
    pure = sum(float(np.sum((group - group.mean()) ** 2)) for group in groups)
    line = np.polyfit(x, y, 1)
    beyond = float(np.sum((y - np.polyval(line, x)) ** 2)) - pure
    expected = stats.f.sf((beyond / 2) / (pure / 6), 2, 6)
    assert lack_of_fit(np.column_stack((np.ones(10), x)), y) == pytest.approx(expected, rel=1e-9)


def test_lack_of_fit_alarms_as_seldom_as_it_says() -> None:
    """Under a true line, every twentieth test falls below 5 %, within four standard deviations of 400 tests."""
    random, x = np.random.default_rng(9), np.repeat(np.arange(5.0), 3)
    for near in (0.0, 0.02):  # repeats that are not quite at one place
        found = []
        for _ in range(400):
            here = x + near * random.uniform(-1.0, 1.0, 15)
            found.append(lack_of_fit(np.column_stack((np.ones(15), here)), 2.0 * here + random.normal(size=15)))
        assert np.all(np.isfinite(found))
        assert abs(np.mean(np.array(found) < 0.05) - 0.05) < 4.0 * np.sqrt(0.05 * 0.95 / 400)


def test_an_exact_law_lacks_no_fit() -> None:
    x = np.repeat(np.arange(5.0), 3)
    assert np.isnan(lack_of_fit(np.column_stack((np.ones(15), x)), 0.1 + x / 3.0))


def test_a_law_of_another_shape_is_told_only_where_conditions_were_repeated() -> None:
    random = np.random.default_rng(10)
    torque = np.repeat([0.05, 0.1, 0.2, 0.4, 0.8], 3)
    area = np.minimum(torque, 0.2) * np.exp(0.01 * random.normal(size=15))
    (saturates,) = trends(design(torque_max=torque), {"area": area})
    assert saturates.bent
    (right,) = trends(design(torque_max=torque), {"area": torque**1.5 * np.exp(0.01 * random.normal(size=15))})
    assert not right.bent
    (unknown,) = trends(design(torque_max=torque[::3]), {"area": area[::3]})
    assert np.isnan(unknown.misfit)
    assert not unknown.bent


def test_specimens_have_levels_of_their_own() -> None:
    """Two units, one twice as large and measured warm: the difference of the units is none of the temperature."""
    warm = np.array([290.0, 295.0, 300.0, 310.0, 315.0, 320.0])
    width = np.array([1.0, 1.01, 0.99, 2.0, 2.02, 1.98])
    mixed = Design({"temperature": "exponential"}, {"temperature": warm}, ("a",) * 3 + ("b",) * 3)
    (own,), (blind,) = trends(mixed, {"width": width}), trends(design(temperature=warm), {"width": width})
    assert not own.significant
    assert blind.significant


def test_what_changed_together_is_not_told_apart() -> None:
    warm = np.array([290.0, 300.0, 310.0, 320.0, 330.0])
    hours = warm - 290.0
    exact = trends(design(temperature=warm, hours=hours), {"width": np.array([1.0, 1.1, 1.2, 1.3, 1.4])})
    assert [each.slope.p for each in exact] == [1.0, 1.0]
    assert [each.together_with for each in exact] == [("hours",), ("temperature",)]
    nearly = trends(design(temperature=warm, hours=hours + np.array([0.0, 1.0, -1.0, 0.5, 0.0])), {"width": warm / 290.0})
    assert nearly[0].together_with == ("hours",)


def test_a_quantity_that_is_zero_is_fitted_in_line() -> None:
    (trend,) = trends(design(torque_max=np.array([1.0, 2.0, 3.0, 4.0])), {"area": np.array([0.0, 1.0, 2.0, 3.0])})
    assert trend.law == "linear"
    assert trend.slope.value == pytest.approx(1.0, rel=1e-12)


def drawn(effect: float, runs: int, seed: int) -> list[tuple[float, float, bool]]:
    """t-test, shuffling, and whether the interval holds the truth, of series under drift."""
    random = np.random.default_rng(seed)
    torque = np.tile([0.1, 0.2, 0.3, 0.4], 3)
    found = []
    for _ in range(runs):
        warm = 293.0 + np.sort(random.uniform(0.0, 20.0, 12))
        noise = 0.03 * random.normal(size=12)
        area = torque**1.4 * np.exp(effect * (warm - 293.0) + noise)
        chosen = design(torque_max=torque, temperature=warm)
        trend = trends(chosen, {"area": area})[1]
        low, high = trend.interval
        found.append((trend.slope.p, trend.shuffled, low <= effect <= high))
    return found


@pytest.mark.slow("rig")
def test_without_an_effect_one_in_twenty_is_a_false_alarm() -> None:
    """Binomial: within four standard deviations of 5 %, for both tests; intervals hold the truth in 95 %."""
    runs = 400
    found = np.array(drawn(0.0, runs, seed=1))
    four = 4.0 * np.sqrt(runs * 0.05 * 0.95)
    for false in (found[:, 0] < 0.05, found[:, 1] < 0.05, found[:, 2] == 0.0):
        assert abs(false.sum() - 0.05 * runs) < four


def test_an_effect_of_five_deviations_is_seen_and_its_interval_holds_it() -> None:
    """Its standard deviation is about 0.03 / (sqrt(12) x 6 K) = 0.0014 per kelvin; 0.01 is seven of them."""
    found = np.array(drawn(-0.01, 100, seed=2))
    assert (found[:, 0] < 0.05).mean() > 0.98
    assert found[:, 2].mean() > 0.87


@pytest.mark.slow("rig")
def test_holm_keeps_the_alarms_of_a_whole_series() -> None:
    """Three quantities without an effect: one alarm or more in 5 % of the series, not in 14 %."""
    random = np.random.default_rng(3)
    warm, runs = np.linspace(290.0, 320.0, 10), 400
    alarms = 0
    for _ in range(runs):
        values = {name: np.exp(0.05 * random.normal(size=10)) for name in ("area", "width", "stiffness")}
        alarms += any(each.significant for each in trends(design(temperature=warm), values))
    assert abs(alarms - 0.05 * runs) < 4.0 * np.sqrt(runs * 0.05 * 0.95)


def test_shuffling_is_right_where_noise_has_outliers() -> None:
    """Cauchy noise, under which the t-test is not exact: still one false alarm in twenty, within four deviations."""
    random = np.random.default_rng(4)
    x, ones, runs = np.linspace(0.0, 1.0, 9), np.ones((9, 1)), 400
    alarms = sum(shuffled(ones, x, random.standard_cauchy(9), 199, seed) <= 0.05 for seed in range(runs))
    assert abs(alarms - 0.05 * runs) < 4.0 * np.sqrt(runs * 0.05 * 0.95)
