"""Drawing of a Campbell diagram."""

from __future__ import annotations

from collections.abc import Sequence
from math import tau
from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave import typeset
from strainwave.drawing import marks

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FIGURE_HEIGHT = 3.8  # inches
DYNAMIC_RANGE = 1e4  # largest over smallest amplitude that a colour shows
MAX_FREQUENCY_RATIO = 1.5  # of the highest eigenfrequency drawn
LABEL_SHARE = 0.97  # of the way along the line of an order, where its name stands


def campbell_figure(diagram: Any, orders: Sequence[float], eigenfrequencies: Sequence[float]) -> Figure:
    """Return the figure of a `Campbell`, as its `plot` describes it.

    Args:
        diagram: spectra over the speed
        orders: lines of the shaft
        eigenfrequencies: [Hz]
    """
    lowest, highest = float(diagram.speed[0]), float(diagram.speed[-1])
    top = _top(diagram.frequency, highest, orders, eigenfrequencies)
    shown = diagram.frequency <= top
    column = diagram.column.replace("_", " ")
    dashed = f"; dashed: {'eigenfrequency' if len(eigenfrequencies) == 1 else 'eigenfrequencies'}" if eigenfrequencies else ""
    with marks.new_figure(FIGURE_HEIGHT, f"Campbell diagram of {column}{dashed}") as figure:
        axes = figure.subplots()
        largest = float(diagram.amplitude.max())
        colours = axes.pcolormesh(
            diagram.speed, diagram.frequency[shown], diagram.amplitude[:, shown].T,
            norm="log", vmin=largest / DYNAMIC_RANGE, vmax=largest, cmap="cividis", rasterized=True, shading="nearest",
        )  # fmt: skip
        axes.grid(visible=False)
        axes.set_facecolor("#00224e")  # the darkest of cividis
        bar = figure.colorbar(colours, ax=axes, location="bottom", aspect=40, pad=0.02)
        bar.set_label(f"amplitude [{typeset.unit(diagram.unit)}]" if diagram.unit != "1" else "amplitude")
        for frequency in (each for each in eigenfrequencies if each <= top):
            axes.axhline(frequency, color="white", linestyle="--", linewidth=1.0)
            label = f" {typeset.quantity(frequency, 'Hz')}"
            axes.text(1.0, frequency, label, transform=axes.get_yaxis_transform(), va="center", fontsize="small")
        for order in orders:
            end = min(highest, LABEL_SHARE * top * tau / order)
            axes.plot([lowest, end], [order * lowest / tau, order * end / tau], color="white", linestyle=":", linewidth=0.9)
            axes.text(
                end, order * end / tau, f"{order:.4g} ", color="white", ha="right", va="top" if end < highest else "bottom",
                fontsize="small",
            )  # fmt: skip
        axes.set_xlim(lowest, highest)
        axes.set_ylim(0.0, top)
        marks.label_axes(axes, "frequency", "Hz", diagram.speed_column.replace("_", " "), "rad/s")
    return figure


def _top(frequency: Any, speed: float, orders: Sequence[float], eigenfrequencies: Sequence[float]) -> float:
    """Return the highest frequency of the axis: above all eigenfrequencies, and what orders reach if there are none."""
    nyquist = float(frequency[-1])
    if eigenfrequencies:
        return min(nyquist, MAX_FREQUENCY_RATIO * max(eigenfrequencies))
    return min(nyquist, max(orders, default=np.inf) * speed / tau)
