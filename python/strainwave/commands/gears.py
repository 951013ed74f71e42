"""The command `strainwave gears`: the gears of the catalogue."""

from __future__ import annotations

from typing import Annotated

import typer

from strainwave.messages import quoted


def gears(part: Annotated[str, typer.Argument(help="Part of a name.")] = "") -> None:
    """List the gears of the catalogue."""
    print("\n".join(packaged("gears", part)))


def packaged(of: str, part: str) -> list[str]:
    """Return the sets that come with the package and have this part in their name.

    Raises:
        ValueError: none has; the message contains similar names
    """
    from difflib import get_close_matches

    from strainwave.files.gear_set import catalogue

    names = catalogue(of)
    found = [name for name in names if part.lower() in name]
    if not found:
        near = ", ".join(get_close_matches(part.lower(), names))
        hint = f"near it are {near}" if near else f"`strainwave {of}` lists all"
        raise ValueError(f"none of the {of} that come with the package has {quoted(part)} in its name; {hint}")
    return found
