"""The web viewer's server: the page and its sockets on a TCP port, in a thread of this process.

HTTP in, requests to a `Simulation` out. The simulation's rate is its own: here is only waited.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import secrets
import socket
import time
from collections.abc import Awaitable, Callable

from aiohttp import web

from sailenv_ros.errors import SailenvError
from sailenv_ros.simulation import Simulation
from sailenv_ros.system.connection_gate import BACKLOG, ConnectionGate, address_of
from sailenv_ros.system.loop_server import LoopServer
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.viewer.access_control import SECURITY_HEADERS, AccessControl, is_loopback
from sailenv_ros.viewer.address import DEFAULT_HOST, DEFAULT_PORT
from sailenv_ros.viewer.agent_feed import AgentFeeds
from sailenv_ros.viewer.client import Client
from sailenv_ros.viewer.data_set_captures import DataSetCaptures, DataSetMaker
from sailenv_ros.viewer.debug_agent import NAME, DebugAgent
from sailenv_ros.viewer.edit_history import EditHistory
from sailenv_ros.viewer.encoding import views_to_json
from sailenv_ros.viewer.export_files import ExportFiles
from sailenv_ros.viewer.messages import StatsMessage
from sailenv_ros.viewer.page_files import page_file
from sailenv_ros.viewer.scene_json import (
    behaviours_to_json,
    materials_to_json,
    picture_settings_to_json,
    skies_to_json,
)
from sailenv_ros.viewer.stats_news import StatsNews
from sailenv_ros.viewer.viewer_limits import ViewerLimits

__all__ = ["ViewerServer"]

_log = logging.getLogger(__name__)

OBJECTS_S = 1.0
"""Least time between two looks at what physics has moved [s]."""

MAX_NAME = 200

_Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


class _Entrance(asyncio.Protocol):
    """A connection of which nothing has been read: given to aiohttp, or closed."""

    def __init__(self, runner: web.AppRunner, gate: ConnectionGate) -> None:
        self._runner = runner
        self._gate = gate

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Admit it or not."""
        server = self._runner.server
        if server is None or not isinstance(transport, asyncio.Transport):
            raise RuntimeError("a connection came before the server was ready")
        others = [
            address_of(handler.transport.get_extra_info("peername"))
            for handler in server.connections
            if handler.transport is not None and not handler.transport.is_closing()
        ]
        if self._gate.admits(transport.get_extra_info("socket"), others):
            protocol = server()
            transport.set_protocol(protocol)
            protocol.connection_made(transport)
        else:
            transport.abort()


class ViewerServer(LoopServer):
    """Serves the web viewer on one simulation; a context manager.

    Parameters
    ----------
    simulation : Simulation
        Stays its owner's; it may end before this does.
    host : str
        Address to listen on; ``127.0.0.1`` for this machine alone. On any other the address that
        people open must bring a token, see `url`.
    port : int
        0 takes any that is free, see `port`.
    control : bool
        Whether those who come from elsewhere may change anything; on this machine alone, everybody
        may.
    limits : ViewerLimits
    data_sets : DataSetMaker or None
        Writes the data sets that the page offers to capture; None offers none.

    Raises
    ------
    AddressInUse, InvalidRequest
        If another program listens there, or the address is none of this machine's.
    """

    def __init__(
        self,
        simulation: Simulation,
        *,
        host: str = DEFAULT_HOST,
        port: int = DEFAULT_PORT,
        control: bool = False,
        limits: ViewerLimits | None = None,
        data_sets: DataSetMaker | None = None,
    ) -> None:
        super().__init__("viewer", host, port)
        self._simulation = simulation
        loopback = is_loopback(host)
        self._access = AccessControl(
            loopback=loopback, token="" if loopback else secrets.token_urlsafe(16)
        )
        self._may_change = loopback or control
        self._limits = limits or ViewerLimits()
        self._gate = ConnectionGate("viewer", self._limits.connections, self._limits.per_address)
        self._debug_agent = DebugAgent(simulation)
        self._clients: set[Client] = set()
        self._connected = 0
        self._touched = 0
        self._objects_told_s = 0.0
        self._history = EditHistory()
        self._captures = DataSetCaptures(simulation, self._access, self._limits, data_sets)
        self._stats = StatsNews(
            simulation,
            self._history,
            tell=self._announce_stats,
            viewers=lambda: len(self._clients),
            time_stands=self._announce_objects,  # no step tells of what programs move
            capturing=lambda: self._captures.progress,
        )
        self._feeds = AgentFeeds(simulation, self._debug_agent, lambda: self._touched)
        self._end_news = contextlib.ExitStack()
        self._start()
        self._end_news.callback(simulation.on_info(self._scene_changed))
        self._end_news.callback(simulation.on_step(self._stepped))

    @property
    def url(self) -> str:
        """Address of the page, with the token where one is needed."""
        name = socket.gethostname() if self.host in ("0.0.0.0", "::", "") else self.host
        name = f"[{name}]" if ":" in name else name
        token = f"?token={self._access.token}" if self._access.token else ""
        return f"http://{name}:{self.port}/{token}"

    @property
    def clients(self) -> int:
        """Number of sockets that are open now."""
        return len(self._clients)

    @property
    def rendered_views(self) -> frozenset[str]:
        """Views that are rendered for somebody here now; none for those that stall."""
        return self._feeds.rendered_views

    def set_intrinsics(self, intrinsics: CameraIntrinsics) -> None:
        """Change what the debug agent sees: its pictures' size and its angle of view."""
        self._debug_agent.set_intrinsics(intrinsics)

    def _release(self) -> None:
        self._end_news.close()
        self._feeds.close()
        self._captures.close()

    def _scene_changed(self, _: SceneInfo) -> None:
        """Have everybody told; called by the simulation's thread."""
        with contextlib.suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(self._announce_scene)

    def _stepped(self, _: int) -> None:
        """Have selected objects told, which physics may have moved; called by the simulation's."""
        now = time.monotonic()
        if now - self._objects_told_s >= OBJECTS_S and self._selects:
            self._objects_told_s = now
            with contextlib.suppress(RuntimeError):  # the loop has ended
                self._loop.call_soon_threadsafe(self._announce_objects)

    # -- in the thread ---------------------------------------------------------------------

    async def _serve(self, listening: Callable[[int], None]) -> None:
        app = web.Application(middlewares=[self._checked])
        app.router.add_get("/", self._page)
        app.router.add_get("/socket", self._socket)
        app.router.add_get("/thumbnail/{asset}", self._thumbnail)
        exports = ExportFiles(self._simulation, self._access, self._limits.request_s)
        app.router.add_get("/export/{format}", exports.answer)
        app.router.add_get("/captured/{key}", self._captures.answer)
        app.router.add_get("/{name}", self._page_file)
        runner = web.AppRunner(
            app,
            access_log=None,
            handle_signals=False,
            shutdown_timeout=1.0,
            # aiohttp closes by it, too, who has not sent a whole request.
            keepalive_timeout=self._limits.header_s,
        )
        await runner.setup()
        try:
            server = await self._loop.create_server(
                lambda: _Entrance(runner, self._gate), self.host, self.port, backlog=BACKLOG
            )
            listening(server.sockets[0].getsockname()[1])
            stats = asyncio.create_task(self._stats.run())
            await self._stop.wait()
            self._captures.give_up()
            stats.cancel()
            server.close()
            await asyncio.gather(*(client.close() for client in tuple(self._clients)))
        finally:
            await runner.cleanup()

    @web.middleware
    async def _checked(self, request: web.Request, handler: _Handler) -> web.StreamResponse:
        reason = self._access.refusal_of_request(request.headers)
        if reason:
            return self._refusal(reason)
        try:
            response = await handler(request)
        except web.HTTPException as refusal:
            refusal.headers.update(SECURITY_HEADERS)
            raise
        if not response.prepared:
            for name, value in SECURITY_HEADERS.items():
                response.headers.setdefault(name, value)
        return response

    async def _page(self, request: web.Request) -> web.StreamResponse:
        reason = self._access.refusal_of_token(request.query.get("token", ""))
        return self._refusal(reason) if reason else self._file("index.html")

    async def _page_file(self, request: web.Request) -> web.StreamResponse:
        return self._file(request.match_info["name"])

    async def _thumbnail(self, request: web.Request) -> web.StreamResponse:
        """Return the picture of a catalogue's object; made now if it was not yet."""
        reason = self._access.refusal_of_token(request.query.get("token", ""))
        if reason:
            return self._refusal(reason)
        try:
            making = self._simulation.get_thumbnail_png.submit(
                request.match_info["asset"][:MAX_NAME]
            )
            data = await asyncio.wait_for(asyncio.wrap_future(making), self._limits.request_s)
        except (SailenvError, asyncio.TimeoutError) as problem:
            return web.Response(status=404, text=f"there is no such picture: {problem}\n")
        return web.Response(
            body=data, content_type="image/png", headers={"Cache-Control": "private, max-age=600"}
        )

    async def _socket(self, request: web.Request) -> web.StreamResponse:
        reason = self._access.refusal_of_socket(request.headers, request.query.get("token", ""))
        if reason:
            _log.warning("a viewer is refused: %s", reason)
            return self._refusal(reason)
        if self._connected >= self._limits.clients:
            return self._refusal(f"{self._connected} viewers are connected, which is the most")
        answer = web.WebSocketResponse(
            max_msg_size=self._limits.message_bytes,
            heartbeat=self._limits.silent_s / 1.5,  # aiohttp waits half as long for the answer
            compress=False,
        )
        self._connected += 1
        try:
            await answer.prepare(request)
            await self._serve_client(answer, request.transport)
        finally:
            self._connected -= 1
        return answer

    async def _serve_client(
        self, answer: web.WebSocketResponse, transport: asyncio.Transport | None
    ) -> None:
        client = Client(
            answer,
            drop=lambda: None if transport is None else transport.abort(),
            simulation=self._simulation,
            debug_agent=self._debug_agent,
            feeds=self._feeds,
            may_change=self._may_change,
            limits=self._limits,
            greeting={
                "type": "hello",
                "control": self._may_change,
                "debug_agent": NAME,
                "views": views_to_json(self._simulation.supported_views),
                "behaviours": behaviours_to_json(),
                "picture_settings": picture_settings_to_json(),
                "materials": materials_to_json(),
                "skies": await asyncio.to_thread(skies_to_json),
                "data_sets": self._captures.formats,
            },
            touch=self._touch,
            history=self._history,
            captures=self._captures,
        )
        self._clients.add(client)
        try:
            await client.serve()
        except (ConnectionError, asyncio.CancelledError):
            _log.info("a viewer went away")
        finally:
            self._clients.discard(client)

    @property
    def _selects(self) -> bool:
        return any(client.selects for client in tuple(self._clients))

    def _touch(self) -> None:
        self._touched += 1
        self._announce_objects()
        self._stats.history_changed()

    def _announce_scene(self) -> None:
        for client in self._clients:
            client.scene_changed()
        self._announce_objects()

    def _announce_objects(self) -> None:
        for client in self._clients:
            client.objects_changed()

    def _announce_stats(self, stats: StatsMessage) -> None:
        for client in self._clients:
            client.send_stats(stats)

    def _file(self, name: str) -> web.Response:
        found = page_file(name)
        if found is None:
            return web.Response(status=404, text=f"there is no page {name[:80]!r} here\n")
        kind, data = found
        return web.Response(body=data, content_type=kind, charset="utf-8")

    def _refusal(self, why: str) -> web.Response:
        return web.Response(status=403, text=f"Refused: {why}\n", headers=SECURITY_HEADERS)
