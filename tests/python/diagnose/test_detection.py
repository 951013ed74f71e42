"""Detection: closed forms for a known level, coverage of intervals, and rates by Monte Carlo."""

from __future__ import annotations

from math import exp, inf, log

import numpy as np
import pytest
from strainwave.diagnose.detection import (
    amplitude_interval,
    false_alarm_of,
    needed_signal_to_noise,
    power_of,
    threshold_of,
)

DRAWS = 20000


def test_a_known_level_has_the_exponential_law_of_rayleigh() -> None:
    assert threshold_of(1e-3, 2, inf) == pytest.approx(-log(1e-3))
    assert false_alarm_of(5.0, 2, inf) == pytest.approx(exp(-5.0))
    assert false_alarm_of(5.0, 2, inf, tests=4) == pytest.approx(4.0 * exp(-5.0))


def test_an_estimated_level_has_the_law_of_two_freedoms() -> None:
    """P(F > x) = (1 + 2 x / nu)^(-nu / 2) for two amplitudes."""
    for freedom in (8, 24, 64):
        assert false_alarm_of(6.0, 2, freedom) == pytest.approx((1.0 + 12.0 / freedom) ** (-0.5 * freedom))


@pytest.mark.parametrize("freedom", [24, 64])
@pytest.mark.parametrize("true", [3.0, 5.0])
def test_the_power_is_the_share_of_detections(true: float, freedom: int) -> None:
    random = np.random.default_rng(1)
    parts = random.normal(size=(2, DRAWS)) + np.array([[true], [0.0]])
    level = random.chisquare(freedom, DRAWS) / freedom
    share = np.mean(0.5 * np.sum(parts**2, axis=0) / level > threshold_of(1e-2, 2, freedom))
    assert share == pytest.approx(power_of(true, 1e-2, freedom), abs=4.0 * 0.5 / np.sqrt(DRAWS))


def test_the_signal_to_noise_that_is_needed_has_the_power_asked_for() -> None:
    for freedom in (12.0, 64.0, inf):
        for probability in (0.5, 0.9, 0.99):
            needed = needed_signal_to_noise(probability, 1e-3, freedom)
            assert power_of(needed, 1e-3, freedom) == pytest.approx(probability, abs=1e-6)
    assert needed_signal_to_noise(0.9, 1e-3, 12.0) > needed_signal_to_noise(0.9, 1e-3, inf)


@pytest.mark.slow("diagnose")
@pytest.mark.parametrize("freedom", [16.0, inf])
@pytest.mark.parametrize("true", [0.0, 1.0, 4.0])
def test_the_interval_of_an_amplitude_covers_it_as_often_as_stated(true: float, freedom: float) -> None:
    random = np.random.default_rng(4)
    draws, covered = 400, 0
    for _ in range(draws):
        amplitude = float(np.hypot(*(random.normal(size=2) + np.array([true, 0.0]))))
        sigma = float(np.sqrt(random.chisquare(freedom) / freedom)) if freedom < inf else 1.0
        low, high = amplitude_interval(amplitude, sigma, freedom)
        covered += low <= true <= high
    assert covered / draws >= 0.95 - 3.0 * np.sqrt(0.95 * 0.05 / draws)
    if true > 0.0:
        assert covered / draws <= 0.99


def test_a_large_amplitude_has_the_usual_interval() -> None:
    low, high = amplitude_interval(100.0, 1.0)
    assert (low, high) == (pytest.approx(100.0 - 1.96, abs=0.02), pytest.approx(100.0 + 1.96, abs=0.02))
