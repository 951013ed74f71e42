"""The command `strainwave show`: every number of a gear or drive."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from strainwave.commands.options import numeric


def show(
    gear: Annotated[str, typer.Argument(help="A set by name, or a gear file.")],
    load: Annotated[
        float | None, numeric("Torque of the output in N.m: show the positioning error to be expected under it.")
    ] = None,
    run: Annotated[list[Path] | None, typer.Option(help="A recording to hold against the ratings; repeat as needed.")] = None,
) -> None:
    """Show every number of a gear or drive with its unit and its source, its modes and its ratings."""
    from strainwave.files.gear_set import GearSet
    from strainwave.files.recording import Recording
    from strainwave.report.listing import listing, positioning_table

    gear_set = GearSet.read(gear)
    print(listing(gear_set, {str(path): Recording.read(path) for path in run or []}))
    if load is not None:
        print(f"\n{positioning_table(gear_set, load)}")
