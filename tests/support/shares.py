"""Intervals of a share that is counted."""

from __future__ import annotations

CONFIDENCE_LEVEL = 0.95


def share_interval(count: int, total: int) -> tuple[float, float]:
    """Return the exact interval of a share (Clopper and Pearson)."""
    from scipy.stats import binomtest

    found = binomtest(count, total).proportion_ci(CONFIDENCE_LEVEL, method="exact")
    return float(found.low), float(found.high)


def allowed_count(total: int, probability: float) -> int:
    """Return the count that chance exceeds in at most half a per cent of all such trials."""
    from scipy.stats import binom

    return int(binom.isf(0.005, total, probability))
