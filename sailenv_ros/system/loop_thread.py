"""An event loop in a thread of its own, for a server beside a simulation.

A coroutine that serves comes in, the port it listens on goes out. Knows no protocol.
"""

from __future__ import annotations

import asyncio
import logging
import threading
from collections.abc import Callable, Coroutine
from concurrent.futures import Future
from typing import Any

from sailenv_ros.errors import DeadlineExceeded
from sailenv_ros.system.futures import wait_for

__all__ = ["LoopThread"]

_log = logging.getLogger(__name__)

_START_S = 10.0
_STOP_S = 5.0


class LoopThread:
    """Runs one server; begins with `start` and is a daemon.

    Parameters
    ----------
    what : str
        The server, as errors and the log name it: ``"gateway"``.
    serve : callable
        ``serve(listening)`` is a coroutine; it calls ``listening(port)`` as soon as it listens, and
        returns after `stop` has been set.

    Attributes
    ----------
    loop : asyncio.AbstractEventLoop
    stop : asyncio.Event
    """

    def __init__(
        self, what: str, serve: Callable[[Callable[[int], None]], Coroutine[Any, Any, None]]
    ) -> None:
        self._what = what
        self._serve = serve
        self._listens: Future[int] = Future()
        self._thread = threading.Thread(target=self._run, name=f"sailenv-{what}", daemon=True)
        self.loop = asyncio.new_event_loop()
        self.stop = asyncio.Event()

    def start(self) -> int:
        """Begin, and return the port that is listened on; raises what `serve` raises before."""
        self._thread.start()
        return wait_for(self._listens, f"the {self._what} to listen", _START_S)

    @property
    def ended(self) -> bool:
        """True after `end`."""
        return self.loop.is_closed()

    def end(self) -> None:
        """Have the server stop, and wait for it.

        Raises
        ------
        DeadlineExceeded
            If it does not.
        """
        self.loop.call_soon_threadsafe(self.stop.set)
        self._thread.join(_STOP_S)
        if self._thread.is_alive():
            raise DeadlineExceeded(f"the {self._what} to end", _STOP_S)
        self.loop.close()

    def _run(self) -> None:
        asyncio.set_event_loop(self.loop)
        try:
            self.loop.run_until_complete(self._serve(self._listens.set_result))
        except Exception as error:
            if self._listens.done():
                _log.exception("the %s ends because of an error", self._what)
            else:
                self._listens.set_exception(error)
        finally:
            self.loop.run_until_complete(_end_of(asyncio.all_tasks(self.loop)))
            self.loop.run_until_complete(self.loop.shutdown_default_executor())


async def _end_of(tasks: set[asyncio.Task[Any]]) -> None:
    """End what is left, e.g. an answer for which nobody waits any more."""
    for task in tasks:
        task.cancel()
    if tasks:
        await asyncio.wait(tasks, timeout=1.0)
