"""Pictures of one panel: a curve, marks, stems, histograms and bars, each of a few arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
PANEL_HEIGHT = 2.8  # inches
SIGMA_OF_95_PERCENT = 1.96
BAR_COLOURS = ("muted", "model")  # of kinds of bars, the last one the strongest
BAR_HEIGHT, MARGIN_HEIGHT = 0.34, 1.2  # inches


class Series(NamedTuple):
    """Numbers along an axis, with their name and unit."""

    name: str
    unit: str
    values: Array


def curve_figure(title: str, x: Series, y: Series, sigma: Array | None = None) -> Figure:
    """Return the figure of a curve, with its band of 95 % where a standard deviation is known."""
    with marks.new_figure(PANEL_HEIGHT, title) as figure:
        axes = figure.subplots()
        if sigma is not None and np.isfinite(sigma).all():
            half = SIGMA_OF_95_PERCENT * sigma
            axes.fill_between(x.values, y.values - half, y.values + half, color=LIGHT["measured"], alpha=0.25, linewidth=0.0)
        marks.curve(axes, x.values, y.values, color=LIGHT["measured"])
        marks.label_axes(axes, y.name, y.unit, x.name, x.unit)
    return figure


def points_figure(title: str, x: Series, y: Series, levels: Mapping[str, float] | None = None) -> Figure:
    """Return the figure of points joined by a line, with level lines by their names."""
    with marks.new_figure(PANEL_HEIGHT, title) as figure:
        axes = figure.subplots()
        axes.plot(x.values, y.values, "o-", color=LIGHT["measured"], label=y.name)
        for name, level in (levels or {}).items():
            axes.axhline(level, color=LIGHT["model"], linestyle="--", linewidth=1.0, label=name)
        marks.label_axes(axes, y.name, y.unit, x.name, x.unit)
        if levels:
            marks.legend(figure, axes)
    return figure


def stems_figure(title: str, x: Series, y: Series) -> Figure:
    """Return the figure of stems from zero, as amplitudes over orders."""
    with marks.new_figure(PANEL_HEIGHT, title) as figure:
        axes = figure.subplots()
        axes.vlines(x.values, 0.0, y.values, color=LIGHT["measured"])
        axes.plot(x.values, y.values, "o", color=LIGHT["measured"])
        axes.set_ylim(bottom=0.0)
        marks.label_axes(axes, y.name, y.unit, x.name, x.unit)
    return figure


def histograms_figure(title: str, quantities: Sequence[Series]) -> Figure:
    """Return the figure of a histogram of each quantity, below each other."""
    with marks.new_figure(0.8 + 1.5 * len(quantities), title) as figure:
        for axes, of in zip(figure.subplots(len(quantities), 1, squeeze=False)[:, 0], quantities, strict=True):
            axes.hist(of.values, bins="auto", color=LIGHT["measured"])
            marks.label_axes(axes, "count", "1", of.name, of.unit)
    return figure


def bars_figure(title: str, names: Sequence[str], of_names: Mapping[str, Sequence[float]], unit: str) -> Figure:
    """Return the figure of horizontal bars: for each name one of each kind, the first name on top."""
    with marks.new_figure(MARGIN_HEIGHT + BAR_HEIGHT * len(names), title) as figure:
        axes = figure.subplots()
        width = 0.8 / len(of_names)
        for place, (kind, values) in enumerate(of_names.items()):
            middle = np.arange(len(names)) + (place - 0.5 * (len(of_names) - 1)) * width
            axes.barh(middle, values, height=width, color=LIGHT[BAR_COLOURS[place - len(of_names)]], label=kind)
        axes.set_yticks(range(len(names)), list(names), fontsize="small")
        axes.set_ylim(len(names) - 0.5, -0.5)
        axes.grid(visible=False, axis="y")
        marks.label_abscissa(axes, "", unit)
        marks.legend(figure, axes)
    return figure
