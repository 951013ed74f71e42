"""Which samples of a loop a fit sees, and which it only predicts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

BLOCKS = 20
FOLDS = 4


def held_out_blocks(n: int, fold: int = FOLDS - 1) -> NDArray[np.bool_]:
    """Samples that train: all but every fourth of twenty blocks, which are held out to validate.

    Whole blocks, because neighbours on a loop resemble each other too much to test one by the other. The four folds hold out
    each block once.

    >>> [int((~held_out_blocks(40, fold)).sum()) for fold in range(4)]
    [10, 10, 10, 10]
    """
    training: NDArray[np.bool_] = block_of(n) % FOLDS != fold
    return training


def block_of(n: int) -> NDArray[np.intp]:
    """The block of each sample."""
    return np.arange(n) * BLOCKS // n
