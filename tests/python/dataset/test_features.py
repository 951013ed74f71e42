"""Features of runs: against closed forms, and against what was put into a made-up current."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from strainwave.dataset.features import FeatureSet, add_noise, moments, order_amplitudes

Array = NDArray[np.float64]
SAMPLES = 2000


def runs(turns: float, members: int = 3) -> Array:
    """Input angles that speed up a little, each member further than the one before."""
    share = np.linspace(0.0, 1.0, SAMPLES)
    return np.array([2.0 * np.pi * turns * (share + 0.1 * number * share**2) for number in range(members)])


def test_moments_of_a_sine_are_those_of_the_textbook() -> None:
    wave = 3.0 + 2.0 * np.sin(2.0 * np.pi * np.arange(SAMPLES) / SAMPLES)
    found = {name: values[0] for name, values in moments(wave[None]).items()}
    assert found["mean"] == pytest.approx(3.0)
    assert found["rms"] == pytest.approx(np.sqrt(9.0 + 2.0))
    assert found["peak"] == pytest.approx(5.0)
    assert found["kurtosis"] == pytest.approx(1.5)  # of a sine


def test_the_kurtosis_of_gaussian_values_is_three() -> None:
    values = np.random.default_rng(1).normal(size=(1, 200_000))
    assert moments(values)["kurtosis"][0] == pytest.approx(3.0, abs=5.0 * np.sqrt(24.0 / 200_000))


def test_a_constant_signal_has_no_kurtosis() -> None:
    assert np.isnan(moments(np.full((1, 50), 0.1))["kurtosis"][0])


@pytest.mark.parametrize("phase", [0.0, 1.0, 2.5])
def test_amplitudes_are_those_that_were_put_in_beside_a_trend(phase: float) -> None:
    angle = runs(6.0)
    share = np.linspace(0.0, 1.0, SAMPLES)
    current = 2.0 - share + 0.7 * share**2 + 0.3 * np.cos(2.0 * angle + phase) + 0.05 * np.sin(4.0 * angle)
    found = order_amplitudes(current, angle, np.ones_like(angle, dtype=bool), [1.0, 2.0, 4.0])
    np.testing.assert_allclose(found, np.tile([0.0, 0.3, 0.05], (3, 1)), atol=1e-9)


def test_the_scatter_of_an_amplitude_is_that_of_least_squares() -> None:
    """sigma sqrt(2 / M) of each component for white noise, physics.md 7.9."""
    angle = np.tile(runs(20.0, 1), (400, 1))
    noise = np.random.default_rng(2).normal(scale=0.1, size=angle.shape)
    found = order_amplitudes(np.cos(2.0 * angle) + noise, angle, np.ones_like(angle, dtype=bool), [2.0])[:, 0]
    assert found.std() == pytest.approx(0.1 * np.sqrt(2.0 / SAMPLES), rel=5.0 / np.sqrt(2 * 400))


def test_samples_that_are_not_used_have_no_influence() -> None:
    angle = runs(6.0)
    used = np.arange(SAMPLES)[None] < np.full((3, 1), 1500)
    current = np.where(used, np.cos(2.0 * angle), 1e3)
    np.testing.assert_allclose(order_amplitudes(current, angle, used, [2.0]), 1.0, atol=1e-9)


def test_a_run_to_and_fro_has_amplitudes_of_each_direction() -> None:
    half = runs(5.0, 1)[0, : SAMPLES // 2]
    angle = np.concatenate([half, half[::-1]])[None]
    speed = np.gradient(angle, axis=1)
    current = np.where(speed > 0.0, 0.5, 0.2) * np.cos(2.0 * angle)
    found = FeatureSet({"current": "A"}, (1.0, 2.0), None).of({"current": current}, angle, speed)
    assert found["current_order_2_forward"][0] == pytest.approx(0.5, rel=1e-3)
    assert found["current_order_2_backward"][0] == pytest.approx(0.2, rel=1e-3)


def test_too_few_turns_determine_no_order_and_less_than_fifty_no_tooth_order() -> None:
    features = FeatureSet({"current": "A"}, (1.0, 2.0), 2.02)
    assert features.tooth_turns == pytest.approx(50.0)
    for turns, known in ((1.0, (False, False)), (10.0, (True, False)), (60.0, (True, True))):
        angle = runs(turns, 1)
        current = np.cos(2.0 * angle) + 0.1 * np.cos(2.02 * angle)
        found = features.of({"current": current}, angle, np.gradient(angle, axis=1))
        values = found["current_order_2_forward"][0], found["current_order_2.02_forward"][0]
        assert tuple(bool(np.isfinite(value)) for value in values) == known, turns
    np.testing.assert_allclose(values, [1.0, 0.1], rtol=1e-6)


def test_at_rest_no_order_is_determined() -> None:
    still = np.zeros((2, 100))
    found = FeatureSet({"current": "A"}, (1.0, 2.0), None).of({"current": still + 1.0}, still, still)
    assert np.isnan(found["current_order_2_forward"]).all()


def test_noise_is_a_function_of_the_member_alone() -> None:
    both = {"current": np.zeros((2, 50)), "torque": np.zeros((2, 50))}
    add_noise(both, {"current": 0.1, "torque": 2.0}, 7, np.array([3, 10**9]))
    alone = {"current": np.zeros((1, 50)), "torque": np.zeros((1, 50))}
    add_noise(alone, {"current": 0.1, "torque": 2.0}, 7, np.array([10**9]))
    for name in both:
        np.testing.assert_array_equal(alone[name][0], both[name][1])
        assert (both[name][0] != both[name][1]).all()


def test_noise_has_the_stated_standard_deviation() -> None:
    series = {"current": np.zeros((50, 1000))}
    add_noise(series, {"current": 0.1}, 1, np.arange(50))
    assert series["current"].std() == pytest.approx(0.1, rel=5.0 / np.sqrt(2 * 50_000))
