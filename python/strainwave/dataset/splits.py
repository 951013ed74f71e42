"""Shares of units and of conditions for training, validation and test."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from strainwave.dataset.sampling import Indices, permuted

SPLIT_COLUMNS = {"unit": 0x51, "condition": 0x52, "fault": 0x53}  # columns of the hash that are kept apart from the designs
MIXED = "mixed"  # unit and condition are of different splits


def share_of(seed: int, what: str, indices: Indices, count: int, shares: Mapping[str, float], rest: str) -> NDArray[np.str_]:
    """Return for each of `count` things the name of the share that it is in: the shares are met to within one thing.

    Args:
        what: a name in `SPLIT_COLUMNS`
        shares: sum at most 1
        rest: name of what no share takes

    >>> names = share_of(1, "unit", np.arange(10), 10, {"train": 0.7, "test": 0.3}, "")
    >>> int((names == "train").sum())
    7
    """
    rank = (permuted(seed, SPLIT_COLUMNS[what], indices, count) + 0.5) / count
    ends = np.cumsum(list(shares.values()))
    return np.array([*shares, rest])[np.searchsorted(ends, rank)]


def joint(by_unit: NDArray[np.str_], by_condition: NDArray[np.str_]) -> NDArray[np.str_]:
    """Return the split that unit and condition agree on, "mixed" if they do not."""
    return np.where(by_unit == by_condition, by_unit, MIXED)
