"""The line through points that err both ways, against published numbers and what every such line must obey."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from strainwave.rig.analysis.lines import fit_line

# Pearson's data with York's weights, and the line that York et al. (2004), Table II, find.
X = np.array([0.0, 0.9, 1.8, 2.6, 3.3, 4.4, 5.2, 6.1, 6.5, 7.4])
Y = np.array([5.9, 5.4, 4.4, 4.6, 3.5, 3.7, 2.8, 2.8, 2.4, 1.5])
SIGMA_X = np.array([1000.0, 1000.0, 500.0, 800.0, 200.0, 80.0, 60.0, 20.0, 1.8, 1.0]) ** -0.5
SIGMA_Y = np.array([1.0, 1.8, 4.0, 8.0, 20.0, 20.0, 70.0, 70.0, 100.0, 500.0]) ** -0.5


def test_the_line_through_pearsons_data_with_yorks_weights_is_the_published_one() -> None:
    line = fit_line(X, Y, SIGMA_X, SIGMA_Y)
    assert line.slope == pytest.approx(-0.480533407, abs=1e-8)
    assert line.intercept == pytest.approx(5.479910224, abs=1e-8)
    assert line.misfit == pytest.approx(11.8663531941 / 8, rel=1e-8)
    assert line.sigma == pytest.approx(0.0580, rel=0.03)  # York's is of the fitted, this of the measured points


def test_without_errors_of_x_it_is_weighted_least_squares() -> None:
    line = fit_line(X, Y, np.zeros(10), SIGMA_Y)
    slope, intercept = np.polyfit(X, Y, 1, w=1.0 / SIGMA_Y)
    assert (line.slope, line.intercept) == (pytest.approx(slope), pytest.approx(intercept))
    columns = np.column_stack((X, np.ones(10))) / SIGMA_Y[:, np.newaxis]
    assert line.sigma == pytest.approx(np.sqrt(np.linalg.inv(columns.T @ columns)[0, 0]))
    assert line.share_x == 0.0


def test_swapped_axes_give_the_same_line() -> None:
    line, swapped = fit_line(X, Y, SIGMA_X, SIGMA_Y), fit_line(Y, X, SIGMA_Y, SIGMA_X)
    assert line.slope * swapped.slope == pytest.approx(1.0)
    assert line.sigma / abs(line.slope) == pytest.approx(swapped.sigma / abs(swapped.slope))


@given(a=st.floats(1e-6, 1e6), b=st.floats(1e-6, 1e6), stated=st.booleans())
def test_units_only_scale_the_slope(a: float, b: float, stated: bool) -> None:
    errors = (SIGMA_X, SIGMA_Y) if stated else (np.zeros(10), np.zeros(10))
    line, scaled = fit_line(X, Y, *errors), fit_line(a * X, b * Y, a * errors[0], b * errors[1])
    assert scaled.slope == pytest.approx(line.slope * b / a)
    assert scaled.sigma == pytest.approx(line.sigma * b / a)


def test_errors_that_are_not_stated_come_from_the_scatter() -> None:
    exact = fit_line(X, 2.0 * X + 1.0, np.zeros(10), np.zeros(10))
    assert exact.slope == pytest.approx(2.0)
    assert exact.sigma == pytest.approx(0.0, abs=1e-9)
    assert fit_line(X, Y, np.zeros(10), np.zeros(10)).freedom == 8


def test_errors_of_x_do_not_flatten_the_line() -> None:
    """Least squares would: by the share of the errors in the variance of x, here 1/3."""
    random = np.random.default_rng(1)
    truth = random.normal(size=20_000)
    x, y = truth + 0.7 * random.normal(size=20_000), 3.0 * truth + 0.5 * random.normal(size=20_000)
    line = fit_line(x, y, np.full(20_000, 0.7), np.full(20_000, 0.5))
    assert line.slope == pytest.approx(3.0, abs=4.0 * line.sigma)
    assert np.polyfit(x, y, 1)[0] < 2.1
