"""Figures of reports as SVG: drawn by matplotlib's objects, coloured by the page that shows them.

Colours are names (measured, model, …) that a page defines for its light and its dark scheme, so that one drawing serves
both. The same data give the same bytes.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from strainwave import _core
from strainwave.identify.experiment import DriveLog, FrictionTable, TorsionLoop
from strainwave.recording import envelope
from strainwave.report import typeset
from strainwave.report.experiment import Experiment

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from strainwave.identify.twin import Contradiction, Evidence, Twin

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Element = ElementTree.Element

LIGHT = {
    "ink": "#1c2127",
    "muted": "#59636e",
    "rule": "#d8dee4",
    "measured": "#2166ac",
    "model": "#c2410c",
    "kept-back": "#7b3fa0",
    "earlier": "#80650a",
}
DARK = {
    "ink": "#e6e9ed",
    "muted": "#9aa5b1",
    "rule": "#38414b",
    "measured": "#7ab8ff",
    "model": "#ff9f6b",
    "kept-back": "#d3a4ff",
    "earlier": "#e0c15c",
}
RUNS = ("model", "measured", "kept-back", "earlier")  # colours of the runs of an experiment, in their order
STRETCHES = 300  # of a long record, each drawn by its extremes: about two to a pixel
MARKED = 120  # samples up to which each is drawn as a point

STYLE = {
    "axes.axisbelow": True,
    "axes.edgecolor": LIGHT["muted"],
    "axes.formatter.useoffset": False,
    "axes.grid": True,
    "axes.labelcolor": LIGHT["ink"],
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": "medium",
    "figure.constrained_layout.use": True,
    "font.family": ["DejaVu Sans"],
    "font.size": 9.0,
    "grid.color": LIGHT["rule"],
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.handlelength": 1.6,
    "lines.linewidth": 1.3,
    "lines.markersize": 4.0,
    "svg.fonttype": "none",
    "text.color": LIGHT["ink"],
    "text.parse_math": False,
    "xtick.color": LIGHT["muted"],
    "ytick.color": LIGHT["muted"],
}


# What can be drawn


def friction_table(evidence: Evidence) -> str:
    """Friction torque over speed, measured and modelled, and how far each measurement lies from its prediction."""

    def draw(figure: Figure) -> None:
        torque, residual = _panels(figure, "Friction torque at the input", "Measured less predicted from the others")
        _friction_points(torque, _table(evidence))
        _friction_law(torque, evidence.fit.gear.friction_input, _table(evidence), color=LIGHT["model"], label="model")
        _residual(residual, _table(evidence).speed, evidence.held_out[0], "N.m", np.ones(len(_table(evidence).speed), bool))
        _finish(residual, "speed of the input", "rad/s")
        _legend(torque)

    return _inline(draw, (6.2, 3.9), "friction", f"Friction torque over input speed: {evidence.source}")


def torsion_loop(evidence: Evidence) -> str:
    """Torque over twist, measured and modelled, and the residual along the loop."""

    def draw(figure: Figure) -> None:
        loop, residual = figure.subplots(2, 1, height_ratios=(2.6, 1.0))
        _name(loop, "Torque at the output")
        _name(residual, "Measured less modelled")
        _loop(loop, evidence)
        training = evidence.fit.training
        _residual(residual, np.arange(1.0, len(training) + 1.0), evidence.fit.residuals[0], "N.m", ~training)
        _shade(residual, np.arange(1.0, len(training) + 1.0), ~training)
        _finish(residual, "sample", "1")
        _legend(loop)

    return _inline(draw, (6.2, 5.2), "torsion", f"Torque over twist: {evidence.source}")


def drive_log(evidence: Evidence, channel: int) -> str:
    """One channel of a drive log over time, measured and modelled, and the residual."""
    log = evidence.fit.experiment
    assert isinstance(log, DriveLog)

    def draw(figure: Figure) -> None:
        values, residual = _panels(figure, channel_name(log.channels[channel]), "Measured less modelled")
        measured, predicted = log.measured[channel], evidence.fit.predicted[channel]
        power = _power(np.concatenate((measured, predicted)), log.units[channel])
        _name(values, channel_name(log.channels[channel]), log.units[channel], power)
        _curve(values, log.time, measured / 10.0**power, color=LIGHT["measured"], linewidth=2.2, alpha=0.55, label="measured")
        _curve(values, log.time, predicted / 10.0**power, color=LIGHT["model"], linewidth=1.0, label="model")
        _residual(residual, log.time, evidence.fit.residuals[channel], log.units[channel], ~evidence.fit.training)
        for axes in (values, residual):
            _shade(axes, log.time, ~evidence.fit.training)
        _finish(residual, "time", "s")
        _legend(values)

    return _inline(draw, (6.2, 3.7), log.channels[channel], f"{channel_name(log.channels[channel])}: {evidence.source}")


def two_friction_laws(twin: Twin, evidence: Evidence) -> str:
    """The friction law that a twin started from and the measurement that contradicts it: two data sets."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        table, law = _table(evidence), twin.start.gear.friction_input
        _friction_law(axes, law, table, color=LIGHT["earlier"], linestyle=(0, (6, 2)), linewidth=2.0, label="starting set")
        _friction_law(axes, evidence.fit.gear.friction_input, table, color=LIGHT["model"], linewidth=1.0, label="fitted law")
        _friction_points(axes, table)
        _finish(axes, "speed of the input", "rad/s")
        _name(axes, "Friction torque at the input")
        _legend(axes)

    return _inline(draw, (6.2, 2.9), "contradiction", "Friction law of the starting set and measured friction torque")
