"""How a node process ends: signals, a parent that has died, and a clean-up with a deadline.

Knows no ROS and no simulation; the node waits on a `StopRequest` and ends in its main thread.
"""

from __future__ import annotations

import logging
import os
import signal
import threading
from collections.abc import Callable

__all__ = ["StopRequest", "finished_within", "stop_at_end_of"]

_log = logging.getLogger(__name__)


class StopRequest:
    """Becomes set once the process shall end, by a signal or by whoever calls `set`.

    The handlers stay installed, so a second signal during the clean-up does nothing.
    """

    def __init__(self) -> None:
        self._event = threading.Event()

    def install(self) -> None:
        """Take SIGINT and SIGTERM; to be called in the main thread, before anything is slow."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._on_signal)

    def disarm(self) -> None:
        """Ignore the signals from now on, also while Python itself ends; for the main thread."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)

    def set(self) -> None:
        """Ask for the end."""
        self._event.set()

    @property
    def is_set(self) -> bool:
        """True once the end was asked for."""
        return self._event.is_set()

    def wait(self, timeout_s: float | None = None) -> bool:
        """Wait for the request; True if it has come. Signals are handled meanwhile."""
        return self._event.wait(timeout_s)

    def _on_signal(self, number: int, frame: object) -> None:
        self._event.set()


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
    """Do something in a thread of its own; False if it was not done in time and goes on."""

    def run() -> None:
        try:
            work()
        except Exception:
            _log.exception("the clean-up met a fault")

    thread = threading.Thread(target=run, name="clean-up", daemon=True)
    thread.start()
    thread.join(timeout_s)
    return not thread.is_alive()
