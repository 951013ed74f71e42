"""Stiffness of a regime by three definitions and along the torque, and its soft spots."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import hypot, inf

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import arguments
from strainwave.equality import ComparedByFields
from strainwave.presentation import Presented, Statement
from strainwave.rig.analysis.lines import Segments, fit_line, fit_segments
from strainwave.rig.analysis.regimes import Regime, RegimeName
from strainwave.rig.analysis.result import Result, inverse, result, student
from strainwave.rig.loop import Loop
from strainwave.statistics.runs import runs_of

Array = NDArray[np.float64]

LOCAL_SLOPE_WINDOW = 0.1  # share of the torque of a regime within which points determine a local slope [1]
MAX_LOCAL_SLOPES = 400  # along a regime
MIN_COMPLIANCE = 1e-30  # rad/(N.m): rounding; nothing is stiffer, and the square is still a number
UNIT, COMPLIANCE = "N.m/rad", "rad/(N.m)"
SOFT_COMPLIANCE_RATIO = 1.5  # a soft spot has more than this times the compliance of the regime's regression [1]
CONFIDENCE_LEVEL = 0.95  # probability that a regime without a soft spot shows none [1]


@dataclass(frozen=True, eq=False)
class LocalStiffness(ComparedByFields):
    """Slope of short stretches along a regime.

    Attributes:
        torque: in the middle of each stretch [N.m], shape (m,), ascending
        compliance: [rad/(N.m)], shape (m,)
        sigma: its standard deviation, shared errors left out [rad/(N.m)], shape (m,)
        width: torque over which each slope was taken [N.m], shape (m,)
    """

    torque: Array
    compliance: Array
    sigma: Array
    width: Array

    @property
    def stiffness(self) -> Array:
        """[N.m/rad], shape (m,); infinite where the angle does not grow."""
        return _inverse(self.compliance)

    @property
    def low(self) -> Array:
        """Lower end of the 95 % band of each stiffness [N.m/rad], shape (m,)."""
        return _inverse(self.compliance + student(np.inf) * self.sigma)

    @property
    def high(self) -> Array:
        """Upper end of the 95 % band of each stiffness [N.m/rad], shape (m,); infinite where the angle may not grow."""
        return _inverse(self.compliance - student(np.inf) * self.sigma)


@dataclass(frozen=True, eq=False)
class Stiffness(ComparedByFields, Presented):
    """Stiffness of a regime by three definitions, which agree if its points lie on one straight line.

    Attributes:
        name: of the regime
        secant: torque of the peak over the angle from zero torque to the peak [N.m/rad]; None where zero was not passed
        regression: slope of the line of greatest likelihood through all its points [N.m/rad]
        softest: slope of its softest straight stretch [N.m/rad]
        stretch: where this one begins and ends [N.m]; without an error where it is the end of the regime
        segments: all its straight stretches
        local: its course along the torque
        misfit: chi-square of the regression per degree of freedom [1]: near 1 where one line is enough
        bend: largest distance of a point from the line, as angle [rad]
    """

    name: RegimeName
    secant: Result | None
    regression: Result
    softest: Result
    stretch: tuple[Result, Result]
    segments: Segments
    local: LocalStiffness
    misfit: float
    bend: float

    @property
    def whole(self) -> bool:
        """True if the softest stretch is the whole regime."""
        return len(self.segments.knees) == 0

    @property
    def share(self) -> float:
        """Share of the regime's torque that the softest stretch covers [1]."""
        low, high = self.segments.stretch(self.segments.softest)
        return (high - low) / (self.segments.high - self.segments.low)


def stiffness_of(regime: Regime, loop: Loop, freedom: float = np.inf) -> Stiffness | None:
    """Stiffness of a regime of a loop; None where its angle does not change, or fewer than two points were measured.

    Args:
        regime: the quarter
        loop: the loop it is of, for what its points share
        freedom: degrees of freedom of the errors, where these were taken from scatter
    """
    segments = segments_of(regime)
    if segments is None:
        return None
    torque, angle, angle_sigma, torque_sigma = _columns(regime)
    line = fit_line(angle, torque, angle_sigma, torque_sigma)
    regression = _stiffness_result(line.slope, line.sigma, loop, freedom, by_angle=line.share_x > 0.5)
    low, high = segments.stretch(segments.softest)
    return Stiffness(
        regime.name,
        _secant(regime, loop, freedom) if regime.from_zero else None,
        regression,
        _softest(segments, loop, freedom),
        (_end(segments, low, loop), _end(segments, high, loop)),
        segments,
        local_stiffness(torque, angle, angle_sigma, torque_sigma),
        line.misfit,
        line.bend / abs(line.slope),
    )


def segments_of(regime: Regime) -> Segments | None:
    """Straight stretches of a regime; None where its angle does not change, or fewer than two points were measured."""
    torque, angle, angle_sigma, torque_sigma = _columns(regime)
    if len(torque) < 2 or np.ptp(angle) == 0.0 or np.ptp(torque) == 0.0:
        return None
    return fit_segments(torque, angle, angle_sigma, torque_sigma)


def _columns(regime: Regime) -> tuple[Array, Array, Array, Array]:
    """Torque, angle and their errors of what was measured, ascending; points of one torque stay in the order measured."""
    rows = regime.measured
    torque = regime.torque[rows]
    order = np.argsort(torque, kind="stable")
    return torque[order], regime.angle[rows][order], regime.angle_sigma[rows][order], regime.torque_sigma[rows][order]


def shared(stiffness: float, loop: Loop) -> float:
    """Standard deviation of a stiffness by what all points of a loop share [N.m/rad]."""
    return abs(stiffness) * hypot(loop.angle_scale, loop.torque_scale, stiffness * loop.compliance_sigma)


def _stiffness_result(stiffness: float, random: float, loop: Loop, freedom: float, *, by_angle: bool) -> Result:
    """A stiffness; where errors of the angle make its error, it is the compliance that is spread normally."""
    of_rig = shared(stiffness, loop)
    if not by_angle or stiffness <= 0.0:
        return result(stiffness, UNIT, random=random, shared=of_rig, freedom=freedom)
    compliance = result(
        1.0 / stiffness, COMPLIANCE, random=random / stiffness**2, shared=of_rig / stiffness**2, freedom=freedom
    )
    return inverse(compliance, UNIT)


def _secant(regime: Regime, loop: Loop, freedom: float) -> Result:
    """Return the secant between the point of zero torque and the peak.

    An error of the pulleys' friction shifts the torque of all points that were reached the same way by d. While loading, that
    is all of them, and the compliance errs by (C - c) d / T, with C of the secant, c at zero torque, T of the peak. A peak
    from which the regime unloads was reached the other way, and it is (C + c) d / T.
    """
    zero, peak = (0, -1) if regime.name.startswith("positive") else (-1, 0)
    rise, turned = float(regime.torque[peak] - regime.torque[zero]), float(regime.angle[peak] - regime.angle[zero])
    compliance = turned / rise
    if abs(compliance) < MIN_COMPLIANCE:
        return result(np.inf, UNIT)
    near = 1 if zero == 0 else -2
    step = float(regime.torque[near] - regime.torque[zero])
    at_zero = float(regime.angle[near] - regime.angle[zero]) / step if step else compliance
    of_angle = hypot(float(regime.angle_sigma[peak]), float(regime.angle_sigma[zero]))
    of_peak = float(loop.torque_sigma[regime.rows[peak]])
    of_torque = hypot(of_peak * compliance, float(regime.torque_sigma[zero]) * at_zero)
    found = _stiffness_result(
        1.0 / compliance, hypot(of_angle, of_torque) / abs(rise) / compliance**2, loop, freedom, by_angle=True
    )
    moved = compliance + at_zero if regime.name.endswith("unloading") else compliance - at_zero
    friction = abs(moved / rise) * loop.friction_sigma
    if not friction or compliance <= 0.0:
        return found
    shared_part = hypot(found.shared * compliance**2, friction)
    random = found.random * compliance**2
    return inverse(result(compliance, COMPLIANCE, random=random, shared=shared_part, freedom=freedom), UNIT)


def _softest(segments: Segments, loop: Loop, freedom: float) -> Result:
    number = segments.softest
    compliance = float(segments.compliances[number])
    if compliance <= 0.0:
        return result(np.inf, UNIT)
    random = float(segments.compliance_sigmas[number]) / compliance**2
    return _stiffness_result(1.0 / compliance, random, loop, freedom, by_angle=True)


def _end(segments: Segments, torque: float, loop: Loop) -> Result:
    """Return the end of a stretch: a knee with its error, or the end of the regime."""
    for knee in segments.knee_results:
        if knee.value == torque:
            grown = Result(torque, "N.m", knee.random, abs(torque) * loop.torque_scale, knee.low, knee.high)
            return result(torque, "N.m", random=knee.random, shared=grown.shared) if knee.low > segments.low else grown
    return result(torque, "N.m", random=0.0, shared=abs(torque) * loop.torque_scale)


def local_stiffness(torque: Array, angle: Array, angle_sigma: Array, torque_sigma: Array) -> LocalStiffness:
    """Slopes of the angle over the torque of the points within a tenth of the regime's torque, or of three points at least.

    >>> torque = np.linspace(0.0, 1.0, 5)
    >>> local_stiffness(torque, 0.5 * torque, np.full(5, 0.01), np.zeros(5)).stiffness.round(9).tolist()
    [2.0, 2.0, 2.0]
    """
    half = 0.5 * LOCAL_SLOPE_WINDOW * float(torque[-1] - torque[0])
    n, found, seen = len(torque), [], set()
    middles = torque if n <= MAX_LOCAL_SLOPES else torque[np.linspace(0, n - 1, MAX_LOCAL_SLOPES).astype(int)]
    for middle in middles.tolist():
        first, last = int(np.searchsorted(torque, middle - half)), int(np.searchsorted(torque, middle + half, "right")) - 1
        while (last - first < 2 or torque[last] - torque[first] < half) and (first > 0 or last < n - 1):
            first, last = max(first - 1, 0), min(last + 1, n - 1)
        at_end = middle in (torque[0], torque[-1])  # of a few points: the neighbour has the same slope
        if (first, last) in seen or last - first < (3 if at_end else 2) or torque[last] == torque[first]:
            continue
        seen.add((first, last))
        found.append(_slope(*(each[first : last + 1] for each in (torque, angle, angle_sigma, torque_sigma))))
    found.sort()
    columns = np.array(found).reshape(-1, 4).T
    return LocalStiffness(columns[0], columns[1], columns[2], columns[3])


def _slope(torque: Array, angle: Array, angle_sigma: Array, torque_sigma: Array) -> tuple[float, float, float, float]:
    """Mean torque, slope of the angle over it, its standard deviation, and the torque it was taken over."""
    middle = float(torque.mean())
    lever = (torque - middle) / np.sum((torque - middle) ** 2)
    slope = float(lever @ angle)
    sigma = float(np.sqrt(np.sum(lever**2 * (angle_sigma**2 + (slope * torque_sigma) ** 2))))
    return middle, slope, sigma, float(torque[-1] - torque[0])


def _inverse(compliance: Array) -> Array:
    return np.asarray(np.divide(1.0, compliance, out=np.full(len(compliance), np.inf), where=compliance > 0.0))


def closure_of_secants(stiffnesses: ArrayLike, torque: float) -> float:
    """Return the closing error of a cycle [rad] whose quarters, from zero to the peak, have these secants.

    Args:
        stiffnesses: of positive unloading, negative loading, negative unloading, positive loading [N.m/rad], shape (4,)
        torque: of the peaks [N.m]

    Raises:
        ValueError: there are not four of them, or one is not positive

    >>> rows = [[4.51, 0.31, 4.85, 0.30], [4.36, 0.29, 3.59, 0.33], [4.19, 0.32, 5.08, 0.33]]
    >>> [round(float(np.degrees(closure_of_secants(row, 0.36))), 2) for row in rows]
    [1.9, -7.61, -2.82]
    """
    values = arguments.numbers("stiffnesses", stiffnesses)
    if values.shape != (4,) or not np.all(values > 0.0):
        raise ValueError(f"stiffnesses = {np.asarray(values).tolist()} must be four positive numbers [N.m/rad], one a regime")
    peak = arguments.number("torque", torque, "N.m", low=0.0)
    return float(peak / values @ np.array([-1.0, -1.0, 1.0, 1.0]))


def soft_parts(stiffnesses: Sequence[float], width: float, torque: float) -> tuple[float, float]:
    """Return the torque over which the loading regimes must be soft, so that the loop closes with this width [N.m].

    The reading under which a table of four slopes and a width is one loop (its erratum 4): a loading regime is as soft as
    stated over part of its torque, and over the rest as stiff as the unloading regimes are in the mean.

    Args:
        stiffnesses: as for `closure_of_secants`
        width: of the loop at zero torque [rad]
        torque: of the peaks [N.m]

    Returns:
        the part of negative loading, and that of positive loading

    Raises:
        ValueError: there are not four stiffnesses, one of them or the torque is not positive, or a loading regime is as stiff
            as the unloading ones

    >>> [round(part, 3) for part in soft_parts([4.51, 0.31, 4.85, 0.30], float(np.radians(50.5)), 0.36)]
    [0.292, 0.283]
    """
    closure_of_secants(stiffnesses, torque)
    down, soft_down, up, soft_up = (float(each) for each in stiffnesses)
    stiff = 0.5 * (down + up)
    if max(soft_down, soft_up) >= stiff:
        raise ValueError(
            f"loading of {soft_down:g} and {soft_up:g} N.m/rad must be softer than unloading, {stiff:g} N.m/rad in the mean"
        )

    def part(soft: float, unloading: float) -> float:
        return (width - torque / stiff + torque / unloading) / (1.0 / soft - 1.0 / stiff)

    return part(soft_down, up), part(soft_up, down)


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
    bands: list[tuple[int, int]] = []
    for first, beyond in ((run.start, run.stop) for run in runs_of(soft)):
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
