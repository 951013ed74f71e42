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
ANGLES = {"small_angle": "angle of the input"}  # of loops, in words


def draw_picture(figure: Figure | SubFigure, picture: Picture) -> Axes:
    """Draw measured and modelled, and below the residual with two bands of 95 %: of the model, and of the residuals.

    Returns:
        the upper axes, which have the labels of a legend
    """
    if picture.look not in _RESIDUAL:
        return draw_measured(figure, picture)
    shared = picture.look != "loop"
    whole: Axes
    whole, left = figure.subplots(2, 1, sharex=shared, height_ratios=(2.2, 1.0))
    _MEASURED[picture.look](whole, picture)
    if shared:
        whole.set_xlabel("")
    _RESIDUAL[picture.look](left, picture.curves)
    if "held_out" in picture.curves:
        x = picture.curves[picture.curves.names[0]] if shared else np.arange(1.0, len(picture.curves) + 1.0)
        for axes in (whole, left) if shared else (left,):
            marks.shade(axes, x, picture.curves["held_out"] > 0.0)
    return whole


def draw_measured(figure: Figure | SubFigure, picture: Picture) -> Axes:
    """Draw measured and modelled alone; of an error over a turn its orders, too. Return axes with labels."""
    if picture.look == "turn":
        return _turn(figure, picture)
    axes: Axes = figure.subplots()
    _MEASURED[picture.look](axes, picture)
    return axes


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


def _table(axes: Axes, picture: Picture) -> None:
    """Draw torque over speed."""
    torque = picture.curves.names[1]
    table_points(axes, picture.curves)
    marks.label_axes(axes, picture_label(picture), picture.curves.unit(torque), "input speed", "rad/s")


def _table_residual(axes: Axes, curves: Recording) -> None:
    order = np.argsort(curves["speed"], kind="stable")
    speed, residual = curves["speed"][order], residual_of(curves)[order]
    marks.residual_curve(axes, speed, residual, LIGHT["ink"])
    _bands(axes, speed, residual, _sigma(curves, order))
    marks.label_axes(axes, "measured − modelled", curves.unit(curves.names[1]), "input speed", "rad/s")


def table_points(axes: Axes, curves: Recording) -> None:
    """Draw the rows of a table and the law, each direction by itself."""
    order = np.argsort(curves["speed"], kind="stable")
    speed = curves["speed"][order]
    axes.plot(speed, curves[curves.names[1]][order], "o", color=LIGHT["measured"], label="measured", zorder=3)
    modelled = curves["modelled"][order]
    if np.any((np.diff(speed) == 0.0) & (np.diff(modelled) != 0.0)):  # of several loads at one speed, which no line shows
        axes.plot(speed, modelled, "_", color=LIGHT["model"], markersize=11.0, markeredgewidth=1.6, label="model", zorder=4)
    else:
        for side in (speed < 0.0, speed > 0.0):
            axes.plot(speed[side], modelled[side], color=LIGHT["model"], label="model" if side[-1] else "")
    marks.speed_axis(axes, speed)


def loop_points(axes: Axes, curves: Recording) -> None:
    """Draw the measured points of a loop over its torque, and the fitted loop in the order measured."""
    rows = np.unique(np.linspace(0, len(curves) - 1, MAX_LOOP_POINTS).astype(int))
    over, channel, modelled = (curves[name][rows] for name in (*curves.names[:2], "modelled"))
    points, lines = ((over, channel), (over, modelled)) if curves.names[0] == "torque" else ((channel, over), (modelled, over))
    axes.plot(*points, "o", color=LIGHT["measured"], markersize=3.0, alpha=0.5, label="measured")
    axes.plot(*lines, color=LIGHT["model"], linewidth=0.9, label="model")


def _loop(axes: Axes, picture: Picture) -> None:
    """Draw the angle over the torque."""
    loop_points(axes, picture.curves)
    torque, angle = sorted(picture.curves.names[:2], key=lambda name: picture.curves.unit(name) == "rad")
    side = picture_label(picture).removeprefix("torque").removeprefix("twist")
    marks.label_axes(axes, f"{ANGLES.get(angle, angle.replace('_', ' '))}{side}", "rad", torque, picture.curves.unit(torque))


def _loop_residual(axes: Axes, curves: Recording) -> None:
    """Draw what is left in the order measured."""
    point, residual = np.arange(1.0, len(curves) + 1.0), residual_of(curves)
    marks.residual_curve(axes, point, residual, LIGHT["ink"])
    _bands(axes, point, residual, _sigma(curves))
    marks.label_axes(axes, "measured − modelled", curves.unit(curves.names[1]), "point compared, in the order measured", "1")


def _means(axes: Axes, picture: Picture) -> None:
    """Draw means of the friction over the temperature, and the line through all samples."""
    over, channel = picture.curves.names[:2]
    celsius = picture.curves.values(over, "degC")
    axes.plot(celsius, picture.curves[channel], "o", color=LIGHT["measured"], label="means of classes")
    axes.plot(celsius, picture.curves["modelled"], color=LIGHT["model"], label="line through all samples")
    marks.label_axes(axes, picture_label(picture), picture.curves.unit(channel), "temperature", "degC")


def _means_residual(axes: Axes, curves: Recording) -> None:
    celsius, residual = curves.values(curves.names[0], "degC"), residual_of(curves)
    marks.residual_curve(axes, celsius, residual, LIGHT["ink"])
    _bands(axes, celsius, residual, None)
    marks.label_axes(axes, "means − line", curves.unit(curves.names[1]), "temperature", "degC")


def _series(axes: Axes, picture: Picture) -> None:
    """Draw a channel over time, or over the angle if there is no time."""
    curves = picture.curves
    over, channel = curves.names[:2]
    x, measured, modelled = _broken(curves[over], curves[channel], curves["modelled"])
    marks.curve(axes, x, measured, color=LIGHT["measured"], linewidth=2.4, alpha=0.6, label="measured")
    label = "orders found" if "residual" in curves else "model"
    marks.curve(axes, x, modelled, color=LIGHT["model"], linewidth=0.9, label=label)
    marks.label_axes(axes, picture_label(picture), curves.unit(channel), over.replace("_", " "), curves.unit(over))


def _series_residual(axes: Axes, curves: Recording) -> None:
    over, residual = curves.names[0], residual_of(curves)
    place, broken = _broken(curves[over], residual)
    marks.residual_curve(axes, place, broken, LIGHT["ink"])
    _bands(axes, curves[over], residual, _sigma(curves))
    below = "left by orders and loads" if "residual" in curves else "measured − modelled"
    marks.label_axes(axes, below, curves.unit(curves.names[1]), over.replace("_", " "), curves.unit(over))


def _turn(figure: Figure | SubFigure, picture: Picture) -> Axes:
    """Draw an error over a turn, and beside it the amplitude of each order with its interval of 95 %."""
    curves = picture.curves
    whole, bars = figure.subplots(1, 2, width_ratios=(1.4, 1.0))
    over, channel = curves.names[:2]
    degrees = np.rad2deg(curves[over])
    whole.plot(degrees, curves[channel], "o", color=LIGHT["measured"], markersize=2.6, label="measured")
    whole.plot(degrees, curves["modelled"], color=LIGHT["model"], label="model: its orders")
    whole.set_xticks([0, 90, 180, 270, 360])
    marks.label_axes(whole, "error", curves.unit(channel), "input angle", "deg")
    order, amplitude, sigma = np.array(picture.orders).T
    place = np.arange(len(order))
    bars.bar(place, amplitude, color=LIGHT["model"], width=0.7)
    bars.errorbar(place, amplitude, SIGMA_OF_95_PERCENT * sigma, fmt="none", ecolor=LIGHT["ink"], elinewidth=0.9)
    bars.set_xticks(place, [f"{each:g}" for each in order])
    marks.label_axes(bars, "orders", curves.unit(channel))
    bars.set_xlabel("order")
    return whole  # type: ignore[no-any-return]


_MEASURED: dict[Look, Callable[[Axes, Picture], None]] = {
    "table": _table, "loop": _loop, "means": _means, "series": _series,
}  # fmt: skip
_RESIDUAL: dict[Look, Callable[[Axes, Recording], None]] = {
    "table": _table_residual, "loop": _loop_residual, "means": _means_residual, "series": _series_residual,
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
