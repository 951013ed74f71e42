"""The straight line through points that err in both directions."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MAX_ITERATIONS = 200  # of the line fit; about ten are usual
SLOPE_TOLERANCE = 1e-13  # relative change of the slope at which the line fit ends [1]
MIN_RELATIVE_SIGMA = 1e-3  # smallest error of a point over the usual one [1], so that no single point determines the line


@dataclass(frozen=True)
class FittedLine:
    """y = intercept + slope x through points with errors in both.

    Attributes:
        slope: its slope
        intercept: its value at x = 0
        sigma: standard deviation of the slope
        share_x: share of the errors of x in the variance of the slope [1]
        freedom: infinite where errors were stated; points less two where they were taken from the scatter about the line
        misfit: chi-square of the residuals over points less two [1]; not a number where errors were not stated
        bend: largest residual of y
    """

    slope: float
    intercept: float
    sigma: float
    share_x: float
    freedom: float
    misfit: float
    bend: float


def fit_line(x: Array, y: Array, sigma_x: Array, sigma_y: Array) -> FittedLine:
    """Line of greatest likelihood, by York's equations for errors that are independent.

    Where no errors are stated, both axes err by the same share of their span, and the size is taken from the scatter: the
    slope then does not depend on units, and swapping the axes inverts it.

    Args:
        x, y: the points, shape (n,), n >= 2, with at least two different x and y
        sigma_x, sigma_y: standard deviations of each, shape (n,); all zero where they are not known

    Source:
        York2004, section II; the variance of the slope is that of the equation it solves, linear in the errors

    >>> line = fit_line(np.array([0.0, 1.0, 2.0]), np.array([1.0, 3.0, 5.0]), np.zeros(3), np.full(3, 0.1))
    >>> round(line.slope, 12), round(line.sigma, 6)  # 0.1 / sqrt(2)
    (2.0, 0.070711)
    """
    stated = bool(np.any(sigma_x > 0.0) or np.any(sigma_y > 0.0))
    span_x, span_y = float(np.ptp(x)), float(np.ptp(y))
    if not stated:
        sigma_x, sigma_y = np.full(len(x), span_x), np.full(len(y), span_y)
    slope = float(np.sign(np.sum((x - x.mean()) * (y - y.mean()))) or 1.0) * span_y / span_x
    for _ in range(MAX_ITERATIONS):
        before = slope
        weights = _weights(slope, sigma_x, sigma_y)
        middle_x, middle_y = weights @ x / weights.sum(), weights @ y / weights.sum()
        from_x, from_y = x - middle_x, y - middle_y
        steps = weights * (from_x * sigma_y**2 + slope * from_y * sigma_x**2)  # York's beta
        pull = weights * (steps - weights @ steps / weights.sum())
        if not (across := float(pull @ from_x)):
            raise ValueError("angle and torque of a regime do not vary together; no line fits them: check the angles")
        slope = float(pull @ from_y) / across
        if abs(slope - before) <= SLOPE_TOLERANCE * abs(slope):
            break
    residual = y - middle_y - slope * from_x
    variances = np.array([slope**2 * np.sum((pull * sigma_x) ** 2), np.sum((pull * sigma_y) ** 2)]) / (pull @ from_x) ** 2
    freedom = len(x) - 2
    misfit = float(weights @ residual**2) / freedom if freedom else 0.0
    sigma = float(np.sqrt(variances.sum()))
    return FittedLine(
        slope,
        float(middle_y - slope * middle_x),
        sigma if stated else (sigma * float(np.sqrt(misfit)) if freedom else np.nan),
        float(variances[0] / variances.sum()),
        inf if stated else max(float(freedom), 1.0),
        misfit if stated else np.nan,
        float(np.abs(residual).max()),
    )


def _weights(slope: float, sigma_x: Array, sigma_y: Array) -> Array:
    """One over the variance of each residual."""
    variance = sigma_y**2 + slope**2 * sigma_x**2
    return np.asarray(1.0 / np.maximum(variance, MIN_RELATIVE_SIGMA**2 * variance.mean()))
