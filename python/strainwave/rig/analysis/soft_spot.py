"""Soft spots: a band of torque within a regime over which the gear gives way more than elsewhere in it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from strainwave.presentation import Statement
from strainwave.rig.analysis.regimes import RegimeName
from strainwave.rig.analysis.result import student
from strainwave.rig.analysis.stiffness import LocalStiffness, Stiffness

SOFT_COMPLIANCE_RATIO = 1.5  # a soft spot has more than this times the compliance of the regime's regression [1]
CONFIDENCE_LEVEL = 0.95  # probability that a regime without a soft spot shows none [1]


@dataclass(frozen=True)
class SoftSpot(Statement):
    """A band of torque that is softer than the rest of its regime.

    Attributes:
        regime: where
        low, high: torque where it begins and ends [N.m], to within half of `width`
        width: torque over which a local slope was taken [N.m]; a narrower spot looks less soft than it is
        multiple: greatest local compliance over that of the regime's regression [1]
        at_least: lower end of the interval of `multiple` [1]
        bounded: whether the regime is stiffer on either side; if not, the band goes on beyond zero torque or the peak
    """

    regime: RegimeName
    low: float
    high: float
    width: float
    multiple: float
    at_least: float
    bounded: bool

    def _headline(self) -> str:
        name = self.regime.replace("_", " ")
        beyond = "" if self.bounded else ", where the regime ends"
        return f"{name}: {self.multiple:.2g} times as soft as the regime from {self.low:.3g} to {self.high:.3g} N.m{beyond}"


def soft_spots(stiffnesses: Sequence[Stiffness], multiple: float = SOFT_COMPLIANCE_RATIO) -> tuple[SoftSpot, ...]:
    """Bands in which the local compliance exceeds a multiple of the compliance of the regime's regression.

    It must exceed it by more than chance does: the level is shared out among the stretches of a regime (Bonferroni), so that of
    twenty regimes without a soft spot at most one shows one. A regime that is soft over most of its torque has none: there
    the regression itself is soft.

    Args:
        stiffnesses: of regimes
        multiple: what is called soft [1], above 1
    """
    return tuple(spot for each in stiffnesses for spot in _spots(each, multiple))


def _spots(stiffness: Stiffness, multiple: float) -> Iterator[SoftSpot]:
    local, ratio, margin = stiffness.local, *_ratio(stiffness)
    soft = ratio - margin > multiple
    for first, beyond in _bands(soft, local):
        band = slice(first, beyond)
        most = first + int(np.argmax(ratio[band]))
        low, high = _edge(local, first, -1), _edge(local, beyond - 1, 1)
        bounded = first > 0 and beyond < len(soft)
        width = float(local.width[most])
        yield SoftSpot(stiffness.name, low, high, width, float(ratio[most]), float(ratio[most] - margin[most]), bounded)


def _bands(soft: NDArray[np.bool_], local: LocalStiffness) -> list[tuple[int, int]]:
    """Return the first stretch of each band and the one after its last; bands closer than the slopes resolve are merged."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], soft, [False])).astype(int))).tolist()
    bands: list[tuple[int, int]] = []
    for first, beyond in zip(edges[::2], edges[1::2], strict=True):
        if bands and local.torque[first] - local.torque[bands[-1][1] - 1] < local.width[first]:
            bands[-1] = (bands[-1][0], beyond)
        else:
            bands.append((first, beyond))
    return bands


def _ratio(stiffness: Stiffness) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Local compliance over that of the regression, and how far chance may take it."""
    local, regression = stiffness.local, stiffness.regression.value
    stretches = max(1, len(local.torque))
    quantile = student(inf, 2.0 * (1.0 - (1.0 - CONFIDENCE_LEVEL) / stretches) - 1.0)
    return local.compliance * regression, quantile * np.nan_to_num(local.sigma, nan=inf) * abs(regression)


def _edge(local: LocalStiffness, row: int, towards: int) -> float:
    """Half way to the next stretch, or the end of the last one."""
    other = row + towards
    if 0 <= other < len(local.torque):
        return float(0.5 * (local.torque[row] + local.torque[other]))
    return float(local.torque[row] + 0.5 * towards * local.width[row])


def words_on_band(stiffness: Stiffness, low: float, high: float, multiple: float = SOFT_COMPLIANCE_RATIO) -> str:
    """Return a sentence: whether a regime has a soft spot between two torques [N.m].

    Args:
        stiffness: of the regime
        low, high: sizes of torque, 0 <= low < high
        multiple: what is called soft [1]

    >>> import numpy as np
    >>> import strainwave as sw
    >>> torque = np.concatenate([np.linspace(0.36, -0.36, 20), np.linspace(-0.36, 0.36, 20)[1:]])
    >>> angle = torque / 0.5 + 2e-3 * np.random.default_rng(1).normal(size=len(torque))
    >>> found = sw.rig.analyse(sw.rig.Loop(angle, torque, side="input", name="loop", angle_sigma=2e-3))
    >>> print(sw.rig.words_on_band(found.stiffness("positive_unloading"), 0.1, 0.2))
    positive unloading, 0.1 to 0.2 N.m: no soft spot, 1.00 to 1.02 times the compliance of the regime's regression
    """
    sign = 1.0 if stiffness.name.startswith("positive") else -1.0
    inside = (sign * stiffness.local.torque >= low) & (sign * stiffness.local.torque <= high)
    where = f"{stiffness.name.replace('_', ' ')}, {sign * low:.3g} to {sign * high:.3g} N.m"
    if not np.any(inside):
        return f"{where}: no point was measured there"
    ratio, margin = _ratio(stiffness)
    low, high = sorted((sign * low, sign * high))
    here = [spot for spot in _spots(stiffness, multiple) if spot.low < high and spot.high > low]
    ends = dict.fromkeys(f"{pick(ratio[inside]):.2f}" for pick in (np.min, np.max))
    as_soft = f"{' to '.join(ends)} times the compliance of the regime's regression"
    if any(spot.bounded for spot in here):
        return f"{where}: soft spot, {as_soft}"
    if here:
        return f"{where}: soft, {as_soft}, but up to the end of the regime"
    if np.any((ratio + margin)[inside] > multiple):
        return f"{where}: undecided, the points scatter too much; {as_soft}"
    return f"{where}: no soft spot, {as_soft}"
