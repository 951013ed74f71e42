"""Estimates without some of the samples, by one bounded step of Gauss and Newton from the fit to all.

Least squares on a motion is nearly linear, so that one step gives what a fit without some samples would.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.fitting.problem import Problem

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

GRAVITY = ("load.gravity_torque", "load.gravity_phase")
SHAPES = ("exponent", "stribeck_speed")  # numbers in which friction is not linear


def without_rows(problem: Problem, x: Array, outs: Sequence[Rows], kept: Sequence[str]) -> Iterator[Array]:
    """Yield the unknowns without each of some parts of the samples: one step of Gauss and Newton from the fit to all.

    Numbers at a limit, and those of the names kept, stay as all samples have them.
    """
    (record,) = problem.records
    low, high = problem.limits().T
    moves = [
        each.path.rpartition(".")[2] not in kept and not each.at_limit(value)
        for each, value in zip(problem.plan.unknowns, x.tolist(), strict=False)
    ]
    linear = np.array(moves + [True] * len(record.experiment.nuisances))
    ((predicted, slopes),) = problem.predict(x)
    left, rows = (record.measured - predicted)[0], slopes[:, 0].T
    before, right = problem.prior_rows()
    noise = float(np.std(left))
    size = np.linalg.norm(rows, axis=0)
    size[size == 0.0] = 1.0
    paths = [each.path for each in problem.plan.unknowns]
    gravity = [paths.index(path) for path in GRAVITY] if set(GRAVITY) <= set(paths) else []
    low = np.where(np.isin(np.arange(len(x)), gravity), -np.inf, low)  # turned round rather than negative
    for out in outs:
        system = (np.concatenate([rows[~out], noise * before]) / size)[:, linear]
        there = x.copy()
        room = ((low - x) * size)[linear], ((high - x) * size)[linear]
        there[linear] += _bounded(system, np.concatenate([left[~out], noise * (right - before @ x)]), *room) / size[linear]
        if gravity:
            there[gravity] = _turned(x[gravity], there[gravity])
        yield there


def _turned(before: Array, after: Array) -> Array:
    """Return amplitude and phase of a gravity after a linear step, which is exact in its sine and cosine."""
    step, turn = after - before
    moved = complex(before[0] + step, before[0] * turn)
    return np.array([abs(moved), before[1] + np.angle(moved)])


def _bounded(system: Array, right: Array, low: Array, high: Array) -> Array:
    """Return the unknowns of least squares within limits, shape (unknowns,)."""
    from scipy.optimize import lsq_linear

    orthogonal, triangle = np.linalg.qr(system)
    found = lsq_linear(triangle, orthogonal.T @ right, (np.minimum(low, 0.0), np.maximum(high, 0.0)), method="bvls", tol=1e-8)
    return np.asarray(found.x)
