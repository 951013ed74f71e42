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


def write(folder: Path) -> None:
    """One page a family, one for gear and drive, with their figures."""
    folder.mkdir()
    for family, models in _core.families.items():
        page(folder, family, getattr(sw, family).__doc__, list(models.values()))
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
                return model(**{word.arg: ast.literal_eval(word.value) for word in node.keywords if word.arg})
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


def steady(model: Any, axes: Axes) -> None:
    fastest = 10.0 * getattr(model, "stribeck_speed", 1.0)
    slowest = 1e-9 * fastest
    for speed in (np.linspace(-fastest, -slowest, 401), np.linspace(slowest, fastest, 401)):
        axes.plot(speed, model.steady(speed), color="C0")
    if hasattr(model, "hold"):
        axes.plot([0.0, 0.0], [-model.hold(), model.hold()], color="C0")
    axes.set(xlabel="speed [rad/s]", ylabel="steady friction [N.m]")


def presliding(model: Any, axes: Axes) -> None:
    time = np.linspace(0.0, 125.0, 2001)
    angle = 2.0 * model.breakaway / model.bristle_stiffness * np.sin(0.1 * time)
    axes.plot(1e3 * angle, model.trace(time, np.gradient(angle, time)))
    axes.set(xlabel="angle [mrad], cycled slowly", ylabel="friction [N.m]")


def tangent(model: Any, axes: Axes) -> None:
    torque = np.linspace(-1.0, 1.0, 401) * 1.5 * getattr(model, "t2", 50.0)
    axes.plot(1e3 * model.twist(torque), torque)
    axes.set(xlabel="twist [mrad]", ylabel="torque [N.m]")


def work(model: Any, axes: Axes) -> None:
    turns = 1e-3 * np.array([0.0, 4.0, -4.0, 4.0, 1.0, 3.0, -4.0])
    path = np.concatenate([np.linspace(start, end, 101) for start, end in pairwise(turns)])
    axes.plot(1e3 * path, model.trace(path))
    axes.set(xlabel="twist [mrad]", ylabel="torque [N.m]")


CURVES = {
    ("error",): error,
    ("steady",): steady,
    ("steady", "trace"): presliding,
    ("tangent",): tangent,
    ("work",): work,
}
