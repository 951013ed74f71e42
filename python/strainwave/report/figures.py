"""Figures of reports as SVG: drawn by matplotlib's objects, coloured by the page that shows them.

Colours are names (measured, model, …) that a page defines for its light and its dark scheme, so that one drawing serves
both. The same data give the same bytes, whatever style or locale the machine prefers.
"""

from __future__ import annotations

import io
import re
import textwrap
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.files.recording import envelope
from strainwave.report import typeset
from strainwave.report.experiment import SimulatedExperiment
from strainwave.simulation.signals import outputs

if TYPE_CHECKING:
    from markupsafe import Markup
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Element = ElementTree.Element
Draw = Callable[["Figure"], None]

LIGHT = {
    "ink": "#1c2127",
    "muted": "#59636e",
    "rule": "#d8dee4",
    "measured": "#2166ac",
    "model": "#c2410c",
    "held-out": "#7b3fa0",
    "earlier": "#80650a",
}
DARK = {
    "ink": "#e6e9ed",
    "muted": "#9aa5b1",
    "rule": "#38414b",
    "measured": "#7ab8ff",
    "model": "#ff9f6b",
    "held-out": "#d3a4ff",
    "earlier": "#e0c15c",
}
RUNS = (  # colours and lines of runs, in turn
    ("model", "-", 2.0), ("measured", "--", 1.5), ("held-out", ":", 1.3), ("earlier", "-.", 1.3),
)  # fmt: skip
WIDTH = 4.4  # inches: its letters are as large as those of the page, on a telephone as well as on a desk
LINE = 48  # letters that fit beside each other in this width
HANDLE = 5  # letters that the line before a label takes
STRETCHES = 300  # of a long record, each drawn by its extremes: about two to a pixel
MARKED = 150  # samples up to which each is drawn as a point
WIDE = 100.0  # ratio of speeds beyond which their axis is logarithmic

STYLE = {
    "axes.axisbelow": True,
    "axes.edgecolor": LIGHT["muted"],
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


# ---- What can be drawn -----------------------------------------------------------------------------------------------


def experiment(simulated: SimulatedExperiment, name: str) -> str:
    """Command, response and, where both are of one unit, their difference over time."""
    first, comparable = simulated.runs[0][1], simulated.comparable
    command_unit, response_unit = first.unit(simulated.command), first.unit(simulated.response)

    def draw(figure: Figure) -> None:
        response, below = figure.subplots(2, 1, sharex=True, height_ratios=(2.0, 1.0))
        command = response if comparable else below
        curve(command, first.time, first[simulated.command], color=LIGHT["ink"], linewidth=0.9, label="command")
        for number, (label, run) in enumerate(simulated.runs):
            colour, line, width = RUNS[number % len(RUNS)]
            style: dict[str, Any] = {"color": LIGHT[colour], "linestyle": line, "linewidth": width}
            style["label"] = f" {label}"  # matplotlib leaves out labels that begin with an underscore
            answer = run.values(simulated.response, response_unit)
            curve(response, run.time, answer, **style)
            if comparable:
                curve(below, run.time, answer - run.values(simulated.command, command_unit), **style)
        label_axes(response, output_name(simulated.response), response_unit)
        label_axes(below, "response − command" if comparable else "command", command_unit, "time", "s")
        legend(figure, response)

    return inline(draw, (WIDTH, 3.9), name, f"{simulated.name}: command and response over time")


def output_name(column: str) -> str:
    """What a column of a simulation is called in words."""
    known = outputs(Drive())
    return known[column].doc if column in known else column.replace("_", " ")


# ---- Parts of drawings -----------------------------------------------------------------------------------------------


def speed_axis(axes: Axes, speed: Array) -> None:
    """Sets the axis of speeds: logarithmic, for either direction by itself, where they lie far apart."""
    slowest, fastest = np.abs(speed[speed != 0.0]).min(), np.abs(speed).max()
    if fastest > WIDE * slowest and np.all(speed > 0.0):
        axes.set_xscale("log")
    elif fastest > WIDE * slowest:
        decades = 10.0 ** np.arange(np.ceil(np.log10(slowest)), np.log10(fastest))
        axes.set_xscale("symlog", linthresh=slowest, linscale=0.3)
        axes.set_xticks([*-decades[::-1], 0.0, *decades])


def curve(axes: Axes, x: Array, y: Array, **style: Any) -> None:
    """A line, of a long record drawn by the extremes of short stretches."""
    axes.plot(*envelope(x, y, STRETCHES), **style)


def residual_curve(axes: Axes, x: Array, residual: Array, color: str) -> None:
    """Each by itself where there are few, else as a curve."""
    axes.axhline(0.0, color=LIGHT["muted"], linewidth=0.8)
    if len(x) <= MARKED:
        axes.vlines(x, 0.0, residual, color=color, linewidth=0.8)
        axes.plot(x, residual, "o", color=color, markersize=2.8)
    else:
        curve(axes, x, residual, color=color, linewidth=0.8)


def shade(axes: Axes, x: Array, held_out: Mask) -> None:
    """Marks what took no part in the fit."""
    between = np.concatenate((x[:1], 0.5 * (x[1:] + x[:-1]), x[-1:]))
    label = "held out"
    for block in _blocks(held_out):
        ends = between[block.start], between[block.stop]
        axes.axvspan(*ends, facecolor=LIGHT["held-out"], alpha=0.13, linewidth=0.0, label=label)
        label = ""


def _blocks(chosen: Mask) -> Iterator[slice]:
    """The stretches of neighbours that are chosen."""
    edges = np.flatnonzero(np.diff(chosen, prepend=False, append=False))
    return (slice(start, stop) for start, stop in edges.reshape(-1, 2).tolist())


def label_axes(axes: Axes, y: str, y_unit: str, x: str = "", x_unit: str = "1") -> None:
    """Names the quantities, in the prefix that suits their size; the upright one stands above its axis."""
    axes.set_title(textwrap.fill(f"{y}{scaled(axes.yaxis, y_unit)}", LINE))
    if x:
        axes.set_xlabel(f"{x}{scaled(axes.xaxis, x_unit)}")


def scaled(axis: Axis, unit: str) -> str:
    """Numbers an axis, all to the same digit if it is linear; gives the unit with its prefix."""
    from strainwave.report.ticks import Ticks

    power = typeset.prefix_power(float(np.max(np.abs(axis.get_view_interval()))), unit)
    axis.set_major_formatter(Ticks(axis, power))
    text = typeset.prefixed(unit, power)
    return f" [{text}]" if text else ""


def legend(figure: Figure, axes: Axes) -> None:
    """In rows above the drawing, as many labels beside each other as fit."""
    handles, labels = axes.get_legend_handles_labels()
    lines = [textwrap.fill(label, LINE) for label in labels]
    widest = max(len(line) for label in lines for line in label.splitlines())
    columns = max(1, LINE // (widest + HANDLE))
    figure.legend(handles, lines, loc="outside upper left", ncols=columns, borderpad=0.0, columnspacing=1.2)


# ---- From a drawing to SVG -------------------------------------------------------------------------------------------


def inline(draw: Draw, size: tuple[float, float], name: str, title: str) -> Markup:
    """Return SVG to stand in a page, whose colours and letters it takes."""
    from markupsafe import Markup

    return Markup(ElementTree.tostring(_svg(draw, size, name, title), encoding="unicode"))


def standalone(draw: Draw, size: tuple[float, float], name: str, title: str) -> str:
    """SVG to stand in a file, with the colours of the light and of the dark scheme."""
    svg = _svg(draw, size, name, title)
    svg.set("xmlns", "http://www.w3.org/2000/svg")
    style = ElementTree.Element("style")
    style.text = (
        f":root {{ font-family: system-ui, sans-serif; {variables(LIGHT)} }} "
        f"@media (prefers-color-scheme: dark) {{ :root {{ {variables(DARK)} }} }}"
    )
    svg.insert(0, style)
    return ElementTree.tostring(svg, encoding="unicode") + "\n"


def variables(colours: dict[str, str]) -> str:
    """Colours as a style sheet defines them."""
    return " ".join(f"--{name}: {colour};" for name, colour in colours.items())


def _svg(draw: Draw, size: tuple[float, float], name: str, title: str) -> Element:
    from matplotlib import style
    from matplotlib.figure import Figure

    file = io.StringIO()
    with style.context(["default", STYLE | {"svg.hashsalt": name}]):
        figure = Figure(figsize=size)
        draw(figure)
        nothing = dict.fromkeys(("Creator", "Date", "Format", "Type"))
        figure.savefig(file, format="svg", transparent=True, metadata=nothing)
    return _tidied(ElementTree.fromstring(file.getvalue()), name, title)


def _tidied(drawn: Element, name: str, title: str) -> Element:
    """The drawing without what a page does not need: names of elements, digits beyond a hundredth of a point, fonts."""
    values = " ".join(value for element in drawn.iter() for value in element.attrib.values())
    references = set(re.findall(r"#(\w+)", values))
    for element in drawn.iter():
        element.tag = element.tag.partition("}")[2]
        element.attrib = {
            key.partition("}")[2] or key: _tidied_value(key, value, name)
            for key, value in element.attrib.items()
            if key != "id" or value in references
        }
        element.text, element.tail = (element.text or "").strip() if element.tag == "text" else None, None
    for element in drawn.iter():
        _style_once(element)
    svg = ElementTree.Element("svg", {"viewBox": drawn.attrib["viewBox"], "role": "img", "aria-label": title})
    svg.attrib |= {"stroke-linejoin": "round", "stroke-linecap": "butt"}
    svg.extend(child for child in drawn if child.find("style") is None)
    return svg


def _tidied_value(key: str, value: str, name: str) -> str:
    if key == "id":
        return f"{name}-{value}"
    if key == "d":
        return _path(value)
    if key == "style":
        value = re.sub(r"font-family: [^;]*;? ?", "", value)
        return re.sub(r"#\w{6}", lambda colour: _COLOURS.get(colour[0], colour[0]), value)
    value = re.sub(r"#(?=\w)", f"#{name}-", value) if key.endswith("href") or key == "clip-path" else value
    return re.sub(r"-?\d+\.\d+", _rounded, value) if key in ("x", "y", "width", "height", "transform") else value


_COLOURS = {colour: f"var(--{name}, {colour})" for name, colour in LIGHT.items()}


def _path(text: str) -> str:
    """A path in few letters: after M and L, further points need no letter of their own."""
    text = re.sub(r"-?\d+\.\d+", _rounded, " ".join(text.split()))
    return text.replace(" L ", " ") if set(re.findall("[A-Za-z]", text)) <= {"M", "L"} else text


def _rounded(number: re.Match[str]) -> str:
    return f"{float(number[0]):.2f}".rstrip("0").rstrip(".")


def _style_once(group: Element) -> None:
    """Moves a style that all markers of a group have up to the group."""
    styles = {child.get("style", "") for child in group}
    if len(group) > 1 and len(styles) == 1 and all(child.tag.endswith("use") for child in group):
        group.set("style", styles.pop())
        for child in group:
            del child.attrib["style"]
