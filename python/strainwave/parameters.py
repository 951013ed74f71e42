"""The numbers of a model, found by their paths."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

from strainwave import Drive, Gear, _core, arguments
from strainwave.messages import quoted


@dataclass(frozen=True)
class Parameter:
    """A number of a model: its place among all of them, and what is known of it."""

    number: int
    path: str
    unit: str
    value: float
    low: float
    high: float


def every(model: Gear | Drive) -> dict[str, Parameter]:
    """All numbers of a model by their paths, in its order."""
    return {
        path: Parameter(number, path, unit, value, low, high)
        for number, (path, value, unit, _, low, high) in enumerate(_core.parameters(model))
    }


def unknown(path: str, known: Iterable[str]) -> ValueError:
    """Return the error for a path that the model does not have; it names similar ones."""
    near = get_close_matches(path, list(known), n=3, cutoff=0.0)
    return ValueError(f"the model has no parameter {quoted(path)}; near it are {', '.join(near)}")


def parameters(name: str, model: Gear | Drive, paths: Sequence[str]) -> list[Parameter]:
    """Return the parameters that an argument names, in the order of the model; the path of a sequence names all its elements.

    >>> gear = Gear()
    >>> [each.path for each in parameters("free", gear, ["damping"])]
    ['damping']
    """
    wanted, known = arguments.names(name, paths), every(model)
    chosen = [each for path, each in known.items() if path in wanted or path.split("[")[0] in wanted]
    found = {each.path for each in chosen} | {each.path.split("[")[0] for each in chosen}
    for path in wanted:
        if path not in found:
            raise unknown(path, known)
    return chosen


def replaced(model: Any, changes: Mapping[str, Any]) -> Any:
    """A model with other numbers or parts, by their paths; what its `replace` does with a mapping.

    >>> gear = Gear()
    >>> replaced(gear, {"damping": 3.0, "friction_input.viscous": 1e-4}).friction_input.viscous
    0.0001

    Raises:
        TypeError, ValueError: a path that the model does not have, or a value that does not fit
    """
    direct: dict[str, Any] = {}
    deeper: dict[str, dict[str, Any]] = {}
    for path, value in changes.items():
        head, _, rest = arguments.text("the path of a parameter", path).partition(".")
        if rest:
            deeper.setdefault(head, {})[rest] = value
        else:
            direct[head] = value
    for head, inner in deeper.items():
        part = direct.get(head, getattr(model, head, None))
        if not hasattr(part, "fields"):
            raise unknown(f"{head}.{next(iter(inner))}", every(model))
        direct[head] = replaced(part, inner)
    for head in [each for each in direct if each.endswith("]")]:
        name, _, place = head[:-1].partition("[")
        elements = list(direct.get(name, getattr(model, name, ())))
        if not (re.fullmatch("[0-9]{1,9}", place) and int(place) < len(elements)):
            raise unknown(head, every(model))
        elements[int(place)] = direct.pop(head)
        direct[name] = elements
    return model.replace(**direct)


def gear_numbers(gear: Gear) -> dict[str, tuple[float, str]]:
    """Return value and unit of each number of a gear, by its path in a gear set.

    >>> gear_numbers(Gear())["gear.damping"]
    (0.0, 'N.m.s/rad')
    """
    return {f"gear.{path}": (value, unit) for path, value, unit, *_ in _core.parameters(gear)}


def plain(path: str) -> str:
    """Return the path of a number without the laws that it stands inside.

    >>> plain("gear.friction_input.law.law.coulomb")
    'gear.friction_input.coulomb'
    """
    return ".".join(part for part in path.split(".") if part != "law")
