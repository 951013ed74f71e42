"""Analysis of a torsion loop: stiffness, widths, losses, soft spots, and their uncertainty."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING, Literal

import numpy as np

from strainwave import arguments
from strainwave.analysis.branches import thinned
from strainwave.equality import ComparedByFields
from strainwave.files.gear_set import GearSet
from strainwave.messages import shortened
from strainwave.presentation import Pictured, Presented
from strainwave.rig.analysis.catalogue_check import CatalogueCheck, check_catalogue, rated_torque_of
from strainwave.rig.analysis.lost_motion import (
    LOST_MOTION,
    Width,
    area,
    closure,
    drift,
    is_lost_motion_cycle,
    lost_motion,
    separation,
    widest,
    widest_in_torque,
)
from strainwave.rig.analysis.regimes import NAMES, RegimeName, Segmented, cycles, part, segment
from strainwave.rig.analysis.result import Result
from strainwave.rig.analysis.stiffness import SoftSpot, Stiffness, segments_of, soft_spots, stiffness_of
from strainwave.rig.loop import Loop
from strainwave.statistics.scale import SIGNIFICANCE_SIGMA

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Definition = Literal["secant", "regression", "softest"]
DEFINITIONS: dict[Definition, str] = {
    "secant": "torque of the peak over the angle from zero torque to the peak",
    "regression": "line through all points of the regime, with errors in torque and angle",
    "softest": "slope of the softest straight stretch of the regime",
}
MAX_MISFIT = 4.0  # chi-square per degree of freedom of a regime that is one straight line
PEAK_TOLERANCE = 0.1  # of the rated torque, for the peaks of a cycle at rated torque
MIN_CLOSURE = 0.02  # of the hysteresis: a smaller closure error is not reported
MAX_LOST_MOTION = 3.0  # arcmin; makers allow 1 to 3: a cycle that turns by more is no test of lost motion
MAX_POINTS = 100_000  # of a loop; of a longer one the means of so many stretches are evaluated


@dataclass(frozen=True, eq=False)
class LoopAnalysis(ComparedByFields, Pictured):
    """Results of a loop; what it does not determine is None, and `remarks` give the reason.

    Attributes:
        loop: as it was measured; of a very long one, the means of short stretches
        cut: its branches and regimes
        stiffnesses: of each regime that was measured from zero torque to the peak, in the order of the cycle
        hysteresis: widest separation at equal torque, as the torsional stiffness article has it
        width_at_zero: separation at zero torque after the peaks of this cycle [rad]
        rated_torque: of the gear, at the loaded shaft [N.m]
        hysteresis_loss: separation at zero torque after rated torque, as catalogues have it [rad]
        lost_motion: of a cycle between plus and minus 4 % of the rated torque the whole angle, as makers measure it; of a
            larger one the mean separation there [rad]
        whole_angle: True if `lost_motion` is the whole angle of such a cycle
        torque_width: widest separation in torque at equal angle [N.m], and that angle [rad]
        area: energy lost in a cycle [J]
        closure: angle at the end of the cycle less that at its beginning [rad]
        drift: movement of the middle of the loop per cycle [rad], where it has several cycles
        soft_spots: bands softer than the rest of their regime
        catalogue: comparison with the figures of a gear set
        errors_stated: whether the loop came with errors; else these are of the scatter about straight stretches
        remarks: what a reader must know, in words

    >>> import numpy as np
    >>> import strainwave as sw
    >>> angle = np.radians([0.0, -4.5, -59.0, -54.5, 0.0])
    >>> loop = sw.rig.Loop(angle, [0.36, 0.0, -0.36, 0.0, 0.36], side="input", name="example", angle_sigma=1e-4)
    >>> found = sw.rig.analyse(loop)
    >>> print(found.stiffness_by("positive_unloading", "secant"))
    4.584 N.m/rad (4.568 to 4.6)
    >>> print(found.area)
    0.3142 J (0.314 to 0.3143)
    """

    loop: Loop
    cut: Segmented
    stiffnesses: tuple[Stiffness, ...]
    hysteresis: Width | None
    width_at_zero: Result | None
    rated_torque: float | None
    hysteresis_loss: Result | None
    lost_motion: Result | None
    torque_width: tuple[float, float] | None
    area: Result | None
    closure: Result | None
    drift: Result | None
    soft_spots: tuple[SoftSpot, ...]
    catalogue: tuple[CatalogueCheck, ...]
    errors_stated: bool
    remarks: tuple[str, ...]
    whole_angle: bool = False

    @property
    def peaks(self) -> tuple[float, float]:
        """Lowest and highest torque of the branches [N.m]."""
        branches = [each for each in (self.cut.falling, self.cut.rising) if each is not None]
        return min(each.low for each in branches), max(each.high for each in branches)

    def stiffness(self, name: RegimeName) -> Stiffness | None:
        """Stiffness of a regime; None where it was not measured from end to end."""
        return next((each for each in self.stiffnesses if each.name == name), None)

    def stiffness_by(self, name: RegimeName, definition: Definition) -> Result | None:
        """Stiffness of a regime by one definition [N.m/rad].

        Raises:
            ValueError: there is no such definition
        """
        arguments.one_of("definition", definition, DEFINITIONS)
        found = self.stiffness(name)
        if found is None:
            return None
        return {"secant": found.secant, "regression": found.regression, "softest": found.softest}[definition]

    def _headline(self) -> str:
        return f"{self.loop._headline()}, {len(self.stiffnesses)} regimes"

    def plot(self) -> Figure:
        """Return a figure of the loop."""
        return self.loop.plot()


@dataclass(frozen=True)
class LoopSummary(Presented):
    """A row in the form of the torsional stiffness article's Table 2.

    Attributes:
        position: of the flexspline in its mount [rad]
        unit: which specimen
        positive_unloading, negative_loading, negative_unloading, positive_loading: stiffness [N.m/rad]
        hysteresis: widest separation at equal torque [rad]

    >>> import numpy as np
    >>> import strainwave as sw
    >>> angle = np.radians([0.0, -4.5, -59.0, -54.5, 0.0])
    >>> loop = sw.rig.Loop(angle, [0.36, 0.0, -0.36, 0.0, 0.36], side="input", name="example", angle_sigma=1e-4)
    >>> (row,) = sw.rig.table([sw.rig.analyse(loop)])
    >>> print(row.positive_unloading)
    4.584 N.m/rad (4.568 to 4.6)
    >>> print(row.negative_loading)
    0.3785 N.m/rad (0.3784 to 0.3786)
    """

    position: float
    unit: str
    positive_unloading: Result | None
    negative_loading: Result | None
    negative_unloading: Result | None
    positive_loading: Result | None
    hysteresis: Result | None


def analyse(loop: Loop, *, gear_set: GearSet | None = None, rated_torque: float | None = None) -> LoopAnalysis:
    """Analyse a loop. Of several cycles the last complete one is analysed; `cycles` gives each as a loop of its own.

    Of a loop of more than 100 000 points, the means of as many stretches are analysed, with a remark.

    Args:
        loop: a loop, or a part of one, in the order measured
        gear_set: the gear, to compare with its catalogue figures
        rated_torque: of the gear at the loaded shaft [N.m]; that of the set if not given

    Returns:
        Stiffness of each regime [N.m/rad], widths [rad], energy lost in a cycle [J] and more, each with its interval of 95 %.

    Raises:
        ValueError: the loop cannot be one, see `segment`; or it gives energy
        TypeError: an argument is not of its kind

    >>> import numpy as np
    >>> angle = np.radians([0.0, -4.5, -59.0, -54.5, 0.0])
    >>> found = analyse(Loop(angle, [0.36, 0.0, -0.36, 0.0, 0.36], side="input", name="example", angle_sigma=1e-4))
    >>> [f"{each.secant.value:.2f}" for each in found.stiffnesses], f"{np.degrees(found.hysteresis.width.value):.1f}"
    (['4.58', '0.38', '4.58', '0.38'], '50.0')
    """
    if not isinstance(loop, Loop):
        raise TypeError(f"loop must be a Loop, not {shortened(loop)}")
    if gear_set is not None and not isinstance(gear_set, GearSet):
        raise TypeError(f"gear_set must be a GearSet, as sw.GearSet.read(...) gives it, not {shortened(gear_set)}")
    if rated_torque is not None:
        rated_torque = arguments.number("rated_torque", rated_torque, "N.m", low=0.0)
    elif gear_set is not None:
        rated_torque = rated_torque_of(gear_set, loop.side)
    loop = _shortened(loop)
    stated = bool(np.any(loop.angle_sigma > 0.0) or np.any(loop.torque_sigma > 0.0))
    cut, freedom = (segment(loop), inf) if stated else _with_scatter(loop)
    found = _analysis(loop, cut, freedom, rated_torque, stated)
    if gear_set is not None:
        checks, words = check_catalogue(cut, gear_set, found.width_at_zero, found.lost_motion, rated_torque, freedom)
        found = replace(found, catalogue=checks, remarks=(*found.remarks, *words))
    return found


def _shortened(loop: Loop) -> Loop:
    """Return a loop of at most so many points that it is evaluated in seconds; the mean of n points errs by root n less."""
    n = len(loop)
    if n <= MAX_POINTS:
        return loop
    root = np.sqrt(n / MAX_POINTS)
    angle, torque, angle_sigma, torque_sigma = thinned(
        loop.angle, loop.torque, loop.angle_sigma / root, loop.torque_sigma / root, samples=MAX_POINTS
    )
    time, temperature = (
        None if each is None else thinned(each, samples=MAX_POINTS)[0] for each in (loop.time, loop.temperature)
    )
    words = f"{n} points are evaluated as the means of {MAX_POINTS} stretches"
    return replace(
        loop, angle=angle, torque=torque, angle_sigma=angle_sigma, torque_sigma=torque_sigma, time=time,
        temperature=temperature, corrections=(*loop.corrections, words),
    )  # fmt: skip


def _with_scatter(loop: Loop) -> tuple[Segmented, float]:
    """Return the loop with the scatter about straight stretches as error of its angles, and its degrees of freedom."""
    fits = [fitted for regime in segment(loop).regimes if (fitted := segments_of(regime)) is not None and fitted.freedom > 0]
    freedom = sum(each.freedom for each in fits)
    if freedom == 0:
        return segment(loop), inf
    scatter = float(np.sqrt(sum(each.freedom * each.scatter**2 for each in fits) / freedom))
    least = 1e-9 * float(np.ptp(loop.angle))
    return segment(replace(loop, angle_sigma=np.full(len(loop), max(scatter, least)))), float(freedom)


def _analysis(loop: Loop, cut: Segmented, freedom: float, rated: float | None, stated: bool) -> LoopAnalysis:
    stiffnesses = tuple(found for each in cut.regimes if (found := stiffness_of(each, cut.loop, freedom)) is not None)
    both = (cut.falling, cut.rising)
    wide = at_zero = in_torque = lost = energy = None
    whole = False
    if cut.closed and both[0] is not None and both[1] is not None:
        falling, rising = both[0], both[1]
        energy = area(part(cut.loop, cut.cycle, loop.name), freedom)
        if energy.value < 0.0 and not energy.high >= 0.0:  # a gear without a loop has one of either sign, by chance
            raise ValueError(
                f"{loop.name}: the loop gives {-energy.value:.4g} J instead of losing energy; "
                "put its points in the order measured"
            )
        wide = widest(falling, rising, cut.loop, freedom)
        at_zero = separation(falling, rising, 0.0, cut.loop, freedom)
        in_torque = widest_in_torque(falling, rising)
        if rated is not None:
            lost, whole = lost_motion(falling, rising, rated, cut.loop, freedom), is_lost_motion_cycle(falling, rising, rated)
    analysis = LoopAnalysis(
        loop, cut, stiffnesses, wide, at_zero, rated, None, lost, in_torque, energy, closure(cut, freedom),
        _drift(loop, cut), soft_spots(stiffnesses), (), stated, (), whole,
    )  # fmt: skip
    low, high = analysis.peaks
    if rated is not None and max(abs(high - rated), abs(low + rated)) <= PEAK_TOLERANCE * rated:
        analysis = replace(analysis, hysteresis_loss=at_zero)
    return replace(analysis, remarks=(*loop.remarks, *cut.remarks, *_remarks(analysis)))


def _drift(loop: Loop, cut: Segmented) -> Result | None:
    if cut.cycles < 2:
        return None
    centres, sigmas = [], []
    for each in cycles(cut.loop):
        branches = segment(each)
        if branches.falling is not None and branches.rising is not None:
            near = [np.interp(0.0, branch.torque, branch.angle) for branch in (branches.falling, branches.rising)]
            centres.append(0.5 * float(near[0] + near[1]))
            sigmas.append(float(np.median(branches.falling.angle_sigma)) / 2.0**0.5)
    return drift(np.array(centres), max(sigmas)) if len(centres) > 1 else None


def _remarks(found: LoopAnalysis) -> Iterator[str]:
    """Yield what limits the numbers."""
    cut, loop = found.cut, found.loop
    if cut.cycles > 1:
        yield f"{cut.cycles} complete cycles: the numbers are those of the last one"
    if not cut.closed:
        yield "the cycle is not complete: it has no width, no area and no closure error"
    if not found.errors_stated:
        yield (
            "no errors were stated: intervals come from the scatter about straight stretches, and leave out what is common to "
            "all points, such as the scale of the torque"
        )
    if found.closure is not None and found.hysteresis is not None:
        yield from _of_closure(found, found.closure, found.hysteresis)
    yield from (_of_bend(each) for each in found.stiffnesses if each.misfit > MAX_MISFIT and not each.whole)
    yield from _of_catalogue(found)
    if loop.input_friction:
        yield (
            "measured at the input with the output held: friction of the wave generator is inside the loop, whose widths and "
            "area are those of gear and friction together"
        )
    elif loop.side == "input":
        yield "measured at the input with the output held; widths and area are as good as the friction taken out of it"


def _of_closure(found: LoopAnalysis, gap: Result, wide: Width) -> Iterator[str]:
    large = abs(gap.value) > MIN_CLOSURE * abs(wide.width.value)
    if not large or not (np.isnan(gap.sigma) or abs(gap.value) > SIGNIFICANCE_SIGMA * gap.sigma):
        return
    yield (
        f"the cycle ends {np.degrees(gap.value):.3g} degrees from where it began: drift, settling, or a first cycle that was "
        "not yet steady. One cycle does not separate these; the area is that of the loop closed by a straight line"
        if found.drift is None
        else f"the cycle ends {np.degrees(gap.value):.3g} degrees from where it began; the middle of the loop moves by "
        f"{np.degrees(found.drift.value):.3g} degrees per cycle"
    )


def _of_bend(stiffness: Stiffness) -> str:
    low, high = stiffness.segments.stretch(stiffness.segments.softest)
    return (
        f"{stiffness.name.replace('_', ' ')} is not one straight line, by more than its errors explain: its softest stretch "
        f"runs from {low:.3g} to {high:.3g} N.m, {100 * stiffness.share:.0f} % of its torque"
    )


def _of_catalogue(found: LoopAnalysis) -> Iterator[str]:
    rated = found.rated_torque
    if rated is None:
        if found.width_at_zero is not None:
            yield (
                "no rated torque is known (--rated-torque, in Python rated_torque): hysteresis loss and lost motion as "
                "catalogues define them cannot be stated"
            )
            yield from _of_peaks(found)
        return
    if found.hysteresis_loss is None and found.width_at_zero is not None and not found.whole_angle:
        low, high = found.peaks
        yield (
            f"the cycle ran from {low:.3g} to {high:.3g} N.m, not to the rated torque of {rated:.3g} N.m either way: its "
            "width at zero torque is not the hysteresis loss of a catalogue"
        )
    if found.lost_motion is None and found.cut.closed:
        low, high = found.peaks
        yield (
            f"the cycle from {low:.4g} to {high:.4g} N.m does not reach ±{LOST_MOTION * rated:.4g} N.m, 4 % of the rated "
            "torque, either way: no lost motion"
        )


def _of_peaks(found: LoopAnalysis) -> Iterator[str]:
    """Yield the lost motion of a cycle whose peaks are 4 % of the rated torque, if that is not known."""
    falling, rising, (low, high) = found.cut.falling, found.cut.rising, found.peaks
    assumed = 0.5 * (high - low) / LOST_MOTION
    if falling is None or rising is None or not is_lost_motion_cycle(falling, rising, assumed):
        return
    lost = lost_motion(falling, rising, assumed, found.cut.loop)
    if lost is not None and found.loop.side == "output" and 60.0 * np.degrees(lost.value) < MAX_LOST_MOTION:
        yield (
            f"if its peaks of ±{LOST_MOTION * assumed:.3g} N.m are 4 % of the rated torque, that is {assumed:.3g} N.m, the "
            f"lost motion is {60.0 * np.degrees(lost.value):.3g} arcmin"
        )


def table(analyses: Sequence[LoopAnalysis], definition: Definition = "softest") -> tuple[LoopSummary, ...]:
    """Return rows in the form of the torsional stiffness article's Table 2, one for each loop.

    The article's table is one of slopes of the softest stretch: under this reading its loops close (its erratum 4). Where a
    regime is one straight line, all three definitions agree.

    Args:
        analyses: of the loops, in the order of the rows
        definition: of the stiffness

    Returns:
        A row for each loop: its four stiffnesses [N.m/rad] and its hysteresis [rad].

    Raises:
        ValueError: there is no such definition

    >>> import numpy as np
    >>> angle = np.radians([0.0, -4.5, -59.0, -54.5, 0.0])
    >>> loop = Loop(angle, [0.36, 0.0, -0.36, 0.0, 0.36], side="input", name="example", angle_sigma=1e-4)
    >>> (row,) = table([analyse(loop)])
    >>> round(row.positive_unloading.value, 2)
    4.58
    """
    arguments.one_of("definition", definition, DEFINITIONS)
    return tuple(_row(each, [each.stiffness_by(name, definition) for name in NAMES]) for each in analyses)


def _row(analysis: LoopAnalysis, stiffnesses: Sequence[Result | None]) -> LoopSummary:
    down, soft_down, up, soft_up = stiffnesses
    width = None if analysis.hysteresis is None else analysis.hysteresis.width
    return LoopSummary(analysis.loop.position, analysis.loop.unit, down, soft_down, up, soft_up, width)
