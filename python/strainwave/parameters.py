"""The numbers of a model, found by their paths."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

from strainwave import Gear, _core, arguments
from strainwave.drives import PositionDrive
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


def every(model: Gear | PositionDrive) -> dict[str, Parameter]:
    """All numbers of a model by their paths, in its order."""
    return {
        path: Parameter(number, path, unit, value, low, high)
        for number, (path, value, unit, _, low, high) in enumerate(_core.parameters(model))
    }


def unknown(path: str, known: Iterable[str]) -> ValueError:
    """Says of a path that the model does not have it, and what is near."""
    near = get_close_matches(path, list(known), n=3, cutoff=0.0)
    return ValueError(f"the model has no parameter {quoted(path)}; near it are {', '.join(near)}")


def parameters(name: str, model: Gear | PositionDrive, paths: Sequence[str]) -> list[Parameter]:
    """Those that an argument names, in the order of the model; the path of a sequence names all its elements.

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
