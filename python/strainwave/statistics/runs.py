"""Runs: stretches of neighbouring rows that have something in common."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def runs_of(wanted: NDArray[np.bool_], min_rows: int = 1) -> list[slice]:
    """Return the stretches of rows that are wanted, those of at least so many rows.

    >>> runs_of(np.array([False, True, True, False, True]), min_rows=2)
    [slice(1, 3, None)]
    """
    edges = np.flatnonzero(np.diff(wanted, prepend=False, append=False)).reshape(-1, 2)
    return [slice(first, beyond) for first, beyond in edges.tolist() if beyond - first >= min_rows]
