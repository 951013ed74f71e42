"""The command `strainwave workbench`: a gear as a page to look at and to change."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def workbench(
    gear: Annotated[str | None, typer.Argument(help="A gear or drive: a set by name, or a file.")] = None,
    out: Annotated[Path, typer.Option("--out", "-o", help="Page to write.")] = Path("out/workbench.html"),
) -> None:
    """Write a page that redraws a gear as you change its numbers.

    The page is one file, which any browser opens without a network. It computes with the same code as the package.

    Examples:
        strainwave workbench hfuc-20-80
        strainwave workbench gear.toml --out gear.html
    """
    from strainwave.files.gear_set import GearSet
    from strainwave.files.writing import replacing
    from strainwave.workbench.page import page

    html = page(None if gear is None else GearSet.read(gear))
    out.parent.mkdir(parents=True, exist_ok=True)
    with replacing(out) as file:
        file.write(html.encode())
    print(f"wrote {out}; open it in a browser")
