"""Noise floor of a series: what is whitened by it."""

from __future__ import annotations

import numpy as np
import pytest
from strainwave.statistics.floor import floor_under, taper


@pytest.mark.parametrize("count", [3000, 3001])
def test_coordinates_have_the_inner_products_of_the_whitened_series(count: int) -> None:
    random = np.random.default_rng(1)
    series = np.cumsum(random.standard_normal((count, 3)), axis=0) + 5.0
    floor = floor_under(series[:, 0] * taper(count), taper(count))
    white, coordinates = floor.whitened(series), floor.coordinates(series)
    np.testing.assert_allclose(coordinates.T @ coordinates, white.T @ white, rtol=1e-10, atol=1e-8)
    np.testing.assert_allclose(floor.coordinates(series[:, 1]), coordinates[:, 1], rtol=1e-12)
