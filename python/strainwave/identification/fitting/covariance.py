"""What residuals and their derivatives say about how well each unknown is known.

The estimates move with the noise e by W e, W = B J' with J the derivatives of what is predicted and B = (J'J + P)^-1, P the
precision of what was known before. Their covariance is W cov(e) W' + B P B. Of the noise there are two estimates, and each
unknown gets the one with the larger variance:

* The noise of each channel is stationary, with the spectrum of an autoregression fitted to its residuals. Then
  W cov(e) W' is the mean over all frequencies of the spectrum times the power of W. The residuals have less power than the
  noise, as the fit took part of it: with U the orthonormal columns of J, the fraction trace(U' cov(e) U) / trace(cov(e)). This
  variance is raised where residuals are larger where they count more, by HC3 of MacKinnon and White, J. Econometrics 29
  (1985) 305-325. Where few samples count, it has few degrees of freedom (Satterthwaite 1946).
* Scores, derivatives times residuals, hang together over some samples, and channels at the same instant do: Newey and West,
  Econometrica 55 (1987) 703-708, with the lags of Andrews (1991).

Noise that repeats itself at the very frequencies of the derivatives cannot be told from the parameters by any of these.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.fitting.estimate import ONE_SIGMA, student
from strainwave.identification.fitting.noise import andrews_lags, correlation_length, spectrum

__all__ = ["correlation_length", "covariance_of", "posterior_of"]

Array = NDArray[np.float64]
DEGENERATE = 1e-10  # singular values below this share of the largest carry no information
MOST_TAKEN = 0.8  # of the power of the noise by the fit: of more, residuals cannot tell (assumed)


def covariance_of(jacobian: Array, residual: Array) -> tuple[Array, float]:
    """Covariance of the unknowns of which only the residuals tell, and the degrees of freedom that it rests on.

    Args:
        jacobian: derivatives of what is predicted, shape (channels * n, unknowns)
        residual: measured less predicted, shape (channels, n)
    """
    covariance, freedom = posterior_of(jacobian, [residual], np.zeros((0, jacobian.shape[1])))
    return covariance, float(freedom.min(initial=residual.size))


@np.errstate(over="ignore")  # a variance beyond all numbers is infinite
def posterior_of(jacobian: Array, residual: Sequence[Array], before: Array, bend: Array | None = None) -> tuple[Array, Array]:
    """Covariance of the unknowns by residuals and by what was known before, and the degrees of freedom of each.

    Widened, where samples are few, so that one standard deviation holds the true value as often as that of a normal
    distribution (Student 1908); what was known before is not. Infinite variance where some direction that an unknown takes part
    in leaves everything unchanged. Degrees of freedom by Welch (1947) and Satterthwaite (1946): variance known before has
    infinitely many.

    Args:
        jacobian: derivatives of what is predicted, shape (samples of all channels of all records, unknowns)
        residual: measured less predicted of each record, shape (channels, n); of a loss that is not quadratic its slope there
        before: what was known before: rows of linear equations of unit uncertainty, shape (priors, unknowns)
        bend: second derivative of the loss at each sample; 1 if not given
    """
    samples = len(jacobian)
    bent = jacobian if bend is None else jacobian * np.sqrt(bend)[:, np.newaxis]
    rows = np.concatenate((bent, before))
    size = np.linalg.norm(rows, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    left, singular, directions = np.linalg.svd(rows / size, full_matrices=False)
    dead = singular <= DEGENERATE * singular.max(initial=0.0)
    root = directions.T * np.where(dead, 0.0, 1.0 / np.where(dead, 1.0, singular))
    moved = root @ root.T @ (jacobian / size).T  # each unknown by each sample, in units of `size`
    taken = left[:samples, ~dead]
    of_data, freedom = _of_noise(moved, taken, residual)
    of_data *= np.outer(wide := np.array([student(ONE_SIGMA, each) for each in freedom]), wide)
    of_priors = root @ left[samples:].T
    covariance = of_data + of_priors @ of_priors.T
    variance = np.diag(covariance)
    share = np.diag(of_data) / np.where(variance > 0.0, variance, 1.0)
    undetermined = (np.abs(directions[dead]) > 1e-6).any(axis=0) | ~np.any(rows, axis=0)
    covariance = covariance / np.outer(size, size)
    covariance[undetermined, undetermined] = np.inf
    return covariance, freedom / np.maximum(share, 1e-12) ** 2


def _of_noise(moved: Array, taken: Array, residual: Sequence[Array]) -> tuple[Array, Array]:
    """Covariance of the unknowns by the noise, and its degrees of freedom for each of them.

    Args:
        moved: each unknown by each sample, shape (unknowns, samples)
        taken: orthonormal columns of what the fit can take of the noise, shape (samples, directions)
        residual: of each record, shape (channels, n)
    """
    unknowns, samples = moved.shape
    free = samples / max(samples - unknowns, 1)
    leverage = np.minimum(np.sum(taken**2, axis=1), 1.0 - 1.0 / samples)
    spectral, white, scores = np.zeros((3, unknowns, unknowns))
    unequal, fourth, independent, first = *np.zeros((3, unknowns)), 0
    for record in residual:
        n = record.shape[1]
        summed, lags = np.zeros((unknowns, n)), 0
        for row in record:
            here = slice(first, first + n)
            w, u, first = moved[:, here], taken[here], first + n
            coloured, inflated = _stationary(w, u, row)
            spectral += coloured
            white += float(row @ row) * (w @ w.T) / n
            shares = (w * (row / (1.0 - leverage[here]))) ** 2
            unequal, fourth = unequal + shares.sum(axis=1), fourth + np.sum(shares**2, axis=1)
            independent += n / np.maximum(inflated, correlation_length(row))
            summed, lags = summed + w * row, max(lags, andrews_lags(row))
        scores += _newey_west(summed, lags)
    variance = np.diag(spectral)
    wider = np.maximum(unequal / _positive(free * np.diag(white)), 1.0)
    wider = np.maximum(wider, free * np.diag(scores) / _positive(variance))
    few = 3.0 * unequal**2 / _positive(fourth)  # 3: mean fourth power of a normal variable of variance 1
    freedom = np.maximum(np.where(few > 0.0, np.minimum(independent - unknowns, few), independent - unknowns), 1.0)
    return spectral * np.sqrt(np.outer(wider, wider)), freedom


def _stationary(moved: Array, taken: Array, row: Array) -> tuple[Array, Array]:
    """Covariance by stationary noise of one channel, and what it is over that by white noise for each unknown."""
    n = len(row)
    length = 2 * n
    power = spectrum(row, length)
    sides = np.full(len(power), 2.0)
    sides[[0, -1]] = 1.0
    weight = power * sides / length
    waves = np.fft.rfft(moved, length, axis=1)
    unit = np.real((waves * weight) @ waves.conj().T)
    lost = float(np.sum(weight * np.sum(np.abs(np.fft.rfft(taken, length, axis=0)) ** 2, axis=1)))
    inflated = np.diag(unit) / _positive(np.sum(moved**2, axis=1))
    return unit * float(row @ row) / max(n - lost, (1.0 - MOST_TAKEN) * n), inflated


def _newey_west(scores: Array, lags: int) -> Array:
    """Covariance of the sum of scores, shape (unknowns, n), which hang together over some lags."""
    total: Array = scores @ scores.T
    for lag in range(1, lags + 1):
        product = scores[:, lag:] @ scores[:, :-lag].T
        total += (1.0 - lag / (lags + 1)) * (product + product.T)
    return total


def _positive(values: Array) -> Array:
    return np.where(values > 0.0, values, 1.0)
