"""Trends of a measured series in sentences, each with its interval and its probabilities."""

from __future__ import annotations

from math import exp

import numpy as np

from strainwave.rig.influence.series import FACTORS, QUANTITIES
from strainwave.rig.influence.trend import Trend
from strainwave.typeset import number, quantity


def trend_words(trend: Trend) -> str:
    """Return a trend in one sentence, with its interval and its probabilities.

    >>> import strainwave as sw
    >>> series = sw.rig.Series({"torque_max": [0.1, 0.2, 0.3, 0.4]}, {"area": [1.0, 4.1, 8.8, 16.3]})
    >>> print(sw.rig.trend_words(*sw.rig.analyse_series(series)).partition(" (")[0])
    loop area goes with the power 2 of the torque level, 95 %: 1.89 to 2.11
    """
    name, factor = QUANTITIES[trend.quantity][0], FACTORS[trend.factor]
    if not np.isfinite(trend.slope.value):
        return (
            f"{name}: {factor.words} changed along with {_factors(trend.together_with)}, so their effects cannot be separated."
        )
    change = change_of(trend)
    found = f"{name} {change}" if trend.significant else f"{name}: no significant effect of {factor.words}; it {change}"
    others = [chance(p).removeprefix("= ") for p in (trend.corrected, trend.shuffled)]
    tests = f"p {chance(trend.slope.p)}; {others[0]} for all tests together; {others[1]} by shuffling; {trend.points} loops"
    warning = f"; changed along with {_factors(trend.together_with)}, whose effect it may be" if trend.together_with else ""
    return f"{found} ({tests}){warning}{bent_words(trend)}."


def bent_words(trend: Trend) -> str:
    """Return the evidence of repeated conditions against the law in words; empty if there is none."""
    if not trend.bent:
        return ""
    scattered = f"loops at equal conditions scatter less than they lie from this law (p {chance(trend.misfit)})"
    return f"; {scattered}: the law is not that of the measurements"


def chance(p: float) -> str:
    """Return a probability with its sign of equality.

    >>> chance(0.0312), chance(2e-9)
    ('= 0.031', '< 0.0001')
    """
    return f"= {number(p, 2)}" if p >= 1e-4 else "< 0.0001"


def _factors(names: tuple[str, ...]) -> str:
    return " and ".join(FACTORS[each].words for each in names)


def change_of(trend: Trend) -> str:
    """Return the coefficient of a trend with its interval, in words."""
    factor, (low, high) = FACTORS[trend.factor], trend.interval
    if trend.law == "power":
        return (
            f"goes with the power {number(trend.slope.value, 3)} of the {factor.words}, "
            f"95 %: {number(low, 3)} to {number(high, 3)}"
        )
    if trend.law == "linear":
        unit, step = QUANTITIES[trend.quantity][1] or "1", factor.step
        ends = " to ".join(quantity(step * end, unit) for end in (low, high))
        return f"changes by {quantity(step * trend.slope.value, unit)} per {factor.step_words or factor.unit}, 95 %: {ends}"
    relative = [percent(exp(factor.step * each) - 1.0, 3) for each in (trend.slope.value, low, high)]
    return f"changes by {relative[0]} per {factor.step_words}, 95 %: {relative[1]} to {relative[2]}"


def percent(share: float, digits: int = 2) -> str:
    """Return a share in per cent."""
    return f"{number(100.0 * share, digits)} %"
