"""Linear fits: agreement with the normal equations, what is not separated in words, and standard deviations with rivals."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from strainwave.statistics.determined_sum import sum_by_information
from strainwave.statistics.linear_fit import linear_fit, normal_inverse, own_share, solved

seeds = st.integers(0, 2**31)


@given(seeds, st.integers(1, 5), st.lists(st.floats(-6.0, 6.0), min_size=5, max_size=5))
def test_separate_columns_of_any_size_give_the_solution_of_the_normal_equations(
    seed: int, count: int, logarithms: list[float]
) -> None:
    draw = np.random.default_rng(seed)
    size = 10.0 ** np.array(logarithms[:count])
    columns, target, weights = draw.normal(size=(60, count)) * size, draw.normal(size=60), draw.uniform(0.5, 2.0, 60)
    fit = linear_fit(columns, target, weights=weights)
    unit, square = columns / size, weights[:, np.newaxis] ** 2
    expected = np.linalg.solve(unit.T @ (square * unit), unit.T @ (weights**2 * target)) / size
    np.testing.assert_allclose(fit.values * size, expected * size, rtol=1e-9, atol=1e-12)
    assert np.isfinite(fit.sigma).all()
    np.testing.assert_allclose(fit.residual, target - columns @ expected, atol=1e-9)


@given(seeds, st.floats(1.0, 100.0), st.floats(0.01, 1.0), st.floats(1e-5, 1e-2))
def test_at_one_speed_the_sum_of_friction_is_determined_and_its_terms_are_not(
    seed: int, speed: float, coulomb: float, viscous: float
) -> None:
    draw = np.random.default_rng(seed)
    sense = draw.choice([-1.0, 1.0], 200)
    acceleration = draw.normal(size=200)
    columns = np.stack([acceleration, sense, speed * sense], axis=1)
    target = columns @ [0.3, coulomb, viscous] + 1e-6 * draw.normal(size=200)
    fit = linear_fit(columns, target)
    assert np.isfinite(fit.sigma).tolist() == [True, False, False]
    assert fit.values[0] == pytest.approx(0.3, abs=1e-5)
    words = str(sum_by_information(columns.T @ columns / 1e-12, 1, fit.values, ("inertia", "coulomb", "viscous"), "N.m"))
    factor = "" if abs(speed - 1.0) < 1e-3 else f"{speed:.3g} "
    assert words.startswith(f"coulomb + {factor}viscous = ")
    value, sigma = words.rpartition("= ")[2].removesuffix(" N.m").split(" ± ")
    assert float(value) == pytest.approx(coulomb + speed * viscous, rel=1e-3)
    assert float(sigma) == pytest.approx(1e-6 / np.sqrt(200), rel=0.06)


def test_own_shares_are_the_sines_of_the_angles_to_the_space_of_the_others() -> None:
    angle = 0.3
    columns = np.array([[1.0, np.cos(angle), 0.0], [0.0, np.sin(angle), 0.0], [0.0, 0.0, 5.0]])
    np.testing.assert_allclose(own_share(columns), [np.sin(angle), np.sin(angle), 1.0], rtol=1e-12)
    np.testing.assert_allclose(own_share(columns[:, :1], columns[:, 1:]), [np.sin(angle)], rtol=1e-12)


def test_standard_deviations_with_rivals_contain_the_truth_where_those_without_do_not() -> None:
    """A slow drift that the model lacks goes into gravity of a short motion; as a rival it makes gravity as unsure as it is."""
    distances = []
    for seed in range(40):
        draw = np.random.default_rng(seed)
        time = np.linspace(0.0, 1.0, 400)
        columns, drift = np.stack([np.ones(400), np.sin(1.5 * time)], axis=1), time[:, np.newaxis]
        target = 0.2 + 0.05 * time + 0.005 * draw.normal(size=400)
        plain, careful = (linear_fit(columns, target, rivals=rivals) for rivals in (None, drift))
        np.testing.assert_array_equal(plain.values, careful.values)
        distances.append([abs(each.values[1]) / each.sigma[1] for each in (plain, careful)])
    without, with_rivals = np.median(distances, axis=0)
    assert without > 10.0
    assert with_rivals < 2.5


def test_coefficients_of_several_targets_are_those_of_each() -> None:
    draw = np.random.default_rng(1)
    columns, targets = draw.normal(size=(30, 3)), draw.normal(size=(30, 2))
    together = solved(columns, targets)
    np.testing.assert_allclose(together, np.stack([solved(columns, each) for each in targets.T], axis=1), rtol=1e-10)


def test_directions_that_columns_do_not_separate_are_left_out_of_the_inverse() -> None:
    """Of two equal columns the sum alone has a variance; that of each is a quarter of it, as of the solution of least norm."""
    column = np.random.default_rng(2).normal(size=50)
    for other in (column, column * (1.0 + 1e-12)):
        inverse = normal_inverse(np.stack([column, other, np.ones(50)], axis=1))
        alone = normal_inverse(np.stack([2.0 * column, np.ones(50)], axis=1))
        np.testing.assert_allclose(inverse[:2, :2], alone[0, 0], rtol=1e-9)
