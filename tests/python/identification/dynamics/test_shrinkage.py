"""Shares shrunk towards zero, against ridge regression solved otherwise, and on terms that explain the same."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.dynamics.shrinkage import Shrunk, shares_of
from strainwave.identification.identify import identify
from strainwave.identification.reading.mapping import FileMapping

from tests import arms

RANDOM = np.random.default_rng(1)
ROWS, TERMS = 120, 60
BASE = RANDOM.normal(size=(ROWS, 3))
COLUMNS = RANDOM.normal(size=(ROWS, 8)) @ RANDOM.normal(size=(8, TERMS)) + 0.05 * RANDOM.normal(size=(ROWS, TERMS))
EXPECTED = np.where(np.arange(TERMS) < 10, 1.0, 0.3)
ENERGY = np.arange(TERMS) % 2 == 0
TRUTH = EXPECTED * np.where(ENERGY, 1.0, 10.0) * RANDOM.normal(size=TERMS)
TORQUE = BASE @ [1.0, 2.0, 3.0] + COLUMNS @ TRUTH
NOISY = TORQUE + 0.02 * np.std(TORQUE) * RANDOM.normal(size=ROWS)
TRAIN = np.arange(ROWS) % 2 == 0


def test_the_most_probable_shares_are_those_of_ridge_regression() -> None:
    told = Shrunk(NOISY, BASE, COLUMNS, EXPECTED, ENERGY).told(TRAIN)
    everything = np.hstack([BASE, COLUMNS])[TRAIN]
    penalty = np.diag([0.0] * 3 + list(1.0 / told.scatter**2))
    ridge = np.linalg.solve(everything.T @ everything + penalty, everything.T @ NOISY[TRAIN])[3:]
    assert COLUMNS @ told.shares == pytest.approx(COLUMNS @ ridge, abs=1e-6 * np.std(TORQUE))


def test_combinations_and_what_is_left_make_up_the_shares() -> None:
    told = Shrunk(NOISY, BASE, COLUMNS, EXPECTED, ENERGY).told(TRAIN)
    assert 5 <= told.combinations.shape[1] < TERMS // 2  # eight directions are large
    beside = told.shares - told.rest
    by_combinations = told.combinations @ np.linalg.lstsq(told.combinations, beside, rcond=None)[0]
    assert by_combinations == pytest.approx(beside, abs=1e-8 * np.abs(beside).max())


def test_other_rows_are_predicted_where_least_squares_fails() -> None:
    shrunk = Shrunk(NOISY, BASE, COLUMNS, EXPECTED, ENERGY)
    checks = [TRAIN & (np.arange(ROWS) % 10 == place) for place in (0, 2, 4, 6, 8)]
    told = shrunk.told(TRAIN)
    with_all, without = (shrunk.error(TRAIN, checks, scatter) for scatter in (told.scatter, np.zeros(TERMS)))
    by_least_squares = shrunk.beside_base(COLUMNS).error(TRAIN, checks, np.zeros(0))
    print(f"\nleft: {with_all:.3g} shrunk, {by_least_squares:.3g} by least squares, {without:.3g} without terms")
    assert with_all < 0.05 < 0.5 < without
    assert with_all < 0.6 * by_least_squares


def test_without_noise_and_terms_the_base_is_what_it_was() -> None:
    assert shares_of(BASE, BASE @ [1.0, 2.0, 3.0]) == pytest.approx([1.0, 2.0, 3.0])


@pytest.mark.parametrize("seed", [1, 2])
def test_twenty_seconds_of_an_arm_are_predicted_better_than_with_a_model_of_it(seed: int, tmp_path: Path) -> None:
    joint = arms.Joint(ripple={2.0: 0.006, 4.0: 0.002})
    recorder = arms.Recorder(rate=95.0, jitter=1e-3, step=1e-4, seed=seed)
    seen = recorder(arms.run((joint,) * 3, arms.fourier(20.0, (0, 1, 2), seed)))
    path = tmp_path / "arm.csv"
    arms.rtde(path, seen)
    (finding,) = identify("hfuc-25-100", [path], mapping=lambda _: FileMapping(joint="1")).files
    specialist = arms.least_squares(seen, 1, "current", links=True)
    assert finding.held_out is not None
    print(f"\n{finding.held_out.in_band:.2%}, by least squares with a model of the arm {specialist:.2%}")
    assert finding.held_out.in_band < specialist
