"""A studio that runs until it is interrupted."""

from __future__ import annotations

import socket
import sys
import webbrowser
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from strainwave.operating_system import locked_folder
from strainwave.studio.forms import forms
from strainwave.studio.workspace import Workspace, first_gear

if TYPE_CHECKING:
    from strainwave.studio.server import Studio

MAX_MESSAGE = 2**20  # bytes from a page
MAX_CONNECTIONS = 512
MAX_PORT = 65535
ANY_ADDRESS = ("0.0.0.0", "::")
LOOPBACK = ("127.0.0.1", "::1", "localhost")
PACKAGES = ("starlette", "uvicorn", "websockets")


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
        ValueError: the address or the port cannot be served
        OSError: the port is taken, or another studio uses the folder
    """
    if any(find_spec(name) is None for name in PACKAGES):
        raise ImportError("the studio is served by starlette, uvicorn and websockets: pip install 'strainwave[studio]'")
    with _listener(host, port) as listener, _alone(workspace := Workspace(folder.resolve(), opened)):
        from strainwave.studio.server import Studio

        _run(Studio(workspace, forms(verbs), first_gear(opened)), listener, host, folder, browser=browser)


def _listener(host: str, port: int) -> socket.socket:
    """Return a socket that listens.

    Raises:
        ValueError: the port is none, or the address stands for all of the machine
        OSError: the port is taken, or the address is none of this machine
    """
    if host in ANY_ADDRESS:
        raise ValueError(f"--host {host} stands for every address of this machine; give the one by which others reach it")
    if not 0 <= port <= MAX_PORT:
        raise ValueError(f"--port {port} is no port: 0 to {MAX_PORT}")
    try:
        return socket.create_server((host, port), family=socket.AF_INET6 if ":" in host else socket.AF_INET)
    except OSError as error:
        raise OSError(f"port {port} of {host} cannot be served ({error.strerror}); give another one as --port, or 0") from None


@contextmanager
def _alone(workspace: Workspace) -> Iterator[None]:
    """Keep other studios out of a workspace.

    Raises:
        BlockingIOError: another one uses it
    """
    lock = locked_folder(workspace.folder, wait=False)
    try:
        lock.__enter__()
    except BlockingIOError:
        raise BlockingIOError(f"another studio uses {workspace.folder}; give another folder as --out") from None
    try:
        yield
    finally:
        lock.__exit__(None, None, None)


def _run(studio: Studio, listener: socket.socket, host: str, folder: Path, *, browser: bool) -> None:
    """Serve a studio until it is interrupted."""
    import uvicorn

    from strainwave.studio.server import application

    port, token = listener.getsockname()[1], studio.workspace.token()
    names = {host, *(LOOPBACK if host in LOOPBACK else ())}
    hosts = frozenset(f"[{name}]:{port}" if ":" in name else f"{name}:{port}" for name in names)
    address = f"http://{f'[{host}]' if ':' in host else host}:{port}/{token}/"
    reached = "" if host in LOOPBACK else "\nOther machines can reach it: whoever learns the address can use it."
    printed = f"the studio is at {address}\nIts results go to {folder}. End it with Ctrl+C.{reached}"
    print(printed, file=sys.stderr, flush=True)  # the output of a verb is printed at its end
    if browser:
        webbrowser.open(address)
    config = uvicorn.Config(
        application(studio, token, hosts),
        log_level="warning",
        access_log=False,
        server_header=False,
        proxy_headers=False,
        ws="websockets-sansio",
        ws_max_size=MAX_MESSAGE,
        limit_concurrency=MAX_CONNECTIONS,
        timeout_graceful_shutdown=1,
    )
    with suppress(KeyboardInterrupt):
        uvicorn.Server(config).run(sockets=[listener])
