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
from strainwave.analysis.branches import turning_points
from strainwave.files.recording import envelope
from strainwave.identification.experiments.drive_log import DriveLog
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.report import typeset
from strainwave.report.experiment import SimulatedExperiment
from strainwave.simulation.signals import outputs

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

    from strainwave.identification.evidence.evidence import Evidence
    from strainwave.identification.twin import Twin

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


def friction_table(evidence: Evidence) -> str:
    """Friction torque over speed, measured and modelled; how far each measurement lies from what the others predict."""

    def draw(figure: Figure) -> None:
        torque, residual = figure.subplots(2, 1, sharex=True, height_ratios=(2.4, 1.0))
        _friction_points(torque, evidence)
        _friction_law(torque, evidence, evidence.fit.gear.friction_input, "model", color=LIGHT["model"])
        residual_curve(residual, _table(evidence).speed, evidence.held_out[0], color=LIGHT["held-out"])
        label_axes(torque, "friction torque", "N.m")
        label_axes(residual, "measured − predicted from the others", "N.m", "input speed", "rad/s")
        legend(figure, torque)

    return inline(draw, (WIDTH, 3.7), "friction", f"Friction torque over input speed, {evidence.source}")


def torsion_loop(evidence: Evidence) -> str:
    """Torque over twist, measured and modelled; the residual along the loop."""

    def draw(figure: Figure) -> None:
        loop, residual = figure.subplots(2, 1, height_ratios=(2.8, 1.0))
        point, held_out = np.arange(1.0, len(evidence.fit.training) + 1.0), ~evidence.fit.training
        _loop(loop, evidence)
        residual_curve(residual, point, evidence.fit.residuals[0], color=LIGHT["ink"])
        shade(residual, point, held_out)
        for gap in gaps(_torsion(evidence)):
            residual.axvline(float(gap) + 0.5, color=LIGHT["muted"], linestyle=":", linewidth=0.8)
        _label_loop(loop, evidence)
        label_axes(residual, "measured − modelled", "N.m", "point compared, in the order measured", "1")
        legend(figure, loop)

    return inline(draw, (WIDTH, 4.8), "torsion", f"Torque over twist, {evidence.source}")


def drive_log(evidence: Evidence, channel: int) -> str:
    """One channel of a drive log over time, measured and modelled, and the residual."""
    log, fit = evidence.fit.experiment, evidence.fit
    assert isinstance(log, DriveLog)
    name, unit = output_name(log.channels[channel]), log.units[channel]

    def draw(figure: Figure) -> None:
        values, residual = figure.subplots(2, 1, sharex=True, height_ratios=(2.0, 1.0))
        measured, predicted = log.measured[channel], fit.predicted[channel]
        curve(values, log.time, measured, color=LIGHT["measured"], linewidth=2.4, alpha=0.6, label="measured")
        curve(values, log.time, predicted, color=LIGHT["model"], linewidth=1.0, label="model")
        residual_curve(residual, log.time, fit.residuals[channel], color=LIGHT["ink"])
        for axes in (values, residual):
            shade(axes, log.time, ~fit.training)
        label_axes(values, name, unit)
        label_axes(residual, "measured − modelled", unit, "time", "s")
        legend(figure, values)

    return inline(draw, (WIDTH, 3.6), f"log-{channel}", f"{name} over time, {evidence.source}")


def two_friction_laws(twin: Twin, evidence: Evidence) -> str:
    """The friction law of the initial model and the friction table that contradicts it: two data sets on one axis."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        earlier, fitted = twin.start.gear.friction_input, evidence.fit.gear.friction_input
        _friction_law(axes, evidence, earlier, "initial model", color=LIGHT["earlier"], linestyle="--", linewidth=2.0)
        _friction_law(axes, evidence, fitted, "fitted to the table", color=LIGHT["model"])
        _friction_points(axes, evidence)
        axes.set_ylim(*_with_zero(axes.get_ylim()))
        label_axes(axes, "friction torque", "N.m", "input speed", "rad/s")
        legend(figure, axes)

    title = f"Two data sets: the friction law of the initial model, and {evidence.source}"
    return inline(draw, (WIDTH, 3.0), "two-laws", title)


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


def overview(torsion: Evidence, friction: Evidence) -> str:
    """A picture by itself: a torsion loop and a friction table, measured and modelled."""

    def draw(figure: Figure) -> None:
        left, right = figure.subplots(1, 2)
        _loop(left, torsion)
        _label_loop(left, torsion)
        _friction_points(right, friction)
        _friction_law(right, friction, friction.fit.gear.friction_input, "model", color=LIGHT["model"])
        label_axes(right, "friction torque", "N.m", "input speed", "rad/s")
        legend(figure, left)

    title = "Torsion loop and friction of two strain wave gears, measured and modelled"
    return _standalone(draw, (8.4, 3.2), "overview", title)


def gaps(loop: TorsionLoop) -> list[int]:
    """The points before which samples were left out: of a loop measured at the input, those just behind each reversal."""
    if loop.input_ratio is None or loop.samples <= len(loop.twist):
        return []
    return [turn + int(np.argmax(loop.twist[turn:] != loop.twist[turn])) for turn in turning_points(loop.twist)]


def output_name(column: str) -> str:
    """What a column of a simulation is called in words."""
    known = outputs(Drive())
    return known[column].doc if column in known else column.replace("_", " ")


# ---- Parts of drawings -----------------------------------------------------------------------------------------------


def _table(evidence: Evidence) -> FrictionTable:
    table = evidence.fit.experiment
    assert isinstance(table, FrictionTable)
    return table


def _friction_points(axes: Axes, evidence: Evidence) -> None:
    table = _table(evidence)
    order = np.argsort(table.speed, kind="stable")
    speed, torque = envelope(table.speed[order], table.torque[order], MARKED)
    axes.plot(speed, torque, "o", color=LIGHT["measured"], label="measured", zorder=3)
    speed_axis(axes, speed)


def speed_axis(axes: Axes, speed: Array) -> None:
    """Sets the axis of speeds: logarithmic, for either direction by itself, where they lie far apart."""
    slowest, fastest = np.abs(speed[speed != 0.0]).min(), np.abs(speed).max()
    if fastest > WIDE * slowest and np.all(speed > 0.0):
        axes.set_xscale("log")
    elif fastest > WIDE * slowest:
        decades = 10.0 ** np.arange(np.ceil(np.log10(slowest)), np.log10(fastest))
        axes.set_xscale("symlog", linthresh=slowest, linscale=0.3)
        axes.set_xticks([*-decades[::-1], 0.0, *decades])


def _friction_law(axes: Axes, evidence: Evidence, law: Any, label: str, **style: Any) -> None:
    """The law over the speeds measured, each direction by itself."""
    speed = _table(evidence).speed
    for side in (speed[speed < 0.0], speed[speed > 0.0]):
        if side.size:
            ends = np.abs(side).min(), np.abs(side).max()
            swept = np.sign(side[0]) * np.union1d(np.linspace(*ends, 200), np.geomspace(*ends, 200))
            axes.plot(swept, law.steady(swept), label=label, **style)
            label = ""


def _torsion(evidence: Evidence) -> TorsionLoop:
    loop = evidence.fit.experiment
    assert isinstance(loop, TorsionLoop)
    return loop


def _loop(axes: Axes, evidence: Evidence) -> None:
    loop, training = _torsion(evidence), evidence.fit.training
    everywhere = np.ones_like(training)
    style: dict[str, Any] = {"linewidth": 3.6, "alpha": 0.55}
    if len(loop.twist) <= MARKED:
        style = {"linewidth": 0.9, "marker": "o", "markersize": 3.0}
    model = "model" if loop.input_ratio is None else "model with friction"
    drawn = (
        (loop.torque, everywhere, {**style, "color": LIGHT["measured"], "label": "measured"}),
        (loop.torque, ~training, {**style, "color": LIGHT["held-out"], "label": "held out"}),
        (evidence.fit.predicted[0], everywhere, {"color": LIGHT["model"], "label": model, "linewidth": 1.0}),
    )
    for torque, chosen, look in drawn:
        for stretch in _unbroken(loop, chosen):
            curve(axes, loop.twist[stretch], torque[stretch], **look)
            look["label"] = ""


def _label_loop(axes: Axes, evidence: Evidence) -> None:
    place = "at the output" if _torsion(evidence).input_ratio is None else "referred to the output"
    label_axes(axes, f"torque {place}", "N.m", f"twist {place}", "rad")


def _unbroken(loop: TorsionLoop, chosen: Mask) -> Iterator[slice]:
    """The stretches of chosen neighbours, none of them across a gap."""
    starts = gaps(loop)
    branch = np.searchsorted(starts, np.arange(len(chosen)), side="right")
    for number in range(len(starts) + 1):
        yield from _blocks(chosen & (branch == number))


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


def _with_zero(ends: tuple[float, float]) -> tuple[float, float]:
    return min(ends[0], 0.0), max(ends[1], 0.0)


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


def inline(draw: Draw, size: tuple[float, float], name: str, title: str) -> str:
    """SVG to stand in a page, whose colours and letters it takes."""
    svg: str = ElementTree.tostring(_svg(draw, size, name, title), encoding="unicode")
    return svg


def _standalone(draw: Draw, size: tuple[float, float], name: str, title: str) -> str:
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
