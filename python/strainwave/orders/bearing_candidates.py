r"""Ball counts and diameters of a bearing that explain orders of the wave generator's shaft.

The inner ring of the bearing in a wave generator is the lobes. With :math:`\gamma = d \cos\alpha / D` and an outer ring that
turns by r per revolution of the input, each ball passes

.. math:: p = \tfrac{1}{2} (1 + \gamma) (1 - r)

times per revolution (RandallAntoni2011, eqs. (1) to (4)), and z balls pass a lobe z p times. Errors of lobes and teeth have
whole orders and multiply what the balls do: orders of a bearing are h z p + m, with h = 1, 2, … and any whole m. So an order
is known modulo 1 only. Balls that differ make every k p. A few orders within their resolution leave many bearings: all are
listed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import comb

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import arguments
from strainwave.messages import listed
from strainwave.presentation import Presented, Row
from strainwave.statistics.runs import runs_of
from strainwave.typeset import number, uncertain

Array = NDArray[np.float64]

BALL_COUNTS = range(7, 61)  # of the bearing of a wave generator (assumed)
DIAMETER_RATIOS = (0.05, 0.35)  # d cos(alpha) / D of a ball bearing (assumed)
MAX_HARMONIC = 4  # of the balls that pass a lobe
MAX_SIDEBAND = 6  # whole orders beside it
MAX_SIGMAS = 2.5  # standard deviations by which an order may lie beside its cause
STEPS_PER_SIGMA = 4.0  # of the diameter ratio that are tried, for the order that depends most on it
MAX_STEPS = 40_000
MAX_CHANCE = 0.05  # that random orders are explained as well
MAX_LISTED = 4  # candidates in words
ORDERS_PER_STRANGER = 3  # explained orders, of which one may have another cause


@dataclass(frozen=True)
class BearingCandidate:
    """A bearing that explains orders.

    Attributes:
        balls: how many there are
        diameter_ratio: d cos(alpha) / D, of ball, contact angle and pitch circle [1]
        diameter_ratio_sigma: its standard deviation [1]
        causes: each order that it explains, with its cause
    """

    balls: int
    diameter_ratio: float
    diameter_ratio_sigma: float
    causes: tuple[tuple[float, str], ...]


@dataclass(frozen=True)
class BearingCandidates(Presented):
    """Bearings that explain orders.

    Attributes:
        candidates: all that explain the most orders, or two thirds of them, fewest balls first
        balls: their number, if all candidates have the same; else None
        orders: that were to be explained [1]
        chance: probability that a bearing explains as many random orders; the number of balls is stated below 5 %
        remarks: what is not separated, and what would separate it
    """

    candidates: tuple[BearingCandidate, ...]
    balls: int | None
    orders: tuple[float, ...]
    chance: float
    remarks: tuple[str, ...]

    def _headline(self) -> str:
        orders = f"orders {listed([number(q, 5) for q in self.orders])}"
        if not self.candidates:
            return f"no ball bearing of {BALL_COUNTS[0]} to {BALL_COUNTS[-1]} balls explains {orders}"
        if self.chance > MAX_CHANCE:
            return f"{orders} determine no bearing: random orders would be explained as well"
        if len(self.candidates) > MAX_LISTED:
            counts = sorted({bearing.balls for bearing in self.candidates})
            return f"{len(self.candidates)} bearings of {counts[0]} to {counts[-1]} balls explain {orders}: not separable"
        bearings = [
            f"{c.balls} balls, d cos α / D {uncertain(c.diameter_ratio, c.diameter_ratio_sigma)}" for c in self.candidates
        ]
        return f"{orders}: {'; or '.join(bearings)}"

    def _rows(self) -> Iterator[Row]:
        for bearing in self.candidates:
            causes = "; ".join(f"{number(order, 5)}: {cause}" for order, cause in bearing.causes)
            yield Row(f"{bearing.balls} balls", bearing.diameter_ratio, "1", bearing.diameter_ratio_sigma, causes)


def bearing_candidates(orders: ArrayLike, sigma: ArrayLike, *, outer_speed: float = 0.0) -> BearingCandidates:
    """Return the ball counts and diameter ratios that explain orders of the shaft of a wave generator.

    Every bearing of 7 to 60 balls and 0.05 to 0.35 = d cos(alpha) / D is tried. Orders of 1e-3 and better are needed for few
    candidates: some hundred revolutions.

    Args:
        orders: that are no whole multiples, and no orders of the splines [1], shape (n,)
        sigma: their standard deviations [1], shape (n,)
        outer_speed: speed of the outer ring over that of the inner one [1], as in `bearing_orders`

    Raises:
        TypeError: an argument is not of its kind
        ValueError: an order or a standard deviation is not positive, or their numbers differ

    >>> import strainwave as sw
    >>> cage = sw.orders.bearing_orders(balls=23, ball_diameter=5.0, pitch_diameter=44.0).cage
    >>> one = sw.orders.bearing_candidates([23 * (1 - cage)], [1e-4])
    >>> one.balls, len(one.candidates) > 100
    (None, True)
    >>> passed = [23 * (1 - cage), 46 * (1 - cage) + 1, 7 * (1 - cage)]
    >>> three = sw.orders.bearing_candidates(passed, [1e-5, 1e-5, 1e-5])
    >>> any(bearing.balls == 23 and abs(bearing.diameter_ratio - 5.0 / 44.0) < 1e-4 for bearing in three.candidates)
    True
    """
    wanted, spread = arguments.positive_series("orders", orders), arguments.positive_series("sigma", sigma)
    if len(wanted) != len(spread):
        raise ValueError(f"sigma has {len(spread)} standard deviations for {len(wanted)} orders; give one for each")
    outer_speed = arguments.number("outer_speed", outer_speed, low=-0.5, high=0.5)
    low, high = (0.5 * (1.0 + ratio) * (1.0 - outer_speed) for ratio in DIAMETER_RATIOS)
    tried = [(balls, *_explained(balls, wanted, spread, low, high)) for balls in BALL_COUNTS]
    most = max(int(count.max()) for _, _, count in tried)
    least = most - most // ORDERS_PER_STRANGER
    best = tuple(
        _candidate(balls, passes[part], wanted, spread, outer_speed)
        for balls, passes, count in tried
        for part in runs_of(count >= max(least, 1))
    )
    counts = {bearing.balls for bearing in best}
    chance = _chance(spread, most)
    balls = counts.pop() if len(counts) == 1 and chance < MAX_CHANCE else None
    return BearingCandidates(best, balls, tuple(wanted.tolist()), chance, tuple(_remarks(best, balls, chance)))


def _chance(sigma: Array, explained: int) -> float:
    """Return the number of bearings that explain so many of as many random orders, 1 at most."""
    reach = 2.0 * MAX_SIGMAS * np.sort(sigma)[:explained]
    bearings = sum(np.ptp(DIAMETER_RATIOS) * MAX_HARMONIC * balls / float(sigma.min()) for balls in BALL_COUNTS)
    return float(min(1.0, bearings * comb(len(sigma), explained) * np.prod(np.minimum(1.0, (MAX_HARMONIC + 1) * reach))))


def _explained(balls: int, orders: Array, sigma: Array, low: float, high: float) -> tuple[Array, Array]:
    """Return passes of a ball that are tried, and how many orders each explains."""
    slope = max(MAX_HARMONIC * balls, float(orders.max()) / low)
    steps = min(int((high - low) * slope / float(sigma.min()) * STEPS_PER_SIGMA) + 2, MAX_STEPS)
    passes = np.linspace(low, high, steps)
    reach = 0.5 * (passes[1] - passes[0])
    count = np.zeros(steps)
    for order, spread in zip(orders.tolist(), sigma.tolist(), strict=True):
        lag = np.full(steps, np.inf)
        for h in range(1, MAX_HARMONIC + 1):
            beside = order - h * balls * passes
            whole = np.clip(np.round(beside), -MAX_SIDEBAND, MAX_SIDEBAND)
            lag = np.minimum(lag, np.abs(beside - whole) - reach * h * balls)
        times = np.maximum(np.round(order / passes), 1.0)
        lag = np.minimum(lag, np.abs(order - times * passes) - reach * times)
        count += lag < MAX_SIGMAS * spread
    return passes, count


def _candidate(balls: int, passes: Array, orders: Array, sigma: Array, outer: float) -> BearingCandidate:
    middle = float(0.5 * (passes[0] + passes[-1]))
    scale = 2.0 / (1.0 - outer)
    spread = max(0.5 * float(passes[-1] - passes[0]), float(sigma.min()) / balls)
    causes = tuple(_causes(balls, middle, float(np.ptp(passes)), orders, sigma))
    return BearingCandidate(balls, scale * middle - 1.0, scale * spread, causes)


def _causes(balls: int, passes: float, reach: float, orders: Array, sigma: Array) -> Iterator[tuple[float, str]]:
    """Yield each order that a bearing explains, with its simplest cause."""
    for order, spread in zip(orders.tolist(), sigma.tolist(), strict=True):
        near = []
        for h in range(1, MAX_HARMONIC + 1):
            beside = order - h * balls * passes
            whole = round(beside)
            if abs(whole) <= MAX_SIDEBAND and abs(beside - whole) < MAX_SIGMAS * spread + reach * h * balls:
                side = f" {'+' if whole > 0 else '-'} {abs(whole)}" if whole else ""
                near.append((h + abs(whole), f"{'' if h == 1 else f'{h} times '}balls past a lobe{side}"))
        times = max(round(order / passes), 1)
        if abs(order - times * passes) < MAX_SIGMAS * spread + reach * times:
            near.append((2 + times, f"{times} times a ball past a lobe"))
        if near:
            yield order, min(near)[1]


def _remarks(best: tuple[BearingCandidate, ...], balls: int | None, chance: float) -> Iterator[str]:
    if chance > MAX_CHANCE:
        yield "some bearing explains as many random orders as well, so that these show none: more orders, or more exact ones"
    if best and balls is None:
        yield (
            f"{len({bearing.balls for bearing in best})} counts of balls are not separable: count the balls, or record more "
            "revolutions, as orders are resolved to one over their number"
        )
