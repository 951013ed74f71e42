"""Drawing of the open loops of a cascade, with their margins."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf, isfinite, tau
from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave.analysis.plots import Response, bode_figure, phase_in_degrees, set_phase_ticks
from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT
from strainwave.typeset import number

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MAX_FREQUENCY_FACTOR = 30.0  # of the frequencies of the margins, down and up, that is drawn
MAX_MAGNITUDE = 1e3  # magnitude that is drawn, and its inverse
PHASE_MARGIN = 20.0  # degrees between the curves and the edge


def margins_figure(margins: Mapping[str, Any]) -> Figure:
    """Return the Bode diagram of open loops: a triangle at each gain margin, a circle at each phase margin.

    Args:
        margins: `Margins` of each loop, by its name
    """
    loops = [Response(_label(name, each), each.frequency / tau, each.loop) for name, each in margins.items()]
    figure = bode_figure(loops, "1", "Open loops: ▲ gain margin, ● phase margin")
    magnitude, phase = figure.axes
    magnitude.axhline(1.0, color=LIGHT["muted"], linewidth=0.8)
    phase.axhline(-180.0, color=LIGHT["muted"], linewidth=0.8)
    ends = [at / tau for each in margins.values() for at in (each.gain_at, each.phase_at) if isfinite(at)]
    low, high = loops[0].frequency[0], loops[0].frequency[-1]
    if ends:
        low, high = min(ends) / MAX_FREQUENCY_FACTOR, min(max(ends) * MAX_FREQUENCY_FACTOR, high)
    for place, each in enumerate(margins.values()):
        colour, log_frequency = marks.line_style(place)["color"], np.log(each.frequency)
        for mark, at in (("^", each.gain_at), ("o", each.phase_at)):
            if isfinite(at):
                size = np.exp(np.interp(np.log(at), log_frequency, np.log(np.abs(each.loop))))
                angle = np.interp(np.log(at), log_frequency, phase_in_degrees(each.loop))
                magnitude.plot([at / tau], [size], mark, color=colour, markersize=6.0)
                phase.plot([at / tau], [angle], mark, color=colour, markersize=6.0)
    shown = [(loop.frequency >= low) & (loop.frequency <= high) for loop in loops]
    angles = np.concatenate([phase_in_degrees(loop.response)[rows] for loop, rows in zip(loops, shown, strict=True)])
    sizes = np.abs(np.concatenate([loop.response[rows] for loop, rows in zip(loops, shown, strict=True)]))
    magnitude.set_xlim(low, high)
    magnitude.set_ylim(max(float(sizes.min()), 1.0 / MAX_MAGNITUDE), min(float(sizes.max()), MAX_MAGNITUDE))
    phase.set_ylim(float(angles.min()) - PHASE_MARGIN, float(angles.max()) + PHASE_MARGIN)
    set_phase_ticks(phase)
    for axis in (magnitude.xaxis, magnitude.yaxis):
        marks.set_log_ticks(axis)
    marks.label_abscissa(phase, "frequency", "Hz")
    return figure


def _label(name: str, margins: Any) -> str:
    phase = "∞" if margins.phase == inf else f"{number(np.degrees(margins.phase), 2)}°"
    return f"{name}: gain margin {number(margins.gain, 2)}, phase margin {phase}"
