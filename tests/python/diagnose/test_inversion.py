"""Orders of a short ramp: their noise and its degrees of freedom are those of many records of noise alone."""

from __future__ import annotations

import numpy as np
import pytest
from strainwave.diagnose.inversion import ERROR_ORDERS, MeasuredOrders, measured_orders
from strainwave.files.recording import Recording

SAMPLES = 1500
SIGMA = 0.05  # A


def measured(revolutions: float, seed: int, amplitude: float = 0.0) -> MeasuredOrders:
    angle = np.linspace(0.0, 2.0 * np.pi * revolutions, SAMPLES, endpoint=False)
    noise = np.random.default_rng(seed).normal(0.0, SIGMA, SAMPLES)
    current = 1.0 + amplitude * np.sin(2.0 * angle) + noise
    return measured_orders(
        Recording({"input_angle": angle, "current": current}, {"input_angle": "rad", "current": "A"}), "current"
    )


@pytest.mark.parametrize("revolutions", [6.0, 8.3, 40.0])
def test_the_noise_of_an_order_is_that_of_its_neighbours(revolutions: float) -> None:
    noise = np.array([measured(revolutions, seed).noise for seed in range(100)])
    expected = SIGMA * np.sqrt(2.0 / SAMPLES)
    assert np.sqrt(np.mean(noise**2)) == pytest.approx(expected, rel=0.15)


@pytest.mark.parametrize("revolutions", [6.0, 8.3, 40.0])
def test_degrees_of_freedom_are_no_more_than_the_scatter_of_the_noise_has(revolutions: float) -> None:
    """Of a short ramp fewer are counted: lines between orders are apart, and correlate less."""
    power = np.array([measured(revolutions, seed).noise ** 2 for seed in range(400)])
    scatter = float(np.mean(power.var(axis=0) / power.mean(axis=0) ** 2))  # of chi-squared: 2 / degrees
    assert 0.5 * 2.0 / scatter < measured(revolutions, 0).degrees < 1.25 * 2.0 / scatter


def test_a_ramp_without_a_line_of_noise_alone_is_refused_with_the_revolutions_that_it_needs() -> None:
    for revolutions in (2.5, 3.5, 3.9):
        with pytest.raises(ValueError, match=r"has [23] whole revolutions .* orders 1 to 4 needs 4 or more: record a longer"):
            measured(revolutions, 0)
    least = measured(4.5, 0)
    assert least.degrees > 0
    assert np.isfinite(least.noise).all()


def test_a_short_ramp_shows_an_order_far_above_its_noise() -> None:
    """With lines of its own half interval alone, an order of 67 standard deviations was no finding in 8 revolutions."""
    found = measured(8.0, 1, amplitude=10.0 * SIGMA * np.sqrt(2.0 / SAMPLES))
    assert found.degrees >= 10
    assert found.false_alarm < 1e-3
    assert len(found.values) == len(ERROR_ORDERS)
