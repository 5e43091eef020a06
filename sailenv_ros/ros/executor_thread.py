"""One rclpy executor spinning in a thread, which no fault of a single callback ends."""

from __future__ import annotations

import logging
import threading

from rclpy.exceptions import InvalidHandle
from rclpy.executors import ExternalShutdownException, ShutdownException, SingleThreadedExecutor

__all__ = ["ExecutorThread"]

_log = logging.getLogger(__name__)


class ExecutorThread:
    """Spins until `stop` is called or the executor's context is shut down.

    Parameters
    ----------
    executor : SingleThreadedExecutor
        The measured best: others lose messages or burn a core under rclpy.
    name : str
        Of the thread.
    """

    def __init__(self, executor: SingleThreadedExecutor, name: str = "executor") -> None:
        self._executor = executor
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._spin, name=name, daemon=True)

    def start(self) -> None:
        """Begin to execute callbacks."""
        self._thread.start()

    def stop(self, timeout_s: float) -> bool:
        """End after the present callback; False if it did not end in time."""
        self._stopping.set()
        if self._thread is threading.current_thread():
            return True  # a callback's own request: the thread ends when it returns
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
            except InvalidHandle:
                # Another thread destroyed an entity while this one got ready to wait for it;
                # rclpy catches that for all but a subscription's events.
                continue
            except Exception:
                # A message that cannot be read, or an answer to a service that is gone, must not
                # end the thread that takes all others.
                if not self._stopping.is_set():
                    _log.exception("a callback failed; all others go on")
