"""Standard deviation of estimates by leaving out blocks of a record, which contains that by an error of the model."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.fitting.estimate import Estimate
from strainwave.identification.fitting.problem import Problem
from strainwave.statistics.linear_fit import solved

Array = NDArray[np.float64]
TIME_BLOCKS = 12  # of a record, which differ in their motion


def sigma_by_blocks(problem: Problem, x: Array, estimates: Sequence[Estimate]) -> Array:
    """Return the standard deviation of each estimate, shape (p,): that of the fit, or of the jackknife if it is larger.

    The covariance of a fit takes residuals for noise. If the model lacks something, residuals depend on the motion, and
    estimates change from one part of a record to another by more than noise moves them. The jackknife contains that (Tukey
    1958; over blocks of correlated series: Künsch 1989). Each step is one of Gauss and Newton, so that nothing is simulated
    again. It does not contain an error that moves all blocks alike.

    Args:
        problem: least squares
        x: the unknowns that solve it
        estimates: of the unknowns, none of them tied to another
    """
    weights = problem.weights(x)
    jacobian, (of_priors, _) = problem.jacobian(x, weights), problem.prior_rows()
    residuals = problem.residuals(x)
    left = np.concatenate([(each.rows * row).ravel() for each, row in zip(weights, residuals, strict=True)])
    place = np.concatenate([np.tile(np.arange(row.shape[1]) * TIME_BLOCKS // row.shape[1], len(row)) for row in residuals])
    size = np.linalg.norm(np.concatenate((jacobian, of_priors)), axis=0)
    size = np.where(size > 0.0, size, 1.0)
    rows, before = jacobian / size, of_priors / size
    whole, moved = rows.T @ rows + before.T @ before, rows.T @ left
    steps = []
    for block in range(TIME_BLOCKS):
        here = place == block
        rest = whole - rows[here].T @ rows[here]
        steps.append(solved(rest, moved - rows[here].T @ left[here]) / size)
    off = np.array(steps) - np.mean(steps, axis=0)
    by_blocks = np.sqrt((TIME_BLOCKS - 1) / TIME_BLOCKS * np.sum(off**2, axis=0))
    sigmas: Array = np.maximum(np.array([each.sigma for each in estimates]), by_blocks)
    return sigmas
