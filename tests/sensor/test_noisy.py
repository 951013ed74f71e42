"""A sensor with noise: as strong, as wide and as random as it says."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave import _core

from tests.kinematic_error.test_stochastic import drawn
from tests.sensor.probe import Array, probe, run_of, shown

AMPLITUDE, BANDWIDTH = 0.3, 200.0
STILL = sw.scenario.constant(0.0, 20.0)


def noise(seed: int, amplitude: float = AMPLITUDE, bandwidth: float = BANDWIDTH) -> sw.sensor.Noisy:
    return sw.sensor.Noisy(amplitude=amplitude, bandwidth=bandwidth, seed=seed)


def heard(seed: int, **changed: float) -> Array:
    """Twenty seconds of it, every millisecond."""
    return shown(noise(seed, **changed), STILL, 1e-3)[1]


@given(st.integers(0, 16777215), st.floats(1.0, 5000.0), st.floats(0.0, 1.0))
def test_it_is_the_sum_of_the_waves_that_its_seed_draws(seed: int, bandwidth: float, time: float) -> None:
    """32 frequencies and phases, drawn in the integers of Python."""
    frequency, phase = drawn(seed, 0.0, bandwidth)
    wanted = AMPLITUDE * np.sqrt(2.0 / 32.0) * np.cos(2.0 * np.pi * frequency * time + phase).sum()
    drive = probe(noise(seed, bandwidth=bandwidth))
    state = drive.rest().replace({"sensors.output_angle.clock": time})
    found = _core.measured(drive, state.numbers, np.array([0.0, 0.0, 0.0, 0.0, 293.15, 0.0]))[2]
    assert found == pytest.approx(wanted, abs=1e-11 * (1.0 + bandwidth * time))


# Of a bandwidth of 128 Hz the frequencies are odd multiples of 1/128 Hz: 128 s hold all of it, and its spectrum has no leakage.
WHOLE, RATE = 128, 512


def spectrum(seed: int) -> Array:
    """The power of each frequency, in steps of 1/128 Hz."""
    values = shown(noise(seed, bandwidth=128.0), sw.scenario.constant(0.0, float(WHOLE)), 1.0 / RATE)[1][:-1]
    return np.append(0.0, 2.0 * np.abs(np.fft.rfft(values) / len(values))[1:] ** 2)


@pytest.mark.parametrize("seed", [0, 1, 77, 16777215])
def test_its_spectrum_is_flat_up_to_the_bandwidth_and_empty_beyond(seed: int) -> None:
    """A 32nd of its power in each 32nd of the band, nothing outside, and in all its amplitude squared."""
    power = spectrum(seed)
    cells = power[: 128 * WHOLE].reshape(32, -1).sum(axis=1)
    assert cells == pytest.approx(np.full(32, AMPLITUDE**2 / 32.0), rel=1e-8)
    assert power[128 * WHOLE :].max() < 1e-18
    assert power.sum() == pytest.approx(AMPLITUDE**2, rel=1e-8)


@pytest.mark.parametrize("seed", [3, 4])
def test_over_any_time_its_root_mean_square_is_about_its_amplitude(seed: int) -> None:
    found = heard(seed)
    assert np.sqrt(np.mean(found**2)) == pytest.approx(AMPLITUDE, rel=0.02)
    assert abs(found.mean()) < 0.02 * AMPLITUDE


def test_its_values_are_close_to_gaussian() -> None:
    values = np.concatenate([heard(seed) for seed in range(4)]) / AMPLITUDE
    for width, share in ((1.0, 0.6827), (2.0, 0.9545)):
        assert np.mean(np.abs(values) < width) == pytest.approx(share, abs=0.015)
    assert np.mean(values**4) == pytest.approx(3.0 * (1.0 - 1.0 / 64.0), rel=0.1)  # of 32 random phases: 3 - 3 / 64


@pytest.mark.parametrize("multiple", [1, 2, 5])
def test_samples_half_a_bandwidth_apart_are_close_to_independent(multiple: int) -> None:
    """1 / (2 B) and its multiples, where a flat band has no correlation."""
    correlations = []
    for seed in range(6):
        found = shown(noise(seed), STILL, 2.5e-3)[1][::multiple] / AMPLITUDE
        correlations.append(np.mean(found[1:] * found[:-1]))
    assert np.abs(correlations).max() < 0.2
    assert abs(np.mean(correlations)) < 0.1


@pytest.mark.slow("physics")
def test_different_seeds_have_nothing_in_common() -> None:
    seeds = [0, 1, 2, 3, 4096, 4097, 8192, 16777215]
    found = np.stack([heard(seed) for seed in seeds]) / AMPLITUDE
    common = found @ found.T / found.shape[1]
    assert np.abs(common - np.diag(np.diag(common))).max() < 0.05
    assert np.array_equal(heard(7), heard(7))


def test_it_is_added_to_what_the_sensor_shows_and_scales_with_its_amplitude() -> None:
    motion = sw.scenario.sine(1.0, 4.0, 0.5)
    lag = sw.sensor.FirstOrder(time_constant=0.01)
    time, alone = shown(lag, motion, 1e-4)
    one, two = (shown(noise(9, amplitude=a).replace(law=lag), motion, 1e-4)[1] - alone for a in (0.1, 0.2))
    assert two == pytest.approx(2.0 * one, abs=1e-12)
    assert np.abs(one).max() > 0.1
    silent = shown(noise(9, amplitude=0.0).replace(law=lag), motion, 1e-4)[1]
    assert np.array_equal(silent, alone)
    assert time[-1] == 0.5


def test_no_step_and_no_method_changes_it() -> None:
    level = sw.scenario.constant(0.2, 0.2)
    wanted = run_of(noise(11), level, 1e-4, sample=1e-3)["motor_torque"]
    for dt in (3e-5, 1e-3):
        assert run_of(noise(11), level, dt, sample=1e-3)["motor_torque"] == pytest.approx(wanted, abs=1e-11)
    drive, still = probe(noise(11)), sw.scenario.constant(0.0, 0.2)
    for method in ("rosenbrock", "moreau_jean"):
        run = sw.simulate(drive, still, sample=1e-3, method=method, inputs={"output_angle": 0.2})
        assert run["motor_torque"] == pytest.approx(wanted, abs=1e-11)


def test_it_goes_on_where_a_run_ended() -> None:
    drive, half = probe(noise(12)), sw.scenario.constant(0.0, 0.1)
    whole = sw.simulate(drive, sw.scenario.constant(0.0, 0.2), 1e-3)["motor_torque"]
    first = sw.simulate(drive, half, 1e-3)
    second = sw.simulate(drive, half, 1e-3, initial=first.end)
    assert second["motor_torque"] == pytest.approx(whole[100:], abs=1e-11)


def test_a_controller_that_samples_sees_it_at_its_instants() -> None:
    law = sw.control.Sampled(law=sw.control.StateFeedback(output_angle=-1.0, limit=1e12), period=2e-3)
    held = sw.simulate(probe(noise(13)).replace(control=law), sw.scenario.constant(0.0, 0.1), sample=2e-3)["motor_torque"]
    wanted = shown(noise(13), sw.scenario.constant(0.0, 0.1), 2e-3)[1]
    assert held[1:] == pytest.approx(wanted[:-1], abs=1e-12)


def test_the_bandwidth_is_in_hertz() -> None:
    """Zero crossings a second of a flat band: 2 B / sqrt(3) (Rice)."""
    crossings = [np.count_nonzero(np.diff(np.sign(shown(noise(seed), STILL, 5e-4)[1]))) / 20.0 for seed in range(2)]
    assert np.mean(crossings) == pytest.approx(2.0 * BANDWIDTH / np.sqrt(3.0), rel=0.02)
