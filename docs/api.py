"""The pages of the API reference: one for each task of a user, and one for each module of models."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Iterator
from functools import cached_property
from inspect import isfunction, ismodule, isroutine
from pathlib import Path
from types import ModuleType
from typing import Any

import docstrings
import strainwave as sw
import theory
from strainwave import _core

# The title of the page that has the public names of a room of the package.
PAGES = {
    "files": "Files and recordings",
    "identification": "Identification",
    "simulation": "Simulation",
    "native": "Simulation",
    "analysis": "Analysis",
    "orders": "Analysis",
    "tuning": "Control and compensation",
    "diagnose": "Diagnosis",
    "dataset": "Diagnosis",
    "report": "Files and recordings",
    "_core": "Gear and drive",
}
MODULES = {"scenario": "Scenarios", "rig": "Torsion rig", "export": "Export"}
VALUES = "Values in results"


def write(folder: Path) -> None:
    """Write a page for each task, each module and the values in results, and the page that lists them."""
    folder.mkdir(exist_ok=True)
    modules = sorted((name for name in sw.__all__ if is_page(name)), key=lambda name: (name not in MODULES, name))
    pages = {file_name(title): (task_head(title), names) for title, names in tasks().items()}
    pages |= {name: introduced(name, getattr(sw, name)) for name in modules}
    pages[file_name(VALUES)] = ([heading(VALUES), "Classes of attributes of results. Functions make them."], values())
    for page, (head, names) in pages.items():
        text = [*head, table(names), *map(entry, names)]
        (folder / f"{page}.rst").write_text("\n\n".join(text) + "\n", encoding="utf-8")
    index = [
        heading("Python API"),
        ".. py:module:: strainwave",
        "``import strainwave as sw``, then for example ``sw.load``, or ``sw.orders.campbell`` of a room.",
        *(f"* :doc:`{page}`: {', '.join(f':py:obj:`~{name}`' for name in names)}" for page, (_, names) in pages.items()),
        "\n".join([".. toctree::", "   :hidden:", "", *(f"   {page}" for page in pages)]),
    ]
    (folder / "index.rst").write_text("\n\n".join(index) + "\n", encoding="utf-8")


def public() -> set[str]:
    """Return the full name of every public function, class, method and property."""
    names = [f"strainwave.{name}" for name in sw.__all__]
    for name in sw.__all__:
        if ismodule(module := getattr(sw, name)):
            names += [f"strainwave.{name}.{each}" for each in public_names(module)]
    members = {f"{name}.{each}" for name in names for each in public_members(resolved(name), name)}
    return {*names, *members}


def public_members(documented: Any, name: str) -> list[str]:
    """Return the names of the methods and properties that a class defines; none of a class by another name."""
    if not isinstance(documented, type) or documented.__name__ != name.rpartition(".")[2]:
        return []
    kinds = (property, cached_property, staticmethod, classmethod)
    own = {each: member for each, member in vars(documented).items() if not each.startswith("_")}
    return [each for each, member in own.items() if isinstance(member, kinds) or isroutine(member)]


def values() -> list[str]:
    """Return the full names of the classes that public classes have as attributes, but that are not public themselves."""
    found = {member: None for name in public() if isinstance(member := resolved(name), type)}
    known, waiting = set(found), list(found)
    while waiting:
        new = [each for each in mentioned(waiting.pop()) if each not in found]
        found |= dict.fromkeys(new)
        waiting += new
    return sorted(f"{each.__module__}.{each.__name__}" for each in found if each not in known)


def mentioned(documented: type[Any]) -> Iterator[type[Any]]:
    """Yield the classes of the package in the annotations of the attributes and properties of a class."""
    for base in documented.__mro__:
        texts = [str(each) for each in vars(base).get("__annotations__", {}).values()]
        for member in vars(base).values():
            function = getattr(member, "fget", getattr(member, "func", None))
            texts.append(str(getattr(function, "__annotations__", {}).get("return", "")))
        for name in dict.fromkeys(re.findall(r"\b[A-Z]\w+", " ".join(texts))):
            member = getattr(sys.modules[base.__module__], name, None)
            if isinstance(member, type) and member.__module__.startswith("strainwave") and member.__doc__:
                yield member


def tasks() -> dict[str, list[str]]:
    """Return the full names of functions and classes at the top of the package and in its rooms, by the title of their page."""
    groups: dict[str, list[str]] = {title: [] for title in PAGES.values()}
    for name in in_order(sw.__all__):
        if not ismodule(member := getattr(sw, name)):
            groups[PAGES[member.__module__.split(".")[1]]].append(f"strainwave.{name}")
    for room in rooms():
        groups[PAGES[room]] += [f"strainwave.{room}.{name}" for name in in_order(public_names(getattr(sw, room)))]
    return groups


def task_head(title: str) -> list[str]:
    """Return the head of the page of a task: its rooms, and what they have."""
    of_page = [room for room in rooms() if PAGES[room] == title]
    texts = [f"``sw.{room}``: {(getattr(sw, room).__doc__ or '').strip()}" for room in of_page]
    return [heading(title), *(f".. py:module:: strainwave.{room}" for room in of_page), *map(docstrings.restructured, texts)]


def rooms() -> list[str]:
    """Return the names of the public modules that are rooms of the package and have no page of their own."""
    return [name for name in sw.__all__ if ismodule(getattr(sw, name)) and name in PAGES]


def is_page(name: str) -> bool:
    return ismodule(getattr(sw, name)) and name not in PAGES


def in_order(names: Iterable[str]) -> list[str]:
    """Return names in order, functions first."""
    return sorted(names, key=lambda name: (name[0].isupper(), name))


def public_names(module: ModuleType) -> list[str]:
    """Return the public functions and classes of a module: those it lists, or those it defines."""
    listed: Iterable[str] = getattr(module, "__all__", None) or (
        name for name in dir(module) if getattr(getattr(module, name), "__module__", None) == module.__name__
    )
    return [name for name in listed if not name.startswith("_") and callable(getattr(module, name))]


def introduced(name: str, module: ModuleType) -> tuple[list[str], list[str]]:
    """Return the head of the page of a module, and the full names on it."""
    models = {theory.module_of(model) for family in families() for model in family.values()}
    head = [heading(MODULES.get(name) or f"sw.{name}"), f".. py:module:: strainwave.{name}"]
    head.append(docstrings.restructured(module.__doc__ or ""))
    if name in models:
        head.append(f"Equations, parameters and figures: :doc:`/theory/{name}`.")
    return head, [f"strainwave.{name}.{each}" for each in public_names(module)]


def families() -> list[dict[str, type[Any]]]:
    return [*_core.families.values(), *_core.fault_families.values()]


def heading(title: str) -> str:
    return f"{title}\n{'=' * len(title)}"


def file_name(title: str) -> str:
    return title.lower().replace(" ", "_")


def table(names: Iterable[str]) -> str:
    """Return a table of names, each with the first sentence of its docstring."""
    rows = (f"   * - :py:obj:`~{name}`\n     - {docstrings.summary(resolved(name))}" for name in names)
    return "\n".join([".. list-table::", "   :widths: 30 70", "   :class: names", "", *rows])


def resolved(name: str) -> Any:
    module, _, last = name.rpartition(".")
    if module in sys.modules:
        return getattr(sys.modules[module], last)
    return getattr(resolved(module), last) if module else sw


def entry(name: str) -> str:
    """Return the directive of a public name, with those of its members if it is a model."""
    documented = resolved(name)
    if docstrings.is_model(documented):
        return model_entry(name, documented)
    if not isinstance(documented, type):
        return f".. autofunction:: {name}"
    fields = getattr(documented, "_fields", ())  # of a named tuple, which its docstring describes
    options = [":members:", f":exclude-members: {', '.join(fields)}" if fields else ""]
    if documented.__bases__ not in ((object,), (tuple,)):
        options.append(":show-inheritance:")
    arguments = f"({', '.join(fields)})" if fields else ""
    return "\n".join([f".. autoclass:: {name}{arguments}", *(f"   {option}" for option in options if option)])


def model_entry(name: str, model: type[Any]) -> str:
    """Return the directive of a compiled model: Sphinx does not know the signatures of what is compiled."""
    if model.__name__ != name.rpartition(".")[2]:
        return f".. autoclass:: {name}"  # another name of a model
    fields = {field["name"] for field in model.fields}
    members = {each: member for each, member in vars(model).items() if not each.startswith("_") and each not in fields}
    entries = [member_entry(model, f"{name}.{each}", member) for each, member in members.items()]
    place = f"{model.__module__}::{model.__qualname__}" if "." in model.__qualname__ else name
    return "\n\n".join([f".. autoclass:: {place}{docstrings.model_signature(model)}", *filter(None, entries)])


def member_entry(model: type[Any], name: str, member: Any) -> str:
    """Return the directive of a member of a compiled model; nothing for an attribute, or for the state of another model."""
    if docstrings.is_model(member):
        text = model_entry(name, member) if member.__qualname__.startswith(f"{model.__qualname__}.") else ""
    elif isinstance(member, property):
        text = f".. autoproperty:: {name}"
    elif isinstance(member, staticmethod) or isfunction(member):  # the latter of Python, which all models share
        text = f".. automethod:: {name}"
    elif declared := docstrings.overload(member):
        text = f".. automethod:: {name}{docstrings.member_arguments(model, declared[0])}"
    else:
        text = ""
    return "\n".join(f"   {line}" if line else "" for line in text.splitlines())
