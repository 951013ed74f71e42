"""A number found on a loop, with what is known of its error."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, inf, isnan, nan

from strainwave.presentation import Statement

CONFIDENCE_LEVEL = 0.95  # probability of the intervals of a result [1]


@dataclass(frozen=True)
class Result(Statement):
    """A number with its standard deviation and its interval of 95 %.

    Errors that two tests on one rig share, such as that of the radius of its disk, shift both results alike. `random` excludes
    them and serves to compare two tests; `sigma` includes them: the standard deviation from the true value.

    Attributes:
        value: the number, in `unit`
        unit: its unit
        random: standard deviation by what is this number's alone, in `unit`; not a number if nothing determines it
        shared: standard deviation by the scales that all numbers of the rig share, in `unit`
        low, high: ends of the interval that holds the true value with 95 %, shared part included

    >>> found = result(4.0, "N.m/rad", random=0.3, shared=0.4)
    >>> found.sigma, round(found.low, 2), round(found.high, 2)
    (0.5, 3.02, 4.98)
    """

    value: float
    unit: str
    random: float
    shared: float
    low: float
    high: float

    @property
    def sigma(self) -> float:
        """Standard deviation, shared part included."""
        return hypot(self.random, self.shared)

    def _headline(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        if isnan(self.sigma):
            return f"{self.value:.4g}{unit} (uncertainty unknown)"
        return f"{self.value:.4g}{unit} ({self.low:.4g} to {self.high:.4g})"


def result(value: float, unit: str, *, random: float = nan, shared: float = 0.0, freedom: float = inf) -> Result:
    """A number whose error is normal, or Student's of so many degrees of freedom where its size was taken from scatter."""
    half = student(freedom) * hypot(random, shared)
    return Result(value, unit, random, shared, value - half, value + half)


def inverse(found: Result, unit: str) -> Result:
    """One over a positive number, the ends of its interval likewise: a compliance from a stiffness, or back.

    >>> inverse(result(0.25, "rad/(N.m)", random=0.05), "N.m/rad").high > 4.0 + 2.0 * 0.8
    True
    """
    value = 1.0 / found.value
    high = 1.0 / found.low if found.low > 0.0 else (found.low if isnan(found.low) else inf)
    return Result(value, unit, found.random * value**2, found.shared * value**2, 1.0 / found.high, high)


def student(freedom: float, confidence: float = CONFIDENCE_LEVEL) -> float:
    """Half the width of the interval of Student's variable with this probability; of the normal one for endless freedom.

    >>> round(student(inf), 4), round(student(4.0), 4)
    (1.96, 2.7764)
    """
    from scipy.special import ndtri, stdtrit

    tail = 0.5 + 0.5 * confidence
    return float(ndtri(tail) if freedom == inf else stdtrit(freedom, tail))
