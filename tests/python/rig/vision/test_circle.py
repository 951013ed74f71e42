"""Circles through points, by all four methods."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from strainwave.rig.vision.circle import Circle, geometric, kasa, pratt, taubin

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
