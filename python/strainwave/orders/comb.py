"""The ratio of a gear from the orders of a joint: the comb of whole multiples on which its lines lie."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, inf, log, pi, sqrt

from strainwave.orders.lines import SpectrumLine
from strainwave.presentation import Presented

STRAIN_WAVE_RATIOS = range(30, 401)  # of strain wave gears
USUAL_RATIOS = (30, 31, 50, 51, 80, 81, 100, 101, 120, 121, 160, 161)  # that makers offer, with either spline fixed
USUAL_PREFERENCE = 4.0  # logarithm of the prior odds of these over others (assumed)
MIN_LINE_ORDER = (
    2.0 * STRAIN_WAVE_RATIOS[0]
)  # per output turn: slower lines of an arm are gravity, inertia and friction of its joints
MIN_LINE_PERIODS = 20.0  # in the span of the angle: fewer are hysteresis, and friction that varies over the angle
WAVE_ORDERS = {2.0: 0.45, 4.0: 0.11, 1.0: 0.09, 3.0: 0.02, 6.0: 0.02, 8.0: 0.01}  # prior share of lines by order (assumed)
MAX_MOTOR_ORDER = 48  # pole pairs, slots and their multiples
MOTOR_SHARES = (0.15, 0.05)  # over the order: prior share of the lines of even and odd orders of the motor (assumed)
OTHER_SPLINE_SHARE = 0.5  # of a wave order, that is seen from the spline that is not fixed (as in records of robots)
ACCIDENT_SHARE = {"order": 0.35, "either": 0.75}  # prior chance that a line is not of the gear (assumed)
NO_COMB_PRIOR = 0.05  # prior probability that the lines are those of no gear (assumed)
LINE_SHIFT = 0.12  # of the resolution [1], by which a phase that changes with the speed moves a line (assumed)
SPLINE_SPLIT = 2.0  # resolutions, below which lines of both splines are one line between them
MIN_RELATIVE_EVIDENCE = 0.15  # of the strongest line [1]: weaker ones do not count for the ratio
MATCH_SIGMA = 3.0  # standard deviations, within which a line lies on a comb
MAX_CANDIDATES = 5  # that are listed
MIN_CONCLUSIVE_SHARE = 0.7  # probability of a ratio with its neighbour, from which it is concluded
MIN_NEIGHBOUR_SHARE = 0.1  # probability of the neighbour over that of a ratio, from which it is not excluded


@dataclass(frozen=True)
class RatioCandidate(Presented):
    """A ratio that the lines may come from.

    Attributes:
        ratio: its size
        share: probability among all ratios and no comb at all, under the assumptions that this module states
        matched: order of the input of each line that it explains, by order of the joint
    """

    ratio: int
    share: float
    matched: tuple[tuple[float, float], ...]


def lowest_usable(resolution: float) -> float:
    """Return the order from which a line counts for the ratio."""
    return max(MIN_LINE_ORDER, MIN_LINE_PERIODS * resolution)


def usable_lines(lines: Sequence[SpectrumLine], resolution: float) -> list[SpectrumLine]:
    """Return the lines from which a ratio may be found: of this joint, strong, and too fast for the motion of an arm.

    Lines of other joints and of time are left out. So are lines that may be those of time or of another joint, unless a line of
    this joint alone is among the others.
    """
    fast = [each for each in lines if each.kind in ("order", "either") and each.order >= lowest_usable(resolution)]
    if not any(each.kind == "order" for each in fast):
        return []
    strongest = max(each.evidence for each in fast)
    return [each for each in fast if each.evidence >= MIN_RELATIVE_EVIDENCE * strongest]


def candidates(lines: Sequence[SpectrumLine], resolution: float, highest: float) -> tuple[RatioCandidate, ...]:
    """Return the most probable ratios whose multiples the order lines of a joint are.

    The probability of a ratio follows from Bayes' rule. A line is a wave order or an order of the motor with its prior share,
    or it lies anywhere by accident. That no ratio explains the lines is one hypothesis among them. The resolution is
    1 / revolutions, in which two lines merge [1]; lines were looked for up to the highest order.
    """
    usable = usable_lines(lines, resolution)
    if not usable:
        return ()
    priors = {ratio: exp(USUAL_PREFERENCE) if ratio in USUAL_RATIOS else 1.0 for ratio in STRAIN_WAVE_RATIOS}
    whole = sum(priors.values())
    range_of_logarithms = log(max(highest, 2.0 * MIN_LINE_ORDER) / MIN_LINE_ORDER)
    scores = {}
    for ratio, prior in priors.items():
        likelihood, matched = _explained(ratio, usable, resolution, range_of_logarithms)
        scores[ratio] = (log((1.0 - NO_COMB_PRIOR) * prior / whole) + likelihood, matched)
    best = max(score for score, _ in scores.values())
    total = sum(exp(score - best) for score, _ in scores.values()) + exp(log(NO_COMB_PRIOR) - best)
    ranked = sorted(scores, key=lambda ratio: -scores[ratio][0])[:MAX_CANDIDATES]
    return tuple(RatioCandidate(ratio, exp(scores[ratio][0] - best) / total, scores[ratio][1]) for ratio in ranked)


def conclusive(ranked: Sequence[RatioCandidate]) -> tuple[int, ...]:
    """Return the ratio that the candidates determine, or two neighbours: one gear with either spline fixed; else none.

    >>> conclusive([RatioCandidate(101, 0.6, ()), RatioCandidate(100, 0.3, ()), RatioCandidate(50, 0.05, ())])
    (100, 101)
    >>> conclusive([RatioCandidate(44, 0.5, ()), RatioCandidate(22, 0.3, ())])
    ()
    """
    if not ranked:
        return ()
    best = ranked[0]
    pair = [best, *(each for each in ranked[1:] if abs(each.ratio - best.ratio) == 1)][:2]
    if len(pair) == 2 and pair[1].share < MIN_NEIGHBOUR_SHARE * best.share:
        pair.pop()
    if sum(each.share for each in pair) < MIN_CONCLUSIVE_SHARE:
        return ()
    return tuple(sorted(each.ratio for each in pair))


def _explained(
    ratio: int, lines: Sequence[SpectrumLine], resolution: float, range_of_logarithms: float
) -> tuple[float, tuple[tuple[float, float], ...]]:
    """Return the logarithm of the likelihood of a ratio over that of accident, and the order of each line that it explains."""
    total, matched = 0.0, []
    for line in lines:
        sigma = sqrt(line.order_sigma**2 + (LINE_SHIFT * resolution) ** 2)
        accident = 1.0 / (line.order * range_of_logarithms)
        density, nearest = 0.0, (inf, 0.0)
        for order, share, place in _teeth(ratio, line.order, resolution):
            off = (line.order - place) / sigma
            density += share * exp(-0.5 * off**2) / (sigma * sqrt(2.0 * pi))
            if abs(off) < MATCH_SIGMA:
                nearest = min(nearest, (abs(off), order))
        chance = ACCIDENT_SHARE[line.kind]
        total += log(chance + (1.0 - chance) * density / accident)
        if nearest[0] < MATCH_SIGMA:
            matched.append((line.order, nearest[1]))
    return total, tuple(matched)


def _teeth(ratio: int, line: float, resolution: float) -> list[tuple[float, float, float]]:
    """Return order of the input, prior share and place per output turn of the comb's lines that one line may be.

    The spline that is not fixed sees another number of turns: the gear is one of an even ratio with the circular spline fixed,
    or of the next odd one with the flexspline fixed.
    """
    usual = (ratio + 1,) if ratio % 2 == 0 else (ratio - 1,)
    teeth, others = [], usual if ratio in USUAL_RATIOS else (ratio + 1, ratio - 1)
    for order, share in WAVE_ORDERS.items():
        teeth.append((order, (1.0 - OTHER_SPLINE_SHARE) * share, order * ratio))
        for other in others:
            low, high = sorted((order * ratio, order * other))
            merged = high - low < SPLINE_SPLIT * resolution  # then one line lies anywhere between both
            place = min(max(line, low), high) if merged else order * other
            teeth.append((order, OTHER_SPLINE_SHARE * share / len(others), place))
    nearest = min(max(1, round(line / ratio)), MAX_MOTOR_ORDER)
    return [*teeth, (float(nearest), MOTOR_SHARES[nearest % 2] / nearest, float(nearest * ratio))]
