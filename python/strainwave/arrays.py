"""Arrays of numbers, from whatever a user has."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def numbers(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """Numbers of any shape, finite or not; text, dates and masked values are none."""
    if type(values) is np.ndarray and values.dtype == np.float64:
        return values
    try:
        array = np.asarray(values)
    except ValueError:
        raise ValueError(f"{name} must be one series of numbers") from None
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} must hold numbers, not {array.dtype}")
    if np.ma.is_masked(values):
        raise ValueError(f"{name} has masked values; every one must be a number")
    with np.errstate(over="ignore"):  # a longer float may be too large; whoever wants finite numbers refuses the infinity
        return array.astype(np.float64, copy=False)
