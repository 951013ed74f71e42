"""A studio that runs until it is interrupted."""

from __future__ import annotations

import socket
import sys
import webbrowser
from collections.abc import Callable, Sequence
from pathlib import Path

from strainwave.studio.forms import forms
from strainwave.studio.workspace import Workspace, first_gear

MAX_MESSAGE = 2**20  # bytes from a page
MAX_CONNECTIONS = 64
LOOPBACK = ("127.0.0.1", "::1", "localhost")


def serve(
    verbs: Sequence[tuple[str, Callable[..., None]]],
    opened: Sequence[Path],
    *,
    folder: Path,
    host: str,
    port: int,
    browser: bool,
) -> None:
    """Serve a studio, and print its address.

    Args:
        verbs: of the command, with their functions
        opened: files and folders that its pages may use
        folder: of uploads and results
        host: address that is served
        port: 0 for a free one
        browser: True to open the page in a browser

    Raises:
        ImportError: the packages of a server are not installed
        FileNotFoundError: a file is not there, or the workbench was not built
        OSError: the port is taken
    """
    try:
        import uvicorn
        import websockets  # noqa: F401 - uvicorn serves sockets by it

        from strainwave.studio.server import Studio, application
    except ImportError:
        raise ImportError(
            "the studio is served by starlette, uvicorn and websockets: pip install 'strainwave[studio]'"
        ) from None
    workspace = Workspace(folder.resolve(), opened)
    studio = Studio(workspace, forms(verbs), first_gear(opened))
    listener = _listener(host, port)
    port, token = listener.getsockname()[1], workspace.token()
    names = {host, *(LOOPBACK if host in LOOPBACK else ())}
    hosts = frozenset(f"[{name}]:{port}" if ":" in name else f"{name}:{port}" for name in names)
    address = f"http://{f'[{host}]' if ':' in host else host}:{port}/{token}/"
    reached = "" if host in LOOPBACK else "\nOther machines can reach it: whoever learns the address can use it."
    told = f"the studio is at {address}\nIts results go to {folder}. End it with Ctrl+C.{reached}"
    print(told, file=sys.stderr, flush=True)  # the output of a verb is printed at its end
    if browser:
        webbrowser.open(address)
    config = uvicorn.Config(
        application(studio, token, hosts),
        log_level="warning",
        access_log=False,
        server_header=False,
        ws="websockets-sansio",
        ws_max_size=MAX_MESSAGE,
        limit_concurrency=MAX_CONNECTIONS,
        timeout_graceful_shutdown=1,
    )
    uvicorn.Server(config).run(sockets=[listener])


def _listener(host: str, port: int) -> socket.socket:
    """Return a socket that listens.

    Raises:
        OSError: the port is taken, or the address is none of this machine
    """
    try:
        return socket.create_server((host, port), family=socket.AF_INET6 if ":" in host else socket.AF_INET)
    except OSError as error:
        raise OSError(f"port {port} of {host} cannot be served ({error.strerror}); give another one as --port, or 0") from None
