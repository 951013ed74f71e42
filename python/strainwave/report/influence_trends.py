"""Words on the trends of a measured series, for the entries of document T's Table 3."""

from __future__ import annotations

from math import exp

import numpy as np

from strainwave.rig.influence.influence import Influence
from strainwave.rig.influence.series import FACTORS, QUANTITIES
from strainwave.rig.influence.trend import Trend
from strainwave.typeset import number, quantity

CONFIRMED, IN_PART, CONTRADICTED, UNDECIDABLE = "confirmed", "confirmed in part", "contradicted", "undecidable"
HIGH, LOW, HYSTERESIS = "High-stiffness regime", "Low-stiffness (reversal) regime", "Hysteresis"
TORQUE, RATIO, MATERIAL = "Applied torque level", "Gear reduction ratio", "Flexspline material & heat treatment"
PRELOAD, TEMPERATURE, LIFE = "Wave generator bearing preload", "Operating temperature", "Life of a unit"

# What of a series speaks to an entry: factor, quantity and the sign that document T expects; 0 for any change.
SPEAKS: dict[tuple[str, str], tuple[tuple[str, str, int], ...]] = {
    (TORQUE, HIGH): (("torque_max", "stiffness", 1), ("torque_max", "high_stiffness", 1)),
    (TORQUE, LOW): (("torque_max", "low_stiffness", 1),),
    (TORQUE, HYSTERESIS): (("torque_max", "area", 1), ("torque_max", "width", 1)),
    (RATIO, HIGH): (("ratio", "stiffness", -1), ("ratio", "high_stiffness", -1)),
    (RATIO, LOW): (("ratio", "low_stiffness", 0),),
    (RATIO, HYSTERESIS): (("ratio", "area", 0), ("ratio", "width", 0)),
    (MATERIAL, HIGH): (("modulus", "stiffness", 1), ("modulus", "high_stiffness", 1)),
    (PRELOAD, HIGH): (("preload", "stiffness", 1), ("preload", "high_stiffness", 1)),
    (PRELOAD, LOW): (("preload", "width", 1), ("preload", "friction", 1), ("preload", "low_stiffness", -1)),
    (PRELOAD, HYSTERESIS): (("preload", "area", 1),),
    (TEMPERATURE, HIGH): (("temperature", "stiffness", -1), ("temperature", "high_stiffness", -1)),
    (TEMPERATURE, LOW): (("temperature", "friction", 0), ("temperature", "low_stiffness", 0)),
    (TEMPERATURE, HYSTERESIS): (("temperature", "area", 0), ("temperature", "width", 0)),
}


def by_series(found: Influence, parameter: str, regime: str) -> tuple[str, tuple[str, ...]]:
    """The verdict of a series on an entry, and its sentences; nothing where it does not speak to it."""
    speaking = [
        (trend, sign)
        for factor, quantity_, sign in SPEAKS.get((parameter, regime), ())
        for trend in found.trends
        if (trend.factor, trend.quantity) == (factor, quantity_)
    ]
    if not speaking:
        return "", ()
    return _verdict(speaking), tuple(trend_words(trend) for trend, _ in speaking)


def _verdict(speaking: list[tuple[Trend, int]]) -> str:
    clear = [(trend, sign) for trend, sign in speaking if trend.significant and not trend.together_with]
    if not clear:
        return UNDECIDABLE
    holds = {sign == 0 or np.sign(trend.slope.value) == sign for trend, sign in clear}
    return IN_PART if len(holds) == 2 else CONFIRMED if True in holds else CONTRADICTED


def trend_words(trend: Trend) -> str:
    """A trend in one sentence, with its interval and its probabilities."""
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
    """A probability, with its sign of equality.

    >>> chance(0.0312), chance(2e-9)
    ('= 0.031', '< 0.0001')
    """
    return f"= {number(p, 2)}" if p >= 1e-4 else "< 0.0001"


def _factors(names: tuple[str, ...]) -> str:
    return " and ".join(FACTORS[each].words for each in names)


def change_of(trend: Trend) -> str:
    """The coefficient with its interval, in words."""
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
    """A share in per cent."""
    return f"{number(100.0 * share, digits)} %"
