"""What is sent to a client that goes meanwhile."""

from __future__ import annotations

import asyncio
from typing import Any, cast

import pytest

from sailenv_ros.viewer.outbox import Outbox


class Socket:
    """One whose peer has gone, or takes nothing."""

    closed = False

    def __init__(self, *, gone: bool) -> None:
        self._gone = gone

    async def send_str(self, text: str) -> None:
        if self._gone:
            raise ConnectionResetError
        await asyncio.sleep(60.0)


def test_a_client_that_has_gone_is_no_fault() -> None:
    """Nothing is raised: its going is told where its messages are read."""

    async def send() -> None:
        socket = cast(Any, Socket(gone=True))
        await Outbox(socket, drop=lambda: pytest.fail("dropped"), send_s=5.0).send("words")

    asyncio.run(send())


def test_a_client_that_takes_nothing_is_dropped(caplog: pytest.LogCaptureFixture) -> None:
    """After the deadline, in words."""
    dropped: list[bool] = []

    async def send() -> None:
        socket = cast(Any, Socket(gone=False))
        await Outbox(socket, drop=lambda: dropped.append(True), send_s=0.05).send("words")

    asyncio.run(send())
    assert dropped
    assert "a viewer that does not read is disconnected" in caplog.text
