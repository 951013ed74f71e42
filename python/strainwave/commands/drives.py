"""The command `strainwave drives`: the drives that come with the package."""

from __future__ import annotations

from typing import Annotated

import typer

from strainwave.commands.gears import packaged


def drives(part: Annotated[str, typer.Argument(help="Part of a name.")] = "") -> None:
    """List the drives that come with the package: a gear with motor, controller and load."""
    from strainwave.files.gear_set import GearSet
    from strainwave.report.listing import aligned

    names = packaged("drives", part)
    print("\n".join(aligned([(name, GearSet.read(name).name) for name in names], "<<")))
