"""Outcome of one drawn record: right, refused, or wrong without a message."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from scipy.stats import norm

MAX_DISTANCE = 2.5  # standard deviations of one estimate from the truth, that counts as right


@dataclass(frozen=True)
class Outcome:
    """Outcome of one record.

    Attributes:
        verdict: "right", "refused" if the program reports in words that the record does not determine it, or "wrong"
        message: what was estimated and what is true, or the reason of the refusal
    """

    verdict: str
    message: str = ""


def compared(pairs: Iterable[tuple[str, float, float, float]], floor: float = 0.0) -> Outcome:
    """Return the outcome of estimates that were listed as identified.

    Of several estimates the limit is larger, so that all together are beyond it as seldom as one is (Sidak, Journal of the
    American Statistical Association 62 (1967) 626).

    Args:
        pairs: name, estimate, its standard deviation, and the truth
        floor: relative difference that counts as right whatever the standard deviation, as of a known bias of the record
    """
    stated = list(pairs)
    inside = (2.0 * norm.cdf(MAX_DISTANCE) - 1.0) ** (1.0 / max(len(stated), 1))
    limit = float(norm.ppf(0.5 * (1.0 + inside)))
    apart = [
        f"{name} {value:.5g} ± {sigma:.2g}, true {truth:.5g}"
        for name, value, sigma, truth in stated
        if abs(value - truth) > max(limit * sigma, floor * abs(truth))
    ]
    return Outcome("wrong", "; ".join(apart)) if apart else Outcome("right")
