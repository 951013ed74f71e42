"""What residuals and their derivatives say about how well each unknown is known."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.fitting.estimate import ONE_SIGMA, student

Array = NDArray[np.float64]
DEGENERATE = 1e-10  # singular values below this share of the largest carry no information


@np.errstate(over="ignore")  # a variance beyond all numbers is infinite
def covariance_of(jacobian: Array, residual: Array) -> tuple[Array, float]:
    """Covariance of the unknowns, and the degrees of freedom it rests on.

    Variance of the residuals over degrees of freedom, times how many samples hang together: residuals that are no white
    noise tell less than their number. Each unknown's is that for residuals of equal size or that for unequal ones, HC3 of
    MacKinnon and White (1985), whichever is larger. Widened, where samples are few, so that one standard deviation holds the
    true value as often as that of a normal distribution (Student 1908). Infinite variance where some direction that an unknown
    takes part in leaves the residuals unchanged.
    """
    size = np.linalg.norm(jacobian, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    left, singular, directions = np.linalg.svd(jacobian / size, full_matrices=False)
    dead = singular <= DEGENERATE * singular.max(initial=0.0)
    together = max(correlation_length(row) for row in residual)
    freedom = max(residual.size / together - len(size), 1.0)
    root = directions.T * np.where(dead, 0.0, 1.0 / np.where(dead, 1.0, singular))
    even = float(np.sum(residual**2)) / max(residual.size - len(size), 1)
    leverage = np.minimum(np.sum(left[:, ~dead] ** 2, axis=1), 1.0 - 1.0 / residual.size)
    uneven = np.sum((root @ (left.T * (residual.ravel() / (1.0 - leverage)))) ** 2, axis=1)
    covariance = even * (root @ root.T)
    wider = np.sqrt(np.maximum(uneven / np.where(uneven > 0.0, np.diag(covariance), 1.0), 1.0))
    covariance *= together * student(ONE_SIGMA, freedom) ** 2 * np.outer(wider / size, wider / size)
    undetermined = (np.abs(directions[dead]) > 1e-6).any(axis=0) | ~np.any(jacobian, axis=0)
    covariance[undetermined, undetermined] = np.inf
    return covariance, freedom


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
