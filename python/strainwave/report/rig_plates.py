"""The figures of a torsion test's report, drawn from what was found."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees
from typing import TYPE_CHECKING

import numpy as np

from strainwave.report import rig_figures
from strainwave.report.rig_figures import DrawnComparison, DrawnRegime, DrawnWidth, StiffnessCurve
from strainwave.report.rig_setup import pictures
from strainwave.rig.analysis.analysis import LoopAnalysis
from strainwave.rig.analysis.comparison import Comparison
from strainwave.rig.analysis.lost_motion import LOST_MOTION
from strainwave.rig.analysis.regimes import NAMES
from strainwave.rig.analysis.result import Result, student
from strainwave.rig.loop import Loop
from strainwave.rig.reading.evaluation import Evaluation
from strainwave.typeset import ARCMIN_PER_DEGREE, ARCMIN_PER_RADIAN

if TYPE_CHECKING:
    from markupsafe import Markup

MIN_WIDTH_DISTANCE = 0.03  # share of the peak [1]: two widths closer than this are drawn as one
FALLING = ("positive_unloading", "negative_loading")


def angle_unit(loop: Loop) -> tuple[str, float]:
    """Return the unit of angles of the loaded shaft as printed, and the factor to it: degrees, at the output arcminutes."""
    return ("°", degrees(1.0)) if loop.side == "input" else ("′", ARCMIN_PER_RADIAN)


def _names(loop: Loop) -> tuple[str, str]:
    return f"angle of the {loop.side} [{angle_unit(loop)[0]}]", f"torque on the {loop.side} [N·m]"


def _markup(svg: str) -> Markup:
    from markupsafe import Markup

    return Markup(svg)


def loop(analysis: LoopAnalysis, label: str, name: str, ratio: float | None) -> Markup:
    """Draw a loop with its regimes and widths."""
    measured, scale = analysis.loop, angle_unit(analysis.loop)[1]
    output = ARCMIN_PER_DEGREE / ratio if ratio and measured.side == "input" else None
    whole = scale * measured.angle, measured.torque
    return _markup(
        rig_figures.loop_figure(
            whole, list(_branches(analysis, scale)), list(_widths(analysis, scale)), _names(measured), output, name, label
        )
    )


def _branches(analysis: LoopAnalysis, scale: float) -> Iterator[DrawnRegime]:
    for regime in analysis.cut.regimes:
        order = slice(None, None, -1) if regime.name in FALLING else slice(None)
        yield DrawnRegime(regime.name.replace("_", " "), scale * regime.angle[order], regime.torque[order])


def _widths(analysis: LoopAnalysis, scale: float) -> Iterator[DrawnWidth]:
    """Return the widths of a loop; two at nearly the same torque as one."""
    falling, rising = analysis.cut.falling, analysis.cut.rising
    if falling is None or rising is None or analysis.hysteresis is None:
        return
    wide = analysis.hysteresis.torque
    at = [("a", "hysteresis", wide)]
    if abs(wide) >= MIN_WIDTH_DISTANCE * max(map(abs, analysis.peaks)):
        at.append(("b", "at zero torque", 0.0))
    if analysis.lost_motion is not None and analysis.rated_torque is not None and not analysis.whole_angle:
        level = LOST_MOTION * analysis.rated_torque
        at += [("c", "lost motion", level), ("c", "", -level)]
    for letter, words, torque in at:
        ends = [scale * float(np.interp(torque, branch.torque, branch.angle)) for branch in (rising, falling)]
        yield DrawnWidth(letter, words, (ends[0], ends[1]), torque)


def stiffness(analysis: LoopAnalysis, label: str, name: str) -> Markup:
    """Local stiffness of each regime over the torque, with its soft spots; nothing where there are too few points."""
    curves = [
        StiffnessCurve(
            each.name.replace("_", " "),
            each.local.torque,
            each.local.stiffness,
            each.local.low,
            each.local.high,
            each.regression.value,
            next(((spot.low, spot.high) for spot in analysis.soft_spots if spot.regime == each.name), None),
        )
        for each in analysis.stiffnesses
        if len(each.local.torque)
    ]
    return _markup(rig_figures.stiffness_figure(curves, name, f"Local stiffness, {label}") if curves else "")


def overlay(found: Evaluation) -> Markup:
    """Draw all loops in one picture, if several are at one shaft."""
    loops = found.loops
    if len(loops) < 2 or len({loop.side for loop in loops}) > 1:
        return _markup("")
    scale = angle_unit(loops[0])[1]
    drawn = {label: (scale * loop.angle, loop.torque) for label, loop in zip(found.labels, loops, strict=True)}
    return _markup(rig_figures.overlay_figure(drawn, _names(loops[0]), "overlay", "All loops"))


def quality(found: Evaluation) -> Markup:
    """Uncertainty of the angle and fit of the markers, photograph by photograph."""
    if not found.angles:
        return _markup("")
    return _markup(rig_figures.quality_figure(pictures(found.angles), "quality", "Quality of the photographs"))


def comparison(found: Evaluation, compared: Comparison) -> Markup:
    """Stiffness of each regime, and the hysteresis, loop by loop, with what is each loop's own of its uncertainty."""
    unit, scale = angle_unit(found.loops[0])
    rows = []
    for name in NAMES:
        results = [each.stiffness_by(name, "softest") for each in found.analyses]
        rows += _row(f"{name.replace('_', ' ')} [N·m/rad]", results, 1.0)
    rows += _row(
        f"hysteresis [{unit}]", [None if each.hysteresis is None else each.hysteresis.width for each in found.analyses], scale
    )
    if not rows:
        return _markup("")
    labels = [
        label.removeprefix("Flexspline at ").replace("Unit ", "").replace(", flexspline at ", ", ") for label in found.labels
    ]
    what = {"position": "position of the flexspline", "unit": "unit, and position of the flexspline"}[compared.by]
    return _markup(rig_figures.comparison_figure(rows, labels, what, f"comparison-{compared.by}", f"Compared by {compared.by}"))


def _row(name: str, results: list[Result | None], scale: float) -> list[DrawnComparison]:
    known = [each for each in results if each is not None]
    if len(known) < len(results):
        return []
    values = np.array([scale * each.value for each in known])
    return [DrawnComparison(name, values, student(np.inf) * np.array([scale * each.random for each in known]))]
