"""Marks of drawings: figures in the style of the package, curves, bands, residuals, axes with units, and legends."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import typeset
from strainwave.drawing.style import (
    DOTS_PER_INCH,
    FIGURE_WIDTH,
    LETTERS_PER_HANDLE,
    LETTERS_PER_LINE,
    LETTERS_PER_TITLE_LINE,
    LIGHT,
    RUNS,
    STYLE,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure, SubFigure

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
MAX_CURVE_STRETCHES = 300  # of a long record, each drawn by its extremes: about two to a pixel
MAX_MARKED_SAMPLES = 150  # samples up to which each is drawn as a point
UNIT_LETTERS = 8  # of the unit that stands to the left of a legend
MAX_SHORT_LOG_AXIS = 150.0  # ratio of the ends of a logarithmic axis up to which 2 and 5 have numbers, too
MAX_LINEAR_SPEED_RATIO = 100.0  # ratio of speeds beyond which their axis is logarithmic


@contextmanager
def new_figure(height: float, title: str = "") -> Iterator[Figure]:
    """Return a figure in the style of the package, whatever style the caller prefers; draw within the context.

    Args:
        height: [inch]
        title: of the figure; none if empty
    """
    from matplotlib import style
    from matplotlib.figure import Figure

    with style.context(["default", STYLE | {"figure.dpi": DOTS_PER_INCH}]):
        figure = Figure(figsize=(FIGURE_WIDTH, height))
        if title:
            figure.suptitle(textwrap.fill(title, LETTERS_PER_TITLE_LINE), x=0.0, ha="left", size="large")
        yield figure


def speed_axis(axes: Axes, speed: Array) -> None:
    """Set the axis of speeds: logarithmic if they span more than two decades; each direction has its own branch."""
    slowest, fastest = np.abs(speed[speed != 0.0]).min(), np.abs(speed).max()
    if fastest > MAX_LINEAR_SPEED_RATIO * slowest and np.all(speed > 0.0):
        axes.set_xscale("log")
    elif fastest > MAX_LINEAR_SPEED_RATIO * slowest:
        decades = 10.0 ** np.arange(np.ceil(np.log10(slowest)), np.log10(fastest))
        axes.set_xscale("symlog", linthresh=slowest, linscale=0.3)
        axes.set_xticks([*-decades[::-1], 0.0, *decades])


def curve(axes: Axes, x: Array, y: Array, **style: Any) -> None:
    """Draw a line; a long record is drawn by the extremes of short stretches."""
    axes.plot(*envelope(x, y, MAX_CURVE_STRETCHES), **style)


def residual_curve(axes: Axes, x: Array, residual: Array, color: str) -> None:
    """Draw a residual: a point for each sample if there are few, else a curve."""
    axes.axhline(0.0, color=LIGHT["muted"], linewidth=0.8)
    if len(x) <= MAX_MARKED_SAMPLES:
        axes.vlines(x, 0.0, residual, color=color, linewidth=0.8)
        axes.plot(x, residual, "o", color=color, markersize=2.8)
    else:
        curve(axes, x, residual, color=color, linewidth=0.8)


def shade(axes: Axes, x: Array, held_out: Mask) -> None:
    """Shade the samples that took no part in the fit."""
    between = np.concatenate((x[:1], 0.5 * (x[1:] + x[:-1]), x[-1:]))
    label = "held out"
    for block in _blocks(held_out):
        ends = between[block.start], between[block.stop]
        axes.axvspan(*ends, facecolor=LIGHT["held-out"], alpha=0.13, linewidth=0.0, label=label)
        label = ""


def _blocks(chosen: Mask) -> Iterator[slice]:
    """Return the stretches of chosen neighbours."""
    edges = np.flatnonzero(np.diff(chosen, prepend=False, append=False))
    return (slice(start, stop) for start, stop in edges.reshape(-1, 2).tolist())


def label_axes(axes: Axes, y: str, y_unit: str, x: str = "", x_unit: str = "1") -> None:
    """Name the quantities of both axes, with the unit prefix that suits their size; that of the vertical axis is its title."""
    axes.set_title(textwrap.fill(f"{y}{scaled(axes.yaxis, y_unit)}".strip(), LETTERS_PER_LINE))
    if x:
        label_abscissa(axes, x, x_unit)


def label_abscissa(axes: Axes, x: str, x_unit: str) -> None:
    """Name the quantity of the horizontal axis, with the unit prefix that suits its size."""
    axes.set_xlabel(f"{x}{scaled(axes.xaxis, x_unit)}")


def set_log_ticks(axis: Axis) -> None:
    """Set the numbers of a logarithmic axis: at powers of ten, and at 2 and 5 times these if the axis is short."""
    from matplotlib.ticker import LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < MAX_SHORT_LOG_AXIS * low else (1.0,)))
    axis.set_minor_formatter(NullFormatter())


def line_style(place: int) -> dict[str, Any]:
    """Return colour and line of a curve by its place among others; both differ, so that they print in grey, too."""
    colour, line, _ = RUNS[place % len(RUNS)]
    return {"color": LIGHT[colour], "linestyle": line}


def panel_legend(axes: Axes) -> None:
    """Place the legend of one panel of several above it, to the right of its unit."""
    labels = axes.get_legend_handles_labels()[1]
    columns = max(1, (LETTERS_PER_LINE - UNIT_LETTERS) // (max(map(len, labels)) + LETTERS_PER_HANDLE))
    axes.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=columns, borderaxespad=0.0, borderpad=0.2, columnspacing=1.2
    )


def scaled(axis: Axis, unit: str) -> str:
    """Number an axis, all to the same digit if it is linear; return the unit with its prefix."""
    from strainwave.drawing.ticks import Ticks

    power = typeset.prefix_power(float(np.max(np.abs(axis.get_view_interval()))), unit)
    axis.set_major_formatter(Ticks(axis, power))
    text = typeset.prefixed(unit, power)
    return f" [{text}]" if text else ""


def legend(figure: Figure | SubFigure, axes: Axes) -> None:
    """Place the legend above the drawing, or below it if the figure has a title, in as many columns as fit."""
    below = bool(figure.figure.get_suptitle())
    handles, labels = axes.get_legend_handles_labels()
    lines = [textwrap.fill(label, LETTERS_PER_LINE) for label in labels]
    widest = max(len(line) for label in lines for line in label.splitlines())
    columns = max(1, LETTERS_PER_LINE // (widest + LETTERS_PER_HANDLE))
    place: Literal["outside lower center", "outside upper left"] = "outside lower center" if below else "outside upper left"
    figure.legend(handles, lines, loc=place, ncols=columns, borderpad=0.0, columnspacing=1.2)


def envelope(x: Array, y: Array, stretches: int) -> tuple[Array, Array]:
    """Return a curve to draw: itself or, if much longer, the extremes of x and y in each of many stretches, in order.

    Args:
        x, y: the samples of the curve, shape (n,)
        stretches: into how many it is cut; up to four samples for each, nothing is left out

    >>> time = np.arange(100_000.0)
    >>> drawn, values = envelope(time, np.where(time == 777.0, 1.0, 0.0), stretches=10)
    >>> len(drawn), float(values.max())
    (21, 1.0)
    """
    if len(x) <= 4 * stretches:
        return x, y
    length = -(-len(x) // stretches)
    whole = len(x) // length * length
    starts = np.arange(0, whole, length)
    blocks = [values[:whole].reshape(-1, length) for values in (x, y)]
    extremes = [starts + pick(block, axis=1) for block in blocks for pick in (np.argmin, np.argmax)]
    kept = np.unique(np.concatenate([*extremes, np.arange(whole, len(x))]))
    return x[kept], y[kept]
