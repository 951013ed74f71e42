"""The ratio of a gear from the orders of a joint: which comb of whole ratios they stand on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, sqrt

from strainwave.orders.lines import Line

RATIOS = range(20, 401)  # of strain wave gears
USUAL = (30, 31, 50, 51, 80, 81, 100, 101, 120, 121, 160, 161)  # sizes that makers offer, with either spline fixed
USUAL_GAIN = 2.0  # logarithm of the odds by which these are preferred (assumed)
# How often an order of the input is the one that is seen: logarithm of the odds (assumed; order 2 leads in published records,
# then 1 and 4, as of documents R and A).
EXPECTED = {2.0: 0.0, 4.0: -1.5, 1.0: -2.0, 6.0: -4.0, 3.0: -4.0, 8.0: -4.5}
RELATIVE = 0.15  # of the evidence of the strongest line, below which a line is not asked
WITHIN = 3.0  # standard deviations
SHIFTED = 0.12  # of the resolution, by which a line moves whose phase changes with the speed, as near a resonance (assumed)
ACCIDENT = -3.0  # logarithm of the chance that a line lies on a comb by accident (assumed)
MISSED = -1.0  # of the odds of a ratio for a line that it does not explain (assumed)
MOST = 5  # candidates that are told


@dataclass(frozen=True)
class Candidate:
    """A ratio that the lines may come from.

    Attributes:
        ratio: its size
        share: probability among the candidates, under the assumptions that this module states
        matched: order of the input of each line that it explains, by order of the joint
    """

    ratio: int
    share: float
    matched: tuple[tuple[float, float], ...]


def candidates(lines: Sequence[Line], resolution: float) -> tuple[Candidate, ...]:
    """Ratios whose multiples 1, 2, 3, 4, 6, 8 the order lines of a joint are.

    The odds of a ratio grow with each line that lies on its comb, by the chance that it does so by accident, and fall with each
    that does not.

    Args:
        lines: of a spectrum over the joint angle
        resolution: 1 / revolutions, in which two lines merge [1]
    """
    order_lines = [each for each in lines if each.kind != "time"]
    if not order_lines:
        return ()
    strongest = max(each.evidence for each in order_lines)
    asked = [each for each in order_lines if each.evidence >= RELATIVE * strongest]
    scored = [(_score(ratio, asked, resolution), ratio) for ratio in RATIOS]
    scored = [((odds, matched), ratio) for (odds, matched), ratio in scored if matched]
    if not scored:
        return ()
    best = max(odds for (odds, _), _ in scored)
    total = sum(exp(odds - best) for (odds, _), _ in scored)
    ranked = sorted(scored, key=lambda each: -each[0][0])[:MOST]
    return tuple(Candidate(ratio, exp(odds - best) / total, tuple(matched)) for (odds, matched), ratio in ranked)


def _score(ratio: int, lines: Sequence[Line], resolution: float) -> tuple[float, list[tuple[float, float]]]:
    odds = USUAL_GAIN if ratio in USUAL else 0.0
    matched = []
    for line in lines:
        sigma = sqrt(line.order_sigma**2 + (SHIFTED * resolution) ** 2)
        fits = []
        for order, expected in EXPECTED.items():
            # with either spline fixed, and as either spline sees the wave generator
            for seen in (ratio, ratio + 1, ratio - 1):
                off = (line.order - order * seen) / sigma
                if abs(off) < WITHIN:
                    fits.append((expected - 0.5 * off**2 - (0.0 if seen == ratio else 2.0), order))
        if fits:
            gain, order = max(fits)
            odds += gain - ACCIDENT
            matched.append((line.order, order))
        else:
            odds += MISSED
    return odds, matched
