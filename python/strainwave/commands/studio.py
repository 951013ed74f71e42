"""The command `strainwave studio`: pages in a browser for a gear, recordings and the verbs of the command."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

from strainwave.commands.options import folder, whole

LOOPBACK = "127.0.0.1"
DEFAULT_PORT = 8765


def studio(
    context: typer.Context,
    paths: Annotated[
        list[Path] | None,
        typer.Argument(metavar="[FILE…]", help="A gear file and recordings, or folders of them, to begin with."),
    ] = None,
    port: Annotated[int, whole("Port of this machine; 0 takes a free one.")] = DEFAULT_PORT,
    host: Annotated[str, typer.Option(help="Address to serve; any other than the default lets other machines in.")] = LOOPBACK,
    browser: Annotated[bool, typer.Option(help="Open the page in the browser.")] = True,
    out: Annotated[Path, folder("Folder for uploads and results; a later studio of it goes on.")] = Path("out/studio"),
) -> None:
    """Serve pages for gears, recordings and faults to a browser.

    The page is the workbench, with forms of the verbs of this command beside it. It sees the files named here, those dropped on
    it and its own results, and nothing else. Its address contains a token: whoever has it can use the studio.

    Examples:
        strainwave studio
        strainwave studio gear.toml recordings --no-browser
    """
    from strainwave.studio.serve import serve

    serve(list(_verbs(context.find_root().command)), paths or [], folder=out, host=host, port=port, browser=browser)


def _verbs(command: Any, before: str = "") -> Iterator[tuple[str, Callable[..., None]]]:
    """Yield all verbs of a command with their functions."""
    for name in command.list_commands(None):
        verb = command.get_command(None, name)
        if hasattr(verb, "list_commands"):
            yield from _verbs(verb, f"{before}{name} ")
        else:
            yield f"{before}{name}", verb.callback
