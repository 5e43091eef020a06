"""Long work, one piece after the other, in a thread of its own beside the simulation.

Pieces of work come in, a future of each one's result goes out. Knows nothing of what is done.
"""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Generic, TypeVar

from sailenv_ros.errors import InvalidState, SimulationClosed

__all__ = ["WorkQueue"]

Piece = TypeVar("Piece")
Result = TypeVar("Result")


class WorkQueue(Generic[Piece, Result]):
    """Work of one kind; its thread begins with the first piece and is a daemon.

    Parameters
    ----------
    what : str
        The pieces, as errors and the thread's name have them: ``"uploads"``.
    work : callable
        Does one piece, in the thread.
    idle_s : callable
        Gives how long the thread waits for a piece before `rest` is called [s]; None is forever.
    rest : callable
        Called in the thread when nothing has come for so long, and at the end.
    """

    def __init__(
        self,
        what: str,
        work: Callable[[Piece], Result],
        *,
        idle_s: Callable[[], float | None] = lambda: None,
        rest: Callable[[], None] = lambda: None,
    ) -> None:
        self._what = what
        self._work = work
        self._idle_s = idle_s
        self._rest = rest
        self._waiting: queue.Queue[tuple[Future[Result], Piece] | None] = queue.Queue()
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None
        self._closed = False

    def begin(self, piece: Piece, *, most: int) -> Future[Result]:
        """Queue a piece of work, unless `most` are waiting already.

        Raises
        ------
        InvalidRequest
            If too many are waiting.
        SimulationClosed
            If the queue was closed.
        """
        future: Future[Result] = Future()
        with self._lock:
            if self._closed:
                raise SimulationClosed()
            if self._waiting.qsize() >= most:
                raise InvalidState(
                    f"{most} {self._what} are waiting, which is the most; wait for one to be done"
                )
            self._waiting.put((future, piece))
            if self._thread is None:
                self._thread = threading.Thread(
                    target=self._run, name=f"sailenv-{self._what}", daemon=True
                )
                self._thread.start()
        return future

    def close(self) -> None:
        """Refuse those that wait and take no more; a second call does nothing."""
        with self._lock:
            self._closed = True
            while not self._waiting.empty():
                waiting = self._waiting.get_nowait()
                if waiting is not None and waiting[0].set_running_or_notify_cancel():
                    waiting[0].set_exception(SimulationClosed())
            self._waiting.put(None)

    def join(self, timeout_s: float) -> None:
        """Wait for the thread to end, after `close`."""
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join(timeout_s)

    def _run(self) -> None:
        while True:
            try:
                waiting = self._waiting.get(timeout=self._idle_s())
            except queue.Empty:
                self._rest()
                continue
            if waiting is None:
                self._rest()
                return
            future, piece = waiting
            if not future.set_running_or_notify_cancel():
                continue
            try:
                future.set_result(self._work(piece))
            except BaseException as error:  # whatever it is, whoever waits is told
                future.set_exception(error)
