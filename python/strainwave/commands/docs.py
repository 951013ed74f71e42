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
    folder = documentation() or _sources()
    if folder is None:
        raise FileNotFoundError(f"the documentation is {MISSING}")
    ending = ".html" if (folder / "index.html").is_file() else ".md"
    found = folder / f"index{ending}" if not page else next(iter(sorted(folder.rglob(f"{_stem(page)}{ending}"))), None)
    if ending == ".md":
        _explain_sources(page if found is None else "")
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


def _sources() -> Path | None:
    """Return the folder of the pages of a clone as they are written; None without a clone."""
    folder = _package().parents[1] / "docs"
    return folder if (folder / "index.md").is_file() else None


def _explain_sources(missing: str) -> None:
    """Print that the pages are not built; raise FileNotFoundError if none of them has the name that is wanted."""
    import sys

    built = "python3 dev.py docs builds the documentation, with theory, reference, pictures and search"
    if missing:
        raise FileNotFoundError(f'no page of this clone is named "{missing}"; {built}')
    print(f"these pages are as they are written; {built}", file=sys.stderr)


def _package() -> Path:
    from pathlib import Path

    import strainwave

    return Path(strainwave.__file__).parent


def _stem(page: str) -> str:
    """Return the path of a page below a folder, without characters that a search for files would interpret."""
    from glob import escape

    return escape(page.strip("/").removesuffix(".html"))
