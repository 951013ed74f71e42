"""The theory pages: what each model says of itself, its parameters, and the curve of its own example."""

from __future__ import annotations

import ast
import doctest
import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import strainwave as sw
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from strainwave import _core

Model = type[Any]
ABOUT = {
    "kinematic_noise": "Random kinematic error, beside the deterministic one.",
    "density": "Densities of Preisach's hysteresis.",
}


def write(folder: Path) -> None:
    """One page a family, one for gear and drive, with their figures."""
    folder.mkdir()
    for family, models in _core.families.items():
        about = getattr(sw, family).__doc__ if hasattr(sw, family) else ABOUT[family]
        page(folder, family, about, list(models.values()))
    page(folder, "gear_and_drive", "How the parts go together.", [sw.Gear, sw.drives.PositionDrive])


def page(folder: Path, name: str, about: str, models: list[Model]) -> None:
    title = name.replace("_", " ").capitalize()
    sections = [section(folder, model) for model in models]
    (folder / f"{name}.md").write_text("\n\n".join([f"# {title}", escaped(about), *sections]) + "\n")


def section(folder: Path, model: Model) -> str:
    words, _, _ = (model.__doc__ or "").partition("\n\nParameters\n---")
    parts = [f"## {model.__name__}", markdown(words), parameters(model), f"*Source:* {escaped(model.source)}"]
    example = constructed(model, words)
    if example is not None and (figure := drawn(example)):
        figure.savefig(folder / f"{model.name}.svg")
        parts.append(f"![curve of the example]({model.name}.svg)\n\n*The model of the example,* `{example!r}`")
    return "\n\n".join(parts)


def markdown(words: str) -> str:
    """A docstring's formulas, examples and paragraphs."""
    return "\n\n".join(block(text) for text in re.split(r"\n\n+", words))


def block(text: str) -> str:
    if text.startswith(".. math::"):
        return f"$$\n{' '.join(text.removeprefix('.. math::').split())}\n$$"
    if text.startswith(">>>"):
        return f"```pycon\n{text}\n```"
    return escaped(text)


def escaped(text: str) -> str:
    """Plain words as Markdown shows them; what stands in double backticks stays code."""
    return re.sub(r"(``.*?``)|([\\`*_\[\]<>#|$])", lambda found: found[1] or "\\" + found[2], text)


def parameters(model: Model) -> str:
    rows = ["| parameter | unit | default | limits | meaning |", "|---|---|---|---|---|"]
    for field in model.fields:
        name = field["name"]
        cells = (field["unit"] or "—", default(model, name), limits(model, name), field["doc"])
        rows.append(f"| `{name}` | " + " | ".join(escaped(cell) for cell in cells) + " |")
    return "\n".join(rows)


def default(model: Model, name: str) -> str:
    value = getattr(model(), name)
    return type(value).__name__ if hasattr(value, "fields") else str(value)


def limits(model: Model, name: str) -> str:
    found = re.search(rf"^{name}: .*, in ([(\[].*[)\]]); default", model.__doc__ or "", re.MULTILINE)
    return found[1] if found else "—"


def constructed(model: Model, words: str) -> Any:
    """The model that the example of a docstring makes."""
    for example in doctest.DocTestParser().get_examples(words):
        for node in ast.walk(ast.parse(example.source)):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == model.__name__:
                names = {kind.__name__: kind for kinds in _core.families.values() for kind in kinds.values()}
                return eval(ast.unparse(node), names)
    return None


# ---- Figures: whatever can be drawn of a model, by what it can be asked ----------------------------------------------


def drawn(model: Any) -> Figure | None:
    curves = [draw for verbs, draw in CURVES.items() if all(hasattr(model, verb) for verb in verbs)]
    if not curves:
        return None
    figure = Figure(figsize=(4.5 * len(curves), 3.0), layout="constrained")
    for draw, axes in zip(curves, figure.subplots(1, len(curves), squeeze=False)[0], strict=True):
        draw(model, axes)
        axes.grid(alpha=0.3)
    return figure


def error(model: Any, axes: Axes) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 721)
    axes.plot(np.degrees(angle), 1e3 * model.error(angle))
    axes.set(xlabel="input angle [deg]", ylabel="error at the output [mrad]")


LOAD = 10.0  # N.m, under which friction is drawn that depends on it


def steady(model: Any, axes: Axes) -> None:
    fastest = 10.0 * getattr(model, "stribeck_speed", 1.0)
    slowest = 1e-9 * fastest
    for speed in (np.linspace(-fastest, -slowest, 401), np.linspace(slowest, fastest, 401)):
        axes.plot(speed, model.steady(speed, load=LOAD), color="C0")
    if model.set_valued:
        axes.plot([0.0, 0.0], [-model.hold(-1.0, load=LOAD), model.hold(load=LOAD)], color="C0")
    axes.set(xlabel="speed [rad/s]", ylabel="steady friction [N.m]")


def over_contact(model: Any, axes: Axes) -> None:
    """Over whatever the law depends on besides the speed."""
    ranges = {
        "angle": (np.linspace(0.0, getattr(model, "domain_end", 2.0 * np.pi), 721), "angle [rad]"),
        "load": (np.linspace(-LOAD, LOAD, 401), "transmitted torque [N.m]"),
        "temperature": (np.linspace(273.15, 333.15, 121), "temperature [K]"),
    }
    for name, (values, label) in ranges.items():
        friction = model.steady(1.0, **{"load": LOAD, name: values})
        if np.ptp(friction) > 1e-9 * np.abs(friction).max():
            axes.plot(values, friction)
            axes.set(xlabel=label, ylabel="friction at 1 rad/s [N.m]")
            return
    axes.set_axis_off()


def presliding(model: Any, axes: Axes) -> None:
    """Slow cycles about three times as wide as the contact bends before it slips."""
    bend = 1e-9
    stiffness = model.trace([0.0, 1.0], [bend, bend], load=LOAD)[-1] / bend
    reach = 3.0 * model.steady(1e-3, load=LOAD) / stiffness
    time = np.linspace(0.0, 125.0, 2001)
    angle = reach * np.sin(0.1 * time)
    axes.plot(1e3 * angle, model.trace(time, np.gradient(angle, time), load=LOAD))
    axes.set(xlabel="angle [mrad], cycled slowly", ylabel="friction [N.m]")


def tangent(model: Any, axes: Axes) -> None:
    torque = np.linspace(-1.0, 1.0, 401) * 1.5 * getattr(model, "t2", 50.0)
    axes.plot(1e3 * model.twist(torque), torque)
    axes.set(xlabel="twist [mrad]", ylabel="torque [N.m]")


def work(model: Any, axes: Axes) -> None:
    """As wide as the secant falls to a third of what it begins with."""
    reaches = np.geomspace(1e-6, 1.0, 241)
    secant = np.array([model.trace([0.0, reach])[-1] / reach for reach in reaches])
    reach = reaches[np.argmax(secant < secant.max() / 3.0)]
    turns = reach * np.array([0.0, 1.0, -1.0, 1.0, 0.25, 0.75, -1.0])
    path = np.concatenate([np.linspace(start, end, 101) for start, end in pairwise(turns)])
    axes.plot(1e3 * path, model.trace(path))
    axes.set(xlabel="twist [mrad]", ylabel="torque [N.m]")


CURVES = {
    ("error",): error,
    ("steady",): steady,
    ("steady", "set_valued"): over_contact,
    ("steady", "State"): presliding,
    ("tangent",): tangent,
    ("work",): work,
}
