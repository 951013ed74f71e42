"""Figures of what influences a torsion loop."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import Any

import numpy as np
from influence_claims import by_size
from matplotlib.figure import Figure
from strainwave.rig import Cycle
from strainwave.typeset import ARCMIN_PER_RADIAN, ZERO_CELSIUS, quantity
from torsion_influences import OWN, SPECIMEN, CatalogueRow, Influence, Sweep

FIGURE_WIDTH = 7.0  # inches, of a figure
MAX_WIDTH_IN_ARCMIN = 0.02  # rad: wider loops are drawn in degrees, narrower ones in minutes of arc
RATIO_TICKS = (30, 50, 80, 100, 160)


def figures(found: Influence) -> dict[str, Figure]:
    """Return all figures by their names."""
    drawn = {
        "loops-own": loops_figure(found.drawn[OWN]),
        "loops-specimen": loops_figure(found.drawn[SPECIMEN]),
        "amplitude-own": amplitude_figure(found.amplitude[OWN]),
        "amplitude-specimen": amplitude_figure(found.amplitude[SPECIMEN]),
        "ratio": ratio_figure(found.rows),
        "temperature": temperature_figure(found.temperature),
    }
    if found.preload is not None:
        drawn["preload"] = preload_figure(found.preload, found.input_torque, found.friction)
    return drawn


def loops_figure(loops: Sequence[Cycle]) -> Figure:
    """Draw loops of several torques, the largest behind."""
    angle, unit = _angles(max(float(np.ptp(each.angle)) for each in loops))
    figure = Figure((FIGURE_WIDTH, 4.0), layout="constrained")
    axes = figure.subplots()
    for loop, shade in zip(reversed(loops), np.linspace(1.0, 0.35, len(loops)), strict=True):
        label = quantity(loop.peak, "N.m", 3)
        axes.plot(angle * loop.angle, loop.torque, color="tab:orange", alpha=float(shade), label=label)
    axes.set(ylabel=f"torque on the {loops[0].side} [N·m]", xlabel=f"angle of the {loops[0].side} [{unit}]")
    axes.legend()
    return figure


def _angles(largest: float) -> tuple[float, str]:
    return (degrees(1.0), "°") if largest > MAX_WIDTH_IN_ARCMIN else (ARCMIN_PER_RADIAN, "′")


def amplitude_figure(sweep: Sweep) -> Figure:
    """Draw area, width and slopes over the torque level."""
    angle, unit = _angles(float(sweep["width"].max()))
    figure = Figure((FIGURE_WIDTH, 6.5), layout="constrained")
    area, width, slopes = figure.subplots(3, 1, sharex=True)
    lost = sweep["area"] > 0.0
    area.plot(sweep.levels[lost], sweep["area"][lost], color="tab:orange", marker="o")
    width.plot(sweep.levels, angle * sweep["width"], color="tab:orange", marker="o")
    slopes.plot(sweep.levels, sweep["high_stiffness"], color="tab:blue", marker="^", label="unloading")
    slopes.plot(sweep.levels, sweep["low_stiffness"], color="tab:green", marker="v", label="loading")
    slopes.plot(sweep.levels, sweep["stiffness"], color="black", linestyle="--", label="peak to peak")
    area.set(yscale="log", ylabel="area [J]")
    width.set_ylabel(f"width at equal torque [{unit}]")
    slopes.set(xscale="log", ylabel="stiffness [N·m/rad]", xlabel="largest torque [N·m]")
    slopes.set_ylim(bottom=0.0)
    slopes.legend()
    return figure


def ratio_figure(rows: tuple[CatalogueRow, ...]) -> Figure:
    """Draw the first stiffness over the ratio, by size: at the output, and as the input sees it."""
    figure = Figure((FIGURE_WIDTH, 5.4), layout="constrained")
    output, input_ = figure.subplots(2, 1, sharex=True)
    for size, sized in list(by_size(rows).items())[::2]:
        ratios, stiffness = np.array([row.ratio for row in sized], float), np.array([row.k1 for row in sized])
        output.loglog(ratios, stiffness, marker="o", label=f"size {size}")
        input_.loglog(ratios, stiffness / ratios**2, marker="o")
    for axes in (output, input_):
        axes.set_xticks(RATIO_TICKS, [str(each) for each in RATIO_TICKS])
        axes.minorticks_off()
    output.set_ylabel("K₁ at the output [N·m/rad]")
    input_.set(ylabel="K₁/i², as the input sees it [N·m/rad]", xlabel="ratio")
    output.legend()
    return figure


def preload_figure(sweep: Sweep, peak: float, friction: float) -> Figure:
    """Draw area and width of the loop at the input over the friction there."""
    angle, unit = _angles(float(sweep["width"].max()))
    figure = Figure((FIGURE_WIDTH, 4.4), layout="constrained")
    area, width = figure.subplots(2, 1, sharex=True)
    style: dict[str, Any] = {"color": "tab:orange", "marker": "o"}
    area.plot(sweep.levels, sweep["area"], **style)
    width.plot(sweep.levels, angle * sweep["width"], **style)
    label = f"friction at the input over {quantity(friction, 'N.m')}; the torque is {quantity(peak, 'N.m')}"
    area.set(ylabel="area [J]", ylim=(0.0, None))
    width.set(ylabel=f"width at equal torque [{unit}]", xlabel=label, ylim=(0.0, None))
    return figure


def temperature_figure(sweep: Sweep) -> Figure:
    """Draw area and slopes of the loop at the input over the temperature."""
    celsius, figure = sweep.levels - ZERO_CELSIUS, Figure((FIGURE_WIDTH, 4.6), layout="constrained")
    area, slopes = figure.subplots(2, 1, sharex=True)
    area.plot(celsius, sweep["area"], color="tab:orange", marker="o")
    slopes.plot(celsius, sweep["high_stiffness"], color="tab:blue", marker="^", label="unloading")
    slopes.plot(celsius, sweep["low_stiffness"], color="tab:green", marker="v", label="loading")
    area.set(ylabel="area [J]", ylim=(0.0, None))
    slopes.set(ylabel="slope [N·m/rad]", xlabel="temperature [°C]", ylim=(0.0, None))
    slopes.legend()
    return figure
