"""Figures of what influences a torsion loop."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strainwave.drawing import marks
from strainwave.drawing.style import FIGURE_WIDTH, LIGHT
from strainwave.report import figures
from strainwave.report.influence_claims import by_size
from strainwave.rig.influence.cycle import Cycle
from strainwave.rig.influence.influence import CatalogueRow, Sweep
from strainwave.rig.influence.series import FACTORS, QUANTITIES, Series
from strainwave.rig.influence.trend import Trend
from strainwave.typeset import ARCMIN_PER_RADIAN, ZERO_CELSIUS, quantity
from strainwave.typeset import unit as typeset_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

MAX_WIDTH_IN_ARCMIN = 0.02  # rad: wider loops are drawn in degrees, narrower ones in minutes of arc
LAW_POINTS = 100  # of the line of a law
MARKS = (("measured", "o"), ("model", "s"), ("held-out", "^"), ("earlier", "D"), ("ink", "v"), ("muted", "P"))


def loops_figure(loops: Sequence[Cycle], name: str) -> str:
    """Loops of several torques, the largest behind."""
    angle, unit = _angles(max(float(np.ptp(each.angle)) for each in loops))
    shades = np.linspace(0.35, 1.0, len(loops))

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for loop, shade in zip(reversed(loops), reversed(shades), strict=True):
            label = quantity(loop.peak, "N.m", 3)
            axes.plot(angle * loop.angle, loop.torque, color=LIGHT["model"], alpha=float(shade), label=label)
        where = "output" if loops[0].side == "output" else "input"
        marks.label_axes(axes, f"torque on the {where}", "N.m", f"angle of the {where} [{unit}]", "1")
        marks.legend(figure, axes)

    return figures.inline(draw, (FIGURE_WIDTH, 3.4), name, "Torsion loops of several torques")


def _angles(largest: float) -> tuple[float, str]:
    return (degrees(1.0), "°") if largest > MAX_WIDTH_IN_ARCMIN else (ARCMIN_PER_RADIAN, "′")


def amplitude_figure(sweep: Sweep, name: str) -> str:
    """Area, width and slopes over the torque level."""
    from matplotlib.ticker import LogLocator

    angle, unit = _angles(float(sweep["width"].max()))

    def draw(figure: Figure) -> None:
        area, width, slopes = figure.subplots(3, 1, sharex=True)
        lost = sweep["area"] > 0.0
        area.set_yscale("log")
        area.plot(sweep.levels[lost], sweep["area"][lost], color=LIGHT["model"], marker="o")
        width.plot(sweep.levels, angle * sweep["width"], color=LIGHT["model"], marker="o", label="widest")
        for figure_name, style, words in (
            ("high_stiffness", {"color": LIGHT["measured"], "marker": "^"}, "unloading"),
            ("low_stiffness", {"color": LIGHT["held-out"], "marker": "v"}, "loading"),
            ("stiffness", {"color": LIGHT["ink"], "linestyle": "--"}, "peak to peak"),
        ):
            slopes.plot(sweep.levels, sweep[figure_name], label=words, **style)
        slopes.set_ylim(bottom=0.0)
        area.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        area.minorticks_off()
        slopes.set_xscale("log")
        slopes.minorticks_off()
        marks.label_axes(area, "area", "J")
        marks.label_axes(width, f"width at equal torque [{unit}]", "1")
        marks.label_axes(slopes, "stiffness", "N.m/rad", "largest torque", "N.m")
        marks.legend(figure, slopes)

    return figures.inline(draw, (FIGURE_WIDTH, 5.4), name, "Area, width and stiffness of loops over their largest torque")


def ratio_figure(rows: tuple[CatalogueRow, ...]) -> str:
    """First stiffness over the ratio, by size: at the output, and as the input sees it."""

    def draw(figure: Figure) -> None:
        output, input_ = figure.subplots(2, 1, sharex=True)
        for (size, sized), (colour, mark) in zip(list(by_size(rows).items())[::2], MARKS, strict=False):
            ratios = np.array([row.ratio for row in sized], float)
            stiffness = np.array([row.k1 for row in sized])
            style: dict[str, Any] = {"color": LIGHT[colour], "marker": mark, "label": f"size {size}"}
            output.loglog(ratios, stiffness, **style)
            input_.loglog(ratios, stiffness / ratios**2, **style)
        for axes in (output, input_):
            axes.set_xticks([30, 50, 80, 100, 160], ["30", "50", "80", "100", "160"])
            axes.minorticks_off()
        marks.label_axes(output, "K₁ at the output", "N.m/rad")
        marks.label_axes(input_, "K₁/i², as the input sees it", "N.m/rad")
        input_.set_xlabel("ratio")
        marks.legend(figure, output)

    return figures.inline(draw, (FIGURE_WIDTH, 4.4), "ratio", "First stiffness of catalogue gears over the ratio, by size")


def preload_figure(sweep: Sweep, peak: float, friction: float) -> str:
    """Area and width of the loop at the input over the friction there, and what a linear spring would have."""
    angle, unit = _angles(float(sweep["width"].max()))

    def draw(figure: Figure) -> None:
        area, width = figure.subplots(2, 1, sharex=True)
        area.plot(sweep.levels, sweep["area"], color=LIGHT["model"], marker="o")
        width.plot(sweep.levels, angle * sweep["width"], color=LIGHT["model"], marker="o")
        marks.label_axes(area, "area", "J")
        marks.label_axes(width, f"width at equal torque [{unit}]", "1")
        width.set_xlabel(f"friction at the input over {quantity(friction, 'N.m')}; the torque is {quantity(peak, 'N.m')}")
        for axes in (area, width):
            axes.set_ylim(bottom=0.0)

    return figures.inline(draw, (FIGURE_WIDTH, 3.6), "preload", "Area and width of the loop over the friction at the input")


def temperature_figure(sweep: Sweep) -> str:
    """Area and slopes of the loop at the input over the temperature."""
    celsius = sweep.levels - ZERO_CELSIUS

    def draw(figure: Figure) -> None:
        area, slopes = figure.subplots(2, 1, sharex=True)
        area.plot(celsius, sweep["area"], color=LIGHT["model"], marker="o")
        slopes.plot(celsius, sweep["high_stiffness"], color=LIGHT["measured"], marker="^", label="unloading")
        slopes.plot(celsius, sweep["low_stiffness"], color=LIGHT["held-out"], marker="v", label="loading")
        marks.label_axes(area, "area", "J")
        marks.label_axes(slopes, "slope", "N.m/rad")
        slopes.set_xlabel("temperature [°C]")
        for axes in (area, slopes):
            axes.set_ylim(bottom=0.0)
        marks.legend(figure, slopes)

    return figures.inline(draw, (FIGURE_WIDTH, 3.8), "temperature", "Area and slopes of the loop over the temperature")


def series_figure(series: Series, trends: Sequence[Trend], factor: str) -> str:
    """Each measured quantity over a factor, what the other factors did to it taken out, with its trend."""
    x, quantities = series.factors[factor], {name: _alone(series, trends, factor, name) for name in series.quantities}
    shown = x - ZERO_CELSIUS if factor == "temperature" else x
    units = list(dict.fromkeys(series.units))

    def draw(figure: Figure) -> None:
        panels = np.atleast_1d(figure.subplots(len(quantities), 1, sharex=True))
        for axes, (name, values) in zip(panels, quantities.items(), strict=True):
            for unit, (colour, mark) in zip(units, MARKS * len(units), strict=False):
                chosen = np.array([each == unit for each in series.units])
                label = unit or "measured"
                axes.plot(shown[chosen], values[chosen], color=LIGHT[colour], marker=mark, linestyle="", label=label)
            _line(axes, _trend(trends, factor, name), x, shown, values)
            marks.label_axes(axes, QUANTITIES[name][0], QUANTITIES[name][1] or "1")
        unit = "degC" if factor == "temperature" else FACTORS[factor].unit
        panels[-1].set_xlabel(f"{FACTORS[factor].words} {_in_brackets(unit)}".strip())
        marks.legend(figure, panels[0])

    size = (FIGURE_WIDTH, 1.0 + 1.5 * len(quantities))
    return figures.inline(draw, size, f"series-{factor}", f"Measured quantities over {FACTORS[factor].words}")


def _trend(trends: Sequence[Trend], factor: str, name: str) -> Trend:
    return next(each for each in trends if (each.factor, each.quantity) == (factor, name))


def _moved(trend: Trend, to: Array, about: Array) -> Array:
    """Return the change of a quantity, or of its logarithm, by a trend as its factor moves away from the middle of `about`."""
    there, middle = (np.log(to), np.log(about).mean()) if trend.law == "power" else (to, about.mean())
    slope = trend.slope.value if np.isfinite(trend.slope.value) else 0.0
    return np.asarray(slope * (there - middle))


def _alone(series: Series, trends: Sequence[Trend], factor: str, name: str) -> Array:
    """A quantity as it would be with the other factors at their means."""
    values = series.quantities[name]
    others = [_trend(trends, other, name) for other in series.varied if other != factor]
    effect = sum(
        (_moved(each, series.factors[each.factor], series.factors[each.factor]) for each in others), np.zeros(len(values))
    )
    linear = any(each.law == "linear" for each in others)
    return values - effect if linear else values * np.exp(-effect)


def _in_brackets(unit: str) -> str:
    return {"": "", "1": "", "degC": "[°C]"}.get(unit, f"[{typeset_unit(unit)}]")


def _line(axes: Axes, trend: Trend, x: Array, shown: Array, values: Array) -> None:
    """The trend through the middle of the points."""
    if not np.isfinite(trend.slope.value):
        return
    reach = np.linspace(x.min(), x.max(), LAW_POINTS)
    effect = _moved(trend, reach, x)
    line = values.mean() + effect if trend.law == "linear" else np.exp(np.log(values).mean() + effect)
    axes.plot(reach + (shown[0] - x[0]), line, color=LIGHT["ink"], linestyle="-" if trend.significant else ":")
