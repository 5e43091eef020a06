"""Waiting for a future, with a deadline that names what it waited for."""

from __future__ import annotations

from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeout
from typing import TypeVar

from sailenv_ros.errors import DeadlineExceeded

__all__ = ["wait_for"]

T = TypeVar("T")


def wait_for(future: Future[T], what: str, timeout_s: float) -> T:
    """Wait for a future; the deadline's error names what it was waited for."""
    try:
        return future.result(timeout_s)
    except FutureTimeout:
        if future.done():
            raise
        future.cancel()
        raise DeadlineExceeded(what, timeout_s) from None
