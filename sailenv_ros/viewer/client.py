"""One client's socket: messages to commands and to its `ViewSubscription`, frames and news back.

Runs in the viewer's event loop. Whatever a client sends is answered in words; what it leaves
unread ends the conversation. Knows no other client.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Awaitable, Callable, Mapping
from typing import Any, Final, ParamSpec, TypeVar

from aiohttp import WSCloseCode, WSMsgType, web

from sailenv_ros.errors import (
    DeadlineExceeded,
    InternalFault,
    InvalidRequest,
    InvalidState,
    SailenvError,
    UnknownName,
)
from sailenv_ros.frame.frame import Frame
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.operations import Operation, Operations
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.types.views import FIVE_VIEWS
from sailenv_ros.viewer.agent_feed import AgentFeeds
from sailenv_ros.viewer.commands import COMMANDS
from sailenv_ros.viewer.data_set_captures import DataSetCaptures
from sailenv_ros.viewer.debug_agent import DebugAgent
from sailenv_ros.viewer.edit_history import EditHistory
from sailenv_ros.viewer.encoding import packed, sheet_png, view_png
from sailenv_ros.viewer.messages import HelloMessage, SentFile, StatsMessage
from sailenv_ros.viewer.outbox import Outbox
from sailenv_ros.viewer.request_arguments import Arguments, arguments_of_text
from sailenv_ros.viewer.scene_json import scene_to_json
from sailenv_ros.viewer.selected_object import SelectedObject
from sailenv_ros.viewer.served_commands import served
from sailenv_ros.viewer.view_subscription import ViewSubscription
from sailenv_ros.viewer.viewer_limits import ViewerLimits

__all__ = ["OWN_COMMANDS", "Client"]

_log = logging.getLogger(__name__)

MAX_WORDS = 1000

P = ParamSpec("P")
R = TypeVar("R")


class Client:
    """A client from its first message to its last.

    Parameters
    ----------
    socket : web.WebSocketResponse
        Prepared already.
    drop : callable
        Ends the connection without a goodbye.
    simulation : Simulation
    debug_agent : DebugAgent
    feeds : AgentFeeds
    may_change : bool
        False for who may only watch.
    limits : ViewerLimits
    greeting : HelloMessage
        Sent first; what never changes.
    touch : callable
        Called after each command that may have changed what is seen.
    history : EditHistory
    captures : DataSetCaptures
    """

    def __init__(
        self,
        socket: web.WebSocketResponse,
        *,
        drop: Callable[[], None],
        simulation: Simulation,
        debug_agent: DebugAgent,
        feeds: AgentFeeds,
        may_change: bool,
        limits: ViewerLimits,
        greeting: HelloMessage,
        touch: Callable[[], None],
        history: EditHistory,
        captures: DataSetCaptures,
    ) -> None:
        self.history = history
        self.captures = captures
        self.picture_pieces = bytearray()
        self.debug_agent = debug_agent
        self._socket = socket
        self._simulation = simulation
        self._feeds = feeds
        self._may_change = may_change
        self._limits = limits
        self._greeting = greeting
        self._touch = touch
        self._loop = asyncio.get_running_loop()
        self._subscription: ViewSubscription | None = None
        self._drop = drop
        self._outbox = Outbox(socket, drop=drop, send_s=limits.send_s)
        self._selected = SelectedObject(self, self._outbox.send_json)
        self._news = asyncio.Event()
        self._sent_revision = (-1, -1)
        self._stats: StatsMessage | None = None
        self._running: set[asyncio.Task[None]] = set()
        self._second, self._messages = 0.0, 0

    # -- as the context of commands ---------------------------------------------------------

    @property
    def info(self) -> SceneInfo:
        """The scene as it was announced last."""
        return self._simulation.info

    def frame(self, number: object) -> Frame:
        """Return a frame that this client was sent lately; None means the last one."""
        if self._subscription is None:
            raise InvalidState("no agent is watched here yet; watch one first")
        return self._subscription.frame(number)

    def select(self, instance_id: int) -> None:
        """Subscribe to the outline and the state of an instance; 0 to stop."""
        self._selected.choose(instance_id)
        if self._subscription is not None:
            self._subscription.selected = instance_id

    async def run(self, operation: Operation[P, R], /, *args: P.args, **kwargs: P.kwargs) -> R:
        """Have the simulation do something; wait for its result."""
        future = asyncio.wrap_future(operation.submit_to(self._simulation, *args, **kwargs))
        try:
            return await asyncio.wait_for(future, self._limits.request_s)
        except asyncio.TimeoutError:
            what = f"the operation {operation.name!r}"
            raise DeadlineExceeded(what, self._limits.request_s) from None

    # -- of the server ---------------------------------------------------------------------

    async def serve(self) -> None:
        """Answer until the client goes."""
        await self._outbox.send_json(self._greeting)
        sending = [asyncio.create_task(one) for one in (self._send_news(), self._selected.tell())]
        self._news.set()
        try:
            await self._listen()
        finally:
            self._end_watch()
            ending = [*sending, *self._running, *self._outbox.tasks]
            # Again and again: until Python 3.12, wait_for loses a cancellation that meets a result.
            for _ in range(10):
                for task in ending:
                    task.cancel()
                _, left = await asyncio.wait(ending, timeout=0.1)
                if not left:
                    break

    def scene_changed(self) -> None:
        """Have the scene told when there is time to."""
        self._news.set()

    @property
    def selects(self) -> bool:
        """True while it is to be told of an object's changes."""
        return self._selected.id != 0

    def objects_changed(self) -> None:
        """Have the selected object told if it has changed."""
        self._selected.changed()

    def send_stats(self, stats: StatsMessage) -> None:
        """Have these numbers told; newer ones take the place of those that wait."""
        self._stats = stats
        self._news.set()

    async def close(self) -> None:
        """Send the closing message."""
        with contextlib.suppress(Exception):
            await self._socket.close(code=WSCloseCode.GOING_AWAY, message=b"the simulator ends")

    # -- inside ----------------------------------------------------------------------------

    async def _listen(self) -> None:
        async for message in self._socket:
            if message.type == WSMsgType.ERROR:
                break
            if not self._admits():
                words = f"more than {self._limits.messages_per_s} messages in a second"
                await self._socket.close(code=WSCloseCode.POLICY_VIOLATION, message=words.encode())
                return
            if message.type != WSMsgType.TEXT:
                await self._refuse(None, InvalidRequest("message", "bytes", "text"))
                continue
            try:
                given = arguments_of_text(message.data)
            except SailenvError as error:
                await self._refuse(None, error)
                continue
            if given.get("do") == "shown":
                await self._shown(given)
            else:
                await self._begin(given)
        problem = self._socket.exception()
        if problem is not None:
            if not isinstance(problem, ConnectionError):
                _log.warning("a viewer is disconnected: %s", _why(problem))
            self._drop()

    def _admits(self) -> bool:
        now = self._loop.time()
        if now - self._second >= 1.0:
            self._second, self._messages = now, 0
        self._messages += 1
        return self._messages <= self._limits.messages_per_s

    async def _shown(self, given: Arguments) -> None:
        try:
            if self._subscription is not None:
                self._subscription.shown(given.get("number"))
        except SailenvError as error:
            await self._refuse(None, error)

    async def _begin(self, given: Arguments) -> None:
        """Do what is asked for while further messages are read."""
        if len(self._running) >= self._limits.requests:
            limit = InvalidRequest(
                "requests on their way", len(self._running) + 1, f"at most {self._limits.requests}"
            )
            await self._refuse(given.get("id"), limit)
            return
        task = asyncio.create_task(self._answer(given))
        self._running.add(task)
        task.add_done_callback(self._running.discard)

    async def _answer(self, given: Arguments) -> None:
        number = given.get("id")
        number = number if isinstance(number, int) else None
        try:
            result = await self._done(given)
        except SailenvError as error:
            await self._refuse(number, error)
        except ConnectionError:
            return
        except Exception:
            _log.exception("a viewer's request ends because of an internal error")
            await self._refuse(
                number, InternalFault("an internal error of the simulator, see its log")
            )
        else:
            if isinstance(result, SentFile):
                await self._outbox.send(packed(result.head(number), [result.data]))
            else:
                await self._outbox.send_json({"type": "reply", "id": number, "result": result})

    async def _done(self, given: Arguments) -> Any:
        name = given.text("do")
        own = OWN_COMMANDS.get(name)
        if own is not None:
            return await own(self, given)
        if name not in COMMANDS:
            raise UnknownName("command", name[:80], sorted({*COMMANDS, *OWN_COMMANDS, "shown"}))
        command = COMMANDS[name]
        if command.changes and not self._may_change:
            accepted = "one that only looks; start the simulator with --viewer-control to allow it"
            raise InvalidRequest("command", name, accepted)
        try:
            return await command.run(self, given)
        finally:
            if command.changes:
                self._touch()

    @served
    async def _watch_agent(self, agent: str, views: list[str]) -> None:
        if self._subscription is not None and self._subscription.agent == agent:
            self._subscription.show(self._feeds.checked(views))
            return
        first = 1 if self._subscription is None else self._subscription.next_number
        watch = self._feeds.watch(
            agent, views, send=self._outbox.post, ended=self._watch_ended, first_number=first
        )
        self._end_watch()
        self._subscription = watch
        watch.selected = self._selected.id

    def _end_watch(self) -> None:
        if self._subscription is not None:
            self._feeds.leave(self._subscription)
            self._subscription = None

    @served
    async def _screenshot(self, view: str, frame: int | None = None) -> SentFile:
        """Return one view as a PNG, without loss."""
        seen = self.frame(frame)
        data = await asyncio.to_thread(
            view_png, seen, view, categories=self.info.categories, depth_range_m=seen.depth_range_m
        )
        return SentFile(f"{seen.scene}_{seen.agent}_{seen.sequence:06d}_{view}.png", data)

    @served
    async def _sheet(self) -> SentFile:
        """Return the five views on one sheet, rendered together at the next instant."""
        last = self.frame(None)
        frame: Frame = await self.run(Operations.capture, FIVE_VIEWS, agent=last.agent)
        categories, range_m = self.info.categories, frame.depth_range_m
        data = await asyncio.to_thread(
            sheet_png, frame, FIVE_VIEWS, categories=categories, depth_range_m=range_m
        )
        return SentFile(f"{frame.scene}_{frame.agent}_{frame.sequence:06d}_views.png", data)

    # -- sending ---------------------------------------------------------------------------

    async def _send_news(self) -> None:
        """Send what is new, the newest alone."""
        while True:
            await self._news.wait()
            self._news.clear()
            info = self._simulation.info
            if (info.epoch, info.revision) != self._sent_revision:
                self._sent_revision = (info.epoch, info.revision)
                await self._outbox.send_json(scene_to_json(info))
            if self._stats is not None:
                stats, self._stats = self._stats, None
                await self._outbox.send_json(stats)

    def _watch_ended(self, why: str) -> None:
        self._outbox.post_json({"type": "watch_ended", "why": why[:MAX_WORDS]})

    async def _refuse(self, number: object, error: SailenvError) -> None:
        words = "; ".join(line.strip() for line in str(error).splitlines() if line.strip())
        await self._outbox.send_json({"type": "refused", "id": number, "error": words[:MAX_WORDS]})


def _why(problem: BaseException) -> str:
    if isinstance(problem, asyncio.TimeoutError):
        return "it does not answer"
    return str(problem) or type(problem).__name__


OWN_COMMANDS: Final[Mapping[str, Callable[[Client, Arguments], Awaitable[Any]]]] = {
    "watch": Client._watch_agent,
    "screenshot": Client._screenshot,
    "sheet": Client._sheet,
}
"""Commands about what this client is shown, by their names."""
