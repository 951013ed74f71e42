"""Drawings of linear and periodic responses, and of sensitivities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

BODE_HEIGHT = 4.2  # inches
PHASE_STEPS = (1.0, 5.0, 15.0, 45.0, 90.0, 180.0, 360.0)  # degrees between two ticks
MAX_PHASE_TICKS = 6
MAX_MARKED_FREQUENCIES = 40  # frequencies of a response, each of which is drawn as a point
BAR_HEIGHT, MARGIN_HEIGHT = 0.24, 1.15  # inches
MAX_BARS = 12  # parameters that are drawn, the strongest


class Response(NamedTuple):
    """A response over the frequency [Hz], both of shape (k,), to be drawn; in the legend if it has a label."""

    label: str
    frequency: Array
    response: NDArray[np.complex128]


def bode_figure(responses: Sequence[Response], unit: str, title: str) -> Figure:
    """Return a Bode diagram: magnitude with its unit, and phase, over the frequency."""
    with marks.new_figure(BODE_HEIGHT, title) as figure:
        magnitude, phase = figure.subplots(2, 1, sharex=True)
        for place, (label, frequency, response) in enumerate(responses):
            points = "o" if len(frequency) <= MAX_MARKED_FREQUENCIES else ""
            style = {**marks.line_style(place), "marker": points, "label": label}
            magnitude.plot(frequency, np.abs(response), **style)
            phase.plot(frequency, phase_in_degrees(response), **style)
        magnitude.set_yscale("log")
        magnitude.set_xscale("log")
        set_phase_ticks(phase)
        for axis in (magnitude.xaxis, magnitude.yaxis):
            marks.set_log_ticks(axis)
        marks.label_axes(magnitude, "magnitude", unit)
        marks.label_axes(phase, "phase", "deg", "frequency", "Hz")
        if responses[0].label:
            marks.legend(figure, magnitude)
    return figure


def set_phase_ticks(axes: Axes) -> None:
    """Set the ticks of an axis in degrees to a whole part of a turn."""
    from matplotlib.ticker import MultipleLocator

    span = float(np.ptp(axes.get_ylim()))
    step = next((step for step in PHASE_STEPS if span / step <= MAX_PHASE_TICKS), PHASE_STEPS[-1])
    axes.yaxis.set_major_locator(MultipleLocator(step))


def phase_in_degrees(response: NDArray[np.complex128]) -> Array:
    """Return the phase without jumps [deg], from between -360 and 0 on."""
    phase = np.degrees(np.unwrap(np.angle(response)))
    return np.asarray(phase - 360.0 * np.ceil((phase[0] - 1.0) / 360.0))  # a phase of rounding about 0 stays there


def sensitivity_figure(effects: Mapping[str, float], unit: str, output: str, percent: float) -> Figure:
    """Return bars of the effects of parameters on an output, the largest first, of a change of each by some percent."""
    strongest = sorted(effects, key=lambda path: -effects[path])[:MAX_BARS]
    which = f"the {MAX_BARS} strongest of {len(effects)} parameters" if len(effects) > MAX_BARS else "parameters"
    with marks.new_figure(MARGIN_HEIGHT + BAR_HEIGHT * len(strongest), f"Sensitivity of {output} to {which}") as figure:
        axes = figure.subplots()
        axes.barh(range(len(strongest)), [effects[path] for path in strongest], height=0.7, color=LIGHT["measured"])
        axes.set_yticks(range(len(strongest)), strongest, fontsize="small")
        axes.set_ylim(len(strongest) - 0.5, -0.5)  # the first one on top
        axes.grid(visible=False, axis="y")
        axes.tick_params(axis="y", length=0.0)
        marks.label_abscissa(axes, f"rms change by + {percent:g} %", unit)
    return figure
