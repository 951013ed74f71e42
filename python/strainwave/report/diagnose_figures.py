"""Figures of a diagnosis: changes against their limits, amplitude over load, condition over the recordings."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from strainwave.diagnose.baseline import BaselineComparison
from strainwave.diagnose.diagnosis import Diagnosis, WaveRipple
from strainwave.drawing import marks
from strainwave.drawing.style import FIGURE_WIDTH, LIGHT
from strainwave.report import figures

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DIRECTIONS = (("forward", "model", "o", -0.12), ("backward", "earlier", "s", 0.12))
MAX_CHANGES = 24  # that are drawn


def changes_figure(comparison: BaselineComparison, unit: str, name: str) -> str:
    """Return the figure of the amplitudes of a recording over its orders, with the band that is no alarm."""
    drawn = sorted(comparison.changes[:MAX_CHANGES], key=lambda each: each.order)
    orders = sorted({each.order for each in drawn})

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for direction, colour, mark, shift in DIRECTIONS:
            own = [each for each in drawn if each.direction == direction]
            x = np.array([orders.index(each.order) + shift for each in own])
            low = [max(each.baseline - each.limit, 0.0) for each in own]
            high = [each.baseline + each.limit for each in own]
            axes.vlines(x, low, high, color=LIGHT["muted"], linewidth=5.0, alpha=0.45)
            axes.plot(x, [each.baseline for each in own], "_", color=LIGHT["ink"], markersize=9)
            axes.plot(x, [each.amplitude for each in own], mark, color=LIGHT[colour], label=f"recording, {direction}")
        axes.set_ylim(bottom=0.0)
        marks.label_axes(axes, "amplitude", unit, "order per revolution of the shaft", "1")
        axes.set_xticks(range(len(orders)), [f"{order:.5g}" for order in orders], rotation=60)
        marks.legend(figure, axes)

    return figures.inline(draw, (FIGURE_WIDTH, 3.0), name, "Amplitudes of the recording and what the baseline allows")


def load_figure(wave: WaveRipple, unit: str, name: str) -> str:
    """Return the figure of the ripple of the wave generator over the load, by direction; empty with a single load."""
    if len({each.low for each in wave.cells}) < 2:
        return ""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for direction, colour, mark, _ in DIRECTIONS:
            own = [each for each in wave.cells if each.direction == direction]
            if own:
                x = [0.5 * (each.low + each.high) for each in own]
                y, sigma = [each.amplitude for each in own], [each.sigma for each in own]
                axes.errorbar(x, y, yerr=sigma, fmt=mark, color=LIGHT[colour], capsize=3.0, label=direction)
        axes.set_xlim(left=0.0)
        axes.set_ylim(bottom=0.0)
        marks.label_axes(axes, "amplitude", unit, "size of the load", unit)
        marks.legend(figure, axes)

    return figures.inline(draw, (FIGURE_WIDTH, 2.6), name, "Ripple of the wave generator over the load")


def condition_figure(found: Diagnosis, hours: Sequence[float], name: str) -> str:
    """Return the figure of the health indicator over the recordings, or over the hours of operation; empty below two."""
    conditions = [each.condition for each in found.runs if each.condition is not None]
    if len(conditions) < 2:
        return ""
    timed = len(hours) == len(conditions)
    x = np.array(hours) if timed else np.arange(1.0, len(conditions) + 1.0)

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        axes.axhline(1.0, color=LIGHT["earlier"], linestyle="--", linewidth=0.9, label="alarm")
        axes.plot(x, [each.indicator for each in conditions], "o", color=LIGHT["measured"], label="health indicator")
        if found.trend is not None:
            axes.axhline(found.trend.threshold, color=LIGHT["muted"], linewidth=0.9, label="threshold")
            level = float(np.mean([each.indicator for each in conditions]))
            end = float(x.max()) + min(found.trend.remaining, 2.0 * float(np.ptp(x)))
            line = np.array([float(x.min()), end])
            axes.plot(line, level + found.trend.slope * (line - float(x.mean())), color=LIGHT["model"], label="trend")
        axes.set_ylim(bottom=0.0)
        marks.label_axes(axes, "indicator", "1", "hours of operation" if timed else "recording", "h" if timed else "1")
        marks.legend(figure, axes)

    return figures.inline(draw, (FIGURE_WIDTH, 2.6), name, "Health indicator")
