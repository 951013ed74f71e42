"""The command `strainwave docs`: the documentation, without a network."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from pathlib import Path

MISSING = "not installed: a wheel contains it, and python3 dev.py docs builds it in a clone"


def docs(
    page: Annotated[str, typer.Argument(help="A page by its name, as `identify`; any other word is searched for.")] = "",
    path: Annotated[bool, typer.Option("--path", help="Print the file, and open nothing.")] = False,
    agents: Annotated[bool, typer.Option("--agents", help="Print the guide for coding agents, as plain text.")] = False,
) -> None:
    """Open the documentation in the browser, without a network.

    Examples:
        strainwave docs identify --path
        strainwave docs --agents
    """
    if agents:
        print(_package().joinpath("AGENTS.md").read_text("utf-8"), end="")
        return
    folder = documentation()
    if folder is None:
        raise FileNotFoundError(f"the documentation is {MISSING}")
    found = folder / "index.html" if not page else next(iter(sorted(folder.rglob(f"{_stem(page)}.html"))), None)
    if path:
        print(found or folder / "search.html")
        return
    import webbrowser
    from urllib.parse import quote

    address = found.as_uri() if found else f"{(folder / 'search.html').as_uri()}?q={quote(page)}"
    if not webbrowser.open(address):
        raise OSError(f"there is no browser; open {address}")


def documentation() -> Path | None:
    """Return the folder of the built documentation: that of the package, or of the clone it runs from; None without one."""
    package = _package()
    return next(
        (each for each in (package / "docs", package.parents[1] / "out" / "docs") if (each / "index.html").is_file()), None
    )


def _package() -> Path:
    from pathlib import Path

    import strainwave

    return Path(strainwave.__file__).parent


def _stem(page: str) -> str:
    """Return the path of a page below a folder, without characters that a search for files would interpret."""
    from glob import escape

    return escape(page.strip("/").removesuffix(".html"))
