"""State of every number of a gear after an identification: determined by a file, or kept, and why."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave import typeset
from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT
from strainwave.files.gear_set import GearSet
from strainwave.identification.results.combined_parameter import CombinedParameter
from strainwave.identification.results.file_result import FileResult, State
from strainwave.identification.results.pictures import SIGMA_OF_95_PERCENT
from strainwave.parameters import gear_numbers, plain
from strainwave.presentation import Presented

if TYPE_CHECKING:
    from matplotlib.figure import Figure

UNDETERMINED = "no file determines it"
NOT_COMPARED = re.compile(r"\[|phase")  # elements of a sequence fitted anew, and phases, whose size means nothing
ROW_HEIGHT, MARGIN_HEIGHT = 0.26, 1.35  # inches
MAX_LINEAR_VALUE_RATIO = 5.0  # of the largest over the smallest ratio; beyond it the axis is logarithmic
MIN_SHARE_OF_AXIS = 0.1  # of an interval that reaches zero or less, where a logarithmic axis ends


@dataclass(frozen=True)
class ParameterState(Presented):
    """State of a number of the gear.

    Attributes:
        path: of the number in the gear set
        unit: its unit
        start: value in the start set; not a number if that has none
        value: value in the gear
        sigma: standard deviation; not a number if it was kept
        state: identified, identified in combination with another (each may be off, together they are not), not identified
            though fitted, or kept from the start set
        why: the reason, or the source
    """

    path: str
    unit: str
    start: float
    value: float
    sigma: float
    state: State
    why: str

    def _headline(self) -> str:
        return f"{self.path} = {typeset.uncertain_quantity(self.value, self.sigma, self.unit)}, {self.state}"


def states_of(
    start: GearSet, gear_set: GearSet, parameters: Sequence[CombinedParameter], files: Sequence[FileResult]
) -> Iterator[ParameterState]:
    """Yield the state of every number of a gear."""
    before = gear_numbers(start.gear)
    combined = {each.estimate.path: each for each in reversed(parameters)}
    in_doubt = {file.name for file in files if file.failed}
    undetermined = {estimate.path: estimate for file in files for estimate in file.estimates if estimate.why}
    for path, (value, unit) in gear_numbers(gear_set.gear).items():
        entry, known = gear_set.sources.get(path), before.get(path, (np.nan, ""))[0]
        source = "" if entry is None else entry.source
        if path in start.sources and start.sources[path] == entry and value == known:
            failed = (each := combined.get(path)) is not None and each.source in in_doubt
            why = f"a check of {each.source} failed" if each is not None and failed else UNDETERMINED
            yield ParameterState(path, unit, known, value, np.nan, "kept", f"{why}; {source}")
        elif source.startswith("assumed"):
            yield ParameterState(path, unit, known, value, np.nan, "kept", source.removeprefix("assumed: "))
        elif (each := combined.get(plain(path))) is not None or source.startswith("identified from"):
            sigma = each.estimate.sigma if each is not None else np.nan
            sigma = entry.uncertainty if entry is not None and entry.uncertainty is not None else sigma
            yield ParameterState(path, unit, known, value, sigma, "identified", source)
        elif source.startswith("identified in combination") and path not in undetermined:
            sigma = np.nan if entry is None or entry.uncertainty is None else entry.uncertainty
            yield ParameterState(path, unit, known, value, sigma, "identified in combination", source)
        elif (estimate := undetermined.get(path)) is not None:
            yield ParameterState(path, unit, known, value, estimate.sigma, estimate.state, estimate.why)
        else:
            yield ParameterState(path, unit, known, value, np.nan, "kept", source)


# ---- Drawing ---------------------------------------------------------------------------------------------------------


def over_start_figure(states: Sequence[ParameterState], start: GearSet, name: str) -> Figure:
    """Return the figure of identified numbers over those of a start set, as `Identified.plot` describes it.

    Args:
        states: of all numbers of the gear
        start: the set
        name: of the gear
    """
    rows = [
        each for each in states
        if each.state == "identified" and np.isfinite(each.start) and each.start != 0.0 and not NOT_COMPARED.search(each.path)
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
        marks.legend(figure, axes)
    return figure


def _spread(start: GearSet, path: str) -> float:
    """Return the spread of a number about its value in a set, relative; 0 if the set states none."""
    entry = start.sources.get(path)
    return 0.0 if entry is None or entry.spread is None else entry.spread
