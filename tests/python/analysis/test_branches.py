"""Paths that go forth and back, with noise and without."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, strategies as st
from strainwave.analysis.branches import monotone, slid, thinned, turning_points
from strainwave.statistics.scale import noise_sigma

ENDS = st.lists(st.floats(0.2, 1.0), min_size=1, max_size=6)


def zigzag(lengths: list[float], points: int = 200) -> tuple[np.ndarray, list[int]]:
    """A path that goes to and fro between ends of alternating sign, and where it turns."""
    corners = np.array([0.0, *((-1.0) ** i * length for i, length in enumerate(lengths))])
    legs = [np.linspace(a, b, points, endpoint=False) for a, b in pairwise(corners)]
    return np.concatenate((*legs, corners[-1:])), [points * i for i in range(1, len(lengths))]


@given(lengths=ENDS, seed=st.integers(0, 100))
def test_a_path_turns_where_it_was_turned_whatever_the_noise(lengths: list[float], seed: int) -> None:
    path, corners = zigzag(lengths)
    assert turning_points(path) == corners
    noisy = path + 3e-3 * np.random.default_rng(seed).normal(size=len(path))
    found = turning_points(noisy)
    assert len(found) == len(corners)
    assert all(abs(a - b) < 20 for a, b in zip(found, corners, strict=True))


@given(lengths=ENDS, seed=st.integers(0, 100))
def test_without_wiggles_each_branch_runs_one_way_and_stays_within_the_noise(lengths: list[float], seed: int) -> None:
    path, _ = zigzag(lengths)
    noisy = path + 3e-3 * np.random.default_rng(seed).normal(size=len(path))
    clean = monotone(noisy)
    assert np.abs(clean - noisy).max() < 12 * 3e-3
    assert len(turning_points(clean)) == len(lengths) - 1
    steps = np.sign(np.diff(clean))
    assert np.count_nonzero(np.diff(steps[steps != 0.0])) == len(lengths) - 1


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_noise_on_a_smooth_series_is_told_from_the_series(scale: float) -> None:
    x = np.linspace(0.0, 20.0, 4000)
    random = np.random.default_rng(0).normal(size=len(x))
    assert noise_sigma(scale * (100.0 * np.sin(x) + random)) == pytest.approx(scale, rel=0.05)
    assert noise_sigma(np.zeros(2)) == 0.0


def test_what_lies_just_behind_a_reversal_slides_not_yet() -> None:
    path, corners = zigzag([1.0, 1.0, 1.0])
    settled = slid(path)
    assert not settled[:8].any()
    for corner in corners:
        assert not settled[corner : corner + 4].any()  # the farthest sample may lie behind the reversal
        assert settled[corner + 5 : corner + 100].all()


def test_means_of_equal_stretches_keep_the_mean() -> None:
    values = np.random.default_rng(1).normal(size=10_000)
    (short,) = thinned(values, samples=1000)
    assert len(short) == 1000
    assert short.mean() == pytest.approx(values.mean(), rel=1e-9, abs=1e-12)
    assert thinned(values, samples=10_000)[0] is values
