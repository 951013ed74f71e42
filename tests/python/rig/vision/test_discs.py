"""The pictures that the other tests here are made with."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

from tests.python.rig.vision.discs import disc, profile


@pytest.mark.parametrize("blur", [0.8, 1.2, 3.0])
@pytest.mark.parametrize("place", [(60.0, 50.0), (59.63, 50.29), (60.5, 49.5)])
def test_a_disc_has_its_area_and_its_centre(place: tuple[float, float], blur: float) -> None:
    share = disc((100, 120), *place, 30.0, blur)
    down, right = np.mgrid[:100, :120]
    assert share.sum() == pytest.approx(np.pi * 900.0, rel=1e-6)
    assert (share * right).sum() / share.sum() == pytest.approx(place[0], abs=1e-5)
    assert (share * down).sum() / share.sum() == pytest.approx(place[1], abs=1e-5)


def test_the_profile_is_the_integral_of_a_gaussian_over_the_disc() -> None:
    curve, _, _ = profile(5.0, 1.2)
    for distance in (4.0, 5.0, 6.5):

        def seen(x: float, distance: float = distance) -> float:
            half = np.sqrt(25.0 - x * x)
            return float(norm.pdf(x, distance, 1.2) * (norm.cdf(half, scale=1.2) - norm.cdf(-half, scale=1.2)))

        assert curve(distance) == pytest.approx(quad(seen, -5.0, 5.0, epsabs=1e-10)[0], abs=1e-8)
