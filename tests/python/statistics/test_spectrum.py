"""Spectra in segments, against those of SciPy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal
from strainwave.statistics.spectrum import bandwidth, floor_under, mean_power, segment_power, taper


@pytest.mark.parametrize("samples", [2, 63, 64, 257])
def test_power_is_that_of_welch_with_the_same_window(samples: int) -> None:
    series = np.random.default_rng(1).normal(1.0, 2.0, 1000)
    frequency, power = mean_power(series, samples)
    expected_frequency, expected = signal.welch(series, nperseg=samples, scaling="spectrum")
    assert frequency == pytest.approx(expected_frequency)
    assert power == pytest.approx(expected, abs=1e-12)
    _, density = signal.welch(series, nperseg=samples)
    assert power / bandwidth(samples) == pytest.approx(density, abs=1e-12)


@pytest.mark.parametrize("repeated", [0, 10, 90])
def test_segments_are_those_of_a_spectrogram(repeated: int) -> None:
    series = np.random.default_rng(2).normal(size=1000)
    frequency, power = segment_power(series, 100, repeated)
    expected_frequency, _, expected = signal.spectrogram(
        series, window="hann", nperseg=100, noverlap=repeated, detrend="constant", scaling="spectrum"
    )
    assert frequency == pytest.approx(expected_frequency)
    np.testing.assert_allclose(power, expected.T, atol=1e-12)


@pytest.mark.parametrize("count", [3000, 3001])
def test_coordinates_have_the_inner_products_of_the_whitened_series(count: int) -> None:
    random = np.random.default_rng(1)
    series = np.cumsum(random.standard_normal((count, 3)), axis=0) + 5.0
    floor = floor_under(series[:, 0] * taper(count), taper(count))
    white, coordinates = floor.whitened(series), floor.coordinates(series)
    np.testing.assert_allclose(coordinates.T @ coordinates, white.T @ white, rtol=1e-10, atol=1e-8)
    np.testing.assert_allclose(floor.coordinates(series[:, 1]), coordinates[:, 1], rtol=1e-12)
