"""Pictures of orders: the spectrum of a ripple, and the transmission error over its record."""

from __future__ import annotations

from math import tau
from typing import TYPE_CHECKING

import numpy as np

from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strainwave.orders.torque_ripple import Ripple
    from strainwave.orders.two_encoders import TransmissionError

MAX_DRAWN_TURNS = 6.0  # of the input: the error of a longer record is a band of one colour


def draw_spectrum(figure: Figure, ripple: Ripple) -> None:
    """Draw amplitude over order, with noise, threshold and lines."""
    axes = figure.subplots()
    spectrum = ripple.spectrum
    order = spectrum["order"]
    marks.curve(axes, order, spectrum["amplitude"], color=LIGHT["measured"], linewidth=0.9, label="spectrum")
    marks.curve(axes, order, spectrum["floor"], color=LIGHT["muted"], linewidth=0.9, label="noise")
    marks.curve(axes, order, spectrum["threshold"], color=LIGHT["earlier"], linestyle="--", label="needed for a line")
    for kind, colour, mark in (("order", "model", "o"), ("time", "held-out", "x"), ("either", "earlier", "s")):
        lines = [line for line in ripple.lines if line.kind == kind and line.order <= ripple.highest]
        if lines:
            where = [line.order for line in lines], [line.amplitude for line in lines]
            axes.plot(*where, mark, color=LIGHT[colour], label={"either": "order or time"}.get(kind, f"{kind} line"))
    axes.set_ylim(bottom=0.0)
    marks.label_axes(axes, "amplitude", ripple.unit, f"order per revolution of the {ripple.side}", "1")
    marks.legend(figure, axes)


def draw_error(figure: Figure, error: TransmissionError) -> None:
    """Draw the transmission error over the record, its orders and its residual."""
    curves = error.curves
    timed = "time" in curves
    x = curves["time"] if timed else curves["input_angle"] / tau
    turns = np.abs(curves["input_angle"] - curves["input_angle"][0]) / tau
    is_cut = bool(turns.max() > 2.0 * MAX_DRAWN_TURNS)
    first = turns <= MAX_DRAWN_TURNS if is_cut else np.ones(len(turns), bool)
    whole, residual = figure.subplots(2, 1, sharex=not is_cut, height_ratios=(2.0, 1.0))
    for name, colour, label in (
        ("transmission_error", "measured", "transmission error"),
        ("kinematic_error", "model", "kinematic error found"),
    ):
        marks.curve(whole, x[first], curves[name][first], color=LIGHT[colour], linewidth=0.9, label=label)
    marks.curve(residual, x, curves["residual"], color=LIGHT["ink"], linewidth=0.8)
    residual.axhline(0.0, color=LIGHT["muted"], linewidth=0.8)
    marks.label_axes(whole, f"at the output{f', first {MAX_DRAWN_TURNS:g} turns of the input' if is_cut else ''}", "rad")
    marks.label_axes(
        residual, "left by orders and loads", "rad", "time" if timed else "revolutions of the input", "s" if timed else "1"
    )
    marks.legend(figure, whole)
