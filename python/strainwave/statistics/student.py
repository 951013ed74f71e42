"""Intervals of normal estimates whose standard deviation is estimated too (Student 1908)."""

from __future__ import annotations

ONE_SIGMA = 0.6826894921370859  # share of a normal distribution within one standard deviation
SIGNIFICANCE_SIGMA = 3.0  # standard deviations: numbers that are farther apart differ


def student(confidence: float, freedom: float) -> float:
    """Return half the width of the interval that contains Student's variable with this probability.

    >>> round(student(0.95, 4.0), 3)
    2.776
    """
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.5 + 0.5 * confidence))
