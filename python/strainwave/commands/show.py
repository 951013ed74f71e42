"""The command `strainwave show`: every number of a gear or drive, or the documentation of a model."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from strainwave.commands.options import numeric


def show(
    name: Annotated[str, typer.Argument(help="A set by name, a gear file, or a model, as lugre.")],
    torque: Annotated[
        float | None, numeric("Torque of the output in N.m: show the positioning error to be expected under it.")
    ] = None,
    run: Annotated[
        list[Path] | None, typer.Option(metavar="FILE", help="A recording to hold against the ratings; repeat as needed.")
    ] = None,
) -> None:
    """Show the numbers of a gear or drive, or describe a model.

    Every number has its unit and its source. Modes and ratings follow.

    Examples:
        strainwave show hfuc-20-80 --torque 20
        strainwave show lugre
    """
    from difflib import get_close_matches

    from strainwave.commands.list import description, models
    from strainwave.files.gear_set import GearSet
    from strainwave.files.recording import Recording
    from strainwave.report.listing import listing, positioning_table

    if name in models():
        print(description(name))
        return
    try:
        gear_set = GearSet.read(name)
    except ValueError as error:
        near = get_close_matches(name, models())
        raise ValueError(f"{error}; models near it: {', '.join(near)}" if near else str(error)) from None
    print(listing(gear_set, {str(path): Recording.read(path) for path in run or []}))
    if torque is not None:
        print(f"\n{positioning_table(gear_set, torque)}")
