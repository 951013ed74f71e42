"""Samples of a loop that a fit takes, and those that it predicts."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from strainwave.statistics.linear_fit import rms_left_out

Array = NDArray[np.float64]

LOOP_BLOCKS = 20  # of the samples of a loop
FOLD_COUNT = 4  # each of every fourth block


def held_out_blocks(n: int, fold: int = FOLD_COUNT - 1) -> NDArray[np.bool_]:
    """Return True for samples that train: all but every fourth of twenty blocks, which are held out to validate.

    Whole blocks, because neighbours on a loop resemble each other too much to test one by the other. The four folds hold out
    each block once.

    >>> [int((~held_out_blocks(40, fold)).sum()) for fold in range(4)]
    [10, 10, 10, 10]
    """
    training: NDArray[np.bool_] = block_of(n) % FOLD_COUNT != fold
    return training


def block_of(n: int) -> NDArray[np.intp]:
    """Return the block of each sample, shape (n,)."""
    return np.arange(n) * LOOP_BLOCKS // n


def plain_error(deflection: Array, torque: Array, parts: Iterable[NDArray[np.bool_]]) -> float:
    """Return the error of a linear spring with dry friction by least squares, each part predicted from the others [N.m].

    Args:
        deflection: angle in the order measured [rad], shape (n,)
        torque: shape (n,)
        parts: True for the samples of a part, shape (n,)
    """
    columns = np.stack([np.ones(len(deflection)), deflection, np.sign(np.gradient(deflection))], axis=1)
    return rms_left_out(columns, torque, parts)
