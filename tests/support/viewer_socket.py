"""A client of the web viewer's socket, for tests: asks, waits with a deadline, unpacks frames."""

from __future__ import annotations

import asyncio
import contextlib
import functools
import json
from collections.abc import AsyncIterator, Callable, Coroutine
from typing import Any

import aiohttp

from sailenv_ros.viewer import ViewerServer

DEADLINE_S = 30.0


class ViewerSocket:
    """One connection; `heads` are those of the frames that have come, `told` all other messages."""

    def __init__(self, socket: aiohttp.ClientWebSocketResponse) -> None:
        self.socket = socket
        self.heads: list[dict[str, Any]] = []
        self.bodies: list[bytes] = []
        self.told: list[dict[str, Any]] = []
        self._ids = 0

    async def ask(self, what: str, **values: Any) -> Any:
        """Ask and return the result; a refusal is an AssertionError with its words."""
        answer = await self.answer(what, **values)
        assert answer["type"] == "reply", answer
        return answer["result"]

    async def refusal(self, what: str, **values: Any) -> str:
        """Ask for what is refused; return the words."""
        answer = await self.answer(what, **values)
        assert answer["type"] == "refused", answer
        return str(answer["error"])

    async def answer(self, what: str, **values: Any) -> dict[str, Any]:
        """Ask; return whatever is answered."""
        self._ids += 1
        number = self._ids
        await self.socket.send_json({"do": what, "id": number, **values})
        return await self.until(lambda message: message.get("id") == number)

    async def until(self, fits: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """Read on until a message fits; it may be a frame's head."""

        async def found() -> dict[str, Any]:
            while True:
                message = await self.read()
                if fits(message):
                    return message

        return await asyncio.wait_for(found(), DEADLINE_S)

    async def read(self) -> dict[str, Any]:
        """Read one message."""
        received = await self.socket.receive()
        if received.type == aiohttp.WSMsgType.TEXT:
            message: dict[str, Any] = json.loads(received.data)
            self.told.append(message)
            return message
        assert received.type == aiohttp.WSMsgType.BINARY, received
        size = int.from_bytes(received.data[:4], "little")
        head: dict[str, Any] = json.loads(received.data[4 : 4 + size])
        if head["type"] == "frame":
            self.heads.append(head)
        self.bodies.append(received.data[4 + size :])
        return head

    async def frame(self, *, shown: bool = True) -> dict[str, Any]:
        """Wait for a frame; say that it is shown."""
        head = await self.until(lambda message: message["type"] == "frame")
        if shown:
            await self.socket.send_json({"do": "shown", "number": head["number"]})
        return head


@contextlib.asynccontextmanager
async def connected(
    server: ViewerServer, *, token: str = "", **headers: str
) -> AsyncIterator[ViewerSocket]:
    """Connect as the page does."""
    host = f"127.0.0.1:{server.port}"
    sent = {"Origin": f"http://{host}", **headers}
    async with (
        aiohttp.ClientSession() as session,
        session.ws_connect(
            f"http://{host}/socket", headers=sent, params={"token": token} if token else {}
        ) as socket,
    ):
        yield ViewerSocket(socket)


def in_a_loop(test: Callable[..., Coroutine[Any, Any, None]]) -> Callable[..., None]:
    """Run a test that waits for answers in an event loop of its own."""

    @functools.wraps(test)
    def run(*args: Any, **kwargs: Any) -> None:
        asyncio.run(test(*args, **kwargs))

    return run


@contextlib.asynccontextmanager
async def page_of(server: ViewerServer) -> AsyncIterator[ViewerSocket]:
    """A connection that watches the debug agent."""
    async with connected(server) as page:
        await page.ask("watch", agent="debug_agent", views=["rgb", "depth", "instance"])
        await page.frame()
        yield page
