"""Drawings of what the actuator paper calls misalignment: its Figures 1.b and 2, drawn anew with every quantity named."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]

FIGURE_WIDTH = 7.0  # inches, of a figure
INK, MUTED = "black", "grey"
AXIS: dict[str, Any] = {"color": MUTED, "linewidth": 0.8, "linestyle": (0, (9, 2, 1.5, 2))}
STILL, TURNING = "tab:blue", "tab:orange"
MAJOR_RADIUS, MINOR_RADIUS = 1.0, 0.82  # half axes of the wave generator as drawn
PITCH_RADIUS = 1.0  # of the circular spline as drawn: the lobes of a straight wave generator touch it
DRAWN_SHIFT, DRAWN_DIRECTION, DRAWN_TURN = 0.17, np.radians(35.0), np.radians(65.0)  # e_1, beta_1 and theta as drawn


def wave_generator() -> Figure:
    """Draw a misaligned wave generator in the circular spline, seen along the shaft (the paper's Figure 1.b)."""
    figure = Figure((FIGURE_WIDTH, 4.6), layout="constrained")
    axes = figure.subplots()
    _ring(axes)
    centre = DRAWN_SHIFT * _unit(DRAWN_DIRECTION)
    for place, colour, line in ((np.zeros(2), MUTED, "--"), (centre, TURNING, "-")):
        x, y = place[:, None] + _ellipse(DRAWN_TURN)
        axes.plot(x, y, linewidth=1.3, color=colour, linestyle=line)
    _axes_of(axes, np.zeros(2), 1.32, ("x", "y"), STILL)
    _ray(axes, np.zeros(2), DRAWN_TURN, 1.38, AXIS)
    _angle(axes, np.zeros(2), 0.0, DRAWN_TURN, 0.62, "θ", INK)
    _lobe(axes, DRAWN_TURN, "A")
    _lobe(axes, DRAWN_TURN + np.pi, "B")
    _arrow(axes, np.zeros(2), centre, STILL)
    _note(axes, "e₁", centre / 2.0, xytext=(0.42, -0.16), color=STILL, arrowprops=_leader(STILL), va="center")
    _angle(axes, np.zeros(2), 0.0, DRAWN_DIRECTION, 0.34, "β₁", STILL)
    axes.plot(*centre, "o", color=TURNING, markersize=3.5)
    axes.plot(0.0, 0.0, "o", color=STILL, markersize=3.5)
    for place, name, at, colour in ((np.zeros(2), "CS", (-0.3, -0.22), STILL), (centre, "WG", (-0.28, 0.32), TURNING)):
        _note(axes, "", place, xytext=at, arrowprops=_leader(colour))
        _indexed(axes, np.array(at) + np.array([-0.13, 0.0]), "O", name, colour)
    _note(
        axes,
        "circular spline,\npitch circle",
        PITCH_RADIUS * _unit(np.radians(-28.0)),
        xytext=(1.24, -0.86),
        color=STILL,
        arrowprops=_leader(STILL),
        va="center",
        ha="center",
    )
    _note(
        axes,
        "wave generator,\nmisaligned",
        centre + _ellipse(DRAWN_TURN)[:, 47],
        xytext=(-1.34, 0.98),
        color=TURNING,
        arrowprops=_leader(TURNING),
        va="center",
        ha="center",
    )
    _note(
        axes,
        "aligned",
        _ellipse(DRAWN_TURN)[:, 62],
        xytext=(-1.42, 0.3),
        color=MUTED,
        arrowprops=_leader(MUTED),
        va="center",
        ha="center",
    )
    _frame(axes, (-1.7, 1.7), (-1.4, 1.5))
    return figure


def scales(major_radius: float, minor_radius: float, eccentricity: float) -> tuple[float, float]:
    """Return the magnifications of ellipticity and eccentricity [m] in the drawing, relative to the radius."""
    flatness = (major_radius - minor_radius) / major_radius
    return (MAJOR_RADIUS - MINOR_RADIUS) / flatness, DRAWN_SHIFT / (eccentricity / major_radius)


def angles() -> Figure:
    """Draw eccentricities and angular deviations with their frames (the paper's Figure 2)."""
    figure = Figure((FIGURE_WIDTH, 6.4), layout="constrained")
    above = figure.add_gridspec(2, 2, height_ratios=(1.25, 1.0))
    _plan(figure.add_subplot(above[0, :]))
    _side(figure.add_subplot(above[1, 0]), "X", "β₂", "α₂")
    _side(figure.add_subplot(above[1, 1]), "Y", "β₃", "α₃")
    return figure


def _plan(axes: Axes) -> None:
    """The three centres, seen along the axis: two eccentricities and their directions."""
    spline, nominal = np.zeros(2), np.array([1.15, 0.72])
    generator = nominal + np.array([0.35, 0.85])
    _axes_of(axes, spline, 1.9, ("x", "y"), STILL, back=0.2)
    turned = np.radians(18.0)
    _axes_of(axes, nominal, 1.35, ("x′", "y′"), TURNING, back=0.1, turn=turned)
    _ray(axes, nominal, 0.0, 1.3, AXIS)
    _arrow(axes, spline, nominal, STILL)
    _arrow(axes, nominal, generator, TURNING)
    _note(axes, "e₁", (0.48, 0.44), color=STILL, ha="center")
    _note(axes, "e₂", nominal + np.array([0.03, 0.5]), color=TURNING, ha="center")
    _angle(axes, spline, 0.0, float(np.arctan2(0.72, 1.15)), 0.62, "β₁", STILL)
    _angle(axes, nominal, turned, float(np.arctan2(0.85, 0.35)), 0.42, "α₁", TURNING)
    _angle(axes, nominal, 0.0, turned, 0.95, "θ", INK)
    for place, name, colour, offset in (
        (spline, "CS", STILL, (-0.2, -0.2)),
        (nominal, "", INK, (0.16, -0.24)),
        (generator, "WG", TURNING, (0.2, 0.1)),
    ):
        axes.plot(*place, "o", color=colour, markersize=3.5)
        _indexed(axes, place + np.array(offset), "O", name, colour)
    axes.set_title("seen along the axis; blue stands in the housing, orange turns with the shaft", fontsize="small")
    _frame(axes, (-0.75, 3.0), (-0.35, 2.25))


def _side(axes: Axes, across: str, housing: str, generator: str) -> None:
    """The axes of circular spline, shaft and wave generator, seen from the side, and the section at h."""
    centre, height = np.zeros(2), 1.15
    lean, further = np.radians(17.0), np.radians(36.0)
    axes.plot([0.0, 0.0], [-0.4, 1.75], **AXIS)
    for way, colour, name in ((0.0, STILL, "CS"), (lean, INK, ""), (further, TURNING, "WG")):
        tip = 1.72 * np.array([np.sin(way), np.cos(way)])
        _arrow(axes, centre, tip, colour)
        _indexed(axes, tip + np.array([0.03, 0.12]), "Z", name, colour)
    _angle(axes, centre, np.pi / 2.0 - lean, np.pi / 2.0, 0.62, housing, STILL)
    _angle(axes, centre, np.pi / 2.0 - further, np.pi / 2.0 - lean, 0.72, generator, TURNING)
    normal = np.array([np.sin(lean), np.cos(lean)])
    along = np.array([np.cos(lean), -np.sin(lean)])
    ends = height * normal + np.outer((-0.75, 0.95), along)
    axes.plot(*ends.T, color=INK, linewidth=1.2)
    _note(axes, "section", ends[1], xytext=(4, -3), textcoords="offset points", color=INK, fontsize="small")
    foot, top = -0.6 * along, height * normal - 0.6 * along
    _note(axes, "", top, xytext=foot, arrowprops={**_leader(INK), "arrowstyle": "<->"})
    axes.plot(*np.array([centre, -0.68 * along]).T, color=MUTED, linewidth=0.6)
    _note(axes, "h", (foot + top) / 2.0 - 0.14 * along, color=INK, ha="center", va="center")
    _arrow(axes, centre, np.array([1.15, 0.0]), STILL)
    _note(axes, across, (1.22, -0.05), color=STILL)
    axes.plot(0.0, 0.0, "o", color=INK, markersize=3.5)
    _note(axes, "centre of tilt", (0.08, -0.3), color=MUTED, fontsize="small")
    axes.set_title(f"{across}OZ", fontsize="small")
    _frame(axes, (-1.05, 1.55), (-0.5, 2.0))


def _ring(axes: Axes) -> None:
    """The circular spline: its pitch circle and the rim behind the teeth."""
    way = np.linspace(0.0, 2.0 * np.pi, 361)
    for radius, width in ((PITCH_RADIUS, 1.3), (1.12, 0.7)):
        axes.plot(radius * np.cos(way), radius * np.sin(way), color=STILL, linewidth=width)


def _ellipse(turn: float) -> Array:
    way = np.linspace(0.0, 2.0 * np.pi, 181)
    x, y = MAJOR_RADIUS * np.cos(way), MINOR_RADIUS * np.sin(way)
    points: Array = np.array([x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)])
    return points


def _lobe(axes: Axes, turn: float, name: str) -> None:
    """The displacement of a lobe: from where it would be to where it is, on the ray from the circular spline's centre."""
    reach = MAJOR_RADIUS + DRAWN_SHIFT * np.cos(turn - DRAWN_DIRECTION)  # to first order
    side = 0.09 * _unit(turn + np.pi / 2.0)
    ends = (MAJOR_RADIUS * _unit(turn) + side, reach * _unit(turn) + side)
    _note(axes, "", ends[1], xytext=ends[0], arrowprops={**_leader(INK), "arrowstyle": "-|>", "linewidth": 1.4})
    beyond = 1.36 * _unit(turn) - 4.6 * side
    _note(axes, "", 0.5 * (ends[0] + ends[1]), xytext=beyond, arrowprops=_leader(INK))
    left = -0.19 if name == "B" else 0.46  # the text ends at its leader, or begins there
    _note(axes, f"lobe {name}:", beyond + np.array([left - 0.08, 0.0]), color=INK, ha="right", va="center")
    _indexed(axes, beyond + np.array([left + 0.05, 0.0]), "δ", name, INK)


def _note(axes: Axes, text: str, place: Any, xytext: Any = None, **style: Any) -> None:
    """A text or an arrow at a place."""
    axes.annotate(text, tuple(place), xytext=None if xytext is None else tuple(xytext), **style)


def _indexed(axes: Axes, place: Array, name: str, index: str, colour: str) -> None:
    """A letter, and an index below its right."""
    _note(axes, name, place, color=colour, ha="right", va="center")
    offset: dict[str, Any] = {"xytext": (0.5, -2.5), "textcoords": "offset points", "fontsize": 6.5}
    _note(axes, index, place, color=colour, ha="left", va="center", **offset)


def _axes_of(
    axes: Axes, centre: Array, length: float, names: tuple[str, str], colour: str, back: float = 1.25, turn: float = 0.0
) -> None:
    for name, way in zip(names, (turn, turn + np.pi / 2.0), strict=True):
        tip = centre + length * _unit(way)
        axes.plot(*np.array([centre - back * _unit(way), centre]).T, **{**AXIS, "color": colour, "alpha": 0.5})
        _arrow(axes, centre, tip, colour, linewidth=0.8)
        _note(axes, name, tip + 0.1 * _unit(way), color=colour, ha="center", va="center")


def _ray(axes: Axes, centre: Array, way: float, length: float, style: dict[str, Any]) -> None:
    axes.plot(*np.array([centre, centre + length * _unit(way)]).T, **style)


def _angle(axes: Axes, centre: Array, start: float, stop: float, radius: float, name: str, colour: str) -> None:
    """Draw an arc with an arrow head at its end, and its name at its middle."""
    way = np.linspace(start, stop, 40)
    x, y = centre[:, None] + radius * np.array([np.cos(way), np.sin(way)])
    axes.plot(x, y, color=colour, linewidth=0.9)
    head = {**_leader(colour), "arrowstyle": "-|>", "shrinkA": 0.0, "shrinkB": 0.0}
    _note(axes, "", (x[-1], y[-1]), xytext=(x[-3], y[-3]), arrowprops=head)
    middle = centre + (radius + 0.13) * _unit(0.5 * (start + stop))
    _note(axes, name, middle, color=colour, ha="center", va="center")


def _arrow(axes: Axes, start: Array, stop: Array, colour: str, linewidth: float = 1.3) -> None:
    look = {"arrowstyle": "-|>", "color": colour, "linewidth": linewidth, "shrinkA": 0.0, "shrinkB": 0.0}
    _note(axes, "", stop, xytext=start, arrowprops=look)


def _leader(colour: str) -> dict[str, Any]:
    return {"arrowstyle": "-", "color": colour, "linewidth": 0.7, "shrinkA": 1.0, "shrinkB": 0.0}


def _unit(way: float) -> Array:
    return np.array([np.cos(way), np.sin(way)])


def _frame(axes: Axes, x: tuple[float, float], y: tuple[float, float]) -> None:
    axes.set_aspect("equal")
    axes.set_xlim(*x)
    axes.set_ylim(*y)
    axes.set_axis_off()
