"""Figures of the report of a torsion test."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave.drawing import marks
from strainwave.drawing.style import FIGURE_WIDTH, LIGHT
from strainwave.report import figures
from strainwave.typeset import number

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

COLOURS = {
    "positive unloading": "measured",
    "negative loading": "model",
    "negative unloading": "held-out",
    "positive loading": "earlier",
}


@dataclass(frozen=True)
class DrawnRegime:
    """A regime of a loop, in the order measured.

    Attributes:
        name: of the regime
        angle, torque: its points, in the unit of the figure and [N.m], those shared with the neighbours too
    """

    name: str
    angle: Array
    torque: Array


@dataclass(frozen=True)
class DrawnWidth:
    """A width of the loop, from one branch to the other.

    Attributes:
        letter: at the arrow
        name: which
        angle: its two ends, in the unit of the figure
        torque: at which [N.m]
    """

    letter: str
    name: str
    angle: tuple[float, float]
    torque: float


def loop_figure(
    whole: tuple[Array, Array],
    branches: Sequence[DrawnRegime],
    widths: Sequence[DrawnWidth],
    names: tuple[str, str],
    output_arcmin: float | None,
    name: str,
    title: str,
) -> str:
    """A loop, its regimes coloured, an arrow for the sense of each, and its widths.

    Args:
        whole: angle and torque of all points measured
        branches: the regimes
        widths: to be drawn across
        names: of angle and torque, with their units
        output_arcmin: at the output for a degree at the input, for a second scale; None for none
        name: of the drawing, alone on its page
        title: what it is
    """

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        axes.axhline(0.0, color=LIGHT["muted"], linewidth=0.8)
        axes.plot(*whole, color=LIGHT["muted"], linewidth=0.7, label="" if branches else "measured")
        for branch in branches:
            _branch(axes, branch)
        for place, width in enumerate(widths):
            _dimension(axes, width, (0.5, 0.62, 0.38)[place % 3])
        marks.label_axes(axes, names[1], "1", names[0], "1")
        if output_arcmin is not None:
            second = axes.secondary_xaxis("top", functions=_times(output_arcmin))
            second.set_xlabel("divided by the ratio: at the output [arcmin]", color=LIGHT["muted"])
        marks.legend(figure, axes)

    return figures.inline(draw, (FIGURE_WIDTH, 4.9 if output_arcmin is not None else 4.2), name, title)


def _times(factor: float) -> tuple[Callable[[ArrayLike], ArrayLike], Callable[[ArrayLike], ArrayLike]]:
    """The scale of a second axis, there and back."""
    return (lambda x: np.asarray(x) * factor), (lambda x: np.asarray(x) / factor)


def _branch(axes: Axes, branch: DrawnRegime) -> None:
    colour = LIGHT[COLOURS.get(branch.name, "ink")]
    few = len(branch.angle) <= marks.MAX_MARKED_SAMPLES
    axes.plot(
        branch.angle, branch.torque, color=colour, linewidth=1.3, marker="o" if few else "", markersize=2.6, label=branch.name
    )
    if len(branch.angle) < 2:
        return
    way = np.concatenate(([0.0], np.cumsum(np.hypot(_unit(np.diff(branch.angle)), _unit(np.diff(branch.torque))))))
    tail, head = (
        (float(np.interp(share * way[-1], way, branch.angle)), float(np.interp(share * way[-1], way, branch.torque)))
        for share in (0.45, 0.55)
    )
    axes.annotate(
        "",
        xy=head,
        xytext=tail,
        arrowprops={"arrowstyle": "-|>", "color": colour, "mutation_scale": 13, "shrinkA": 0, "shrinkB": 0},
    )


def _unit(steps: Array) -> Array:
    extent = float(np.abs(steps).sum())
    return steps / extent if extent > 0.0 else steps


def _dimension(axes: Axes, width: DrawnWidth, share: float) -> None:
    """A double arrow from one branch to the other, with its letter."""
    ink = LIGHT["ink"]
    start, stop = ((angle, width.torque) for angle in width.angle)
    arrow: dict[str, Any] = {
        "arrowstyle": "<|-|>",
        "color": ink,
        "linewidth": 0.9,
        "mutation_scale": 7,
        "shrinkA": 0,
        "shrinkB": 0,
    }
    axes.annotate("", xy=start, xytext=stop, arrowprops=arrow)
    middle = ((1.0 - share) * width.angle[0] + share * width.angle[1], width.torque)
    place: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "va": "bottom", "fontweight": "bold"}
    if width.name:  # the second arrow of one width needs no letter of its own
        axes.annotate(width.letter, middle, (0.0, 2.5), color=ink, **place)
        axes.plot([], [], color=ink, linewidth=0.9, label=f"{width.letter}: {width.name}")


@dataclass(frozen=True)
class StiffnessCurve:
    """Local stiffness along a regime.

    Attributes:
        regime: its name
        torque: where [N.m]
        stiffness: there [N.m/rad]
        low, high: ends of its interval [N.m/rad]
        regression: stiffness of the whole regime [N.m/rad]
        band: torques between which the gear is soft [N.m], or None
    """

    regime: str
    torque: Array
    stiffness: Array
    low: Array
    high: Array
    regression: float
    band: tuple[float, float] | None = None


def stiffness_figure(curves: Sequence[StiffnessCurve], name: str, title: str) -> str:
    """Local stiffness over torque: a panel for unloading, one for loading, and where the gear is soft."""
    unloading = [curve for curve in curves if curve.regime.endswith("unloading")]
    panels = [panel for panel in (unloading, [curve for curve in curves if curve not in unloading]) if panel]

    def draw(figure: Figure) -> None:
        every = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for axes, panel in zip(every, panels, strict=True):
            for curve in panel:
                _stiffness(axes, curve)
            _stiffness_axis(axes, panel)
            marks.label_axes(axes, "local stiffness [N·m/rad]", "1")
        every[-1].set_xlabel("torque [N·m]")
        _common_legend(figure, every)

    return figures.inline(draw, (FIGURE_WIDTH, 1.2 + 1.75 * len(panels)), name, title)


def _stiffness(axes: Axes, curve: StiffnessCurve) -> None:
    colour, order = LIGHT[COLOURS.get(curve.regime, "ink")], np.argsort(curve.torque, kind="stable")
    torque = curve.torque[order]
    if curve.band is not None:
        axes.axvspan(*curve.band, facecolor=colour, alpha=0.15, linewidth=0.0, label="soft spot")
    axes.fill_between(torque, curve.low[order], curve.high[order], color=colour, alpha=0.18, linewidth=0.0)
    axes.plot(torque, curve.stiffness[order], color=colour, marker="o", markersize=2.6, label=curve.regime)
    ends = [float(torque[0]), float(torque[-1])]
    axes.plot(ends, 2 * [curve.regression], color=colour, linewidth=0.9, linestyle="--", label="regression over the regime")


def _stiffness_axis(axes: Axes, panel: Sequence[StiffnessCurve]) -> None:
    """Set the axis of the stiffness: from zero, or logarithmic if stiff and soft stretches would not both be visible."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    values = np.concatenate([curve.stiffness for curve in panel])
    values = values[np.isfinite(values) & (values > 0.0)]
    if values.size and values.max() > 5.0 * values.min():
        axes.set_yscale("log")
        axes.set_ylim(0.6 * values.min(), 1.7 * values.max())
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: number(value, 3)))
        axes.yaxis.set_minor_formatter(NullFormatter())
    elif values.size:
        axes.set_ylim(0.0, 1.3 * values.max())


def _common_legend(figure: Figure, every: Sequence[Axes] | Any) -> None:
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


@dataclass(frozen=True)
class Pictures:
    """Quality of the photographs of a test, in their order.

    Attributes:
        sigma: of the angle of each [arcsec], not-a-number if it gives none
        residual: rms distance of a marker's edge from the fitted curve [px], shape (n, 2), not-a-number likewise
        limit: of the residual, beyond which a photograph has a warning [px], or None
    """

    sigma: Array
    residual: Array


def quality_figure(pictures: Pictures, name: str, title: str) -> str:
    """Uncertainty of the angle and fit of both markers, image by image; a line if an image gives no angle."""
    image = np.arange(1, len(pictures.sigma) + 1)
    lost = image[np.isnan(pictures.sigma)]

    def draw(figure: Figure) -> None:
        sigma, residual = figure.subplots(2, 1, sharex=True)
        sigma.plot(image, pictures.sigma, "o", color=LIGHT["measured"], markersize=2.8)
        for marker, (colour, mark) in enumerate((("measured", "o"), ("model", "s"))):
            residual.plot(
                image, pictures.residual[:, marker], mark, color=LIGHT[colour], markersize=2.8, label=f"marker {marker + 1}"
            )
        for place, each in enumerate(lost):
            label = "" if place else "image of no use"
            residual.axvline(each, color=LIGHT["ink"], linewidth=0.9, linestyle=":", label=label)
            sigma.axvline(each, color=LIGHT["ink"], linewidth=0.9, linestyle=":")
        for axes, values in ((sigma, pictures.sigma), (residual, pictures.residual)):
            axes.set_ylim(0.0, 1.15 * float(np.nanmax(values, initial=1e-9)))
        marks.label_axes(sigma, "standard deviation of the angle [arcsec]", "1")
        marks.label_axes(residual, "rms distance of the edge from its fit [px]", "1", "image, in the order taken", "1")
        marks.legend(figure, residual)

    return figures.inline(draw, (FIGURE_WIDTH, 3.4), name, title)


@dataclass(frozen=True)
class DrawnComparison:
    """One quantity over several loops.

    Attributes:
        name: of the quantity, with its unit in brackets
        values: of each loop
        half_widths: of the interval of 95 % of each, what all share left out
    """

    name: str
    values: Array
    half_widths: Array


def comparison_figure(rows: Sequence[DrawnComparison], labels: Sequence[str], what: str, name: str, title: str) -> str:
    """Draw quantities of several loops, each with its interval."""
    place = np.arange(len(labels))

    def draw(figure: Figure) -> None:
        every = figure.subplots(len(rows), 1, sharex=True, squeeze=False)[:, 0]
        for axes, row in zip(every, rows, strict=True):
            error = np.where(np.isfinite(row.half_widths), row.half_widths, 0.0)
            axes.errorbar(
                place,
                row.values,
                yerr=error,
                fmt="o",
                color=LIGHT["measured"],
                markersize=4.0,
                capsize=4.0,
                elinewidth=1.1,
                label="measured",
            )
            axes.margins(y=0.25)
            axes.axhline(float(np.mean(row.values)), color=LIGHT["muted"], linewidth=0.8, linestyle="--", label="mean")
            marks.label_axes(axes, row.name, "1")
        every[-1].set_xticks(place, labels)
        every[-1].set_xlim(-0.5, len(labels) - 0.5)
        every[-1].set_xlabel(what)

    return figures.inline(draw, (FIGURE_WIDTH, 0.6 + 0.95 * len(rows)), name, title)


def overlay_figure(loops: Mapping[str, tuple[Array, Array]], names: tuple[str, str], name: str, title: str) -> str:
    """Several loops in one picture: angle and torque by label."""
    colours, lines = list(COLOURS.values()), ("-", "--", ":", "-.")

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        axes.axhline(0.0, color=LIGHT["muted"], linewidth=0.8)
        for place, (label, (angle, torque)) in enumerate(loops.items()):
            colour, line = colours[place % len(colours)], lines[place // len(colours) % len(lines)]
            marks.curve(axes, angle, torque, color=LIGHT[colour], linestyle=line, linewidth=1.1, label=label)
        marks.label_axes(axes, names[1], "1", names[0], "1")
        marks.legend(figure, axes)

    return figures.inline(draw, (FIGURE_WIDTH, 3.6), name, title)
