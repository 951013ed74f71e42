"""Designs: points that fill their cube as each design promises, and do not depend on which others are asked for."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import kstest, qmc
from strainwave.dataset.sampling import POINT_DESIGNS, grid_levels, hashed, permuted, points, uniform

BILLION = 10**9


@pytest.mark.parametrize("design", POINT_DESIGNS)
def test_a_part_of_a_design_is_that_part_of_the_whole(design: str) -> None:
    whole = points(design, 3, 64, 2, 0, 64)
    np.testing.assert_array_equal(points(design, 3, 64, 2, 17, 29), whole[17:29])
    assert whole.min() >= 0.0
    assert whole.max() <= 1.0


def test_each_row_and_column_of_a_latin_square_has_one_point() -> None:
    cells = np.floor(points("latin", 1, 50, 3, 0, 50) * 50).astype(int)
    for column in cells.T:
        assert sorted(column.tolist()) == list(range(50))


def test_a_grid_has_every_combination_of_its_levels_once() -> None:
    grid = points("grid", 0, 27, 3, 0, 27)
    assert len(np.unique(grid, axis=0)) == 27
    assert set(np.unique(grid).tolist()) == {0.0, 0.5, 1.0}


def test_sobol_points_fill_the_cube_more_evenly_than_random_ones() -> None:
    sobol, random = (qmc.discrepancy(points(design, 2, 256, 2, 0, 256)) for design in ("sobol", "random"))
    assert sobol < 0.2 * random


def test_hashed_numbers_are_uniform_and_columns_do_not_correlate() -> None:
    one, other = (uniform(9, column, np.arange(20_000)) for column in (0, 1))
    assert kstest(one, "uniform").pvalue > 1e-3
    assert abs(np.corrcoef(one, other)[0, 1]) < 4.0 / np.sqrt(20_000)


def test_seeds_give_other_numbers() -> None:
    assert (hashed(1, 0, np.arange(100)) != hashed(2, 0, np.arange(100))).all()


@pytest.mark.parametrize("count", [1, 2, 3, 100, 1000])
def test_a_permutation_has_every_place_once(count: int) -> None:
    assert sorted(permuted(4, 0, np.arange(count), count).tolist()) == list(range(count))


def test_points_far_within_a_design_of_a_billion_are_made_without_those_before() -> None:
    for design in ("latin", "random", "grid"):
        assert points(design, 1, BILLION, 2, BILLION - 5, BILLION).shape == (5, 2)


def test_a_grid_takes_the_largest_whole_number_of_levels() -> None:
    assert [grid_levels(count, 2) for count in (1, 3, 4, 8, 9, 10**8)] == [1, 1, 2, 2, 3, 10**4]
