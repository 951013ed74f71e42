r"""Ball counts and diameters of a bearing that explain orders of the wave generator's shaft.

The inner ring of the bearing in a wave generator is the lobes. With z balls, :math:`\gamma = d \cos\alpha / D` and an outer ring
that turns by r per revolution of the input, the balls go round by

.. math:: c = \tfrac{1}{2} [1 - \gamma + r (1 + \gamma)]

(RandallAntoni2011, eqs. (1) to (4)). They pass a lobe h z (1 - c) times per revolution, h = 1, 2, …; two equal lobes leave even
h z alone, as odd ones cancel. Balls that differ make the multiples of c where the sensor stands and of 1 - c where it goes with the
lobes; a fault of the outer ring makes h z (c - r). One such order leaves z and γ both; two different kinds determine them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import arguments
from strainwave.messages import listed
from strainwave.presentation import Presented, Row
from strainwave.typeset import number, uncertain

Array = NDArray[np.float64]

BALL_COUNTS = range(7, 61)  # of the bearing of a wave generator (assumed)
DIAMETER_RATIOS = (0.05, 0.35)  # d cos(alpha) / D of a ball bearing (assumed)
MAX_HARMONICS = {"lobes": 4, "cage against the lobes": 2, "cage": 2, "outer ring": 3}
MAX_SIGMAS = 2.5  # standard deviations by which an order may lie beside its cause
MAX_LISTED = 6  # candidates in words


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
        candidates: all that explain as many orders, fewest balls first
        balls: their number, if all candidates have the same and two kinds of order determine it; else None
        orders: that were to be explained [1]
        unexplained: those that no candidate explains [1]
        remarks: what is not separated, and what would separate it
    """

    candidates: tuple[BearingCandidate, ...]
    balls: int | None
    orders: tuple[float, ...]
    unexplained: tuple[float, ...]
    remarks: tuple[str, ...]

    def _headline(self) -> str:
        orders = f"orders {listed([number(q, 5) for q in self.orders])}"
        if not self.candidates:
            return f"no ball bearing of {BALL_COUNTS[0]} to {BALL_COUNTS[-1]} balls explains {orders}"
        each = [f"{c.balls} balls, d cos α / D {uncertain(c.diameter_ratio, c.diameter_ratio_sigma)}" for c in self.candidates]
        more = f", or {len(each) - MAX_LISTED} more" if len(each) > MAX_LISTED else ""
        return f"{orders}: {'; or '.join(each[:MAX_LISTED])}{more}"

    def _rows(self) -> Iterator[Row]:
        for each in self.candidates:
            causes = "; ".join(f"{number(order, 5)}: {cause}" for order, cause in each.causes)
            yield Row(f"{each.balls} balls", each.diameter_ratio, "1", each.diameter_ratio_sigma, causes)


def bearing_candidates(orders: ArrayLike, sigma: ArrayLike, *, outer_speed: float = 0.0) -> BearingCandidates:
    """Return the ball counts and diameter ratios that explain orders of the shaft of a wave generator.

    Every bearing of 7 to 60 balls and 0.05 to 0.35 = d cos(alpha) / D is tried. Those that explain the most orders are listed:
    one kind of order leaves many.

    Args:
        orders: that are no multiples of those of wave generator and teeth [1], shape (n,)
        sigma: their standard deviations [1], shape (n,)
        outer_speed: speed of the outer ring over that of the inner one [1], as in `bearing_orders`

    Raises:
        TypeError: an argument is not of its kind
        ValueError: an order or a standard deviation is not positive, or their numbers differ

    >>> import strainwave as sw
    >>> geometry = sw.orders.bearing_orders(balls=24, ball_diameter=5.0, pitch_diameter=44.0)
    >>> found = sw.orders.bearing_candidates([24 * (1 - geometry.cage), 1 - geometry.cage], [1e-4, 1e-4])
    >>> found.balls, [(each.balls, round(each.diameter_ratio, 3)) for each in found.candidates]
    (24, [(24, 0.114)])
    >>> found = sw.orders.bearing_candidates([24 * (1 - geometry.cage)], [1e-4])
    >>> found.balls, [(each.balls, round(each.diameter_ratio, 3)) for each in found.candidates][:2]
    (None, [(11, 0.215), (20, 0.336)])
    """
    wanted, spread = (arguments.positive_series(name, values) for name, values in (("orders", orders), ("sigma", sigma)))
    if len(wanted) != len(spread):
        raise ValueError(f"{len(wanted)} orders have {len(spread)} standard deviations; give one for each")
    outer_speed = arguments.number("outer_speed", outer_speed, low=-0.5, high=0.5)
    tried = [each for balls in BALL_COUNTS for each in _of_count(balls, wanted, spread, outer_speed)]
    most = max((len(each.causes) for each in tried), default=0)
    best = tuple(each for each in tried if len(each.causes) == most)
    explained = {order for each in best for order, _ in each.causes}
    counts, kinds = {each.balls for each in best}, [{cause.split(",")[0] for _, cause in each.causes} for each in best]
    balls = counts.pop() if len(counts) == 1 and min(map(len, kinds)) > 1 else None
    unexplained = tuple(order for order in wanted.tolist() if order not in explained)
    return BearingCandidates(best, balls, tuple(wanted.tolist()), unexplained, tuple(_remarks(best, balls, kinds, unexplained)))


def _of_count(balls: int, orders: Array, sigma: Array, outer: float) -> Iterator[BearingCandidate]:
    """Yield the bearings with so many balls that explain the most orders, each with its own diameter ratio."""
    causes = list(_causes(balls, outer))
    fundamental = {name.split(",")[0]: name for name, _, _ in reversed(causes)}
    found: list[tuple[float, float, list[tuple[float, str]]]] = []
    for (place, order), (_, constant, slope) in product(enumerate(orders.tolist()), causes):
        ratio, reach = (order - constant) / slope, float(sigma[place]) / abs(slope)
        if not DIAMETER_RATIOS[0] <= ratio <= DIAMETER_RATIOS[1]:
            continue
        matched, weights = [], []
        for other, spread in zip(orders.tolist(), sigma.tolist(), strict=True):
            near = [(abs(other - c - s * ratio) / np.hypot(spread, reach * abs(s)), name, c, s) for name, c, s in causes]
            lag, name, c, s = min(near)
            if lag < MAX_SIGMAS:
                matched.append((other, name))
                weights.append(((other - c) / s, (s / spread) ** 2))
        names = {name for _, name in matched}
        complete = {name.split(",")[0] for name in names if fundamental[name.split(",")[0]] in names}
        kept_of = [k for k, (_, name) in enumerate(matched) if name.split(",")[0] in complete]
        if not kept_of:
            continue
        matched, weights = [matched[k] for k in kept_of], [weights[k] for k in kept_of]
        total = sum(weight for _, weight in weights)
        mean = sum(value * weight for value, weight in weights) / total
        found.append((mean, total**-0.5, matched))
    most = max((len(matched) for _, _, matched in found), default=0)
    kept: list[tuple[float, float]] = []
    for mean, spread, matched in found:
        if len(matched) == most and not any(abs(mean - other) < MAX_SIGMAS * np.hypot(spread, of) for other, of in kept):
            kept.append((mean, spread))
            yield BearingCandidate(balls, mean, spread, tuple(matched))


def _causes(balls: int, outer: float) -> Iterator[tuple[str, float, float]]:
    """Yield name, and constant and slope over the diameter ratio, of each order of a bearing."""
    cage = 0.5 * (1.0 + outer), 0.5 * (outer - 1.0)
    passing = 1.0 - cage[0], -cage[1]
    bases = {
        "lobes": (balls * passing[0], balls * passing[1]),
        "cage against the lobes": passing,
        "cage": cage,
        "outer ring": (balls * (cage[0] - outer), balls * cage[1]),
    }
    for name, (constant, slope) in bases.items():
        for harmonic in range(1, MAX_HARMONICS[name] + 1):
            if name == "lobes" and harmonic * balls % 2:
                continue
            times = "" if harmonic == 1 else f", {harmonic} times"
            yield f"{name}{times}", harmonic * constant, harmonic * slope


def _remarks(
    best: tuple[BearingCandidate, ...], balls: int | None, kinds: list[set[str]], unexplained: tuple[float, ...]
) -> Iterator[str]:
    if best and balls is None:
        counts = sorted({each.balls for each in best})
        why = (
            "the orders are of one kind"
            if max(map(len, kinds)) == 1
            else "several bearings explain them within their resolution"
        )
        yield (
            f"{len(counts)} counts of balls are not separable, {counts[0]} to {counts[-1]}: {why}; count the balls, or measure the "
            "order of the cage over more revolutions"
        )
        yield "lobes that differ, or an odd count that they pass once, have not been tried: equal lobes leave even multiples"
    if unexplained:
        yield f"orders {listed([number(order, 5) for order in unexplained])} are not explained by these bearings"


__all__ = ["BearingCandidate", "BearingCandidates", "bearing_candidates"]
