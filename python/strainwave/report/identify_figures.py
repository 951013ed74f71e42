"""Figures of an identification: the estimates of each file beside each other, and each file measured against modelled."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strainwave.files.recording import Recording
from strainwave.identification.results.combined_parameter import MAX_DISTANCE
from strainwave.identification.results.file_result import FileResult, Look, Picture
from strainwave.report import figures
from strainwave.report.figures import LIGHT, WIDTH

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
NINETY_FIVE = 1.959963984540054  # standard deviations about the mean that contain 95 % of a normal distribution
MAX_POINTS = 600  # of a loop that are drawn
MAX_INTERVALS = 2.5  # median intervals between two samples that a line joins
MAX_BAND_BLOCKS = 200  # stretches of a band over time
ROW_HEIGHT = 0.19  # inches, of a row of a comparison
ABSCISSAE = {"twist": "twist", "small_angle": "angle of the input"}  # of loops, in words
MAX_NAME = 22  # letters of the name of a file beside a drawing
WHOLE_QUANTILE = 0.8  # of the lengths of intervals; longer ones reach beyond the edge
BEYOND = f"more than {MAX_DISTANCE:g} σ apart"
LOOKS = {  # of a file in a comparison: mark, colour, whether filled
    "value taken": ("o", "measured", True),
    "agrees": ("o", "ink", True),
    "not counted": ("s", "muted", True),
    "copy of another": ("o", "muted", False),
    BEYOND: ("D", "model", True),
}


@dataclass(frozen=True)
class Row:
    """The estimate of one file, against the value taken.

    Attributes:
        file: its name
        off: difference from the value taken [%]
        sigma: its standard deviation [%]
        look: one of `LOOKS`
    """

    file: str
    off: float
    sigma: float
    look: str


def comparison(numbers: Sequence[tuple[str, Sequence[Row]]], name: str) -> str:
    """Draw the estimates of each file, each with its interval of 95 %.

    Args:
        numbers: name of each parameter, and its estimates, the value taken first
        name: of the drawing
    """
    count = sum(1 + len(rows) for _, rows in numbers)

    def draw(figure: Figure) -> None:
        axes, place = figure.subplots(), 0
        ticks: list[tuple[int, str]] = []
        every = [row for _, rows in numbers for row in rows]
        reach = _reach(every)
        for title, rows in numbers:
            axes.text(-0.98 * reach, place, title, va="center", fontsize="small", fontweight="bold", color=LIGHT["ink"])
            ticks.append((place, ""))
            axes.plot([0.0, 0.0], [place + 0.5, place + len(rows) + 0.5], color=LIGHT["muted"], linewidth=0.8)
            for row in rows:
                place += 1
                ticks.append((place, _short(row.file)))
                _interval(axes, row, place)
            place += 1
        axes.set_yticks([where for where, _ in ticks], [label for _, label in ticks], fontsize="small")
        axes.tick_params(axis="y", length=0.0)
        axes.grid(visible=False, axis="y")
        axes.set_ylim(count - 0.4, -0.7)
        axes.set_xlim(-reach, reach)
        axes.set_xlabel("difference from the value taken [%]")
        _looks_legend(figure, axes, every)

    return figures.inline(
        draw, (WIDTH, 0.75 + ROW_HEIGHT * count), name, "Each parameter by each file, with its interval of 95 %"
    )


def _reach(rows: Sequence[Row]) -> float:
    """Return the end of the axis, beyond all values and most of their intervals [%]."""
    values = max(abs(row.off) for row in rows)
    ends = np.quantile([abs(row.off) + NINETY_FIVE * row.sigma for row in rows], WHOLE_QUANTILE, method="higher")
    return 1.15 * max(values, float(ends), 1e-6)


def _interval(axes: Axes, row: Row, place: int) -> None:
    mark, colour, filled = LOOKS[row.look]
    half = NINETY_FIVE * row.sigma
    axes.plot([row.off - half, row.off + half], [place, place], "-", color=LIGHT[colour], linewidth=1.4, solid_capstyle="butt")
    style: dict[str, Any] = {"markerfacecolor": LIGHT[colour] if filled else "none", "markeredgecolor": LIGHT[colour]}
    axes.plot([row.off], [place], mark, color=LIGHT[colour], markersize=4.4, **style)


def _looks_legend(figure: Figure, axes: Axes, rows: Sequence[Row]) -> None:
    for look, (mark, colour, filled) in LOOKS.items():
        if any(row.look == look for row in rows):
            style: dict[str, Any] = {"markerfacecolor": LIGHT[colour] if filled else "none", "markeredgecolor": LIGHT[colour]}
            axes.plot([], [], mark, color=LIGHT[colour], markersize=4.4, label=look, **style)
    figures.legend(figure, axes)


def _short(name: str) -> str:
    return name if len(name) <= MAX_NAME else f"{name[: MAX_NAME // 2 - 1]}…{name[-MAX_NAME // 2 :]}"


# ---- One file --------------------------------------------------------------------------------------------------------


def file_figure(result: FileResult, picture: Picture, name: str) -> str:
    """Draw measured against modelled, and below what is left, with two bands of 95 %: of the model, and of the residuals."""

    def draw(figure: Figure) -> None:
        whole, left = figure.subplots(2, 1, sharex=picture.look != "loop", height_ratios=(2.2, 1.0))
        _DRAWN[picture.look](whole, left, picture.curves, _label(picture))
        figures.legend(figure, whole)

    title = f", {picture.title}" if picture.title else ""
    return figures.inline(draw, (WIDTH, 3.9), name, f"Measured against modelled, {result.name}{title}")


def overview(loop: Picture, table: Picture) -> str:
    """Draw a picture by itself: a torsion loop and a friction table, measured and modelled."""

    def draw(figure: Figure) -> None:
        left, right = figure.subplots(1, 2)
        _loop_points(left, loop.curves)
        _table_points(right, table.curves)
        figures.label_axes(left, _label(loop), "N.m", "twist", "rad")
        figures.label_axes(right, _label(table), "N.m", "input speed", "rad/s")
        figures.legend(figure, left)

    title = "Torsion loop and friction of two strain wave gears, measured and modelled"
    return figures.standalone(draw, (8.4, 3.2), "overview", title)


def residual_of(curves: Recording) -> Array:
    """Return what is left of a file: measured less modelled, or what neither orders nor loads explain."""
    left: Array = curves["residual"] if "residual" in curves else curves[curves.names[1]] - curves["modelled"]
    return left


def _label(picture: Picture) -> str:
    """Return the name of what was measured."""
    return picture.label or picture.curves.names[1].replace("_", " ")


def _table(whole: Axes, left: Axes, curves: Recording, words: str) -> None:
    """Draw torque over speed."""
    order = _table_points(whole, curves)
    speed, torque = curves["speed"][order], curves.names[1]
    residual = residual_of(curves)[order]
    figures.residual_curve(left, speed, residual, LIGHT["ink"])
    _bands(left, speed, residual, _sigma(curves, order))
    figures.label_axes(whole, words, curves.unit(torque))
    figures.label_axes(left, "measured − modelled", curves.unit(torque), "input speed", "rad/s")


def _table_points(axes: Axes, curves: Recording) -> NDArray[np.intp]:
    """Draw the rows of a table and the law, each direction by itself; return their order by speed."""
    order = np.argsort(curves["speed"], kind="stable")
    speed = curves["speed"][order]
    axes.plot(speed, curves[curves.names[1]][order], "o", color=LIGHT["measured"], label="measured", zorder=3)
    for side in (speed < 0.0, speed > 0.0):
        axes.plot(speed[side], curves["modelled"][order[side]], color=LIGHT["model"], label="model" if side[-1] else "")
    figures.speed_axis(axes, speed)
    return order


def _loop_points(axes: Axes, curves: Recording) -> None:
    """Draw the measured points of a loop, and the fitted loop in the order measured."""
    over, torque = curves.names[:2]
    rows = np.unique(np.linspace(0, len(curves) - 1, MAX_POINTS).astype(int))
    x = curves[over][rows]
    axes.plot(x, curves[torque][rows], "o", color=LIGHT["measured"], markersize=3.0, alpha=0.5, label="measured")
    axes.plot(x, curves["modelled"][rows], color=LIGHT["model"], linewidth=0.9, label="model")


def _loop(whole: Axes, left: Axes, curves: Recording, words: str) -> None:
    """Draw a loop; below, what is left in the order measured."""
    over, torque = curves.names[:2]
    _loop_points(whole, curves)
    point, residual = np.arange(1.0, len(curves) + 1.0), residual_of(curves)
    figures.residual_curve(left, point, residual, LIGHT["ink"])
    _bands(left, point, residual, _sigma(curves))
    _held_out((left,), point, curves)
    side = words.removeprefix("torque") if over == "twist" else ""
    figures.label_axes(whole, words, curves.unit(torque), ABSCISSAE.get(over, over.replace("_", " ")) + side, "rad")
    figures.label_axes(left, "measured − modelled", curves.unit(torque), "point compared, in the order measured", "1")


def _means(whole: Axes, left: Axes, curves: Recording, words: str) -> None:
    """Draw means of the friction over the temperature, and the line through all samples."""
    over, channel = curves.names[:2]
    celsius, residual = curves.values(over, "degC"), residual_of(curves)
    whole.plot(celsius, curves[channel], "o", color=LIGHT["measured"], label="means of classes")
    whole.plot(celsius, curves["modelled"], color=LIGHT["model"], label="line through all samples")
    figures.residual_curve(left, celsius, residual, LIGHT["ink"])
    _bands(left, celsius, residual, None)
    figures.label_axes(whole, words, curves.unit(channel))
    figures.label_axes(left, "means − line", curves.unit(channel), "temperature", "degC")


def _series(whole: Axes, left: Axes, curves: Recording, words: str) -> None:
    """Draw a channel over time, or over the angle if there is no time."""
    over, channel = curves.names[:2]
    x, unit, residual = curves[over], curves.unit(channel), residual_of(curves)
    places, measured, modelled, rest = _broken(x, curves[channel], curves["modelled"], residual)
    figures.curve(whole, places, measured, color=LIGHT["measured"], linewidth=2.4, alpha=0.6, label="measured")
    label = "orders found" if "residual" in curves else "model"
    figures.curve(whole, places, modelled, color=LIGHT["model"], linewidth=0.9, label=label)
    figures.residual_curve(left, places, rest, LIGHT["ink"])
    _bands(left, x, residual, _sigma(curves))
    _held_out((whole, left), x, curves)
    figures.label_axes(whole, words, unit)
    below = "left by orders and loads" if "residual" in curves else "measured − modelled"
    figures.label_axes(left, below, unit, over.replace("_", " "), curves.unit(over))


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
    if len(x) + len(gaps) > 4 * figures.STRETCHES:
        return x, *series
    return np.insert(x, gaps, x[gaps]), *(np.insert(each, gaps, np.nan) for each in series)


def _sigma(curves: Recording, order: NDArray[np.intp] | None = None) -> Array | None:
    if "sigma" not in curves:
        return None
    return curves["sigma"] if order is None else curves["sigma"][order]


def _bands(axes: Axes, x: Array, residual: Array, sigma: Array | None) -> None:
    """Draw the limits of 95 % of the residuals, if they are normal, and the interval of the model."""
    level = NINETY_FIVE * float(np.sqrt(np.mean(residual**2)))
    for side in (-level, level):
        axes.axhline(side, color=LIGHT["earlier"], linestyle="--", linewidth=0.9)
    if sigma is not None:
        where, half = zip(*_blocks(x, NINETY_FIVE * sigma), strict=True)
        band = np.array(half)
        axes.fill_between(where, -band, band, facecolor=LIGHT["model"], alpha=0.35, linewidth=0.0)


def _blocks(x: Array, half: Array) -> Iterator[tuple[float, float]]:
    """Yield the points of a band: of a long record the largest of each of many stretches."""
    for rows in np.array_split(np.arange(len(x)), min(len(x), MAX_BAND_BLOCKS)):
        yield float(np.mean(x[rows])), float(np.max(half[rows]))


def _held_out(axes: Sequence[Axes], x: Array, curves: Recording) -> None:
    if "held_out" in curves:
        for each in axes:
            figures.shade(each, x, curves["held_out"] > 0.0)
