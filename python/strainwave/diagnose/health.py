"""Condition of a gear over its recordings, and its remaining life: the maker's formula, and the trend of the condition."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, log
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.diagnose.baseline import BaselineComparison
from strainwave.diagnose.detection import CONFIDENCE_LEVEL
from strainwave.files.gear_set import GearSet
from strainwave.presentation import Presented
from strainwave.statistics.scale import student

Array = NDArray[np.float64]

RATED_SPEED = 2000.0  # rpm of the input, at which makers state the rated torque [HarmonicDrive2014]
LIFE_L10 = {"csg": 10000.0, "shg": 10000.0}  # h at rated torque and speed, by series [HarmonicDrive2014]
OTHER_LIFE_L10 = 7000.0  # h: series CSF, HFUC and others [HarmonicDrive2014]
MEDIAN_TO_L10 = 5.0  # L50 over L10 [HarmonicDrive2014]
WEIBULL_SLOPE = log(log(2.0) / log(1.0 / 0.9)) / log(MEDIAN_TO_L10)  # 1.17, by these two quantiles
MIN_TREND_RECORDINGS = 5  # recordings, of which a trend is extrapolated
LIFE_QUANTILES = (0.1, 0.5, 0.9)  # of the gears that have failed


@dataclass(frozen=True)
class HealthIndicator(Presented):
    """Health indicator of a recording.

    Attributes:
        name: of the recording
        indicator: largest change of an order over the smallest change that is an alarm; 1 is the limit of detection
        distance: root of the sum of squared changes over their standard deviations, over all orders and directions
        order: per revolution of the shaft, of the largest change
        direction: of it
    """

    name: str
    indicator: float
    distance: float
    order: float
    direction: str


@dataclass(frozen=True)
class CatalogueLife(Presented):
    """Remaining life of the bearing of the wave generator by the maker's formula, for a load like that of the recordings.

    L_10 = L_n (T_r / T_av)³ (N_r / N_av), with the Weibull slope that L_50 = 5 L_10 means.

    Attributes:
        l10: hours, after which one gear in ten has failed
        hours: of operation so far
        remaining: hours from now until 10, 50 and 90 % of the gears that work now have failed
        average_torque: cubic mean of the torque at the output [N.m]
        average_speed: mean speed of the input [rpm]
        rated_torque: of the gear [N.m]
    """

    l10: float
    hours: float
    remaining: tuple[float, float, float]
    average_torque: float
    average_speed: float
    rated_torque: float


@dataclass(frozen=True)
class HealthTrend(Presented):
    """Straight line through the health indicator over the hours of operation.

    Attributes:
        slope, slope_sigma: per hour, and its standard deviation
        threshold: of the indicator
        remaining: hours from the last recording until the line passes the threshold; infinite if it falls
        low, high: ends of the interval of these hours, of 95 % (Fieller1954); infinite if the slope may be zero
    """

    slope: float
    slope_sigma: float
    threshold: float
    remaining: float
    low: float
    high: float


def condition(name: str, comparison: BaselineComparison) -> HealthIndicator | None:
    """Return the health indicator of a compared recording; None if nothing was compared."""
    if not comparison.changes:
        return None
    largest = max(comparison.changes, key=lambda each: abs(each.change) / each.limit)
    distance = float(np.sqrt(sum((each.change / each.sigma) ** 2 for each in comparison.changes)))
    return HealthIndicator(name, abs(largest.change) / largest.limit, distance, largest.order, largest.direction)


def catalogue_life(gear_set: GearSet, *, average_torque: float, average_speed: float, hours: float = 0.0) -> CatalogueLife:
    """Return the remaining life by the maker's formula.

    Args:
        gear_set: with the rating `rated_torque`
        average_torque: cubic mean of the torque at the output [N.m]
        average_speed: mean speed of the input [rpm]
        hours: of operation so far, under the same load [h]

    Raises:
        ValueError: the set has no rated torque, or a number is not positive

    >>> import strainwave as sw
    >>> life = catalogue_life(sw.GearSet.read("csg-20-100"), average_torque=52.0, average_speed=2000.0)
    >>> life.l10, round(life.remaining[1])
    (10000.0, 50000)
    """
    if "rated_torque" not in gear_set.ratings:
        raise ValueError(
            f"{gear_set.name} has no rated_torque in [ratings]; the life of its bearing is not determined: add it to "
            "the gear file"
        )
    torque = arguments.number("average_torque", average_torque, "N.m", low=0.0)
    speed = arguments.number("average_speed", average_speed, "rpm", low=0.0)
    hours = arguments.number("hours", hours, "h", brackets="[)", low=0.0)
    rated = float(gear_set.ratings["rated_torque"].to("N.m").value)
    series = gear_set.name.lower().partition("-")[0]
    l10 = LIFE_L10.get(series, OTHER_LIFE_L10) * (rated / torque) ** 3 * (RATED_SPEED / speed)
    scale = l10 / log(1.0 / 0.9) ** (1.0 / WEIBULL_SLOPE)
    used = (hours / scale) ** WEIBULL_SLOPE  # of a Weibull distribution; below the gears that work after these hours count
    low, middle, high = (scale * (used - log(1.0 - failed)) ** (1.0 / WEIBULL_SLOPE) - hours for failed in LIFE_QUANTILES)
    return CatalogueLife(l10, hours, (low, middle, high), torque, speed, rated)


def trend(hours: Sequence[float], indicators: Sequence[float], threshold: float) -> HealthTrend:
    """Return the line through health indicators and the hours until it passes a threshold.

    The interval is that of Fieller's theorem (Fieller1954): it contains all hours at which the line may have the value
    of the threshold. A line is an assumption; wear that accelerates ends sooner.

    Args:
        hours: of operation, of each recording
        indicators: of each recording
        threshold: of the indicator, at which the gear is to be exchanged

    Raises:
        ValueError: there are fewer than 5 recordings, or all are of the same hour

    >>> found = trend([0, 100, 200, 300, 400, 500], [0.1, 0.32, 0.49, 0.71, 0.88, 1.11], 2.0)
    >>> round(found.remaining), found.low < found.remaining < found.high
    (454, True)
    """
    x, y = np.asarray(hours, float), np.asarray(indicators, float)
    threshold = arguments.number("threshold", threshold, low=0.0)
    if len(x) != len(y):
        raise ValueError(f"{len(x)} hours are given for {len(y)} recordings; give one for each")
    if len(x) < MIN_TREND_RECORDINGS:
        raise ValueError(
            f"a trend needs {MIN_TREND_RECORDINGS} compared recordings or more; there are {len(x)}: add recordings of "
            "other days"
        )
    if float(np.ptp(x)) == 0.0:
        raise ValueError(f"all recordings are of hour {x[0]:g}; a trend needs different hours: give those of each recording")
    line = line_crossing(x, y, threshold, CONFIDENCE_LEVEL)
    return HealthTrend(line.slope, line.slope_sigma, threshold, line.distance, line.low, line.high)


class LineCrossing(NamedTuple):
    """Crossing of a fitted line with a threshold.

    Attributes:
        start: of the line, at x = 0
        slope, slope_sigma: of it, and its standard deviation
        distance: from the last x to the crossing; infinite if the line falls
        low, high: ends of the interval of that distance; infinite if the slope may be zero
    """

    start: float
    slope: float
    slope_sigma: float
    distance: float
    low: float
    high: float


def line_crossing(
    x: Array, y: Array, threshold: float, confidence: float, min_sigma: float = 0.0, known_sigma: float = 0.0
) -> LineCrossing:
    """Return where the line through points of equal, unknown noise passes a threshold, in the interval of Fieller1954.

    Args:
        x, y: of the points, shape (n,), n at least 3
        confidence: probability that the interval contains the crossing
        min_sigma: standard deviation of y that points on a line have, too
        known_sigma: standard deviation that y has at least, and that is known without the scatter of the points

    >>> line_crossing(np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 2.0]), 5.0, 0.95).distance
    3.0
    """
    middle, spread = float(x.mean()), float(((x - x.mean()) ** 2).sum())
    slope = float(((x - middle) @ y) / spread)
    level = float(y.mean())
    freedom = len(x) - 2
    variance = max(float(((y - level - slope * (x - middle)) ** 2).sum()) / freedom, min_sigma**2)
    scale = max(student(confidence, freedom) ** 2 * variance, student(confidence, inf) ** 2 * known_sigma**2)
    last = float(x.max())
    crossing = middle + (threshold - level) / slope if slope > 0.0 else inf
    low, high = _fieller(slope, threshold - level, scale, len(x), spread)
    return LineCrossing(
        level - slope * middle,
        slope,
        float(np.sqrt(max(variance, known_sigma**2) / spread)),
        max(crossing - last, 0.0),
        max(middle + low - last, 0.0),
        max(middle + high - last, 0.0),
    )


def _fieller(slope: float, rise: float, scale: float, count: int, spread: float) -> tuple[float, float]:
    """Return the interval of d with (rise - slope d)² <= scale (1 / count + d² / spread)."""
    a, b, c = slope**2 - scale / spread, -2.0 * slope * rise, rise**2 - scale / count
    if a <= 0.0:  # the slope may be zero: no upper end
        inside = b**2 - 4.0 * a * c
        if a == 0.0 or inside <= 0.0 or c <= 0.0:  # of c <= 0, the line may have passed already
            return -inf, inf
        roots = sorted((-b + s * np.sqrt(inside)) / (2.0 * a) for s in (1.0, -1.0))
        return (float(roots[1]) if rise > 0.0 else -inf), inf
    if slope < 0.0:
        return inf, inf
    root = float(np.sqrt(max(b**2 - 4.0 * a * c, 0.0)))
    return (-b - root) / (2.0 * a), (-b + root) / (2.0 * a)
