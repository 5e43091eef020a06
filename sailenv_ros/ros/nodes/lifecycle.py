"""End of a node process: signals, a parent that has died, and a clean-up with a deadline.

Knows no ROS and no simulation; the node waits on a `StopRequest` and ends in its main thread.
"""

from __future__ import annotations

import contextlib
import logging
import os
import select
import signal
import threading
from collections.abc import Callable

__all__ = ["StopRequest", "finished_within", "stop_at_end_of"]

_log = logging.getLogger(__name__)

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class StopRequest:
    """Becomes set once the process shall end, by a signal or by a call of `set`.

    The handlers stay while the process cleans up, so a second signal disturbs nothing; `disarm`
    is for the very end, where Python takes its handlers away.
    """

    def __init__(self) -> None:
        self._set = False
        # A pipe, because a handler that interrupts a lock's owner must not ask for that lock.
        self._read_end, self._write_end = os.pipe()
        os.set_blocking(self._write_end, False)

    def install(self) -> None:
        """Take SIGINT and SIGTERM; to be called in the main thread, before anything is slow."""
        for number in _SIGNALS:
            signal.signal(number, self._on_signal)

    def disarm(self) -> None:
        """Ignore the signals from now on; for the main thread."""
        for number in _SIGNALS:
            signal.signal(number, signal.SIG_IGN)

    def set(self) -> None:
        """Ask for the end."""
        self._set = True
        with contextlib.suppress(BlockingIOError):  # full: whoever waits is woken already
            os.write(self._write_end, b"!")

    @property
    def is_set(self) -> bool:
        """True once the end was asked for."""
        return self._set

    def wait(self, timeout_s: float | None = None) -> bool:
        """Wait for the request; True if it has come. Signals are handled meanwhile."""
        if not self._set:
            select.select([self._read_end], [], [], timeout_s)
        return self._set

    def _on_signal(self, number: int, frame: object) -> None:
        if not self._set:
            self.set()


def stop_at_end_of(fd: int, stop: StopRequest) -> None:
    """Ask for the end when a pipe's other end is closed, which death does however it comes."""

    def watch() -> None:
        try:
            while os.read(fd, 4096):
                pass
        except OSError as problem:
            _log.warning("cannot watch file descriptor %d: %s", fd, problem)
        stop.set()

    threading.Thread(target=watch, name="parent-watch", daemon=True).start()


def finished_within(work: Callable[[], None], timeout_s: float) -> bool:
    """Do something in a thread of its own; False if it was not done in time and still runs."""

    def run() -> None:
        try:
            work()
        except Exception:
            _log.exception("the clean-up failed")

    thread = threading.Thread(target=run, name="clean-up", daemon=True)
    thread.start()
    thread.join(timeout_s)
    return not thread.is_alive()
