"""Functions that are told of something, from the thread where it happens."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

__all__ = ["Listeners"]

T = TypeVar("T")


class Listeners(Generic[T]):
    """Quick functions of one argument, in the order they came; call this to tell them all."""

    def __init__(self) -> None:
        self._all: list[Callable[[T], None]] = []

    def add(self, listener: Callable[[T], None]) -> Callable[[], None]:
        """Have a function told from now on; gives the one that ends it."""
        self._all.append(listener)
        return lambda: self._discard(listener)

    def __call__(self, value: T) -> None:
        """Tell each of them."""
        for listener in tuple(self._all):
            listener(value)

    def _discard(self, listener: Callable[[T], None]) -> None:
        if listener in self._all:
            self._all.remove(listener)
