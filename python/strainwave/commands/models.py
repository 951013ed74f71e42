"""The command `strainwave models`: the models that a gear file may name."""

from __future__ import annotations

from typing import Annotated

import typer

from strainwave.messages import listed, unquoted


def models(name: Annotated[str, typer.Argument(help="A model, to be described in full.")] = "") -> None:
    """List the models that a gear file may name, or describe one."""
    from difflib import get_close_matches
    from inspect import cleandoc

    from strainwave import _core

    kinds = {model: kind for family in _core.families.values() for model, kind in family.items()}
    if name and name not in kinds:
        near = get_close_matches(name, kinds, n=3) or list(kinds)
        raise ValueError(f"there is no model {unquoted(name)}; near to it is {listed(near)}; strainwave models lists all")
    if name:
        print(cleandoc(str(kinds[name].__doc__)))
        return
    width = max(map(len, kinds))
    for family, members in _core.families.items():
        print(family)
        for model, kind in members.items():
            print(f"  {model:{width}}  {cleandoc(str(kind.__doc__)).splitlines()[0]}")
