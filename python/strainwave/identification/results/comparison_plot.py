"""Drawing of identified numbers over those of the set that the identification started from."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT
from strainwave.files.gear_set import GearSet
from strainwave.identification.results.parameter_state import ParameterState
from strainwave.identification.results.picture_plot import SIGMA_OF_95_PERCENT

if TYPE_CHECKING:
    from matplotlib.figure import Figure

UNCOMPARED = re.compile(r"\[|phase")  # elements of a sequence fitted anew, and phases, whose size means nothing
ROW_HEIGHT, MARGIN_HEIGHT = 0.26, 1.35  # inches
MAX_LINEAR_VALUE_RATIO = 5.0  # of the largest over the smallest ratio; beyond it the axis is logarithmic
MIN_SHARE_OF_AXIS = 0.1  # of an interval that reaches zero or less, where a logarithmic axis ends


def over_start_figure(states: Sequence[ParameterState], start: GearSet, name: str) -> Figure:
    """Return the figure of identified numbers over those of a start set, as `Identified.plot` describes it.

    Args:
        states: of all numbers of the gear
        start: the set
        name: of the gear
    """
    rows = [
        each for each in states
        if each.state == "identified" and np.isfinite(each.start) and each.start != 0.0 and not UNCOMPARED.search(each.path)
    ]  # fmt: skip
    if not rows:
        raise ValueError(f"no identified number has a value in {start.name}: there is nothing to compare")
    ratio = np.array([each.value / each.start for each in rows])
    half = SIGMA_OF_95_PERCENT * np.nan_to_num([each.sigma / abs(each.start) for each in rows])
    with marks.new_figure(MARGIN_HEIGHT + ROW_HEIGHT * len(rows), f"{name} over {start.name}") as figure:
        axes, places = figure.subplots(), np.arange(len(rows))
        spread = np.array([_spread(start, each.path) for each in rows])
        stated = spread > 0.0
        if stated.any():
            style: dict[str, Any] = {"height": 0.8, "color": LIGHT["rule"], "label": "spread of individual gears"}
            axes.barh(places[stated], 2.0 * spread[stated], left=1.0 - spread[stated], **style)
        axes.axvline(1.0, color=LIGHT["muted"], linewidth=0.9, label=start.name)
        if ratio.min() > 0.0 and ratio.max() > MAX_LINEAR_VALUE_RATIO * ratio.min():
            axes.set_xscale("log")
            half = np.minimum(half, (1.0 - MIN_SHARE_OF_AXIS) * ratio)
        axes.errorbar(
            ratio, places, xerr=half, fmt="o", color=LIGHT["measured"], capsize=3.0, label="identified, interval of 95 %"
        )
        if axes.get_xscale() == "log":
            marks.set_log_ticks(axes.xaxis)
        axes.set_yticks(places, [each.path.removeprefix("gear.") for each in rows], fontsize="small")
        axes.set_ylim(len(rows) - 0.5, -0.5)
        axes.grid(visible=False, axis="y")
        axes.tick_params(axis="y", length=0.0)
        marks.label_abscissa(axes, f"value over that of {start.name}", "1")
        marks.legend(figure, axes, below=True)
    return figure


def _spread(start: GearSet, path: str) -> float:
    """Return the spread of a number about its value in a set, relative; 0 if the set states none."""
    entry = start.sources.get(path)
    return 0.0 if entry is None or entry.spread is None else entry.spread
