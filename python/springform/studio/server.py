"""The server of the studio: on this machine only, for whoever has its token."""

from __future__ import annotations

import asyncio
import secrets
import socket
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from typing import Any
from urllib.parse import quote

import uvicorn
from pydantic import BaseModel, TypeAdapter, ValidationError
from starlette.applications import Starlette
from starlette.datastructures import Headers
from starlette.requests import HTTPConnection, Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from .. import _core, scenes
from ..curve_file import curve_in
from ..design import load
from ..errors import InputError
from .address import Address, keep_address, last_address
from .editing_messages import CurvePoints
from .exports import export
from .folders import folder_at
from .library import Library
from .message_base import Side
from .messages import Refusal
from .pin_messages import Comparing
from .run_messages import Brushes
from .session import Session
from .shelf_messages import DocumentEntry, Folder, Opened, Opening, SceneEntry, Shelf
from .telling import picture_of

HOST = "127.0.0.1"
"""The studio listens nowhere else."""

STATIC = Path(__file__).parent / "static"
"""Where the build puts the page."""

_KEEP_ALIVE = 600
"""Time for which an idle connection stays open [s]; one that closes as it is used again fails."""

_LARGEST_MESSAGE = 4 * 2**20
"""Bytes of a request [B]; beyond it the window is cut off."""

_SIDE: TypeAdapter[Side] = TypeAdapter(Side)
_LARGEST_CURVE = 2**20
"""Bytes of a CSV file with a measured curve [B]."""

_POLICY = (
    "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)


_WRONG_ADDRESS = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>springFORM</title>
<body style="font: 16px/1.6 sans-serif; max-width: 34em; margin: 18vh auto; padding: 0 2em">
<h1 style="font-size: 1.3em">This address is not the studio's</h1>
<p>Open the address that <code>springform studio</code> printed when it was started, with its
token. Your documents are kept: nothing is lost.</p>
"""


class Studio:
    """The open documents of one server."""

    def __init__(self, library: Library) -> None:
        self.library = library
        self._sessions: dict[str, Session] = {}
        self._opening = asyncio.Lock()
        self._pictures: dict[str, bytes] = {}

    async def session(self, document: str) -> Session:
        """Return the session of a document. Raises `InputError`: it can't be opened."""
        async with self._opening:
            if document not in self._sessions:
                self._sessions[document] = Session(self.library.folder(document))
            return self._sessions[document]

    async def remove(self, document: str) -> None:
        """Remove a document for good. Raises `InputError`: there is none, or a window shows it."""
        folder = self.library.folder(document)
        async with self._opening:
            if (session := self._sessions.get(document)) is not None:
                if session.is_looked_at:
                    raise InputError("is open in a window; close it first", key=document)
                del self._sessions[document]
                await session.close()
            await asyncio.to_thread(self.library.remove, folder.name)

    def is_open(self, document: str) -> bool:
        """Whether a document has a session."""
        return document in self._sessions

    async def close(self) -> None:
        """Close all documents."""
        for session in self._sessions.values():
            await session.close()

    async def picture(self, source: str) -> bytes:
        """Return a scene's net at equilibrium, as a frame of its net and one of its motion."""
        if source not in self._pictures:
            loop = asyncio.get_running_loop()
            self._pictures[source] = await loop.run_in_executor(None, picture_of, load(source))
        return self._pictures[source]


def application(library: Library, token: str, port: int) -> Starlette:
    """Return the server's application; it answers only to `port` on this machine and `token`."""
    studio = Studio(library)

    @asynccontextmanager
    async def life(app: Starlette) -> AsyncIterator[None]:
        yield
        await studio.close()

    app = Starlette(
        routes=[
            Route("/", _page),
            Route("/api/shelf", _answering(_shelf)),
            Route("/api/folder", _answering(_folder)),
            Route("/api/documents", _answering(_open), methods=["POST"]),
            Route("/api/documents/{document}", _answering(_document)),
            Route("/api/documents/{document}", _answering(_remove), methods=["DELETE"]),
            Route("/api/documents/{document}/picture", _answering(_document_picture)),
            Route("/api/documents/{document}/run", _answering(_table)),
            Route("/api/documents/{document}/export/{name}", _answering(_export)),
            Route("/api/documents/{document}/net/{side:path}", _answering(_net)),
            Route("/api/documents/{document}/compare", _answering(_compare), methods=["POST"]),
            Route(
                "/api/documents/{document}/run/clusters", _answering(_clusters), methods=["POST"]
            ),
            Route("/api/documents/{document}/lineage/{generation:int}", _answering(_lineage)),
            Route(
                "/api/documents/{document}/lineage/{generation:int}/{individual:int}",
                _answering(_lineage),
            ),
            Route("/api/scenes/{scene}/picture", _answering(_scene_picture)),
            Route("/api/curve", _answering(_curve), methods=["POST"]),
            WebSocketRoute("/api/documents/{document}/socket", _socket),
            Mount("/", StaticFiles(directory=STATIC, check_dir=False)),
        ],
        lifespan=life,
    )
    app.state.studio = studio
    app.add_middleware(_Guard, token=token, port=port)
    return app


def serve(
    library: Library,
    *,
    port: int | None = None,
    on_ready: Callable[[str], None] = lambda address: None,
) -> None:
    """Serve until the process is told to stop; `on_ready` is given the address with its token.

    Without a port it is the one these documents were last served on, if that is free; 0 means
    any. The token stays the same. Raises `InputError`: the port is taken.
    """
    last = last_address(library.home)
    listening = _listen(last.port, otherwise=True) if port is None else _listen(port)
    port, token = listening.getsockname()[1], last.token
    keep_address(library.home, Address(port=port, token=token))
    config = uvicorn.Config(
        application(library, token, port),
        ws="websockets-sansio",
        ws_max_size=_LARGEST_MESSAGE,
        ws_per_message_deflate=False,
        log_level="warning",
        access_log=False,
        timeout_graceful_shutdown=1,
        timeout_keep_alive=_KEEP_ALIVE,
        server_header=False,
    )
    server = _Server(config, lambda: on_ready(f"http://{HOST}:{port}/?token={token}"))
    server.run(sockets=[listening])


def _listen(port: int, *, otherwise: bool = False) -> socket.socket:
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((HOST, port))
    except OSError as error:
        listening.close()
        if otherwise:
            return _listen(0)
        problem = f"port {port} can't be used: {error.strerror}; choose another"
        raise InputError(problem, key="--port") from None
    return listening


class _Server(uvicorn.Server):
    def __init__(self, config: uvicorn.Config, ready: Callable[[], None]) -> None:
        super().__init__(config)
        self._ready = ready

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self._ready()


class _Guard:
    """Refuses, with 403, whoever comes by another name, from another page, or without the token."""

    def __init__(self, app: ASGIApp, *, token: str, port: int) -> None:
        self._app = app
        self._token = token
        self._hosts = {f"{name}:{port}" for name in (HOST, "localhost")}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan" or self._allows(scope):
            await self._app(scope, receive, _with_headers(send))
        elif scope["type"] == "websocket":
            # Refused before it is accepted, which a browser and a client see as 403.
            await send({"type": "websocket.close", "code": 1008})
        else:
            await _refusal(scope)(scope, receive, _with_headers(send))

    def _allows(self, scope: Scope) -> bool:
        headers = Headers(scope=scope)
        origin = headers.get("origin")
        own = origin is None or origin.removeprefix("http://") in self._hosts
        if headers.get("host") not in self._hosts or not own:
            return False
        path: str = scope["path"]
        if path.startswith("/assets/"):  # scripts and styles hold nothing of the user
            return True
        connection = HTTPConnection(scope)
        bearer = headers.get("authorization", "").removeprefix("Bearer ")
        given = connection.query_params.get("token") or bearer
        return secrets.compare_digest(given.encode(), self._token.encode())


def _refusal(scope: Scope) -> Response:
    problem = "the address needs the token that the studio printed"
    if scope["path"] == "/" and "text/html" in Headers(scope=scope).get("accept", ""):
        return HTMLResponse(_WRONG_ADDRESS, 403, {"cache-control": "no-store"})
    return _json(Refusal(problem=problem), 403)


def _with_headers(send: Send) -> Send:
    added = [
        (b"content-security-policy", _POLICY.encode()),
        (b"referrer-policy", b"no-referrer"),
        (b"x-content-type-options", b"nosniff"),
        (b"cross-origin-resource-policy", b"same-origin"),
        (b"cross-origin-opener-policy", b"same-origin"),
    ]

    async def sending(message: Any) -> None:
        if message["type"] == "http.response.start":
            message = message | {"headers": [*message["headers"], *added]}
        await send(message)

    return sending


# --- routes ---------------------------------------------------------------------------------------


def _json(answer: BaseModel, status: int = 200) -> JSONResponse:
    return JSONResponse(answer.model_dump(mode="json"), status, {"cache-control": "no-store"})


def _answering(
    route: Callable[[Request], Awaitable[BaseModel | Response]],
) -> Callable[[Request], Awaitable[Response]]:
    async def answer(request: Request) -> Response:
        try:
            found = await route(request)
        except InputError as error:
            return _json(Refusal(problem=str(error)), 422)
        return found if isinstance(found, Response) else _json(found)

    return answer


async def _page(request: Request) -> Response:
    page = STATIC / "index.html"
    if not page.is_file():
        return _json(Refusal(problem="the page is not built; run `make setup`"), 404)
    return FileResponse(page, headers={"cache-control": "no-store"})


async def _shelf(request: Request) -> Shelf:
    studio: Studio = request.app.state.studio
    entries = await asyncio.to_thread(studio.library.entries)
    return Shelf(
        scenes=[
            SceneEntry(name=name, description=scenes.load_scene(name).description)
            for name in scenes.names()
        ],
        documents=[
            DocumentEntry(
                id=entry.id,
                name=entry.name,
                file=entry.file,
                changed=entry.changed,
                open=studio.is_open(entry.id),
            )
            for entry in entries
        ],
    )


async def _folder(request: Request) -> Folder:
    return await asyncio.to_thread(folder_at, request.query_params.get("path", ""))


async def _remove(request: Request) -> Response:
    studio: Studio = request.app.state.studio
    await studio.remove(request.path_params["document"])
    return Response(status_code=204)


async def _document_picture(request: Request) -> Response:
    studio: Studio = request.app.state.studio
    document = request.path_params["document"]
    picture = await asyncio.to_thread(studio.library.picture, document)
    return Response(picture, media_type="application/octet-stream")


async def _open(request: Request) -> Opened:
    studio: Studio = request.app.state.studio
    try:
        asked = Opening.model_validate_json(await request.body())
    except ValidationError:
        raise InputError("must be a source", key="body") from None
    document = await asyncio.to_thread(studio.library.open, asked.source)
    session = await studio.session(document)
    return Opened(id=document, went_on=session.belongs_to_file and not session.is_saved)


async def _document(request: Request) -> BaseModel:
    studio: Studio = request.app.state.studio
    session = await studio.session(request.path_params["document"])
    return await session.document_state()


async def _table(request: Request) -> Response:
    studio: Studio = request.app.state.studio
    session = await studio.session(request.path_params["document"])
    first = request.query_params.get("from", "1")
    table = session.runs.table(int(first) if first.isdecimal() else 1)
    return Response(table, media_type="application/octet-stream")


async def _export(request: Request) -> Response:
    studio: Studio = request.app.state.studio
    session = await studio.session(request.path_params["document"])
    name = request.path_params["name"]
    content, suffix, media_type = await asyncio.to_thread(export, session.shown, name)
    file = f"{session.shown.name.replace(' ', '-')}{suffix}"
    headers = {
        "content-disposition": f"attachment; filename*=UTF-8''{quote(file)}",
        "cache-control": "no-store",
    }
    return Response(content, media_type=media_type, headers=headers)


async def _clusters(request: Request) -> BaseModel:
    studio: Studio = request.app.state.studio
    session = await studio.session(request.path_params["document"])
    try:
        asked = Brushes.model_validate_json(await request.body())
    except ValidationError:
        raise InputError("must be brushes and a number of clusters", key="body") from None
    return await asyncio.to_thread(session.runs.clusters, asked)


async def _lineage(request: Request) -> BaseModel:
    studio: Studio = request.app.state.studio
    session = await studio.session(request.path_params["document"])
    place = request.path_params["generation"], request.path_params.get("individual")
    return await asyncio.to_thread(session.runs.lineage, *place)


async def _net(request: Request) -> Response:
    studio: Studio = request.app.state.studio
    session = await studio.session(request.path_params["document"])
    try:
        side = _SIDE.validate_python(request.path_params["side"])
    except ValidationError:
        raise InputError("must be a net, such as design, pin/4 or run/34/2", key="net") from None
    picture = await asyncio.to_thread(session.pins.picture, side)
    return Response(picture, media_type="application/octet-stream")


async def _compare(request: Request) -> BaseModel:
    studio: Studio = request.app.state.studio
    session = await studio.session(request.path_params["document"])
    try:
        asked = Comparing.model_validate_json(await request.body())
    except ValidationError:
        problem = "must be two nets, such as design, pin/4 or run/34/2"
        raise InputError(problem, key="body") from None
    return await asyncio.to_thread(session.pins.compared, asked)


async def _scene_picture(request: Request) -> Response:
    studio: Studio = request.app.state.studio
    name = request.path_params["scene"]
    scenes.load_scene(name)
    return Response(await studio.picture(name), media_type="application/octet-stream")


async def _curve(request: Request) -> CurvePoints:
    name = request.query_params.get("name", "the file")
    data = bytearray()
    async for part in request.stream():
        data += part
        if len(data) > _LARGEST_CURVE:
            raise InputError("is larger than 1 MiB; leave out points", file=name)
    strains, forces = zip(*curve_in(bytes(data), name), strict=True)
    return CurvePoints(strains=list(strains), forces=list(forces))


async def _socket(socket: WebSocket) -> None:
    studio: Studio = socket.app.state.studio
    await socket.accept()
    try:
        session = await studio.session(socket.path_params["document"])
    except InputError as error:
        await socket.send_text(Refusal(problem=str(error)).model_dump_json())
        await socket.close(4000, str(error)[:100])
        return
    window = await session.join(_core.__version__)
    sending = asyncio.create_task(_send(socket, session, window))
    try:
        while True:
            message = await socket.receive()
            if message["type"] == "websocket.disconnect":
                break
            text = message.get("text")
            await session.receive(window, message["bytes"] if text is None else text)
    finally:
        sending.cancel()
        session.leave(window)


async def _send(socket: WebSocket, session: Session, window: Any) -> None:
    with suppress(WebSocketDisconnect, RuntimeError):
        async for message in session.outgoing(window):
            if isinstance(message, str):
                await socket.send_text(message)
            else:
                await socket.send_bytes(message)
