"""Random kinematic error: what the seed draws, number by number; its statistics; and what its amplitude follows."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from strainwave.kinematic_error import Stochastic

Array = NDArray[np.float64]

WAVES = 32
MODULI = np.array([30269, 30307, 30323])
FACTORS = np.array([171, 172, 170])

# Orders of the default band are odd multiples of 1/512: this is the whole of the error, and its spectrum has no leakage.
TURNS, SAMPLES = 512, 96
PERIOD = 2.0 * np.pi * np.arange(TURNS * SAMPLES) / SAMPLES

seeds = st.integers(0, 16777215)
angles = st.floats(-math.pi, math.pi)


def drawn(seed: int, lowest: float = 8.0, highest: float = 40.0) -> tuple[Array, Array]:
    """Orders and phases, in the integers of Python: AS 183 (WichmannHill1982), stirred before use."""
    high = round(seed / 4096)
    state = np.array([seed - 4096 * high + 2049, high + 1, 1])
    for _ in range(16):
        for i in range(3):
            state[i] = max((FACTORS[i] * state[i] + state[(i + 1) % 3]) % MODULI[i], 1)
    orders, phases = [], []
    for wave in range(WAVES):
        state = FACTORS * state % MODULI
        place = int((256 * state // MODULI).sum()) % 256
        orders.append(lowest + (wave + (place + 0.5) / 256.0) * (highest - lowest) / WAVES)
        state = FACTORS * state % MODULI
        phases.append(2.0 * math.pi * math.fsum(state / MODULI))
    return np.array(orders), np.array(phases)


@given(seeds, angles, st.sampled_from([(8.0, 40.0), (0.0, 2.0), (10.0, 60.0)]))
def test_orders_and_phases_are_those_the_seed_draws(seed: int, angle: float, band: tuple[float, float]) -> None:
    order, phase = drawn(seed, *band)
    noise = Stochastic(amplitude=1e-5, seed=seed, lowest_order=band[0], highest_order=band[1])
    waves = order * angle + phase
    scale = 1e-5 * math.sqrt(2.0 / WAVES)
    rounding = 1e-12 * scale * WAVES
    assert noise.error(angle) == pytest.approx(scale * math.fsum(np.cos(waves)), rel=0.0, abs=rounding)
    assert noise.slope(angle) == pytest.approx(-scale * math.fsum(order * np.sin(waves)), rel=0.0, abs=rounding * band[1])


@pytest.mark.parametrize("seed", [0, 1, 2047, 2048, 2049, 6144, 16777214, 16777215])
def test_seeds_at_the_seams_draw_whole_numbers_too(seed: int) -> None:
    order, phase = drawn(seed)
    expected = 0.25 * math.fsum(np.cos(order + phase))
    assert Stochastic(amplitude=1.0, seed=seed).error(1.0) == pytest.approx(expected, rel=0.0, abs=1e-12)


@pytest.mark.parametrize("seed", [0, 1, 4711])
def test_the_amplitude_is_the_root_mean_square(seed: int) -> None:
    values = Stochastic(amplitude=3e-5, seed=seed).error(PERIOD)
    assert math.sqrt(np.mean(values**2)) == pytest.approx(3e-5, rel=1e-9)


@pytest.mark.parametrize("seed", [0, 1, 4711])
def test_all_power_lies_in_the_band_and_each_cell_holds_as_much(seed: int) -> None:
    values = Stochastic(amplitude=1.0, seed=seed).error(PERIOD)
    power = 2.0 * np.abs(np.fft.rfft(values) / len(values)) ** 2
    order = np.arange(len(power)) / TURNS
    cells = [power[(order > low) & (order < low + 1.0)].sum() for low in range(8, 40)]
    assert cells == pytest.approx([1.0 / WAVES] * WAVES, rel=1e-9)
    assert power[(order <= 8.0) | (order >= 40.0)].sum() < 1e-18


@pytest.mark.parametrize("seed", [0, 16777215])
def test_the_slope_is_the_derivative(seed: int) -> None:
    noise = Stochastic(amplitude=1.0, seed=seed)
    spectrum = np.fft.rfft(noise.error(PERIOD))
    slope = np.fft.irfft(spectrum * 1j * np.arange(len(spectrum)) / TURNS)
    np.testing.assert_allclose(noise.slope(PERIOD), slope, rtol=0.0, atol=1e-8)


def test_the_values_of_all_seeds_at_one_place_are_gaussian_and_those_of_neighbours_unrelated() -> None:
    """Within four standard deviations of the estimates; the fourth moment of 32 cosines is 3 (1 - 1/64)."""
    place, count = np.array([0.0, 0.05, 1.0]), 4000
    values = np.array([Stochastic(amplitude=1.0, seed=seed).error(place) for seed in range(count)])
    sigma = 1.0 / math.sqrt(count)
    assert np.abs(values.mean(axis=0)).max() < 4.0 * sigma
    assert np.abs((values**2).mean(axis=0) - 1.0).max() < 4.0 * math.sqrt(2.0) * sigma
    assert np.abs((values**4).mean(axis=0) - 3.0 * (1.0 - 1.0 / 64.0)).max() < 4.0 * math.sqrt(96.0) * sigma
    for lag in (1, 2, 256, 2048):
        assert np.abs((values[lag:] * values[:-lag]).mean(axis=0)).max() < 4.0 / math.sqrt(count - lag)


def test_errors_of_different_seeds_do_not_correlate() -> None:
    """Over the whole of them two errors share what orders they share, 1/32 each: four shared ones do not occur by chance."""
    values = np.array([Stochastic(amplitude=1.0, seed=seed).error(PERIOD[::3]) for seed in [*range(12), 4096, 8192, 16777215]])
    correlation = np.corrcoef(values)
    assert np.abs(correlation - np.eye(len(values))).max() < 4.0 / WAVES


@given(seeds, angles, st.floats(-1e3, 1e3), st.floats(-1e3, 1e3))
def test_load_speed_and_depth_only_scale_it(seed: int, angle: float, torque: float, speed: float) -> None:
    plain = Stochastic(amplitude=1e-5, seed=seed)
    noise = plain.replace(load_sensitivity=0.02, speed_sensitivity=3e-3, insertion_depth=5e-3, depth_sensitivity=40.0)
    factor = math.exp(-0.2) * (1.0 + 3e-3 * abs(speed)) / (1.0 + 0.02 * abs(torque))
    assert noise.error(angle, torque, speed) == pytest.approx(factor * plain.error(angle), rel=1e-13, abs=1e-25)
    assert noise.slope(angle, torque=torque, speed=speed) == pytest.approx(factor * plain.slope(angle), rel=1e-13, abs=1e-25)
    assert plain.error(angle, torque, speed) == plain.error(angle)


def test_it_falls_with_load_rises_with_speed_and_falls_with_depth() -> None:
    """The directions that the review states."""
    noise = Stochastic(
        amplitude=1e-5, load_sensitivity=0.02, speed_sensitivity=3e-3, insertion_depth=1e-3, depth_sensitivity=40.0
    )
    at_rest = abs(noise.error(0.3))
    assert at_rest > 0.0
    for sense in (-1.0, 1.0):
        assert abs(noise.error(0.3, torque=10.0 * sense)) < at_rest
        assert abs(noise.error(0.3, speed=10.0 * sense)) > at_rest
    assert abs(noise.replace(insertion_depth=2e-3).error(0.3)) < at_rest


@given(angles)
def test_no_amplitude_is_no_error(angle: float) -> None:
    assert Stochastic(seed=3).error(angle, torque=5.0, speed=100.0) == 0.0
    assert Stochastic(seed=3).slope(angle, torque=5.0, speed=100.0) == 0.0


@given(seeds, angles)
def test_the_same_seed_gives_the_same_error(seed: int, angle: float) -> None:
    assert Stochastic(amplitude=1e-5, seed=seed).error(angle) == Stochastic(amplitude=1e-5, seed=seed).error(angle)
    other = Stochastic(amplitude=1e-5, seed=(seed + 1) % 16777216)
    assert other.error([0.0, 1.0]).tolist() != Stochastic(amplitude=1e-5, seed=seed).error([0.0, 1.0]).tolist()


def test_it_goes_on_after_a_turn() -> None:
    noise = Stochastic(amplitude=1.0, seed=1)
    order, phase = drawn(1)
    angle = np.linspace(-300.0, 300.0, 601)
    expected = 0.25 * np.cos(np.outer(angle, order) + phase).sum(axis=1)
    np.testing.assert_allclose(noise.error(angle), expected, rtol=0.0, atol=1e-10)
    assert abs(noise.error(0.3) - noise.error(0.3 + 2.0 * math.pi)) > 1e-3


def test_a_seed_that_is_no_whole_number_is_refused() -> None:
    for seed in (0.5, -1, 16777216):
        with pytest.raises((TypeError, ValueError), match="seed"):
            Stochastic(seed=seed)


def test_an_empty_band_is_refused() -> None:
    with pytest.raises(ValueError, match="highest_order must exceed lowest_order"):
        Stochastic(lowest_order=10.0, highest_order=10.0)
