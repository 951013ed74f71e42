"""Figures of an identification: the estimates of all files, and each file measured against modelled."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strainwave.drawing import marks
from strainwave.drawing.style import FIGURE_WIDTH, LIGHT
from strainwave.identification.results.combined_parameter import MAX_DISTANCE
from strainwave.identification.results.file_result import FileResult
from strainwave.identification.results.pictures import (
    SIGMA_OF_95_PERCENT,
    Picture,
    Subject,
    draw_measured,
    draw_picture,
    loop_points,
    picture_label,
    table_points,
)
from strainwave.report import figures

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
ROW_HEIGHT = 0.19  # inches, of a row of a comparison
MAX_LETTERS = 22  # of a line of the name of a file beside a drawing
PANEL_SIZE = (3.5, 2.25)  # inches, of a picture of the first screen
SUBJECTS: dict[Subject, str] = {  # of the pictures of the first screen, in their order
    "torque": "Torque, measured and predicted",
    "friction": "Friction over speed",
    "twist": "Twist over torque",
    "error": "Error over a turn, and its orders",
}
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
class EstimateRow:
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


def comparison(numbers: Sequence[tuple[str, Sequence[EstimateRow]]], name: str) -> str:
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
                ticks.append((place, textwrap.fill(row.file, MAX_LETTERS)))
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
        draw, (FIGURE_WIDTH, 0.75 + ROW_HEIGHT * count), name, "Each parameter by each file, with its interval of 95 %"
    )


def _reach(rows: Sequence[EstimateRow]) -> float:
    """Return the end of the axis, beyond all values and most of their intervals [%]."""
    values = max(abs(row.off) for row in rows)
    ends = np.quantile([abs(row.off) + SIGMA_OF_95_PERCENT * row.sigma for row in rows], WHOLE_QUANTILE, method="higher")
    return 1.15 * max(values, float(ends), 1e-6)


def _interval(axes: Axes, row: EstimateRow, place: int) -> None:
    mark, colour, filled = LOOKS[row.look]
    half = SIGMA_OF_95_PERCENT * row.sigma
    axes.plot([row.off - half, row.off + half], [place, place], "-", color=LIGHT[colour], linewidth=1.4, solid_capstyle="butt")
    style: dict[str, Any] = {"markerfacecolor": LIGHT[colour] if filled else "none", "markeredgecolor": LIGHT[colour]}
    axes.plot([row.off], [place], mark, color=LIGHT[colour], markersize=4.4, **style)


def _looks_legend(figure: Figure, axes: Axes, rows: Sequence[EstimateRow]) -> None:
    for look, (mark, colour, filled) in LOOKS.items():
        if any(row.look == look for row in rows):
            style: dict[str, Any] = {"markerfacecolor": LIGHT[colour] if filled else "none", "markeredgecolor": LIGHT[colour]}
            axes.plot([], [], mark, color=LIGHT[colour], markersize=4.4, label=look, **style)
    marks.legend(figure, axes)


# ---- One file --------------------------------------------------------------------------------------------------------


def file_figure(result: FileResult, picture: Picture, name: str) -> str:
    """Draw measured against modelled, and below what is left, with two bands of 95 %: of the model, and of the residuals."""

    def draw(figure: Figure) -> None:
        marks.legend(figure, draw_picture(figure, picture))

    title, height = f", {picture.title}" if picture.title else "", 2.6 if picture.look == "turn" else 3.9
    return figures.inline(draw, (FIGURE_WIDTH, height), name, f"Measured against modelled, {result.name}{title}")


def panel(result: FileResult, picture: Picture, name: str) -> str:
    """Draw measured and modelled of a picture small, without the residual."""

    def draw(figure: Figure) -> None:
        marks.legend(figure, draw_measured(figure, picture))

    return figures.inline(draw, PANEL_SIZE, name, f"{SUBJECTS[picture.subject]}, {result.name}")


def overview(loop: Picture, table: Picture) -> str:
    """Draw a picture by itself: a torsion loop and a friction table, measured and modelled."""

    def draw(figure: Figure) -> None:
        left, right = figure.subplots(1, 2)
        loop_points(left, loop.curves)
        table_points(right, table.curves)
        marks.label_axes(left, f"twist{picture_label(loop).removeprefix('torque')}", "rad", "torque", "N.m")
        marks.label_axes(right, picture_label(table), "N.m", "input speed", "rad/s")
        marks.legend(figure, left)

    title = "Torsion loop and friction of two strain wave gears, measured and modelled"
    return figures.standalone(draw, (8.4, 3.2), "overview", title)
