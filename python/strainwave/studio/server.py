"""The server of a studio: the page of the workbench with further pages, files, jobs, and one socket for what changes.

Only a browser that has the address with its token is served, under the names of this machine, and from no other page. A page
runs scripts of this server alone, and a report runs none.
"""

from __future__ import annotations

import asyncio
import json
import re
from collections.abc import Awaitable, Callable, Mapping
from contextlib import asynccontextmanager, suppress
from importlib import resources
from secrets import compare_digest
from typing import Any, NamedTuple

from starlette.applications import Starlette
from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import ClientDisconnect, Request
from starlette.responses import FileResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from strainwave.files.gear_set import GearSet, catalogue
from strainwave.identification.reading.names import CHANNELS
from strainwave.studio.fault_spectrum import fault_spectrum
from strainwave.studio.forms import Form, described, is_in_catalogue
from strainwave.studio.jobs import Jobs
from strainwave.studio.workspace import Workspace
from strainwave.workbench.page import embedded, page, start_of

PAGE_POLICY = (
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
# Of what jobs wrote: a report has its style and pictures within, and no scripts.
RESULT_POLICY = (
    "sandbox allow-popups; default-src 'none'; style-src 'unsafe-inline'; img-src 'self' data:; frame-ancestors 'self'"
)
SHOWN = {".html": "text/html; charset=utf-8", ".png": "image/png", ".svg": "image/svg+xml"}  # any other file is a text
REFUSED_HANDSHAKE = 1008  # code of a closed socket: policy violated
PARTS = resources.files("strainwave.studio").joinpath("page")


class _PageRequest(NamedTuple):
    """Request of a page: an action, the name of a verb or a job, and values."""

    do: str
    name: str
    values: dict[str, Any]

    @classmethod
    def of(cls, text: str) -> _PageRequest:
        """Return what a message asks.

        Raises:
            ValueError: it is no such message
        """
        message = json.loads(text)
        if not isinstance(message, dict):
            raise ValueError("an object is expected")
        do, name, values = message.get("do"), message.get("name", ""), message.get("values", {})
        if not (isinstance(do, str) and isinstance(name, str) and isinstance(values, dict)):
            raise ValueError("do, name and values are expected")
        return cls(do, name, values)


class Guard:
    """An application that only the owner of the token reaches, from this machine's own pages."""

    def __init__(self, inner: ASGIApp, token: str, hosts: frozenset[str]) -> None:
        self._inner, self._token, self._hosts = inner, token, hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self._inner(scope, receive, send)
            return
        if reason := self._refusal(scope):
            if scope["type"] == "websocket":
                await WebSocket(scope, receive, send).close(REFUSED_HANDSHAKE)
            else:
                await PlainTextResponse(reason, 403)(scope, receive, send)
            return

        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                headers.setdefault("Content-Security-Policy", PAGE_POLICY)
                headers["Cache-Control"] = "no-store"
                headers["Referrer-Policy"] = "no-referrer"
                headers["X-Content-Type-Options"] = "nosniff"
                headers["Cross-Origin-Opener-Policy"] = "same-origin"
                headers["Cross-Origin-Resource-Policy"] = "same-origin"
            await send(message)

        await self._inner(scope, receive, with_headers)

    def _refusal(self, scope: Scope) -> str:
        """Return why a request is not answered; empty if it is."""
        headers = Headers(scope=scope)
        host, origin = headers.get("host", ""), headers.get("origin")
        if host not in self._hosts:
            return "this server has other names: use the address that strainwave studio printed"
        changes = scope["type"] == "websocket" or scope["method"] not in ("GET", "HEAD")
        if origin != f"http://{host}" and (changes or origin is not None):
            return "the request comes from another page"
        token = scope["path"].removeprefix("/").partition("/")[0]
        if not compare_digest(token.encode(), self._token.encode()):
            return "the address lacks the token of this studio: use the one that strainwave studio printed"
        return ""


class Studio:
    """Answers to the requests of all pages of a workspace, and what changes for them."""

    def __init__(self, workspace: Workspace, forms: Mapping[str, Form], gear: GearSet | None) -> None:
        self.workspace = workspace
        self._pages: set[asyncio.Queue[str]] = set()
        self.jobs = Jobs(workspace, forms, lambda job: self._send_to_pages({"job": job}))
        self.assets = assets(gear, forms)

    async def home(self, request: Request) -> Response:
        if not request.url.path.endswith("/"):
            return Response(status_code=307, headers={"Location": f"{request.url.path}/"})
        return Response(self.assets["index.html"], media_type="text/html")

    async def asset(self, request: Request) -> Response:
        name = request.path_params["name"]
        if name not in self.assets:
            return PlainTextResponse("no such file", 404)
        return Response(self.assets[name], media_type="text/css" if name.endswith(".css") else "text/javascript")

    async def upload(self, request: Request) -> Response:
        try:
            name = await self.workspace.upload(request.path_params["name"], request.stream())
        except (ValueError, OSError, ClientDisconnect) as error:
            return JSONResponse({"problem": str(error)}, 400)
        self._send_to_pages(self._state())
        return JSONResponse({"name": name})

    async def remove(self, request: Request) -> Response:
        try:
            self.workspace.remove(request.path_params["name"])
        except (ValueError, OSError) as error:
            return JSONResponse({"problem": str(error)}, 400)
        self._send_to_pages(self._state())
        return Response(status_code=204)

    async def result(self, request: Request) -> Response:
        try:
            if request.path_params["path"].endswith("workbench.html"):  # which the studio contains
                raise ValueError("open this gear by its button in the studio, or this page from the folder of the studio")
            path = self.workspace.result(request.path_params["job"], request.path_params["path"])
        except ValueError as error:
            return PlainTextResponse(str(error), 404)
        kind = SHOWN.get(path.suffix, "text/plain; charset=utf-8")
        return FileResponse(path, media_type=kind, headers={"Content-Security-Policy": RESULT_POLICY})

    async def live(self, socket: WebSocket) -> None:
        """Serve one page: send what changes, and answer only the newest of its requests of one kind."""
        await socket.accept()
        outgoing: asyncio.Queue[str] = asyncio.Queue()
        outgoing.put_nowait(json.dumps(self._state() | {"jobs": list(self.jobs.jobs.values())}))
        self._pages.add(outgoing)
        newest: dict[str, asyncio.Task[None]] = {}
        sender = asyncio.create_task(_send_all(socket, outgoing))
        try:
            while True:
                await self._handle(_PageRequest.of(await socket.receive_text()), outgoing, newest)
        except (WebSocketDisconnect, ValueError, KeyError, RuntimeError):  # it has gone, or is none of these pages
            pass
        finally:
            self._pages.discard(outgoing)
            for task in (sender, *newest.values()):
                task.cancel()
            with suppress(RuntimeError):
                await socket.close()

    async def _handle(
        self, page_request: _PageRequest, outgoing: asyncio.Queue[str], newest: dict[str, asyncio.Task[None]]
    ) -> None:
        """Do what a page asks."""
        try:
            if page_request.do == "start":
                outgoing.put_nowait(json.dumps({"started": self.jobs.start(page_request.name, page_request.values)}))
            elif page_request.do == "cancel":
                self.jobs.cancel(page_request.name)
            elif page_request.do in LIVE:
                if page_request.do in newest:
                    newest[page_request.do].cancel()
                newest[page_request.do] = asyncio.create_task(self._answer(page_request, outgoing))
        except (ValueError, OSError) as error:
            outgoing.put_nowait(json.dumps({"problem": str(error)}))

    async def _answer(self, page_request: _PageRequest, outgoing: asyncio.Queue[str]) -> None:
        try:
            answer = {page_request.do: await LIVE[page_request.do](self, page_request.values)}
        except (ValueError, TypeError, KeyError, AttributeError, OSError, ArithmeticError, RecursionError) as error:
            answer = {"problem": str(error), "of": page_request.do}
        outgoing.put_nowait(json.dumps(answer, allow_nan=False))

    def _state(self) -> dict[str, Any]:
        return {"files": list(self.workspace.files), "opened": list(self.workspace.opened)}

    def _send_to_pages(self, message: dict[str, Any]) -> None:
        text = json.dumps(message, allow_nan=False)
        for outgoing in self._pages:
            outgoing.put_nowait(text)
        if message.get("job", {}).get("files"):  # a gear may be among them
            for outgoing in self._pages:
                outgoing.put_nowait(json.dumps(self._state()))


async def _read(studio: Studio, values: dict[str, Any]) -> Any:
    return await studio.jobs.readings(values)


async def _gear(studio: Studio, values: dict[str, Any]) -> Any:
    return await asyncio.to_thread(lambda: start_of(GearSet.read(studio.workspace.path_of(values["name"]))))


async def _spectrum(studio: Studio, values: dict[str, Any]) -> Any:
    name = values["drive"]
    place = name if is_in_catalogue(name) else studio.workspace.path_of(name)
    return await asyncio.to_thread(
        lambda: fault_spectrum(GearSet.read(place).drive, values["moved"], values["record"], values["combine"])
    )


LIVE: dict[str, Callable[[Studio, dict[str, Any]], Awaitable[Any]]] = {"read": _read, "gear": _gear, "spectrum": _spectrum}


async def _send_all(socket: WebSocket, outgoing: asyncio.Queue[str]) -> None:
    with suppress(WebSocketDisconnect, RuntimeError):
        while True:
            await socket.send_text(await outgoing.get())


def assets(gear: GearSet | None, forms: Mapping[str, Form]) -> dict[str, str]:
    """Return the files of the page by name: the page of the workbench, its scripts and styles moved_to_file from it.

    Raises:
        FileNotFoundError: the workbench was not built
    """
    html = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>\n?', "", page(gear))
    made = {name: PARTS.joinpath(name).read_text("utf-8") for name in ("studio.js", "studio.css")}

    def moved_to_file(match: re.Match[str]) -> str:
        name = f"workbench-{len(made)}.{'css' if match['tag'] == 'style' else 'js'}"
        made[name] = match["content"]
        return _style(name) if match["tag"] == "style" else _script(name)

    html = re.sub(r"<(?P<tag>style|script)>(?P<content>.*?)</(?P=tag)>", moved_to_file, html, flags=re.DOTALL)
    about = {"pages": described(forms), "sets": [*catalogue(), *catalogue("drives")], "channels": list(CHANNELS)}
    data = f'<script type="application/json" id="studio">{embedded(about)}</script>'
    html = html.replace("</head>", f'<link rel="icon" href="data:,">{_style("studio.css")}</head>')
    return {"index.html": html.replace("</body>", f"{data}{_script('studio.js')}</body>"), **made}


def _style(name: str) -> str:
    return f'<link rel="stylesheet" href="asset/{name}">'


def _script(name: str) -> str:
    return f'<script src="asset/{name}"></script>'


def application(studio: Studio, token: str, hosts: frozenset[str]) -> ASGIApp:
    """Return the application of a studio, which only a holder of the token reaches under these names of hosts."""

    @asynccontextmanager
    async def lifespan(_: Starlette) -> Any:
        yield
        await studio.jobs.close()

    routes = [
        Route("/{token}", studio.home),
        Route("/{token}/", studio.home),
        Route("/{token}/asset/{name}", studio.asset),
        Route("/{token}/files/{name}", studio.upload, methods=["PUT"]),
        Route("/{token}/files/{name}", studio.remove, methods=["DELETE"]),
        Route("/{token}/results/{job}/{path:path}", studio.result),
        WebSocketRoute("/{token}/live", studio.live),
    ]
    return Guard(Starlette(routes=routes, lifespan=lifespan), token, hosts)
