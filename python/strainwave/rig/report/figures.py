"""The figures of a torsion test's report, drawn from what was found."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strainwave.drawing import marks
from strainwave.drawing.style import FIGURE_WIDTH, LIGHT
from strainwave.report.figures import inline
from strainwave.rig.analysis.analysis import LoopAnalysis
from strainwave.rig.analysis.comparison import Comparison
from strainwave.rig.analysis.lost_motion import LOST_MOTION
from strainwave.rig.analysis.regimes import NAMES, Regime
from strainwave.rig.analysis.result import student
from strainwave.rig.analysis.stiffness import Stiffness
from strainwave.rig.loop import Loop
from strainwave.rig.reading.evaluation import Evaluation
from strainwave.typeset import ARCMIN_PER_DEGREE, ARCMIN_PER_RADIAN, ARCSEC_PER_DEGREE, number

if TYPE_CHECKING:
    from markupsafe import Markup
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

COLOURS = {
    "positive unloading": "measured",
    "negative loading": "model",
    "negative unloading": "held-out",
    "positive loading": "earlier",
}
FALLING = ("positive_unloading", "negative_loading")
MIN_WIDTH_DISTANCE = 0.03  # share of the peak [1]: two widths closer than this are drawn as one


def angle_unit(loop: Loop) -> tuple[str, float]:
    """Return the unit of angles of the loaded shaft as printed, and the factor to it: degrees, at the output arcminutes."""
    return ("°", degrees(1.0)) if loop.side == "input" else ("′", ARCMIN_PER_RADIAN)


def loop_figure(analysis: LoopAnalysis, label: str, name: str, ratio: float | None) -> Markup:
    """Draw a loop, its regimes coloured, an arrow for the sense of each, and its widths.

    Args:
        analysis: of the loop
        label: of the loop
        name: of the drawing, alone on its page
        ratio: of the gear, for a second scale with the angle at the output; None for none
    """
    measured, scale = analysis.loop, angle_unit(analysis.loop)[1]
    output_arcmin = ARCMIN_PER_DEGREE / ratio if ratio and measured.side == "input" else None

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        axes.axhline(0.0, color=LIGHT["muted"], linewidth=0.8)
        whole_label = "" if analysis.cut.regimes else "measured"
        axes.plot(scale * measured.angle, measured.torque, color=LIGHT["muted"], linewidth=0.7, label=whole_label)
        for regime in analysis.cut.regimes:
            _draw_regime(axes, regime, scale)
        _draw_widths(axes, analysis, scale)
        _label_angle_and_torque(axes, measured)
        if output_arcmin is not None:
            functions = (lambda x: np.asarray(x) * output_arcmin), (lambda x: np.asarray(x) / output_arcmin)
            second = axes.secondary_xaxis("top", functions=functions)
            second.set_xlabel("divided by the ratio: at the output [arcmin]", color=LIGHT["muted"])
        marks.legend(figure, axes)

    return inline(draw, (FIGURE_WIDTH, 4.9 if output_arcmin is not None else 4.2), name, label)


def _label_angle_and_torque(axes: Axes, loop: Loop) -> None:
    marks.label_axes(axes, f"torque on the {loop.side} [N·m]", "1", f"angle of the {loop.side} [{angle_unit(loop)[0]}]", "1")


def _draw_regime(axes: Axes, regime: Regime, scale: float) -> None:
    """Draw a regime in the order measured, with an arrow in its middle."""
    order = slice(None, None, -1) if regime.name in FALLING else slice(None)
    angle, torque, name = scale * regime.angle[order], regime.torque[order], regime.name.replace("_", " ")
    colour = LIGHT[COLOURS[name]]
    few = len(angle) <= marks.MAX_MARKED_SAMPLES
    axes.plot(angle, torque, color=colour, linewidth=1.3, marker="o" if few else "", markersize=2.6, label=name)
    if len(angle) < 2:
        return

    def shares(steps: Array) -> Array:
        extent = float(np.abs(steps).sum())
        return steps / extent if extent > 0.0 else steps

    way = np.concatenate(([0.0], np.cumsum(np.hypot(shares(np.diff(angle)), shares(np.diff(torque))))))
    tail, head = (
        (float(np.interp(share * way[-1], way, angle)), float(np.interp(share * way[-1], way, torque)))
        for share in (0.45, 0.55)
    )
    arrow = {"arrowstyle": "-|>", "color": colour, "mutation_scale": 13, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", xy=head, xytext=tail, arrowprops=arrow)


def _draw_widths(axes: Axes, analysis: LoopAnalysis, scale: float) -> None:
    """Draw a double arrow with a letter for each width of a loop; one for two at nearly the same torque."""
    falling, rising = analysis.cut.falling, analysis.cut.rising
    if falling is None or rising is None or analysis.hysteresis is None:
        return
    wide = analysis.hysteresis.torque
    widths = [("a", "hysteresis", wide)]
    if abs(wide) >= MIN_WIDTH_DISTANCE * max(map(abs, analysis.peaks)):
        widths.append(("b", "at zero torque", 0.0))
    if analysis.lost_motion is not None and analysis.rated_torque is not None and not analysis.whole_angle:
        level = LOST_MOTION * analysis.rated_torque
        widths += [("c", "lost motion", level), ("c", "", -level)]
    ink = LIGHT["ink"]
    arrow: dict[str, Any] = {"arrowstyle": "<|-|>", "color": ink, "linewidth": 0.9}
    arrow |= {"mutation_scale": 7, "shrinkA": 0, "shrinkB": 0}
    place: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "va": "bottom", "fontweight": "bold"}
    for row, (letter, name, torque) in enumerate(widths):
        low, high = (scale * float(np.interp(torque, branch.torque, branch.angle)) for branch in (rising, falling))
        axes.annotate("", xy=(low, torque), xytext=(high, torque), arrowprops=arrow)
        if name:  # the second arrow of one width needs no letter of its own
            share = (0.5, 0.62, 0.38)[row % 3]
            axes.annotate(letter, ((1.0 - share) * low + share * high, torque), (0.0, 2.5), color=ink, **place)
            axes.plot([], [], color=ink, linewidth=0.9, label=f"{letter}: {name}")


def stiffness_figure(analysis: LoopAnalysis, label: str, name: str) -> Markup | str:
    """Draw the local stiffness over torque: a panel for unloading, one for loading, and where the gear is soft.

    Empty if there are too few points.
    """
    known = [each for each in analysis.stiffnesses if len(each.local.torque)]
    unloading = [each for each in known if each.name.endswith("unloading")]
    panels = [panel for panel in (unloading, [each for each in known if each not in unloading]) if panel]
    if not panels:
        return ""

    def draw(figure: Figure) -> None:
        every = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for axes, panel in zip(every, panels, strict=True):
            for stiffness in panel:
                _draw_stiffness(axes, stiffness, analysis)
            _set_stiffness_axis(axes, panel)
            marks.label_axes(axes, "local stiffness [N·m/rad]", "1")
        every[-1].set_xlabel("torque [N·m]")
        _common_legend(figure, every)

    return inline(draw, (FIGURE_WIDTH, 1.2 + 1.75 * len(panels)), name, f"Local stiffness, {label}")


def _draw_stiffness(axes: Axes, stiffness: Stiffness, analysis: LoopAnalysis) -> None:
    local, name = stiffness.local, stiffness.name.replace("_", " ")
    colour, order = LIGHT[COLOURS[name]], np.argsort(local.torque, kind="stable")
    torque = local.torque[order]
    for spot in [spot for spot in analysis.soft_spots if spot.regime == stiffness.name][:1]:
        axes.axvspan(spot.low, spot.high, facecolor=colour, alpha=0.15, linewidth=0.0, label="soft spot")
    axes.fill_between(torque, local.low[order], local.high[order], color=colour, alpha=0.18, linewidth=0.0)
    axes.plot(torque, local.stiffness[order], color=colour, marker="o", markersize=2.6, label=name)
    ends, level = [float(torque[0]), float(torque[-1])], 2 * [stiffness.regression.value]
    axes.plot(ends, level, color=colour, linewidth=0.9, linestyle="--", label="regression over the regime")


def _set_stiffness_axis(axes: Axes, panel: list[Stiffness]) -> None:
    """Set the axis of the stiffness: from zero, or logarithmic if stiff and soft stretches would not both be visible."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    values = np.concatenate([each.local.stiffness for each in panel])
    values = values[np.isfinite(values) & (values > 0.0)]
    if values.size and values.max() > 5.0 * values.min():
        axes.set_yscale("log")
        axes.set_ylim(0.6 * values.min(), 1.7 * values.max())
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: number(value, 3)))
        axes.yaxis.set_minor_formatter(NullFormatter())
    elif values.size:
        axes.set_ylim(0.0, 1.3 * values.max())


def _common_legend(figure: Figure, every: Any) -> None:
    """One legend for several panels, each label once: the regimes in the order of the cycle, then what any of them has."""
    shown: dict[str, Any] = {}
    for axes in every:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            shown.setdefault(label, handle)
    labels = [each for each in COLOURS if each in shown] + [each for each in shown if each not in COLOURS]
    handles = [shown[each] for each in labels]
    drawn = figure.legend(handles, labels, loc="outside upper left", ncols=2, borderpad=0.0, columnspacing=1.2)
    for label, line in zip(labels, drawn.legend_handles, strict=True):
        if label not in COLOURS and line is not None:  # of no regime alone, and so of no regime's colour
            line.set(color=LIGHT["ink"])


def quality_figure(found: Evaluation) -> Markup | str:
    """Draw the uncertainty of the angle and the fit of both markers by photograph; a line if one gives no angle."""
    if not found.angles:
        return ""
    sigma_list, residual_list = [], []
    for angles in found.angles:
        sigmas = dict(zip((frame.name for frame in angles.useful), angles.sigma, strict=True))
        for frame in angles.frames:
            sigma_list.append(ARCSEC_PER_DEGREE * degrees(sigmas[frame.name]) if frame.name in sigmas else np.nan)
            residual_list.append([marker.residual for marker in frame.markers] if frame.markers else [np.nan, np.nan])
    sigma, residual = np.array(sigma_list), np.reshape(np.array(residual_list), (-1, 2))
    image = np.arange(1, len(sigma) + 1)

    def draw(figure: Figure) -> None:
        upper, lower = figure.subplots(2, 1, sharex=True)
        upper.plot(image, sigma, "o", color=LIGHT["measured"], markersize=2.8)
        for marker, (colour, mark) in enumerate((("measured", "o"), ("model", "s"))):
            label = f"marker {marker + 1}"
            lower.plot(image, residual[:, marker], mark, color=LIGHT[colour], markersize=2.8, label=label)
        for place, without_angle in enumerate(image[np.isnan(sigma)]):
            label = "" if place else "image of no use"
            lower.axvline(without_angle, color=LIGHT["ink"], linewidth=0.9, linestyle=":", label=label)
            upper.axvline(without_angle, color=LIGHT["ink"], linewidth=0.9, linestyle=":")
        for axes, values in ((upper, sigma), (lower, residual)):
            axes.set_ylim(0.0, 1.15 * float(np.nanmax(values, initial=1e-9)))
        marks.label_axes(upper, "standard deviation of the angle [arcsec]", "1")
        marks.label_axes(lower, "rms distance of the edge from its fit [px]", "1", "image, in the order taken", "1")
        marks.legend(figure, lower)

    return inline(draw, (FIGURE_WIDTH, 3.4), "quality", "Quality of the photographs")


def comparison_figure(found: Evaluation, compared: Comparison) -> Markup | str:
    """Draw what every loop determines: stiffness of each regime, and hysteresis, with what is each loop's own of its error."""
    unit, scale = angle_unit(found.loops[0])
    quantities = {
        f"{name.replace('_', ' ')} [N·m/rad]": (1.0, [each.stiffness_by(name, "softest") for each in found.analyses])
        for name in NAMES
    }
    widths = [None if each.hysteresis is None else each.hysteresis.width for each in found.analyses]
    quantities[f"hysteresis [{unit}]"] = scale, widths
    rows = []
    for name, (factor, results) in quantities.items():
        known = [each for each in results if each is not None]
        if len(known) == len(results):
            half_widths = student(np.inf) * np.array([factor * each.random for each in known])
            rows.append((name, np.array([factor * each.value for each in known]), half_widths))
    if not rows:
        return ""
    labels = [
        label.removeprefix("Flexspline at ").replace("Unit ", "").replace(", flexspline at ", ", ") for label in found.labels
    ]
    what = {"position": "position of the flexspline", "unit": "unit, and position of the flexspline"}[compared.by]
    style: dict[str, Any] = {"fmt": "o", "markersize": 4.0, "capsize": 4.0, "elinewidth": 1.1}

    def draw(figure: Figure) -> None:
        every = figure.subplots(len(rows), 1, sharex=True, squeeze=False)[:, 0]
        place = np.arange(len(labels))
        for axes, (name, values, half_widths) in zip(every, rows, strict=True):
            error = np.where(np.isfinite(half_widths), half_widths, 0.0)
            axes.errorbar(place, values, yerr=error, color=LIGHT["measured"], label="measured", **style)
            axes.margins(y=0.25)
            axes.axhline(float(np.mean(values)), color=LIGHT["muted"], linewidth=0.8, linestyle="--", label="mean")
            marks.label_axes(axes, name, "1")
        every[-1].set_xticks(place, labels)
        every[-1].set_xlim(-0.5, len(labels) - 0.5)
        every[-1].set_xlabel(what)

    size = (FIGURE_WIDTH, 0.6 + 0.95 * len(rows))
    return inline(draw, size, f"comparison-{compared.by}", f"Compared by {compared.by}")


def overlay_figure(found: Evaluation) -> Markup | str:
    """Draw all loops in one picture, if several are at one shaft."""
    loops = found.loops
    if len(loops) < 2 or len({loop.side for loop in loops}) > 1:
        return ""
    scale = angle_unit(loops[0])[1]
    colours, lines = list(COLOURS.values()), ("-", "--", ":", "-.")

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        axes.axhline(0.0, color=LIGHT["muted"], linewidth=0.8)
        for place, (label, loop) in enumerate(zip(found.labels, loops, strict=True)):
            colour, line = colours[place % len(colours)], lines[place // len(colours) % len(lines)]
            style: dict[str, Any] = {"color": LIGHT[colour], "linestyle": line, "linewidth": 1.1}
            marks.curve(axes, scale * loop.angle, loop.torque, label=label, **style)
        _label_angle_and_torque(axes, loops[0])
        marks.legend(figure, axes)

    return inline(draw, (FIGURE_WIDTH, 3.6), "overlay", "All loops")
