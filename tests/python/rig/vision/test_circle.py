"""Circles and ellipses through points."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from strainwave.rig.vision.circle import Circle, Ellipse, centre_covariance, circle, fit_ellipse, geometric, kasa, pratt, taubin
from strainwave.rig.vision.edge import oblong

Array = NDArray[np.float64]
Fit = Callable[[Array, Array], Circle]
FITS = (kasa, pratt, taubin, geometric)
X = np.array([5.0, 4.0, 1.0, -3.0, -5.0, -4.0, 0.0, 3.0])
Y = np.array([0.1, 3.0, 4.95, 4.0, 1.02, -3.0, -4.97, -4.04])
# Gander, Golub & Strebel, Least-squares fitting of circles and ellipses, BIT 34 (1994), section 5.1: points and their circle.
GANDER = np.array([[1.0, 7.0], [2.0, 6.0], [5.0, 8.0], [7.0, 7.0], [9.0, 5.0], [3.0, 7.0]])


def arc(degrees: float, count: int, radius: float = 100.0) -> tuple[Array, Array]:
    turn = np.radians(np.linspace(-degrees / 2.0, degrees / 2.0, count, endpoint=degrees < 360.0))
    return radius * np.cos(turn), radius * np.sin(turn)


def moments(degrees: float) -> tuple[Array, Array]:
    """Of noise of standard deviation 1 in both directions: four points with its mean and its variances in place of each."""
    x, y = arc(degrees, 361 if degrees < 360.0 else 360)
    shift = 2.0**0.5
    return np.concatenate((x + shift, x - shift, x, x)), np.concatenate((y, y, y + shift, y - shift))


def test_kasas_circle_has_the_published_numbers() -> None:
    fit = kasa(X, Y)
    np.testing.assert_allclose(
        [fit.x, fit.y, fit.radius], [-0.019256771505, 0.017582826349, 5.019737017307], rtol=0, atol=6e-13
    )


def test_the_geometric_circle_has_the_numbers_of_the_minimum() -> None:
    """Where the derivatives of the sum of squares are zero, by Newton's method with 40 digits."""
    fit = geometric(X, Y)
    wanted = [-0.0189307147148850785, 0.0175689289991532374, 5.0196117029108744683]
    np.testing.assert_allclose([fit.x, fit.y, fit.radius], wanted, rtol=0, atol=2e-14)


def test_the_geometric_circle_is_the_one_of_gander_golub_and_strebel() -> None:
    fit = geometric(*GANDER.T)
    np.testing.assert_allclose([fit.x, fit.y, fit.radius], [4.7398, 2.9835, 4.7142], rtol=0, atol=6e-5)
    algebraic = kasa(*GANDER.T)  # their section 2, "algebraic distance", constrained otherwise, gives another one
    assert (algebraic.x - fit.x) ** 2 + (algebraic.y - fit.y) ** 2 > 0.01


def test_kasas_circle_solves_its_equations_exactly() -> None:
    """By fractions: the normal equations of T's squares have no rounding there."""
    points = [(Fraction(int(x)), Fraction(int(y))) for x, y in GANDER]
    fit = kasa(*GANDER.T)
    a, b = Fraction(fit.x), Fraction(fit.y)
    rest = [(x - a) ** 2 + (y - b) ** 2 - Fraction(fit.radius) ** 2 for x, y in points]
    sums = [
        sum(rest),
        sum(r * x for r, (x, _) in zip(rest, points, strict=True)),
        sum(r * y for r, (_, y) in zip(rest, points, strict=True)),
    ]
    assert max(abs(float(each)) for each in sums) < 1e-12


@pytest.mark.parametrize("fit", FITS)
@given(
    x=st.floats(-1e3, 1e3), y=st.floats(-1e3, 1e3), radius=st.floats(0.1, 1e3), count=st.integers(3, 40),
    degrees=st.floats(20.0, 359.0),
)  # fmt: skip
def test_points_of_a_circle_give_it_back(fit: Fit, x: float, y: float, radius: float, count: int, degrees: float) -> None:
    right, up = arc(degrees, count, radius)
    found = fit(x + right, y + up)
    size = 1e-8 * (radius + abs(x) + abs(y))
    assert abs(found.x - x) < size
    assert abs(found.y - y) < size
    assert abs(found.radius - radius) < size


@pytest.mark.parametrize("fit", FITS)
def test_a_turned_shifted_and_scaled_figure_has_its_circle_turned_shifted_and_scaled(fit: Fit) -> None:
    plain, turn, scale = fit(X, Y), 0.7, 3.0
    x, y = scale * (np.cos(turn) * X - np.sin(turn) * Y) + 50.0, scale * (np.sin(turn) * X + np.cos(turn) * Y) - 20.0
    moved = fit(x, y)
    wanted = [
        scale * (np.cos(turn) * plain.x - np.sin(turn) * plain.y) + 50.0,
        scale * (np.sin(turn) * plain.x + np.cos(turn) * plain.y) - 20.0,
        scale * plain.radius,
    ]
    np.testing.assert_allclose([moved.x, moved.y, moved.radius], wanted, rtol=0, atol=1e-9)
    assert moved.rms == pytest.approx(scale * plain.rms, rel=1e-9)


def test_a_short_arc_shrinks_kasas_circle_as_erratum_t2_says_and_no_other() -> None:
    points = moments(60.0)
    shrunk = kasa(*points)
    assert (round(shrunk.x, 2), round(shrunk.radius, 2)) == (5.54, 94.74)
    for fit in (pratt, taubin, geometric):
        found = fit(*points)
        assert abs(found.radius - 100.0) < 0.05
        assert abs(found.x) < 0.05


@pytest.mark.parametrize(("fit", "bias"), [(kasa, 1.0), (pratt, 2.0), (taubin, 1.0), (geometric, 0.5)])
def test_on_the_whole_edge_only_the_radius_has_a_bias_the_one_that_is_published(fit: Fit, bias: float) -> None:
    """In sigma^2 / R: A. Al-Sharadqah, N. Chernov, Error analysis for circle fitting algorithms, EJS 3 (2009), section 7."""
    found = fit(*moments(360.0))
    assert abs(found.x) < 1e-9
    assert abs(found.y) < 1e-9
    assert found.radius - 100.0 == pytest.approx(bias * 0.01, rel=1e-3)


@pytest.mark.slow("rig")
def test_sixty_noisy_points_on_sixty_degrees_lose_nearly_five_pixels_of_radius_by_kasas_fit_alone() -> None:
    """Physics section 8: -4.65 px at R = 100 px and sigma = 1 px, which is what some sixty points give."""
    random, (x, y) = np.random.default_rng(8), arc(60.0, 60)
    drawn = [(x + random.standard_normal(60), y + random.standard_normal(60)) for _ in range(1500)]
    bias = {fit.__name__: np.array([fit(*points).radius - 100.0 for points in drawn]) for fit in FITS}
    error = {name: each.std() / np.sqrt(len(each)) for name, each in bias.items()}
    assert bias["kasa"].mean() == pytest.approx(-4.65, abs=3.0 * error["kasa"])
    for name in ("pratt", "taubin", "geometric"):
        assert abs(bias[name].mean()) < 0.5 + 3.0 * error[name]  # (sigma / R)^2 times how badly the arc tells the radius


@pytest.mark.parametrize("fit", FITS)
@pytest.mark.parametrize("degrees", [360.0, 200.0])
def test_the_covariance_is_that_of_many_draws(fit: Fit, degrees: float) -> None:
    random, (x, y) = np.random.default_rng(3), arc(degrees, 72, 40.0)
    fits = [fit(x + 0.05 * random.standard_normal(72), y + 0.05 * random.standard_normal(72)) for _ in range(400)]
    scatter = np.cov(np.array([[each.x, each.y, each.radius] for each in fits]).T)
    stated = np.mean([each.covariance for each in fits], axis=0)
    np.testing.assert_allclose(np.diag(scatter), np.diag(stated), rtol=4.0 * np.sqrt(2.0 / 400.0))
    assert scatter[0, 2] == pytest.approx(stated[0, 2], abs=4.0 * np.sqrt(stated[0, 0] * stated[2, 2] / 400.0))


def test_on_the_whole_edge_the_centre_is_known_to_sigma_times_the_root_of_two_over_n() -> None:
    x, y = arc(360.0, 72, 40.0)
    wave = 0.1 * np.tile([1.0, -1.0], 36)  # of a frequency that no circle follows
    fit = geometric(x * (1.0 + wave / 40.0), y * (1.0 + wave / 40.0))
    wanted = 0.1**2 * 72 / 69 * 2.0 / 72
    np.testing.assert_allclose(fit.covariance[:2, :2], wanted * np.eye(2), rtol=1e-3, atol=1e-3 * wanted)
    assert fit.rms == pytest.approx(0.1, rel=1e-3)


@pytest.mark.parametrize("fit", FITS)
def test_three_points_tell_a_circle_and_nothing_of_its_error(fit: Fit) -> None:
    found = fit(np.array([0.0, 2.0, 0.0]), np.array([0.0, 0.0, 2.0]))
    np.testing.assert_allclose([found.x, found.y, found.radius], [1.0, 1.0, np.sqrt(2.0)], rtol=1e-12)
    assert np.all(np.isinf(found.covariance))


@pytest.mark.parametrize("fit", FITS)
@pytest.mark.parametrize(
    ("x", "y", "message"),
    [
        ([0.0, 1.0], [0.0, 1.0], "a circle needs three points or more, not 2"),
        ([0.0, 1.0, 2.0, 3.0], [1.0, 2.0, 3.0, 4.0], "the points lie on a line"),
        ([1.0, 1.0, 1.0], [2.0, 2.0, 2.0], "the points lie on a line"),
        ([0.0, 1.0, 2.0], [0.0, 1.0], "x and y have shapes"),
        ([0.0, 1.0, np.nan], [0.0, 1.0, 0.0], "x and y must be finite"),
    ],
)
def test_what_is_no_circle_is_refused(fit: Fit, x: list[float], y: list[float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        fit(np.array(x), np.array(y))


def test_two_circles_are_equal_if_all_of_them_is() -> None:
    assert geometric(X, Y) == geometric(X, Y)
    assert geometric(X, Y) != geometric(X, Y + 1.0)


def test_the_sum_of_squared_distances_is_least_for_the_geometric_circle() -> None:
    random = np.random.default_rng(5)
    for degrees in (90.0, 180.0, 360.0):
        x, y = (each + random.standard_normal(50) for each in arc(degrees, 50))
        for other, near in itertools.product((kasa, pratt, taubin), (geometric,)):
            assert near(x, y).rms <= other(x, y).rms


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
