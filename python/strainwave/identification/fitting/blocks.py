"""How much estimates move when blocks of a record are left out: what noise cannot explain, a model that is wrong may."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.fitting.estimate import Estimate
from strainwave.identification.fitting.loss import Squared
from strainwave.identification.fitting.problem import Problem

Array = NDArray[np.float64]
BLOCKS = 12  # of time, which differ in what the record does in them


def sigma_by_blocks(problem: Problem, x: Array, estimates: Sequence[Estimate]) -> Array:
    """Standard deviation of each estimate, shape (p,): that of the fit, or what blocks of the record left out in turn tell.

    The covariance of a fit takes what is left for noise. Where the model lacks something, what is left depends on what the
    drive does, and estimates change from one part of a record to another by more than noise moves them. The jackknife sees
    that (Tukey 1958; over blocks of series that hang together: Künsch 1989). Each step is one of Gauss and Newton, so that
    nothing is simulated again. What moves all blocks alike it does not see.

    Args:
        problem: least squares
        x: the unknowns that solve it
        estimates: of the unknowns, none of them tied to another
    """
    weights = problem.weights(x, problem.first_weights(), Squared())
    jacobian, (of_priors, _) = problem.jacobian(x, weights), problem.prior_rows()
    left = np.concatenate([(each.rows * row).ravel() for each, row in zip(weights, problem.residuals(x), strict=True)])
    place = np.concatenate([_blocks(row.shape) for row in problem.residuals(x)])
    size = np.linalg.norm(np.concatenate((jacobian, of_priors)), axis=0)
    size = np.where(size > 0.0, size, 1.0)
    rows, before = jacobian / size, of_priors / size
    whole, moved = rows.T @ rows + before.T @ before, rows.T @ left
    steps = []
    for block in range(BLOCKS):
        here = place == block
        rest = whole - rows[here].T @ rows[here]
        steps.append(np.linalg.lstsq(rest, moved - rows[here].T @ left[here], rcond=1e-12)[0] / size)
    off = np.array(steps) - np.mean(steps, axis=0)
    by_blocks = np.sqrt((BLOCKS - 1) / BLOCKS * np.sum(off**2, axis=0))
    sigmas: Array = np.maximum(np.array([each.sigma for each in estimates]), by_blocks)
    return sigmas


def _blocks(shape: tuple[int, int]) -> NDArray[np.intp]:
    """The block of each sample of each channel, those of one channel after the other."""
    channels, n = shape
    return np.tile(np.minimum(np.arange(n) * BLOCKS // n, BLOCKS - 1), channels)
