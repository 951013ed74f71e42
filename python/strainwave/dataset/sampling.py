"""Numbers drawn by index: a design determines each of many points without the points before it."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from math import ceil

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Words = NDArray[np.uint64]

SOBOL_BITS = 32
FEISTEL_ROUNDS = 4  # from this number on the permutation is pseudo-random (Luby and Rackoff 1988)
SPLIT_COLUMNS = {"unit": 0x51, "condition": 0x52, "fault": 0x53}  # columns of the hash that are kept apart from the designs
MIXED_SPLIT = "mixed"  # unit and condition are of different splits


def hashed(seed: int, column: int, indices: Indices) -> Words:
    """Return pseudo-random words, each a function of seed, column and index alone (splitmix64, Steele et al. 2014)."""
    start = _mixed(np.array([seed % 2**64], dtype=np.uint64) + np.uint64(column * 0x9E3779B97F4A7C15 % 2**64))
    return _mixed(start + indices.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15))


def uniform(seed: int, column: int, indices: Indices) -> Array:
    """Return pseudo-random numbers in [0, 1), each a function of seed, column and index alone.

    >>> both = uniform(1, 0, np.array([3, 4]))
    >>> float(uniform(1, 0, np.array([4]))[0]) == float(both[1])
    True
    """
    return (hashed(seed, column, indices) >> np.uint64(11)).astype(np.float64) * 2.0**-53


def permuted(seed: int, column: int, indices: Indices, count: int) -> Indices:
    """Return the places of indices in a pseudo-random permutation of 0 … count - 1, which is nowhere stored.

    A Feistel network permutes the next square power of two; what falls outside is permuted again until it falls inside.

    >>> sorted(permuted(7, 0, np.arange(10), 10).tolist()) == list(range(10))
    True
    """
    half = max(1, ceil((count - 1).bit_length() / 2))
    places = indices.astype(np.uint64)
    outside = np.ones(len(places), dtype=bool)
    while outside.any():
        places[outside] = _feistel(seed, column, places[outside], half)
        outside = places >= np.uint64(count)
    return places.astype(np.int64)


def _feistel(seed: int, column: int, words: Words, half: int) -> Words:
    mask = np.uint64((1 << half) - 1)
    left, right = words >> np.uint64(half), words & mask
    for turn in range(FEISTEL_ROUNDS):
        key = hashed(seed, FEISTEL_ROUNDS * column + turn + (1 << 32), right.astype(np.int64))
        left, right = right, (left ^ key) & mask
    return (left << np.uint64(half)) | right


def _mixed(words: Words) -> Words:
    words = (words ^ (words >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    words = (words ^ (words >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return words ^ (words >> np.uint64(31))


def grid_levels(count: int, columns: int) -> int:
    """Return the levels of each column of the largest full grid of at most `count` points.

    >>> grid_levels(27, 3), grid_levels(26, 3)
    (3, 2)
    """
    levels = max(1, round(count ** (1.0 / max(columns, 1))))
    return int(levels - 1 if levels**columns > count else levels)


def points(design: str, seed: int, count: int, columns: int, first: int, last: int) -> Array:
    """Return the points `first` up to `last`, not included, of a design in the unit cube.

    Returns:
        coordinates in [0, 1], shape (last - first, columns)
    """
    if columns == 0:
        return np.empty((last - first, 0))
    return POINT_DESIGNS[design](seed, count, columns, np.arange(first, last))


def _random(seed: int, count: int, columns: int, indices: Indices) -> Array:
    return np.column_stack([uniform(seed, column, indices) for column in range(columns)])


def _latin(seed: int, count: int, columns: int, indices: Indices) -> Array:
    cells = (permuted(seed, column, indices, count) + uniform(seed, column, indices) for column in range(columns))
    return np.column_stack([cell / count for cell in cells])


def _grid(seed: int, count: int, columns: int, indices: Indices) -> Array:
    levels = grid_levels(count, columns)
    digits = np.stack([indices // levels**column % levels for column in range(columns)], axis=1)
    return digits / (levels - 1.0) if levels > 1 else np.full(digits.shape, 0.5)


def _sobol(seed: int, count: int, columns: int, indices: Indices) -> Array:
    from scipy.stats import qmc  # takes a second to import, which every worker of other designs would spend

    sequence = qmc.Sobol(columns, scramble=True, bits=SOBOL_BITS, seed=seed)
    if indices[0] > 0:
        sequence.fast_forward(int(indices[0]))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of a number that is no power of two: these are a part of the points
        drawn: Array = sequence.random(len(indices))
    return drawn


POINT_DESIGNS: dict[str, Callable[[int, int, int, Indices], Array]] = {
    "grid": _grid,
    "latin": _latin,
    "random": _random,
    "sobol": _sobol,
}


def share_of(seed: int, what: str, indices: Indices, count: int, shares: Mapping[str, float], rest: str) -> NDArray[np.str_]:
    """Return for each of `count` things the name of the share that it is in: the shares are met to within one thing.

    >>> names = share_of(1, "unit", np.arange(10), 10, {"train": 0.7, "test": 0.3}, "")
    >>> int((names == "train").sum())
    7
    """
    rank = (permuted(seed, SPLIT_COLUMNS[what], indices, count) + 0.5) / count
    ends = np.cumsum(list(shares.values()))
    return np.array([*shares, rest])[np.searchsorted(ends, rank)]


def joint(by_unit: NDArray[np.str_], by_condition: NDArray[np.str_]) -> NDArray[np.str_]:
    """Return the split that unit and condition agree on, "mixed" if they do not."""
    return np.where(by_unit == by_condition, by_unit, MIXED_SPLIT)
