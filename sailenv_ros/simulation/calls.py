"""A request by its name as a call that waits, with a deadline. Knows no thread and no queue."""

from __future__ import annotations

from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeout
from typing import Any, TypeVar

from sailenv_ros.errors import DeadlineExceeded

__all__ = ["Calls", "wait_for"]

T = TypeVar("T")


class Calls:
    """What the blocking methods have in common; `Simulation` adds the queue."""

    def request(self, name: str, /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Queue a request by its name; the future gives its result or raises its error."""
        raise NotImplementedError

    def _ask(self, name: str, timeout_s: float, /, *args: Any, **kwargs: Any) -> Any:
        """Queue a request and wait; its result has the type of the core's method."""
        return wait_for(self.request(name, *args, **kwargs), f"the request {name!r}", timeout_s)


def wait_for(future: Future[T], what: str, timeout_s: float) -> T:
    """Wait for a future; the deadline's error names what it was waited for."""
    try:
        return future.result(timeout_s)
    except FutureTimeout:
        if future.done():
            raise
        future.cancel()
        raise DeadlineExceeded(what, timeout_s) from None
