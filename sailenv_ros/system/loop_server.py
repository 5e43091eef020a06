"""A server with an event loop in a thread of its own, beside a simulation. Knows no protocol."""

from __future__ import annotations

import asyncio
import errno
import logging
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, TypeVar

from sailenv_ros.errors import AddressInUse, DeadlineExceeded, InvalidRequest
from sailenv_ros.system.connection_gate import RareWarning
from sailenv_ros.system.futures import wait_for

__all__ = ["LoopServer"]

_log = logging.getLogger(__name__)

_START_S = 10.0
_STOP_S = 5.0

S = TypeVar("S", bound="LoopServer")


class LoopServer(ABC):
    """Listens on a port from a daemon thread; a context manager.

    Parameters
    ----------
    what : str
        The server, as errors and the log name it: ``"gateway"``.
    host : str
        Address to listen on.
    port : int
        0 takes any that is free.

    Attributes
    ----------
    host : str
        Address that is listened on.
    port : int
        Port that is listened on; the one that was taken, after `_start`.

    Raises
    ------
    InvalidRequest
        If the port is out of its range.
    """

    def __init__(self, what: str, host: str, port: int) -> None:
        if not 0 <= port <= 65535:
            raise InvalidRequest(f"port of the {what}", port, "an integer from 0 to 65535")
        self.host, self.port = host, port
        self._what = what
        self._listens: Future[int] = Future()
        self._thread = threading.Thread(target=self._run, name=f"sailenv-{what}", daemon=True)
        self._loop = asyncio.new_event_loop()
        self._loop.set_exception_handler(self._warn_of)
        self._warning = RareWarning(_log)
        self._stop = asyncio.Event()

    def _warn_of(self, _: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Tell of what no request answers for, e.g. that no connection can be accepted."""
        problem = context.get("exception")
        self._warning.warn(f"the {self._what}: {context['message']} ({problem})", problem)

    @abstractmethod
    async def _serve(self, listening: Callable[[int], None]) -> None:
        """Call ``listening(port)`` as soon as it listens; return after `_stop` has been set."""

    @abstractmethod
    def _release(self) -> None:
        """Free what the server holds beside its loop, once that has ended."""

    def _start(self) -> None:
        """Begin, and return when it listens.

        Raises
        ------
        AddressInUse, InvalidRequest
            If another program listens there, or the address is none of this machine's.
        DeadlineExceeded
        """
        self._thread.start()
        try:
            self.port = wait_for(self._listens, f"the {self._what} to listen", _START_S)
        except BaseException as problem:
            self.close()
            if not isinstance(problem, OSError) or isinstance(problem, DeadlineExceeded):
                raise
            if problem.errno == errno.EADDRINUSE:
                raise AddressInUse(f"the {self._what}", self.host, self.port) from problem
            accepted = f"one that can be listened on ({problem.strerror or problem})"
            address = f"{self.host}:{self.port}"
            raise InvalidRequest(f"address of the {self._what}", address, accepted) from problem

    def close(self) -> None:
        """Disconnect everybody and stop to listen; a second call does nothing.

        Raises
        ------
        DeadlineExceeded
            If it does not.
        """
        if self._loop.is_closed():
            return
        self._loop.call_soon_threadsafe(self._stop.set)
        self._thread.join(_STOP_S)
        if self._thread.is_alive():
            raise DeadlineExceeded(f"the {self._what} to end", _STOP_S)
        self._loop.close()
        self._release()

    def __enter__(self: S) -> S:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        try:
            self._loop.run_until_complete(self._serve(self._listens.set_result))
        except Exception as error:
            if self._listens.done():
                _log.exception("the %s ends because of an error", self._what)
            else:
                self._listens.set_exception(error)
        finally:
            self._loop.run_until_complete(_end_of(asyncio.all_tasks(self._loop)))
            self._loop.run_until_complete(self._loop.shutdown_default_executor())


async def _end_of(tasks: set[asyncio.Task[Any]]) -> None:
    """End what is left, e.g. an answer for which nobody waits any more."""
    for task in tasks:
        task.cancel()
    if tasks:
        await asyncio.wait(tasks, timeout=1.0)
