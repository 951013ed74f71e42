"""Sums that data determine: what a fit of the sum itself gives, for drawn records."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from strainwave.statistics.covariance import posterior_of
from strainwave.statistics.determined_sum import sum_by_covariance, sum_by_information

NAMES = ("inertia", "coulomb", "viscous")


@given(st.integers(0, 2**31), st.floats(1.0, 100.0), st.floats(0.01, 1.0), st.floats(0.2, 5.0), st.floats(1e-4, 1e-2))
def test_sum_at_one_speed_is_that_of_a_fit_of_the_sum(
    seed: int, speed: float, coulomb: float, part: float, noise: float
) -> None:
    draw = np.random.default_rng(seed)
    sense, acceleration = draw.choice([-1.0, 1.0], 200), draw.normal(size=200)
    values = np.array([0.3, coulomb, part * coulomb / speed])
    rows = np.stack([acceleration, sense, speed * sense], axis=1) / noise
    of_sum = np.linalg.inv(rows[:, :2].T @ rows[:, :2])
    for place, factors in ((1, (1.0, speed)), (2, (1.0, 1.0 / speed))):
        found = sum_by_information(rows.T @ rows, place, values, NAMES, "N.m")
        assert found is not None
        assert found.paths == (NAMES[place], NAMES[3 - place])
        assert found.factors == pytest.approx(factors, rel=1e-6)
        assert found.value == pytest.approx(values[place] + factors[1] * values[3 - place], rel=1e-6)
        assert found.sigma == pytest.approx(np.sqrt(of_sum[1, 1]) * (1.0 if place == 1 else 1.0 / speed), rel=1e-6)
    alone = sum_by_information(rows.T @ rows, 0, values, NAMES, "kg.m2")
    assert alone is not None
    assert (alone.paths, alone.value) == (("inertia",), 0.3)
    assert alone.sigma == pytest.approx(np.sqrt(of_sum[0, 0]), rel=1e-6)


def test_a_parameter_that_data_do_not_depend_on_has_no_sum() -> None:
    assert sum_by_information(np.diag([1.0, 0.0]), 1, np.ones(2), ("a", "b"), "1") is None


def test_fewer_samples_than_unknowns_determine_what_they_separate() -> None:
    jacobian = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 1.0, 0.0]])
    covariance, _ = posterior_of(jacobian, [np.array([[0.1, -0.1]])], np.zeros((0, 4)))
    assert np.isfinite(np.diag(covariance)).tolist() == [True, False, False, False]


@given(st.integers(0, 2**31), st.floats(0.9, 0.9999))
def test_sum_by_covariance_has_the_least_variance_of_all_sums(seed: int, correlation: float) -> None:
    draw = np.random.default_rng(seed)
    sigma = 10.0 ** draw.uniform(-2.0, 2.0, 2)
    covariance = np.array([[1.0, correlation], [correlation, 1.0]]) * np.outer(sigma, sigma)
    found = sum_by_covariance(covariance, (0, 1), np.array([1.0, 2.0]), ("a", "b"), "1")
    others = found.factors[1] + np.linspace(-1.0, 1.0, 9) * sigma[0] / sigma[1]
    variances = [factors @ covariance @ factors for factors in (np.array([1.0, each]) for each in others)]
    assert np.argmin(variances) == 4
    assert found.sigma == pytest.approx(np.sqrt(variances[4]), rel=1e-6)
