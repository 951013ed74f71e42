"""Drawing of a measurement against its model, with the residual below."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT
from strainwave.files.recording import Recording
from strainwave.identification.results.file_result import Look, Picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

Array = NDArray[np.float64]
FIGURE_HEIGHT = 4.3  # inches
SIGMA_OF_95_PERCENT = 1.959963984540054  # standard deviations about the mean that contain 95 % of a normal distribution
MAX_LOOP_POINTS = 600  # of a loop that are drawn
MAX_INTERVALS = 2.5  # median intervals between two samples that a line joins
MAX_BAND_BLOCKS = 200  # stretches of a band over time
ABSCISSAE = {"twist": "twist", "small_angle": "angle of the input"}  # of loops, in words


def draw_picture(figure: Figure | SubFigure, picture: Picture) -> Axes:
    """Draw measured and modelled, and below the residual with two bands of 95 %: of the model, and of the residuals.

    Returns:
        the upper axes, which have the labels of a legend
    """
    whole: Axes
    whole, left = figure.subplots(2, 1, sharex=picture.look != "loop", height_ratios=(2.2, 1.0))
    _DRAWN[picture.look](whole, left, picture.curves, picture_label(picture))
    return whole


def pictures_figure(pictures: Sequence[Picture], title: str) -> Figure:
    """Return the figure of one picture or several, below each other."""
    with marks.new_figure(FIGURE_HEIGHT * len(pictures), title) as figure:
        parts = np.atleast_1d(np.array(figure.subfigures(len(pictures), 1)))
        for part, picture in zip(parts, pictures, strict=True):
            marks.legend(part, draw_picture(part, picture), below=True)
    return figure


def residual_of(curves: Recording) -> Array:
    """Return what is left of a file: measured less modelled, or what neither orders nor loads explain."""
    left: Array = curves["residual"] if "residual" in curves else curves[curves.names[1]] - curves["modelled"]
    return left


def picture_label(picture: Picture) -> str:
    """Return the name of what was measured."""
    return picture.label or picture.curves.names[1].replace("_", " ")


def _table(whole: Axes, left: Axes, curves: Recording, words: str) -> None:
    """Draw torque over speed."""
    order = table_points(whole, curves)
    speed, torque = curves["speed"][order], curves.names[1]
    residual = residual_of(curves)[order]
    marks.residual_curve(left, speed, residual, LIGHT["ink"])
    _bands(left, speed, residual, _sigma(curves, order))
    marks.label_axes(whole, words, curves.unit(torque))
    marks.label_axes(left, "measured − modelled", curves.unit(torque), "input speed", "rad/s")


def table_points(axes: Axes, curves: Recording) -> NDArray[np.intp]:
    """Draw the rows of a table and the law, each direction by itself; return their order by speed."""
    order = np.argsort(curves["speed"], kind="stable")
    speed = curves["speed"][order]
    axes.plot(speed, curves[curves.names[1]][order], "o", color=LIGHT["measured"], label="measured", zorder=3)
    for side in (speed < 0.0, speed > 0.0):
        axes.plot(speed[side], curves["modelled"][order[side]], color=LIGHT["model"], label="model" if side[-1] else "")
    marks.speed_axis(axes, speed)
    return order


def loop_points(axes: Axes, curves: Recording) -> None:
    """Draw the measured points of a loop, and the fitted loop in the order measured."""
    over, torque = curves.names[:2]
    rows = np.unique(np.linspace(0, len(curves) - 1, MAX_LOOP_POINTS).astype(int))
    x = curves[over][rows]
    axes.plot(x, curves[torque][rows], "o", color=LIGHT["measured"], markersize=3.0, alpha=0.5, label="measured")
    axes.plot(x, curves["modelled"][rows], color=LIGHT["model"], linewidth=0.9, label="model")


def _loop(whole: Axes, left: Axes, curves: Recording, words: str) -> None:
    """Draw a loop; below, what is left in the order measured."""
    over, torque = curves.names[:2]
    loop_points(whole, curves)
    point, residual = np.arange(1.0, len(curves) + 1.0), residual_of(curves)
    marks.residual_curve(left, point, residual, LIGHT["ink"])
    _bands(left, point, residual, _sigma(curves))
    _held_out((left,), point, curves)
    side = words.removeprefix("torque") if over == "twist" else ""
    marks.label_axes(whole, words, curves.unit(torque), ABSCISSAE.get(over, over.replace("_", " ")) + side, "rad")
    marks.label_axes(left, "measured − modelled", curves.unit(torque), "point compared, in the order measured", "1")


def _means(whole: Axes, left: Axes, curves: Recording, words: str) -> None:
    """Draw means of the friction over the temperature, and the line through all samples."""
    over, channel = curves.names[:2]
    celsius, residual = curves.values(over, "degC"), residual_of(curves)
    whole.plot(celsius, curves[channel], "o", color=LIGHT["measured"], label="means of classes")
    whole.plot(celsius, curves["modelled"], color=LIGHT["model"], label="line through all samples")
    marks.residual_curve(left, celsius, residual, LIGHT["ink"])
    _bands(left, celsius, residual, None)
    marks.label_axes(whole, words, curves.unit(channel))
    marks.label_axes(left, "means − line", curves.unit(channel), "temperature", "degC")


def _series(whole: Axes, left: Axes, curves: Recording, words: str) -> None:
    """Draw a channel over time, or over the angle if there is no time."""
    over, channel = curves.names[:2]
    x, unit, residual = curves[over], curves.unit(channel), residual_of(curves)
    places, measured, modelled, rest = _broken(x, curves[channel], curves["modelled"], residual)
    marks.curve(whole, places, measured, color=LIGHT["measured"], linewidth=2.4, alpha=0.6, label="measured")
    label = "orders found" if "residual" in curves else "model"
    marks.curve(whole, places, modelled, color=LIGHT["model"], linewidth=0.9, label=label)
    marks.residual_curve(left, places, rest, LIGHT["ink"])
    _bands(left, x, residual, _sigma(curves))
    _held_out((whole, left), x, curves)
    marks.label_axes(whole, words, unit)
    below = "left by orders and loads" if "residual" in curves else "measured − modelled"
    marks.label_axes(left, below, unit, over.replace("_", " "), curves.unit(over))


_DRAWN: dict[Look, Callable[..., None]] = {
    "table": _table, "loop": _loop, "means": _means, "series": _series,
}  # fmt: skip


def _broken(x: Array, *series: Array) -> tuple[Array, ...]:
    """Return series with a gap where samples were left out; those with so many samples that extremes are drawn, unchanged."""
    gaps = (
        np.flatnonzero(np.abs(np.diff(x)) > MAX_INTERVALS * np.median(np.abs(np.diff(x)))) + 1
        if len(x) > 1
        else np.zeros(0, int)
    )
    if len(x) + len(gaps) > 4 * marks.MAX_CURVE_STRETCHES:
        return x, *series
    return np.insert(x, gaps, x[gaps]), *(np.insert(each, gaps, np.nan) for each in series)


def _sigma(curves: Recording, order: NDArray[np.intp] | None = None) -> Array | None:
    if "sigma" not in curves:
        return None
    return curves["sigma"] if order is None else curves["sigma"][order]


def _bands(axes: Axes, x: Array, residual: Array, sigma: Array | None) -> None:
    """Draw the limits of 95 % of the residuals, if they are normal, and the interval of the model."""
    level = SIGMA_OF_95_PERCENT * float(np.sqrt(np.mean(residual**2)))
    for side in (-level, level):
        axes.axhline(side, color=LIGHT["earlier"], linestyle="--", linewidth=0.9)
    if sigma is not None:
        where, half = zip(*_blocks(x, SIGMA_OF_95_PERCENT * sigma), strict=True)
        band = np.array(half)
        axes.fill_between(where, -band, band, facecolor=LIGHT["model"], alpha=0.35, linewidth=0.0)


def _blocks(x: Array, half: Array) -> Iterator[tuple[float, float]]:
    """Yield the points of a band: of a long record the largest of each of many stretches."""
    for rows in np.array_split(np.arange(len(x)), min(len(x), MAX_BAND_BLOCKS)):
        yield float(np.mean(x[rows])), float(np.max(half[rows]))


def _held_out(axes: Sequence[Axes], x: Array, curves: Recording) -> None:
    if "held_out" in curves:
        for each in axes:
            marks.shade(each, x, curves["held_out"] > 0.0)
