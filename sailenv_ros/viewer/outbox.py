"""Outgoing messages of one client, sent in turn, from the event loop or another thread.

Messages in, bytes on a socket out. Who does not read is disconnected after a deadline, so that
nothing heaps up.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
from collections.abc import Callable, Coroutine, Mapping
from typing import Any

from aiohttp import web

__all__ = ["Outbox"]

_log = logging.getLogger(__name__)


class Outbox:
    """Sends on a socket; made in the event loop.

    Parameters
    ----------
    socket : web.WebSocketResponse
        Prepared already.
    drop : callable
        Ends the connection without a goodbye, which would not be read either.
    send_s : float
        Deadline of a message [s].
    """

    def __init__(
        self, socket: web.WebSocketResponse, *, drop: Callable[[], None], send_s: float
    ) -> None:
        self._socket = socket
        self._drop = drop
        self._send_s = send_s
        self._loop = asyncio.get_running_loop()
        self._turn = asyncio.Lock()
        self._tasks: set[asyncio.Task[None]] = set()

    @property
    def tasks(self) -> tuple[asyncio.Task[None], ...]:
        """Tasks that other threads began and that have not ended."""
        return tuple(self._tasks)

    async def send_json(self, message: Mapping[str, object]) -> None:
        """Send a message as text."""
        await self.send(json.dumps(message, separators=(",", ":"), allow_nan=False))

    async def send(self, message: str | bytes) -> None:
        """Send a message, after those that were begun before; nothing if the client has gone."""
        async with self._turn:
            if self._socket.closed:
                return
            sent = (
                self._socket.send_str(message)
                if isinstance(message, str)
                else self._socket.send_bytes(message)
            )
            try:
                await asyncio.wait_for(sent, self._send_s)
            except ConnectionError:
                return  # it went just now
            except asyncio.TimeoutError:
                _log.warning("a viewer that does not read is disconnected")
                self._drop()

    def post(self, message: bytes) -> None:
        """Have a message sent; from another thread."""
        self._begin(lambda: self.send(message))

    def post_json(self, message: Mapping[str, object]) -> None:
        """Have a message sent as text; from another thread."""
        self._begin(lambda: self.send_json(message))

    def _begin(self, sending: Callable[[], Coroutine[Any, Any, None]]) -> None:
        with contextlib.suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(self._begun, sending)

    def _begun(self, sending: Callable[[], Coroutine[Any, Any, None]]) -> None:
        if not self._socket.closed:
            task = asyncio.create_task(_quietly(sending))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)


async def _quietly(sending: Callable[[], Coroutine[Any, Any, None]]) -> None:
    """Send to a client that may go meanwhile, even before the first step."""
    with contextlib.suppress(ConnectionError, RuntimeError):
        await sending()
