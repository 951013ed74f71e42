"""Figures of orders: spectra over the angle, orders against time, the transmission error."""

from __future__ import annotations

from itertools import pairwise
from math import tau
from typing import TYPE_CHECKING

import numpy as np

from strainwave.drawing import marks
from strainwave.drawing.style import FIGURE_WIDTH, LIGHT
from strainwave.orders.torque_ripple import Ripple, draw_spectrum
from strainwave.orders.two_encoders import TransmissionError, draw_error
from strainwave.report import figures

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TURN_BINS = 60  # of a revolution, over which samples are averaged
TIME_BLOCKS = 40  # of time, in the map
ORDER_CELLS = 90  # of the order, in the map
SHADE_LIMITS = (0.25, 0.45, 0.7, 1.0)  # of a cell, over the largest amplitude
MIN_SPEED_SPREAD = 0.1  # of the speed, above which a map shows more than the spectrum
MIN_BLOCK_SAMPLES = 8  # samples of a block that can show anything


def spectrum_figure(ripple: Ripple, name: str) -> str:
    """Return the figure of amplitude over order, with floor, threshold and lines."""
    return figures.inline(
        lambda figure: draw_spectrum(figure, ripple), (FIGURE_WIDTH, 3.0), name, "Amplitude of ripple over its order"
    )


def map_figure(ripple: Ripple, name: str) -> str:
    """Return the figure of order against time; empty if the speed is constant, or no time is known."""
    curves = ripple.curves
    if "time" not in curves or not ripple.lines:
        return ""
    speed = np.abs(curves["speed"])
    if float(np.std(speed)) < MIN_SPEED_SPREAD * float(np.mean(speed)):
        return ""
    drawn = [line.order for line in ripple.lines if line.kind != "joint" and line.order <= ripple.highest * 1.01]
    highest = min(ripple.highest, 1.3 * max(drawn, default=ripple.highest))
    order = np.linspace(ripple.lowest, highest, ORDER_CELLS)
    wave = curves["series"] - curves["smooth"]
    edges = np.linspace(0, len(wave), TIME_BLOCKS + 1).astype(int)
    blocks = [slice(low, high) for low, high in pairwise(edges.tolist()) if high - low >= MIN_BLOCK_SAMPLES]
    rows = []
    for block in blocks:
        window = np.hanning(block.stop - block.start)
        turned = np.exp(-1j * np.outer(order, curves["angle"][block]))
        rows.append(2.0 / window.sum() * np.abs(turned @ (window * (wave[block] - wave[block].mean()))))
    amplitude = np.array(rows)
    middle = np.array([float(curves["time"][block].mean()) for block in blocks])
    share = np.minimum(amplitude / np.quantile(amplitude, 0.995), 1.0)  # where friction turns over, all orders are large

    def draw(figure: Figure) -> None:
        axes, below = figure.subplots(2, 1, sharex=True, height_ratios=(2.6, 1.0))
        for low, high in zip(SHADE_LIMITS, (*SHADE_LIMITS[1:], 1.1), strict=True):
            row, column = np.nonzero((share >= low) & (share < high))
            axes.plot(middle[row], order[column], "s", color=LIGHT["measured"], alpha=low, markersize=2.6, markeredgewidth=0.0)
        marks.curve(below, curves["time"], curves["speed"], color=LIGHT["ink"], linewidth=0.8)
        axes.set_ylim(ripple.lowest, highest)
        marks.label_axes(axes, f"order per revolution of the {ripple.side}", "1")
        marks.label_axes(below, "speed", "rad/s", "time", "s")

    return figures.inline(draw, (FIGURE_WIDTH, 3.6), name, "Amplitude of ripple over order and time")


def error_figure(error: TransmissionError, name: str) -> str:
    """Return the figure of the transmission error over the record, its orders and its residual."""
    return figures.inline(
        lambda figure: draw_error(figure, error), (FIGURE_WIDTH, 3.6), name, "Transmission error, kinematic error and residual"
    )


def turn_figure(error: TransmissionError, name: str) -> str:
    """Return the figure of the kinematic error over a revolution of the input, with the residual of the samples."""
    law = error.law
    turn = np.linspace(0.0, 1.0, 400)
    angle, residual = error.curves["input_angle"], error.curves["residual"]
    bins = ((angle / tau) % 1.0 * TURN_BINS).astype(int) % TURN_BINS
    counts = np.bincount(bins, minlength=TURN_BINS)
    measured = np.bincount(bins, law.error(angle) + residual, TURN_BINS)[counts > 0] / counts[counts > 0]
    middle = ((np.arange(TURN_BINS) + 0.5) / TURN_BINS)[counts > 0]

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        axes.plot(middle, measured, "o", color=LIGHT["measured"], markersize=2.8, label="mean of the samples")
        axes.plot(turn, law.error(tau * turn), color=LIGHT["model"], label="significant orders")
        marks.label_axes(axes, "kinematic error", "rad", "revolution of the input", "1")
        marks.legend(figure, axes)

    return figures.inline(draw, (FIGURE_WIDTH, 2.8), name, "Kinematic error over a revolution of the input")
