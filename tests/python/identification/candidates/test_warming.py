"""Friction over a warm-up: a known fall is found within its interval, also under noise that hangs together."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.candidates.warming import friction_over_temperature


def log(seed: int, slope: float = -0.01, memory: float = 0.9, n: int = 4000) -> sw.Recording:
    """An axis to and fro under its weight, warming up by 10 K, with noise that forgets itself over ten samples."""
    random = np.random.default_rng(seed)
    time = np.arange(n) * 1.0
    speed = np.sin(0.7 * time) * np.sin(0.031 * time)
    temperature = 42.0 - 10.0 * np.exp(-time / 1500.0)
    noise, white = np.empty(n), 0.3 * random.normal(size=n)
    noise[0] = white[0]
    for i in range(1, n):
        noise[i] = memory * noise[i - 1] + np.sqrt(1.0 - memory**2) * white[i]
    current = -0.6 + 0.002 * (temperature - 40.0) + np.sign(speed) * (0.4 + slope * (temperature - 38.0)) + noise
    units = {"time": "s", "speed": "rad/s", "temperature": "degC", "current": "A"}
    return sw.Recording({"time": time, "speed": speed, "temperature": temperature, "current": current}, units)


def test_a_known_fall_lies_within_its_interval_as_often_as_is_said() -> None:
    off = []
    for seed in range(50):
        found = friction_over_temperature(log(seed))
        reference = found.reference_temperature - 273.15
        level = 0.4 - 0.01 * (reference - 38.0)
        truths = (level, -0.01, 0.01 / level)
        off.append([(e.value - t) / e.sigma for e, t in zip((found.friction, found.slope, found.fall), truths, strict=True)])
    table = np.array(off)
    assert np.all(np.mean(np.abs(table) <= 2.0, axis=0) >= 0.9)
    scatter = np.sqrt(np.mean(table**2, axis=0))
    assert np.all((scatter > 0.7) & (scatter < 1.4)), scatter


def test_no_fall_is_not_told_from_none() -> None:
    low, high = friction_over_temperature(log(1, slope=0.0)).slope.interval(0.99)
    assert low < 0.0 < high


def test_one_way_the_slope_is_that_of_the_friction_and_its_level_has_the_weight_inside() -> None:
    both, off = log(3), []
    for seed in range(20):
        random = np.random.default_rng(seed)
        warmth = both["temperature"] - both["temperature"].mean()
        current = 0.9 - 0.01 * warmth + 0.1 * random.normal(size=len(warmth))
        one = both.with_column("speed", np.full(len(warmth), 1.0), "rad/s").with_column("current", current, "A")
        found = friction_over_temperature(one)
        assert found.one_way
        off.append([(found.slope.value + 0.01) / found.slope.sigma, (found.friction.value - 0.9) / found.friction.sigma])
    assert np.all(np.abs(off) < 4.0)
    assert np.all(np.sqrt(np.mean(np.square(off), axis=0)) < 1.5)


def test_a_temperature_that_hardly_changes_is_refused() -> None:
    recording = log(0).with_column("temperature", np.full(4000, 30.0), "K")
    with pytest.raises(ValueError, match="the temperature changes by 0 K only"):
        friction_over_temperature(recording)


def test_an_effort_without_friction_is_refused() -> None:
    still = log(0).with_column("current", np.zeros(4000), "A")
    with pytest.raises(ValueError, match="no part of current turns round with the motion"):
        friction_over_temperature(still)
