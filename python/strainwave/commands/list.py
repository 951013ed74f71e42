"""The command `strainwave list`: the gears, drives and models that come with the package."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any

import typer

from strainwave.messages import quoted

KINDS = ("gears", "drives", "models")


def list_command(
    kind: Annotated[str, typer.Argument(help=f"{', '.join(KINDS[:-1])} or {KINDS[-1]}.")],
    part: Annotated[str, typer.Argument(help="Part of a name.")] = "",
) -> None:
    """List the gears, drives or models that come with the package.

    A drive is a gear with motor, controller and load. A gear file names models; `strainwave show` describes one.

    Examples:
        strainwave list gears 20-80
        strainwave list models
    """
    from strainwave.arguments import one_of

    one_of("list", kind, KINDS)
    print(*(_models(part) if kind == "models" else _sets(kind, part)), sep="\n")


def _sets(kind: str, part: str) -> Iterator[str]:
    """Yield the name of each gear, and the title of each drive, that has a part in its name."""
    from strainwave.files.gear_set import GearSet, catalogue, spelled
    from strainwave.report.listing import aligned

    names = _named(kind, catalogue(kind), spelled(part))
    return iter(names) if kind == "gears" else aligned([(name, GearSet.read(name).name) for name in names], "<<")


def _models(part: str) -> Iterator[str]:
    """Yield the models that have a part in their name, with their summaries, under the names of their families."""
    names = _named("models", models(), part)
    width = max(map(len, names))
    families = {family: [name for name in members if name in names] for family, members in _families().items()}
    for family, members in families.items():
        yield from [family] * bool(members)
        yield from (f"  {name:{width}}  {_described(_families()[family][name]).splitlines()[0]}" for name in members)


def _families() -> dict[str, dict[str, Any]]:
    from strainwave import _core

    return _core.families


def models() -> dict[str, Any]:
    """Return the classes of all models by the names that gear files use."""
    return {name: model for family in _families().values() for name, model in family.items()}


def description(name: str) -> str:
    """Return the documentation of a model; of several families, if they have a model of this name."""
    return "\n\n".join(_described(family[name]) for family in _families().values() if name in family)


def _described(model: Any) -> str:
    from inspect import cleandoc

    return cleandoc(str(model.__doc__))


def _named(kind: str, names: Any, part: str) -> list[str]:
    """Return the names that contain a part.

    Raises:
        ValueError: none does; the message contains similar names
    """
    from difflib import get_close_matches

    matching = [name for name in names if part.lower() in name]
    if not matching:
        near = ", ".join(get_close_matches(part.lower(), names))
        hint = f"near it are {near}" if near else f"`strainwave list {kind}` lists all"
        raise ValueError(f"none of the {kind} that come with the package has {quoted(part)} in its name; {hint}")
    return matching
