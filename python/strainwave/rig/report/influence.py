"""The page of the influences on the loops of a measured series, and the same in lines for a terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strainwave.drawing import marks
from strainwave.drawing.style import FIGURE_WIDTH, LIGHT
from strainwave.report import figures
from strainwave.report.page import render
from strainwave.report.provenance import Provenance
from strainwave.rig.influence.series import FACTORS, QUANTITIES, Series, bent_words, chance, change_of, trend_words
from strainwave.rig.influence.trend import SHUFFLE_COUNT, Trend
from strainwave.typeset import ZERO_CELSIUS, unit as typeset_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LETTERS_PER_LINE = 110  # on a terminal
Array = NDArray[np.float64]

LAW_POINTS = 100  # of the line of a law
MARKS = (("measured", "o"), ("model", "s"), ("held-out", "^"), ("earlier", "D"), ("ink", "v"), ("muted", "P"))


def influence_report(series: Series, trends: Sequence[Trend], provenance: Provenance | None = None) -> str:
    """Return the page, as one HTML file that needs nothing else.

    Args:
        series: what was measured
        trends: of it, as `analyse_series` returns them
        provenance: how the page came to be, if that is to be shown

    Returns:
        HTML; the same for the same arguments
    """
    return render(
        "influence.html.jinja",
        {
            "title": series.name,
            "points": len(series),
            "figures": [series_figure(series, trends, name) for name in FACTORS if name in series.varied],
            "sentences": [trend_words(each) for each in trends],
            "trends": [_row(each) for each in trends],
            "shuffles": SHUFFLE_COUNT,
        },
        provenance,
        "strainwave.rig.report",
    )


def summary(series: Series, trends: Sequence[Trend]) -> str:
    """Return the trends as lines of text, a sentence for each."""
    lines = [f"{series.name}, {len(series)} loops"]
    for each in trends:
        lines += textwrap.wrap(trend_words(each), LETTERS_PER_LINE, initial_indent="  ", subsequent_indent="    ")
    return "\n".join(lines)


def _row(trend: Trend) -> dict[str, Any]:
    return {
        "quantity": QUANTITIES[trend.quantity][0],
        "factor": FACTORS[trend.factor].words,
        "words": f"{change_of(trend)}{bent_words(trend)}" if isfinite(trend.slope.value) else trend_words(trend),
        "p": chance(trend.slope.p).removeprefix("= "),
        "corrected": chance(trend.corrected).removeprefix("= "),
        "shuffled": chance(trend.shuffled).removeprefix("= "),
        "significant": "significant" if trend.significant else "not significant",
    }


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
