"""What residuals and their derivatives say about how well each unknown is known."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.fitting.estimate import ONE_SIGMA, student

Array = NDArray[np.float64]
DEGENERATE = 1e-10  # singular values below this share of the largest carry no information


def covariance_of(jacobian: Array, residual: Array) -> tuple[Array, float]:
    """Covariance of the unknowns of which only the residuals tell, and the degrees of freedom that it rests on.

    Args:
        jacobian: derivatives of what is predicted, shape (rows * n, unknowns)
        residual: measured less predicted, shape (rows, n)
    """
    covariance, freedom = posterior_of(jacobian, list(residual), np.zeros((0, jacobian.shape[1])))
    return covariance, float(freedom.max(initial=1.0))


@np.errstate(over="ignore")  # a variance beyond all numbers is infinite
def posterior_of(jacobian: Array, residual: Sequence[Array], before: Array) -> tuple[Array, Array]:
    """Covariance of the unknowns by residuals and by what was known before, and the degrees of freedom of each.

    Variance of the residuals over degrees of freedom, times how many samples hang together: residuals that are no white
    noise tell less than their number. Each unknown's is that for residuals of equal size or that for unequal ones, HC3 of
    MacKinnon and White (1985), whichever is larger. Widened, where samples are few, so that one standard deviation holds the
    true value as often as that of a normal distribution (Student 1908); what was known before is not. Infinite variance where
    some direction that an unknown takes part in leaves everything unchanged. Degrees of freedom by Welch (1947) and
    Satterthwaite (1946): variance known before has infinitely many.

    Args:
        jacobian: derivatives of what is predicted, shape (samples of all rows, unknowns)
        residual: measured less predicted, row by row
        before: what was known before: rows of linear equations of unit uncertainty, shape (priors, unknowns)
    """
    samples, unknowns = jacobian.shape
    rows = np.concatenate((jacobian, before))
    size = np.linalg.norm(rows, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    left, singular, directions = np.linalg.svd(rows / size, full_matrices=False)
    dead = singular <= DEGENERATE * singular.max(initial=0.0)
    root = directions.T * np.where(dead, 0.0, 1.0 / np.where(dead, 1.0, singular))
    moved = root @ left.T  # each unknown by each row, in units of `size`
    each = np.concatenate(residual)
    together = np.repeat([correlation_length(row) for row in residual], [len(row) for row in residual])
    freedom = max(float(np.sum(1.0 / together)) - unknowns, 1.0)
    even = float(np.sum(each**2)) / max(samples - unknowns, 1)
    leverage = np.minimum(np.sum(left[:samples, ~dead] ** 2, axis=1), 1.0 - 1.0 / samples)
    of_data = even * (moved[:, :samples] * together) @ moved[:, :samples].T
    uneven = np.sum((moved[:, :samples] * (each / (1.0 - leverage))) ** 2 * together, axis=1)
    even_variance = np.diag(of_data)
    wider = np.sqrt(np.maximum(uneven / np.where(uneven > 0.0, even_variance, 1.0), 1.0))
    of_data = of_data * student(ONE_SIGMA, freedom) ** 2 * np.outer(wider, wider)
    covariance = of_data + moved[:, samples:] @ moved[:, samples:].T
    share = np.diag(of_data) / np.where(np.diag(covariance) > 0.0, np.diag(covariance), 1.0)
    covariance /= np.outer(size, size)
    undetermined = (np.abs(directions[dead]) > 1e-6).any(axis=0) | ~np.any(rows, axis=0)
    covariance[undetermined, undetermined] = np.inf
    return covariance, freedom / np.maximum(share, 1e-12) ** 2


def correlation_length(residual: Array) -> float:
    """Integrated autocorrelation time in samples, summed over Sokal's window; 1 for white noise.

    Sokal, "Monte Carlo methods in statistical mechanics" (1997), section 3.
    """
    centred = residual - residual.mean()
    power = np.abs(np.fft.rfft(centred, 2 * len(centred))) ** 2
    if power.sum() == 0.0:
        return 1.0
    correlation = np.fft.irfft(power)[: len(centred)]
    time = 2.0 * np.cumsum(correlation / correlation[0]) - 1.0
    window = np.arange(len(time)) >= 5.0 * time
    return float(max(1.0, time[np.argmax(window)] if window.any() else time[-1]))
