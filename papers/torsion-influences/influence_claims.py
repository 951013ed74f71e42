"""Entries of the torsion article's Table 3, each in its words, with the answers of the models and of measured series."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import groupby, pairwise
from math import degrees, exp

import numpy as np
import torsion_influences as study
from numpy.typing import NDArray
from strainwave.rig import Trend, trend_words
from strainwave.typeset import ARCMIN_PER_RADIAN, fixed, number, quantity
from torsion_influences import OWN, SPECIMEN, CatalogueRow, Influence, Sweep, power

Array = NDArray[np.float64]

FAR_BELOW = 0.5  # ratio of stiffnesses: "remains low relative to", where the article speaks of an order of magnitude
FIRST_SHARED_RATIO = 80  # ratio from which on the catalogue states one stiffness of a size for all ratios

CONFIRMED, IN_PART, CONTRADICTED, UNDECIDABLE = "confirmed", "confirmed in part", "contradicted", "undecidable"
HIGH, LOW, HYSTERESIS = "High-stiffness regime", "Low-stiffness (reversal) regime", "Hysteresis"
TORQUE, RATIO, MATERIAL = "Applied torque level", "Gear reduction ratio", "Flexspline material & heat treatment"
PRELOAD, TEMPERATURE, LIFE = "Wave generator bearing preload", "Operating temperature", "Life of a unit"

# What of a series speaks to an entry: factor, quantity and the sign that the article expects; 0 for any change.
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


@dataclass(frozen=True)
class InfluenceClaim:
    """A statement of Table 3, whether it holds, and why.

    Attributes:
        parameter: the row
        regime: the column
        words: of the article
        verdict, answer: by the models and the catalogue
        measured_verdict, measured: by the series; empty where it does not speak to the entry
    """

    parameter: str
    regime: str
    words: str
    verdict: str
    answer: str
    measured_verdict: str = ""
    measured: tuple[str, ...] = ()


def entries(found: Influence) -> list[InfluenceClaim]:
    """All statements of the table, row by row."""
    rules: list[tuple[str, str, str, Callable[[Influence], tuple[str, str]]]] = [
        (TORQUE, HIGH, "Generally increases with preload, but may saturate.", _torque_high),
        (
            TORQUE,
            LOW,
            "May become slightly stiffer at higher torques but remains low relative to high-stiffness regime.",
            _torque_low,
        ),
        (TORQUE, HYSTERESIS, "Hysteresis loop area typically increases with torque amplitude.", _torque_area),
        (
            RATIO,
            HIGH,
            "Higher ratio gears often have a more compliant flexspline, potentially reducing stiffness.",
            _ratio_high,
        ),
        (
            RATIO,
            LOW,
            "The reversal zone is a system property but scales with the gear’s physical size and design.",
            _ratio_low,
        ),
        (RATIO, HYSTERESIS, "May scale with the physical size and design of the gear unit.", _ratio_width),
        (MATERIAL, HIGH, "Directly determines elastic modulus.", _modulus),
        (MATERIAL, HIGH, "High-strength steel with optimal heat treatment maximizes stiffness.", _heat_treatment),
        (
            MATERIAL,
            LOW,
            "Material yield strength and fatigue limits influence the micro-yielding and friction during reversal.",
            _yielding,
        ),
        (MATERIAL, HYSTERESIS, "Material internal damping characteristics directly contribute to hysteresis.", _damping),
        (
            PRELOAD,
            HIGH,
            "Higher preload increases bearing stiffness, contributing to overall system stiffness.",
            _bearing,
        ),
        (
            PRELOAD,
            LOW,
            "Higher preload increases static friction, potentially widening the very low stiffness reversal zone.",
            _preload_low,
        ),
        (PRELOAD, HYSTERESIS, "Increases friction-related energy loss, enlarging the hysteresis loop.", _preload_area),
        (
            TEMPERATURE,
            HIGH,
            "Stiffness may decrease slightly with rising temperature due to reduced material modulus.",
            _warm_high,
        ),
        (
            TEMPERATURE,
            LOW,
            "Friction coefficients may change with temperature, altering the reversal behavior.",
            _warm_low,
        ),
        (
            TEMPERATURE,
            HYSTERESIS,
            "Can vary due to changes in lubrication viscosity and material properties.",
            _warm_area,
        ),
    ]
    return [
        InfluenceClaim(parameter, regime, words, *rule(found), *by_series(found, parameter, regime))
        for parameter, regime, words, rule in rules
    ]


def life(found: Influence) -> InfluenceClaim | None:
    """Return the claim about the age of units, which the article leaves to future work; None without such a series."""
    trends = [each for each in found.trends if each.factor in ("cycles", "hours")]
    if not trends:
        return None
    changed = [each for each in trends if each.significant and not each.together_with]
    verdict = CONFIRMED if changed else UNDECIDABLE
    words = "Future work may focus on … correlating the measured parameters with long-term wear and performance degradation."
    answer = "The article measured nothing of it, and no model of this package wears."
    return InfluenceClaim(LIFE, "All", words, UNDECIDABLE, answer, verdict, tuple(map(trend_words, trends)))


# ---- Torque level ----------------------------------------------------------------------------------------------------


def usual(sweep: Sweep, name: str) -> Array:
    """A figure over the torques that the article’s sweep is taken to span."""
    return np.asarray(sweep[name][sweep.levels >= study.LOWEST_SHARE * sweep.levels[-1] * (1.0 - 1e-9)])


def _rises(values: Array) -> bool:
    return bool(np.all(np.diff(values) > -1e-6 * np.abs(values[:-1])) and values[-1] > 1.01 * values[0])


def _torque_high(found: Influence) -> tuple[str, str]:
    sweep = found.amplitude[OWN]
    high = usual(sweep, "high_stiffness")
    local = sweep.local_exponents("high_stiffness")[-len(high) + 1 :]
    verdict = CONFIRMED if _rises(high) else CONTRADICTED
    law = found.amplitude[SPECIMEN]["high_stiffness"][-1]
    return verdict, (
        f"From {percent(study.LOWEST_SHARE)} of {nm(found.torque)} on, the unloading slope goes from {stiff(high[0])} to "
        f"{stiff(high[-1])}, its power of the torque falling from {number(float(local.max()), 2)} to "
        f"{number(float(local[-1]), 2)}, while in the smallest loop, of {nm(sweep.levels[0])}, it is "
        f"{stiff(sweep['high_stiffness'][0])}, and the article’s row, one torque, gives one slope only ({stiff(law)})."
    )


def _torque_low(found: Influence) -> tuple[str, str]:
    sweep, tested = found.amplitude[OWN], found.amplitude[SPECIMEN]
    low, ratio = usual(sweep, "low_stiffness"), float(sweep["low_stiffness"][-1] / sweep["high_stiffness"][-1])
    other = float(tested["low_stiffness"][-1] / tested["high_stiffness"][-1])
    parts = [_rises(low), ratio < FAR_BELOW]
    verdict = CONFIRMED if all(parts) else IN_PART if any(parts) else CONTRADICTED
    return verdict, (
        f"From {percent(study.LOWEST_SHARE)} to all of {nm(found.torque)} the loading slope goes from {stiff(low[0])} to "
        f"{stiff(low[-1])}, which is {number(ratio, 2)} of the unloading slope there; the article’s gear has "
        f"{number(other, 2)}."
    )


def _torque_area(found: Influence) -> tuple[str, str]:
    sweep, tested = found.amplitude[OWN], found.amplitude[SPECIMEN]
    if sweep["area"].max() == 0.0:
        return UNDECIDABLE, f"{_LOSSLESS} up to {nm(found.torque)}; loops of it at three torques would decide."
    slope = sweep.exponent("area", study.LOWEST_SHARE * found.torque)
    still, other = found.lossless[OWN], found.lossless[SPECIMEN]
    begin = f"Nothing is lost up to {quantity(still, 'N.m', 4)}; the" if still > 0.0 else "The"
    return CONFIRMED if _rises(usual(sweep, "area")) else CONTRADICTED, (
        f"{begin} area grows with the power {number(slope.value, 3)} ± {number(slope.half_width, 2)} of the torque from "
        f"{percent(study.LOWEST_SHARE)} of {nm(found.torque)} on; the article’s gear loses nothing up to "
        f"{quantity(other, 'N.m', 4)} and no more than {quantity(float(tested['area'].max()), 'J', 4)} once its soft range is "
        "used up."
    )


_LOSSLESS = "The gear’s model loses 0 J at every torque"


# ---- Ratio and size --------------------------------------------------------------------------------------------------


def by_size(rows: tuple[CatalogueRow, ...]) -> dict[int, list[CatalogueRow]]:
    """The rows of each size, ratios rising."""
    ordered = sorted(rows, key=lambda row: (row.size, row.ratio))
    return {size: list(each) for size, each in groupby(ordered, key=lambda row: row.size)}


def steps_and_falls(rows: tuple[CatalogueRow, ...]) -> tuple[int, int]:
    """Comparisons of K1, K2 and K3 at the next ratio of a size, and how many of them fall by more than rounding.

    From `FIRST_SHARED_RATIO` on the catalogue has one value for all ratios, which is not compared with itself.
    """
    stated = [[row for row in each if row.ratio <= FIRST_SHARED_RATIO] for each in by_size(rows).values()]
    steps = [pair for each in stated for pair in pairwise(each)]
    falls = [getattr(after, k) < 0.999 * getattr(before, k) for before, after in steps for k in ("k1", "k2", "k3")]
    return len(falls), sum(falls)


def _ratio_high(found: Influence) -> tuple[str, str]:
    steps, falls = steps_and_falls(found.rows)
    sized = by_size(found.rows)[25]
    seen = power(np.array([float(r.ratio) for r in sized]), np.array([r.k1 / r.ratio**2 for r in sized]))
    first, last = sized[0], sized[-1]
    return CONTRADICTED if falls == 0 else IN_PART, (
        f"Of one size the catalogue’s stiffness at the output falls in {falls} of {steps} comparisons of ratios 30, 50 and "
        f"{FIRST_SHARED_RATIO}, from which on it states one value for all ratios ("
        f"size 25, ratio {first.ratio} to {last.ratio}: K₁ {stiff(first.k1)} to {stiff(last.k1)}); what falls is K/i² at the "
        f"input, with the power {number(seen.value, 3)} ± {number(seen.half_width, 2)} of the ratio."
    )


def over_size(rows: tuple[CatalogueRow, ...], ratio: int, name: str) -> tuple[float, float]:
    """Exponent of a figure over the size at a ratio, and half of its 95 % interval."""
    chosen = sorted((row for row in rows if row.ratio == ratio), key=lambda row: row.size)
    slope = power(np.array([float(row.size) for row in chosen]), np.array([getattr(row, name) for row in chosen]))
    return slope.value, slope.half_width


def _ratio_low(found: Influence) -> tuple[str, str]:
    knee, half = over_size(found.rows, 100, "t1")
    stiffness, other = over_size(found.rows, 100, "k1")
    turns = [ARCMIN_PER_RADIAN * row.t1 / row.k1 for row in found.rows if row.ratio == 100]
    return CONFIRMED if knee - half > 0.0 else CONTRADICTED, (
        f"The soft first range of the catalogue ends at T₁ ~ size^({fixed(knee, 2)} ± {fixed(half, 2)}) with "
        f"K₁ ~ size^({fixed(stiffness, 2)} ± {fixed(other, 2)}), so it scales as a torque, while as an angle it is "
        f"{number(min(turns), 2)}′ to {number(max(turns), 2)}′ in every size."
    )


def _ratio_width(found: Influence) -> tuple[str, str]:
    bounds = {row.ratio: 2.0 * ARCMIN_PER_RADIAN * row.width for row in sorted(found.rows, key=lambda row: row.ratio)}
    low, rest = bounds[min(bounds)], {round(value, 1) for ratio, value in bounds.items() if ratio != min(bounds)}
    return UNDECIDABLE, (
        f"The maker states only bounds, {number(low, 2)}′ at ratio {min(bounds)} and "
        f"{' or '.join(number(each, 2) for each in sorted(rest))}′ above for every size; loops of a few units of three "
        "sizes at rated torque would decide."
    )


# ---- Material --------------------------------------------------------------------------------------------------------


def _modulus(found: Influence) -> tuple[str, str]:
    share = found.shares["flexspline"]
    own = found.material.exponent("stiffness").value
    more = 1.0 / (1.0 - share + share / 1.1) - 1.0
    return CONFIRMED, (
        f"Stiffness goes with the power {number(own, 3)} of the modulus if all springs are of the material (a spring that "
        "hardens has less than 1, for it is loaded less far); if only the flexspline is, "
        f"{percent(share)} of the compliance of a gear of stages (assumed numbers), "
        f"10 % of modulus give {percent(more)}."
    )


def _heat_treatment(_: Influence) -> tuple[str, str]:
    least, most = study.STEELS
    return CONTRADICTED, (
        f"The modulus of ferritic steels from carbon to nickel steel lies between {number(least, 4)} and "
        f"{number(most, 4)} GPa (ASME B31.3, Table C-6), {percent(most / least - 1.0)} apart, while their strengths differ "
        "several times: strength and heat treatment leave stiffness nearly as it is."
    )


def _yielding(_: Influence) -> tuple[str, str]:
    return UNDECIDABLE, (
        "No model here has yield or fatigue, and the article measured 1 flexspline; loops of flexsplines of one design in "
        "two heat treatments, in the same wave generator, would decide."
    )


def loss_factor(sweep: Sweep) -> float:
    """Return the loss factor of the largest loop: area over 2 pi times a spring's energy from its middle to its peak."""
    peak = sweep.levels[-1]
    return float(sweep["area"][-1] / (np.pi * peak**2 / sweep["stiffness"][-1]))


def _damping(found: Influence) -> tuple[str, str]:
    own, tested = (loss_factor(found.amplitude[each]) for each in (OWN, SPECIMEN))
    here = f"{percent(study.LOSS_FACTOR / own)} of this gear’s loop and " if own > 0.0 else ""
    return UNDECIDABLE, (
        f"A loss factor of steel of {number(study.LOSS_FACTOR, 1)} (order of magnitude) would make {here}"
        f"{percent(study.LOSS_FACTOR / tested)} of the article’s, which no loop separates from friction; loops too small to "
        "slip would decide."
    )


# ---- Preload of the bearing ------------------------------------------------------------------------------------------


def _bearing(found: Influence) -> tuple[str, str]:
    share = found.shares["bearing"]
    more = 1.0 / (1.0 - share + share / 1.1) - 1.0
    seen = f" {_held_higher(found)}" if found.preload is not None else ""
    return IN_PART, (
        f"A bearing 10 % stiffer makes a gear of stages (assumed numbers) {percent(more)} stiffer, and how much stiffer "
        f"preload makes the bearing is undecidable here.{seen}"
    )


def _held_higher(found: Influence) -> str:
    assert found.preload is not None
    high = found.preload["high_stiffness"]
    now, more = high[_at(found.preload, 1.0)], high[_at(found.preload, 1.5)]
    return (
        f"A loop at the input seems {percent(more / now - 1.0)} stiffer in unloading with 50 % more friction, for the shaft "
        "is held at first; no part is stiffer."
    )


def _preload_low(found: Influence) -> tuple[str, str]:
    if found.preload is None:
        return UNDECIDABLE, _no_friction(found)
    width = found.preload["width"]
    now, more = width[_at(found.preload, 1.0)], width[_at(found.preload, 1.15)]
    wider = 2.0 * 0.15 * found.friction
    return CONFIRMED if _rises(width) else IN_PART, (
        f"Friction of {quantity(found.friction, 'N.m')} at the input, 15 % higher, widens the loop by exactly 2 ΔF = "
        f"{quantity(wider, 'N.m')} in torque and leaves the slope of every branch; at "
        f"{quantity(found.input_torque, 'N.m')} the width goes from {number(degrees(now), 3)}° to {number(degrees(more), 3)}°."
    )


def _preload_area(found: Influence) -> tuple[str, str]:
    if found.preload is None:
        return UNDECIDABLE, _no_friction(found)
    area = found.preload["area"]
    now, more = area[_at(found.preload, 1.0)], area[_at(found.preload, 1.15)]
    share = found.friction / found.input_torque
    return CONFIRMED if _rises(area) else IN_PART, (
        f"15 % more friction enlarges the loop by {percent(more / now - 1.0)}; but weights give a torque, not an angle: a loop "
        f"of a spring has 4 F (T − F)/k, which shrinks beyond F = T/2, and here F is {percent(share)} of T."
    )


def _no_friction(found: Influence) -> str:
    return f"{found.gear_set.name} has 0 N·m of friction at rest at its input; a breakaway torque measured there would decide."


# ---- Temperature -----------------------------------------------------------------------------------------------------


def _warm_high(found: Influence) -> tuple[str, str]:
    fall = found.rates.stiffness
    change = exp(-40.0 * fall) - 1.0
    high = found.temperature["high_stiffness"]
    seen = float(high[-1] / high[_at(found.temperature, 293.15)] - 1.0)
    return CONFIRMED if 0.0 > change > -0.1 else CONTRADICTED, (
        f"By {percent(change)} over 40 K, with {number(1e4 * fall, 3)} × 10⁻⁴ per kelvin ({found.rates.sources[0]}); a "
        f"loop at the input shows {percent(seen)}, because friction that falls holds the shaft for less."
    )


def _warm_low(found: Influence) -> tuple[str, str]:
    fall, low = found.rates.friction, found.temperature["low_stiffness"]
    change = float(low[-1] / low[_at(found.temperature, 293.15)] - 1.0)
    if found.friction <= 0.0:
        return UNDECIDABLE, _no_friction(found)
    return CONFIRMED if fall else CONTRADICTED, (
        f"Friction that falls by {percent(1.0 - exp(-10.0 * fall))} per 10 K ({found.rates.sources[2]}) changes the loading "
        f"slope at the input by {percent(change)} from 20 to 60 °C."
    )


def _warm_area(found: Influence) -> tuple[str, str]:
    area = found.temperature["area"]
    if area.max() == 0.0:
        return UNDECIDABLE, f"{_LOSSLESS} and temperature; loops of it at two temperatures would decide."
    change = float(area[-1] / area[_at(found.temperature, 293.15)] - 1.0)
    steel = exp(40.0 * found.rates.stiffness) - 1.0
    return IN_PART, (
        f"Dry friction changes the area at the input by {percent(change)} from 20 to 60 °C and the modulus alone by less than "
        f"{percent(steel)}, but viscosity by 0 %: the article’s images show states of rest, in which nothing flows."
    )


def _at(sweep: Sweep, level: float) -> int:
    """Return the index of a level in a sweep."""
    return int(np.argmin(np.abs(sweep.levels - level)))


# ---- Series -----------------------------------------------------------------------------------------------------------


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


# ---- Words -----------------------------------------------------------------------------------------------------------


def percent(share: float, digits: int = 2) -> str:
    """Return a share in per cent."""
    return f"{number(100.0 * share, digits)} %"


def stiff(value: float) -> str:
    """A stiffness with its unit."""
    return quantity(float(value), "N.m/rad")


def nm(value: float) -> str:
    """A torque with its unit."""
    return quantity(float(value), "N.m")


def counts(found: list[InfluenceClaim]) -> Iterator[tuple[str, int]]:
    """Return the count of claims with each verdict, by the models."""
    for verdict in (CONFIRMED, IN_PART, CONTRADICTED, UNDECIDABLE):
        yield verdict, sum(each.verdict == verdict for each in found)
