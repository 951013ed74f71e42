"""Drawing of an ensemble: median and bands of its members over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT
from strainwave.files.plots import MARGIN_HEIGHT, PANEL_HEIGHT, in_words
from strainwave.messages import in_a_sentence

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
BANDS = ((0.05, 0.95, "90 % of members", 0.2), (0.25, 0.75, "50 % of members", 0.45))  # quantiles, label, opacity
LEGEND_HEIGHT = 0.3  # inch
MAX_INSTANTS = 2_000  # that are drawn; of more every n-th


def ensemble_figure(time: Array, columns: Mapping[str, Array], units: Mapping[str, str], names: Sequence[str]) -> Figure:
    """Return the figure of some outputs, as `Ensemble.plot` describes it."""
    step = -(-len(time) // MAX_INSTANTS)
    ran = ~np.isnan(columns[names[0]][:, 0])
    title = f"{in_a_sentence([in_words(name) for name in names])} of {ran.sum()} members"
    with marks.new_figure(MARGIN_HEIGHT + LEGEND_HEIGHT + PANEL_HEIGHT * len(names), title[0].upper() + title[1:]) as figure:
        axes = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
        for axis, name in zip(axes, names, strict=True):
            values = columns[name][ran, ::step]
            for low, high, label, opacity in BANDS:
                edges = np.quantile(values, (low, high), axis=0)
                style = {"facecolor": LIGHT["measured"], "alpha": opacity, "linewidth": 0.0}
                axis.fill_between(time[::step], *edges, label=label, **style)
            axis.plot(time[::step], np.median(values, axis=0), color=LIGHT["ink"], label="median")
            axis.margins(x=0.01)
            marks.label_axes(axis, in_words(name), units[name])
        marks.label_abscissa(axes[-1], "time", "s")
        marks.legend(figure, axes[0], below=True)
    return figure
