"""Figures of a gear and of a recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from strainwave import Gear
from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT
from strainwave.messages import in_a_sentence, listed, quoted

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FASTEST_DRAWN_SPEED = 200.0  # rad/s of the input: 1900 rpm, where most gears are rated
FRICTION_SHARE = 5.0  # torque over that of friction at the input, times the ratio: about that of the rated torque
HYSTERESIS_SHARE = 10.0  # torque over half the width of the loop
KNEE_SHARE = 1.3  # torque over that of the last knee
USUAL_TWIST = 1e-3  # rad, of a gear without friction, hysteresis and knees
BRANCH_POINTS = 200  # of a branch


def gear_figure(gear: Gear, title: str) -> Figure:
    """Return the figure of a gear: the loop of twist over torque, and friction at the input over speed."""
    beginning = np.linspace(0.0, 1.0, BRANCH_POINTS)
    loop_of_torque = np.concatenate([np.linspace(1.0, -1.0, BRANCH_POINTS), np.linspace(-1.0, 1.0, BRANCH_POINTS)])
    largest = _largest_torque(gear)
    torque = largest * loop_of_torque
    twist = np.asarray(gear.twist(largest * np.concatenate([beginning, loop_of_torque])))[BRANCH_POINTS:]
    speed = np.linspace(0.005 * FASTEST_DRAWN_SPEED, FASTEST_DRAWN_SPEED, BRANCH_POINTS)
    with marks.new_figure(4.2, title) as figure:
        loop, friction = figure.subplots(2, 1)
        loop.plot(torque, twist, color=LIGHT["measured"])
        friction.plot(speed, np.asarray(gear.friction_input.steady(speed)), color=LIGHT["model"])
        friction.set_ylim(bottom=0.0)
        marks.label_axes(loop, "twist", "rad", "torque of the output", "N.m")
        marks.label_axes(friction, "friction at the input", "N.m", "speed of the input", "rad/s")
    return figure


def _largest_torque(gear: Gear) -> float:
    """Return a torque that shows the knees, the loop and about the rated load of a gear [N.m]."""
    ratio = abs(float(gear.kinematics.ratio))
    knee = float(getattr(gear.stiffness, "t2", 0.0))
    friction = ratio * float(gear.friction_input.steady(0.1 * FASTEST_DRAWN_SPEED))
    loop = 0.5 * float(np.ptp(gear.hysteresis.trace(np.array([0.0, 1e-2, 0.0]))))
    shown = max(KNEE_SHARE * knee, FRICTION_SHARE * friction, HYSTERESIS_SHARE * loop)
    return shown or float(gear.stiffness.torque(USUAL_TWIST))


# ---- Recordings ------------------------------------------------------------------------------------------------------


Array = NDArray[np.float64]
MAX_RATIO_IN_PANEL = 20.0  # of the largest values of two curves; beyond it the smaller one is flat, and gets its own panel
MIN_RELATIVE_SWING = 1e-9  # swing over the largest value of its unit; a curve that swings less is constant but for rounding
MAX_DRAWABLE = 1e300  # value; the range of an axis, with its margins, must be a number too
MAX_RECORDING_STRETCHES = 5_000  # of a long curve, each drawn by its extremes
MAX_IN_TITLE = 3  # columns that a title names
PANEL_HEIGHT, MARGIN_HEIGHT = 1.3, 0.7  # inches


def recording_figure(
    columns: Mapping[str, Array], units: Mapping[str, str], names: Sequence[str] | None, against: str, title: str
) -> Figure:
    """Return the figure of columns, as `Recording.plot` describes it.

    Args:
        columns, units: of the recording
        names: the columns to draw, known to be there; those that change if None
        against: the column on the axis
        title: of the figure; the names of the columns if empty
    """
    drawn = _changing(columns, units, against) if names is None else list(names)
    if not drawn:
        raise ValueError(f"nothing to draw against {quoted(against)}; there are {listed(columns)}")
    for name in (*drawn, against):
        _check_drawable(name, columns[name])
    panels = _panels({name: columns[name] for name in drawn}, units)
    with marks.new_figure(MARGIN_HEIGHT + PANEL_HEIGHT * len(panels), title or _title(drawn, against)) as figure:
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for axis, panel in zip(axes, panels, strict=True):
            for place, name in enumerate(panel):
                style = marks.line_style(place)
                axis.plot(
                    *marks.envelope(columns[against], columns[name], MAX_RECORDING_STRETCHES), label=in_words(name), **style
                )
            axis.margins(x=0.01)
            marks.label_axes(axis, in_words(panel[0]) if len(panel) == 1 else "", units[panel[0]])
            if len(panel) > 1:
                marks.panel_legend(axis)
        marks.label_abscissa(axes[-1], in_words(against), units[against])
    return figure


def in_words(name: str) -> str:
    """Return the name of a column as a drawing shows it."""
    return name.replace("_", " ")


def _title(names: Sequence[str], against: str) -> str:
    """Return a title that names the columns: "Command and output angle over time"."""
    words = [in_words(name) for name in names]
    if len(words) > MAX_IN_TITLE + 1:
        words = [*words[:MAX_IN_TITLE], f"{len(words) - MAX_IN_TITLE} more columns"]
    title = f"{in_a_sentence(words)} over {in_words(against)}"
    return title[0].upper() + title[1:]


def _changing(columns: Mapping[str, Array], units: Mapping[str, str], against: str) -> list[str]:
    """Return the columns that change; all if none does."""
    names = [name for name in columns if name != against]
    largest = dict.fromkeys(units.values(), 0.0)
    for name in names:
        largest[units[name]] = max(largest[units[name]], float(np.abs(columns[name]).max()))
    half = {name: 0.5 * float(columns[name].max()) - 0.5 * float(columns[name].min()) for name in names}
    return [name for name in names if half[name] > MIN_RELATIVE_SWING * largest[units[name]]] or names


def _panels(columns: Mapping[str, Array], units: Mapping[str, str]) -> list[list[str]]:
    """Return the columns that share a panel, in the order in which the first of each is named."""
    names = list(columns)
    sizes = {name: float(np.abs(values).max()) for name, values in columns.items()}
    panels: dict[str, list[list[str]]] = {}
    for name in sorted(sizes, key=lambda name: -sizes[name]):
        of_unit = panels.setdefault(units[name], [])
        if not of_unit or 0.0 < sizes[name] < sizes[of_unit[-1][0]] / MAX_RATIO_IN_PANEL:
            of_unit.append([])
        of_unit[-1].append(name)
    ordered = [sorted(panel, key=names.index) for of_unit in panels.values() for panel in of_unit]
    return sorted(ordered, key=lambda panel: names.index(panel[0]))


def _check_drawable(name: str, values: Array) -> None:
    largest = np.abs(values).max()
    if largest > MAX_DRAWABLE:
        raise ValueError(f"column {quoted(name)} cannot be drawn: it reaches {largest}; at most {MAX_DRAWABLE} can be drawn")
