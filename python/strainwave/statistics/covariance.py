"""Covariance of the unknowns of a fit by its residuals and derivatives.

The estimates move with the noise e by W e, W = B J' with J the derivatives of what is predicted and B = (J'J + P)^-1, P the
precision of what was known before. Their covariance is W cov(e) W' + B P B. Of the noise there are two estimates, and each
unknown gets the one with the larger variance:

* The noise of each channel is stationary, with the spectrum of an autoregression fitted to its residuals. Then
  W cov(e) W' is the mean over all frequencies of the spectrum times the power of W. The residuals have less power than the
  noise, as the fit took part of it: with U the orthonormal columns of J, the fraction trace(U' cov(e) U) / trace(cov(e)). This
  variance is raised where residuals are larger where they count more, by HC3 of MacKinnon and White, J. Econometrics 29
  (1985) 305-325. Where few samples count, it has few degrees of freedom (Satterthwaite 1946).
* Scores, derivatives times residuals, correlate over some samples, and between channels at one instant: Newey and West,
  Econometrica 55 (1987) 703-708, with the lags of Andrews (1991).

None of these separates the parameters from a noise that repeats itself at the frequencies of the derivatives.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave.statistics.residuals import andrews_lags, correlation_length, spectrum
from strainwave.statistics.scale import ONE_SIGMA, student

Array = NDArray[np.float64]
MIN_SINGULAR_OF_JACOBIAN = 1e-10  # singular values below this share of the largest carry no information
MAX_OPEN_PART = 1e-6  # of an unknown in directions that are not determined: one with more is not determined either
MAX_TAKEN_POWER = 0.8  # of the power of the noise, that a fit takes; residuals do not determine a larger share (assumed)


def covariance_of(jacobian: Array, residual: Array) -> tuple[Array, float]:
    """Return the covariance of unknowns without priors, and its degrees of freedom.

    Args:
        jacobian: derivatives of the prediction, shape (channels * n, unknowns)
        residual: measured less predicted, shape (channels, n)
    """
    covariance, freedom = posterior_of(jacobian, [residual], np.zeros((0, jacobian.shape[1])))
    return covariance, float(freedom.min(initial=residual.size))


@np.errstate(over="ignore")  # a variance beyond all numbers is infinite
def posterior_of(
    jacobian: Array, residual: Sequence[Array], before: Array, curvature: Array | None = None
) -> tuple[Array, Array]:
    """Return the covariance of the unknowns by residuals and priors, and the degrees of freedom of each.

    It is widened if samples are few, so that one standard deviation contains the true value as often as that of a normal
    distribution (Student 1908); priors are not. The variance is infinite if an unknown takes part in a direction that leaves
    the prediction unchanged. Degrees of freedom by Welch (1947) and Satterthwaite (1946): those of priors are infinite.

    Args:
        jacobian: derivatives of the prediction, shape (samples of all channels of all records, unknowns)
        residual: measured less predicted of each record, shape (channels, n); of a loss that is not quadratic its slope there
        before: priors as rows of linear equations of unit uncertainty, shape (priors, unknowns)
        curvature: second derivative of the loss at each sample; 1 if not given
    """
    samples = len(jacobian)
    bent = jacobian if curvature is None else jacobian * np.sqrt(curvature)[:, np.newaxis]
    rows = np.concatenate((bent, before))
    size = np.linalg.norm(rows, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    left, singular, directions = np.linalg.svd(rows / size, full_matrices=False)
    dead = singular <= MIN_SINGULAR_OF_JACOBIAN * singular.max(initial=0.0)
    root = directions.T * np.where(dead, 0.0, 1.0 / np.where(dead, 1.0, singular))
    moved = root @ root.T @ (jacobian / size).T  # each unknown by each sample, in units of `size`
    basis = left[:samples, ~dead]
    of_data, freedom = _of_noise(moved, basis, residual)
    of_data *= np.outer(wide := np.array([student(ONE_SIGMA, each) for each in freedom]), wide)
    of_priors = root @ left[samples:].T
    covariance = of_data + of_priors @ of_priors.T
    variance = np.diag(covariance)
    share = np.diag(of_data) / np.where(variance > 0.0, variance, 1.0)
    undetermined = (1.0 - np.sum(directions[~dead] ** 2, axis=0) > MAX_OPEN_PART**2) | ~np.any(rows, axis=0)
    covariance = covariance / np.outer(size, size)
    covariance[undetermined, undetermined] = np.inf
    return covariance, freedom / np.maximum(share, 1e-12) ** 2


def _of_noise(moved: Array, basis: Array, residual: Sequence[Array]) -> tuple[Array, Array]:
    """Return the covariance of the unknowns by the noise, and its degrees of freedom for each of them.

    Args:
        moved: each unknown by each sample, shape (unknowns, samples)
        basis: orthonormal columns of the noise that the fit can take, shape (samples, directions)
        residual: of each record, shape (channels, n)
    """
    unknowns, samples = moved.shape
    free = samples / max(samples - unknowns, 1)
    leverage = np.minimum(np.sum(basis**2, axis=1), 1.0 - 1.0 / samples)
    spectral, white, scores = np.zeros((3, unknowns, unknowns))
    unequal, fourth, independent, first = *np.zeros((3, unknowns)), 0
    for record in residual:
        n = record.shape[1]
        summed, lags = np.zeros((unknowns, n)), 0
        for row in record:
            here = slice(first, first + n)
            w, u, first = moved[:, here], basis[here], first + n
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


def _stationary(moved: Array, basis: Array, row: Array) -> tuple[Array, Array]:
    """Return the covariance by stationary noise of one channel, and that over the one by white noise for each unknown."""
    n = len(row)
    length = 2 * n
    power = spectrum(row, length)
    sides = np.full(len(power), 2.0)
    sides[[0, -1]] = 1.0
    weight = power * sides / length
    waves = np.fft.rfft(moved, length, axis=1)
    unit = np.real((waves * weight) @ waves.conj().T)
    lost = float(np.sum(weight * np.sum(np.abs(np.fft.rfft(basis, length, axis=0)) ** 2, axis=1)))
    inflated = np.diag(unit) / _positive(np.sum(moved**2, axis=1))
    return unit * float(row @ row) / max(n - lost, (1.0 - MAX_TAKEN_POWER) * n), inflated


def _newey_west(scores: Array, lags: int) -> Array:
    """Return the covariance of the sum of scores, shape (unknowns, n), which correlate over some lags."""
    total: Array = scores @ scores.T
    for lag in range(1, lags + 1):
        product = scores[:, lag:] @ scores[:, :-lag].T
        total += (1.0 - lag / (lags + 1)) * (product + product.T)
    return total


def _positive(values: Array) -> Array:
    return np.where(values > 0.0, values, 1.0)
