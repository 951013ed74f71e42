"""Ellipses by distance."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from strainwave.rig.vision.edge import oblong
from strainwave.rig.vision.ellipse import Ellipse, centre_covariance, circle, fit_ellipse

Array = NDArray[np.float64]


def ellipse(x: float, y: float, longer: float, shorter: float, direction: float) -> Ellipse:
    """By its half-axes; the direction of the shorter one counts from x towards the top of the picture."""
    right, down = np.cos(direction), -np.sin(direction)
    along, across = np.outer((right, down), (right, down)), np.outer((-down, right), (-down, right))
    matrix = along / shorter + across / longer
    return Ellipse(x, y, float(matrix[0, 0]), float(matrix[0, 1]), float(matrix[1, 1]))


@given(st.floats(10.0, 100.0), st.floats(0.5, 0.98), st.floats(-1.5, 1.5))
def test_axes_and_direction_are_those_it_was_made_of(longer: float, ratio: float, direction: float) -> None:
    curve = ellipse(3.0, 4.0, longer, ratio * longer, direction)
    assert curve.half_axes == pytest.approx((longer, ratio * longer), rel=1e-9)
    assert curve.short_direction == pytest.approx(direction, abs=1e-7)
    assert curve.radius == pytest.approx(longer * np.sqrt(ratio), rel=1e-9)


def test_distances_are_exact_on_a_circle_and_on_the_axes() -> None:
    ring = circle(10.0, 20.0, 5.0)
    x, y = np.array([10.0, 18.0, 10.0, 13.0]), np.array([21.0, 20.0, 8.0, 24.0])
    np.testing.assert_allclose(ring.distance(x, y), [-4.0, 3.0, 7.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(ring.normal(x, y), [[0.0, 1.0, 0.0, 0.6], [1.0, 0.0, -1.0, 0.8]], atol=1e-12)
    curve = ellipse(0.0, 0.0, 8.0, 5.0, 0.0)
    np.testing.assert_allclose(curve.distance(np.array([6.0, 0.0]), np.array([0.0, 9.5])), [1.0, 1.5], rtol=1e-12)
    assert ring.distance(np.array([10.0]), np.array([20.0]))[0] <= -5.0  # at the centre


def test_near_the_curve_distances_are_right_to_first_order() -> None:
    curve, turn = ellipse(1.0, 2.0, 40.0, 30.0, 0.5), np.linspace(0.0, 6.0, 50)
    x, y = curve.points(turn)
    right, down = curve.normal(x, y)
    np.testing.assert_allclose(curve.distance(x, y), 0.0, atol=1e-12)
    np.testing.assert_allclose(curve.turns(x, y), np.arctan2(np.sin(turn), np.cos(turn)), atol=1e-12)
    for off in (-0.1, 0.1):
        np.testing.assert_allclose(curve.distance(x + off * right, y + off * down), off, rtol=3e-3)


@given(st.floats(-50.0, 50.0), st.floats(10.0, 100.0), st.floats(0.5, 1.0), st.floats(-1.5, 1.5))
def test_points_of_an_ellipse_give_it_back(x: float, longer: float, ratio: float, direction: float) -> None:
    curve = ellipse(x, -x, longer, ratio * longer, direction)
    found = fit_ellipse(*curve.points(np.linspace(0.0, 6.0, 30)), circle(x + 0.5, -x, curve.radius))
    np.testing.assert_allclose([found.x, found.y, *found.half_axes], [x, -x, longer, ratio * longer], rtol=1e-6, atol=1e-5)


def test_the_centre_scatters_as_its_covariance_says() -> None:
    random, curve = np.random.default_rng(6), ellipse(0.0, 0.0, 40.0, 30.0, 0.4)
    x, y = curve.points(np.linspace(0.0, 2.0 * np.pi, 72, endpoint=False))
    right, down = curve.normal(x, y)
    centres = []
    for _ in range(300):
        off = 0.05 * random.standard_normal(72)
        found = fit_ellipse(x + off * right, y + off * down, curve)
        centres.append((found.x, found.y))
    stated = 0.05**2 * centre_covariance(curve, x, y)
    np.testing.assert_allclose(np.diag(np.cov(np.array(centres).T)), np.diag(stated), rtol=4.0 * np.sqrt(2.0 / 300.0))


def test_points_on_a_line_are_no_ellipse() -> None:
    with pytest.raises(np.linalg.LinAlgError):
        fit_ellipse(np.linspace(0.0, 10.0, 20), np.zeros(20), circle(5.0, 3.0, 4.0))


@settings(max_examples=30, deadline=None)
@given(squeeze=st.floats(1e-4, 0.05), direction=st.floats(-1.5, 1.5), seed=st.integers(0, 99))
def test_how_oblong_points_are_is_told_within_its_error(squeeze: float, direction: float, seed: int) -> None:
    turn, scatter = 2.0 * np.pi * np.arange(72) / 72, 0.03
    along, across = 40.0 * (1.0 - squeeze) * np.cos(turn), 40.0 * np.sin(turn)
    x = along * np.cos(direction) - across * np.sin(direction)
    y = -(along * np.sin(direction) + across * np.cos(direction))
    x, y = (each + scatter * np.random.default_rng([seed, n]).standard_normal(72) for n, each in enumerate((x, y)))
    found, sigma = oblong(x, y, circle(0.0, 0.0, 40.0), scatter)
    assert sigma == pytest.approx(2.0 / 40.0 * scatter * np.sqrt(2.0 / 67.0), rel=0.03)
    assert abs(found - squeeze * np.exp(2j * direction)) < 5.0 * sigma + squeeze**2
