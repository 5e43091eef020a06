"""One rclpy executor spinning in a thread, which no fault of a single callback ends."""

from __future__ import annotations

import logging
import threading

from rclpy.executors import ExternalShutdownException, ShutdownException, SingleThreadedExecutor

__all__ = ["ExecutorThread"]

_log = logging.getLogger(__name__)


class ExecutorThread:
    """Spins until `stop` is called.

    Parameters
    ----------
    executor : SingleThreadedExecutor
        The measured best: others lose messages or burn a core under rclpy.
    """

    def __init__(self, executor: SingleThreadedExecutor) -> None:
        self._executor = executor
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._spin, name="executor", daemon=True)

    def start(self) -> None:
        """Begin to execute callbacks."""
        self._thread.start()

    def stop(self, timeout_s: float) -> bool:
        """End after the present callback; False if it did not end in time."""
        self._stopping.set()
        if self._thread.is_alive():
            # A mere wake would not do: a turn ends when there was something to execute.
            self._executor.create_task(lambda: None)
            self._thread.join(timeout_s)
        return not self._thread.is_alive()

    def _spin(self) -> None:
        while not self._stopping.is_set():
            try:
                self._executor.spin_once()
            except (ExternalShutdownException, ShutdownException):
                return
            except Exception:
                # A request that cannot be decoded, or an answer to a service that is gone.
                _log.exception("a callback failed; the node goes on")
