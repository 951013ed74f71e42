"""Shape of residuals: its size, and how often noise has one."""

from __future__ import annotations

import numpy as np
import pytest
from strainwave.statistics.residuals import shape

TIME = np.linspace(0.0, 30.0, 3000)
ANGLE = np.mod(40.0 * np.sin(TIME), 2.0 * np.pi)


@pytest.mark.parametrize(("over", "count", "ordered"), [("order", 40, True), ("order", 400, True), ("turn", 3000, False)])
def test_white_noise_has_a_shape_as_often_as_chance(over: str, count: int, ordered: bool) -> None:
    """Of 300 drawn at most 8 are below 1 %: more are less likely than 1 in 1000."""
    abscissa = np.arange(count) if over == "order" else ANGLE
    random = np.random.default_rng(7)
    found = [shape(random.normal(size=count), abscissa, ordered=ordered) for _ in range(300)]
    assert sum(each is not None and each.chance < 0.01 for each in found) <= 8
    assert all(each is not None for each in found)


def test_slow_noise_is_in_one_half_alone() -> None:
    random = np.random.default_rng(3)
    slow = [np.convolve(random.normal(size=3200), np.exp(-np.arange(200) / 20.0), "valid")[:3000] for _ in range(200)]
    assert sum(shape(each, ANGLE).chance < 1e-3 for each in slow) <= 3  # type: ignore[union-attr]


@pytest.mark.parametrize("size", [0.3, 1.0])
def test_a_wave_over_the_turn_is_found_with_its_size(size: float) -> None:
    noise = np.random.default_rng(1).normal(size=len(TIME))
    found = shape(noise + size * np.sqrt(2.0) * np.sin(2.0 * ANGLE), ANGLE)
    assert found is not None
    assert found.chance < 1e-3
    assert found.size == pytest.approx(size, abs=0.03)


def test_few_samples_have_none() -> None:
    assert shape(np.ones(23), np.arange(23.0), ordered=True) is None
    assert shape(np.zeros(100), np.arange(100.0), ordered=True).size == 0.0  # type: ignore[union-attr]
