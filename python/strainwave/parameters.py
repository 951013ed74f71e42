"""The numbers of a model, found by their paths."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches

from strainwave import Gear, _core, arguments
from strainwave.drives import PositionDrive


@dataclass(frozen=True)
class Parameter:
    """A number of a model: its place among all of them, and what is known of it."""

    number: int
    path: str
    unit: str
    value: float
    low: float
    high: float


def parameters(name: str, model: Gear | PositionDrive, paths: Sequence[str]) -> list[Parameter]:
    """Those that an argument names, in the order of the model; the path of a sequence names all its elements.

    >>> gear = Gear()
    >>> [each.path for each in parameters("free", gear, ["damping"])]
    ['damping']
    """
    wanted, known = arguments.names(name, paths), _core.parameters(model)
    chosen = [
        Parameter(number, path, unit, value, low, high)
        for number, (path, value, unit, _, low, high) in enumerate(known)
        if path in wanted or path.split("[")[0] in wanted
    ]
    found = {each.path for each in chosen} | {each.path.split("[")[0] for each in chosen}
    for path in wanted:
        if path not in found:
            near = get_close_matches(path, [each for each, *_ in known], n=3, cutoff=0.0)
            raise ValueError(f'the model has no parameter "{path}"; near it are {", ".join(near)}')
    return chosen
