"""The theory pages: what each model says of itself, its parameters, and what it does."""

from __future__ import annotations

import ast
import doctest
import re
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

import law_panels
import parts
import strainwave as sw
from matplotlib.figure import Figure
from prose import escaped, linked, markdown
from strainwave import _core

Model = type[Any]


def write(folder: Path) -> None:
    """Write one page for each module of models, one for gear and drive, and their figures."""
    folder.mkdir(exist_ok=True)
    for name, (about, models) in pages().items():
        title = name.replace("_", " ").capitalize()
        sections = [saved_section(folder, model) for model in models]
        names = f"Signatures and methods: [reference](../reference/api/{name}.rst)."
        text = "\n\n".join([f"# {title}", escaped(about), names, *failure_modes(models), *sections])
        (folder / f"{name}.md").write_text(text + "\n", encoding="utf-8")


def pages() -> dict[str, tuple[str, list[Model]]]:
    """Return what each page is about and its models, by the name of the page."""
    families = _core.families | _core.fault_families
    every = [(module_of(model), family, model) for family, models in families.items() for model in models.values()]
    every.sort(key=lambda entry: (entry[0], entry[0] != entry[1]))  # the family with the name of the module first
    by_module = {
        name: (str(getattr(sw, name).__doc__), [model for _, _, model in entries])
        for name, entries in groupby(every, key=lambda entry: entry[0])
    }
    return by_module | {"gear_and_drive": ("How the parts go together.", [sw.Gear, sw.Drive, sw.Sensors])}


def module_of(model: Model) -> str:
    return str(model.__module__).rpartition(".")[2]


def saved_section(folder: Path, model: Model) -> str:
    text, figure = section(model)
    if figure:
        figure.savefig(folder / f"{model.name}.svg")
    return text


def section(model: Model) -> tuple[str, Figure | None]:
    """Return the section of a model on its page, and the figure that it shows."""
    words, _, _ = (model.__doc__ or "").partition("\n\nParameters\n---")
    written = [f"## {model.__name__}", markdown(words), parameters(model), f"*Source:* {linked(model.source)}"]
    if module_of(model) in _core.fault_families:
        return "\n\n".join(written), None  # it does nothing by itself
    shown = law_panels.SHOWN.get(model.name) or parts.SUITED.get(model.name) or {"": constructed(model, words)}
    figure = drawn(shown)
    if figure:
        written.append(f"![what {model.__name__} does]({model.name}.svg)\n\n*Shown:* {caption(shown)}")
    return "\n\n".join(written), figure


def failure_modes(models: Sequence[Model]) -> list[str]:
    """Return a table of faults: what fails, the numbers that change, effect and signal; nothing for other models."""
    if not all(hasattr(model, "mode") for model in models):
        return []
    facts = _core.fault.Facts(flexspline_teeth=200, circular_spline_teeth=202, ratio=-100.0)
    head = "| Fault | Failure mode | Numbers that change | Effect | Signal |\n|---|---|---|---|---|"
    rows = (
        f"| `{model.__name__}` | {model.mode} | {numbers(model, facts)} | {escaped(model.effect)} | {escaped(model.signal)} |"
        for model in models
    )
    return ["## Failure modes, numbers and signals", "\n".join([head, *rows])]


def numbers(model: Model, facts: Any) -> str:
    """Return the numbers of a drive that a fault changes, by their places; of a wave its law."""
    changed: dict[str, dict[str, None]] = {}
    for place, quantity, kind, _, law, *_ in model().changes(facts):
        changed.setdefault(place, {})[f"waves of `{law}`" if kind == "wave" else f"`{quantity}`"] = None
    places: dict[tuple[str, ...], list[str]] = {}
    for place, names in changed.items():
        places.setdefault(tuple(names), []).append(f"`{place}`")
    return "; ".join(f"{', '.join(where)}: {', '.join(names)}" for names, where in places.items())


def caption(shown: dict[str, Any]) -> str:
    """Return the caption of a figure: the calls that make its models."""
    return "; ".join(f"{escaped(label)} `{call(model)}`".strip() for label, model in shown.items())


def call(model: Any) -> str:
    """Return the call that makes a model, without what has its default."""
    numbers = {field["name"]: (getattr(model, field["name"]), field) for field in model.fields}
    given = {name: value for name, (value, field) in numbers.items() if field["required"] or value != unasked(model, field)}
    words = (f"{name}={call(value) if hasattr(value, 'fields') else in_code(value)}" for name, value in given.items())
    return f"{type(model).__name__}({', '.join(words)})"


def unasked(model: Any, field: dict[str, Any]) -> Any:
    """Return the default of a parameter."""
    return getattr(model, field["follows"]) if field["follows"] else field["default"]


def in_code(value: Any) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(in_code(number) for number in value)}]"
    return f"{value:g}" if isinstance(value, float) else repr(value)


# ---- Parameters ------------------------------------------------------------------------------------------------------


def parameters(model: Model) -> str:
    if not model.fields:
        return "It has no parameters."
    rows = ["| parameter | unit | default | limits | meaning |", "|---|---|---|---|---|"]
    for field in model.fields:
        cells = (field["unit"] or "—", default(field), limits(model, field), field["doc"])
        rows.append(f"| `{field['name']}` | " + " | ".join(escaped(cell) for cell in cells) + " |")
    return "\n".join(rows)


def default(field: dict[str, Any]) -> str:
    if field["required"]:
        return "required"
    if field["follows"]:
        return f"as `{field['follows']}`"
    value = field["default"]
    if hasattr(value, "fields"):
        return type(value).__name__
    if isinstance(value, tuple):
        return "none" if not value else ", ".join(f"{number:g}" for number in value)
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def limits(model: Model, field: dict[str, Any]) -> str:
    """Return limits that do not break, or what may be chosen."""
    if field["kind"] == "part":
        kinds = set((field["options"] or {}).values())
        families = [family.replace("_", " ") for family, members in _core.families.items() if kinds == set(members.values())]
        return f"any {families[0]}" if families else "—"
    if field["options"]:
        return ", ".join(field["options"])
    stated = re.search(rf"^{field['name']}: .*, in ([(\[].*[)\]]); (?:default|required)", model.__doc__ or "", re.MULTILINE)
    return stated[1].replace(" ", "\N{NO-BREAK SPACE}") if stated else "—"


# ---- What the figures show -------------------------------------------------------------------------------------------


def constructed(model: Model, words: str) -> Any:
    """Return the model that the example of a docstring makes."""
    for example in doctest.DocTestParser().get_examples(words):
        for node in ast.walk(ast.parse(example.source)):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == model.__name__:
                names = {kind.__name__: kind for kinds in _core.families.values() for kind in kinds.values()}
                return eval(ast.unparse(node), names)
    return None


def drawn(shown: dict[str, Any]) -> Figure | None:
    """Return the figure of every panel that has something to show of the models, side by side."""
    models = [(label.rstrip(":"), model) for label, model in shown.items() if model is not None]
    panels = [panel for draw in (*law_panels.PANELS, *parts.PANELS) if models for panel in draw(models)]
    if not panels:
        return None
    size = (4.6 if len(panels) == 1 else 8.6 if len(panels) == 2 else 10.5, 3.0)
    figure = Figure(figsize=size, layout="constrained")
    for panel, axes in zip(panels, figure.subplots(1, len(panels), squeeze=False)[0], strict=True):
        axes.locator_params(axis="x", nbins=6)
        panel(axes)
        axes.grid(alpha=0.3)
        if any(not line.get_label().startswith("_") for line in axes.lines):
            axes.legend(fontsize="small")
    return figure
