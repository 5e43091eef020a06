"""Assets and skies, made when they are asked for: kept while in use, and some beside."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar
from weakref import WeakValueDictionary

__all__ = ["KeptAssets"]

MAX_KEPT = 64
"""Most assets that are kept though nothing uses them: of two furnished rooms or more. The one that
was not asked for for longest is dropped first."""

K = TypeVar("K", bound=Hashable)
T = TypeVar("T")


class KeptAssets(Generic[K, T]):
    """Assets by what they are made of; may be used from several threads.

    Parameters
    ----------
    most : int
        How many are kept though nothing uses them.
    """

    def __init__(self, most: int = MAX_KEPT) -> None:
        self._in_use: WeakValueDictionary[K, T] = WeakValueDictionary()
        self._last: OrderedDict[K, T] = OrderedDict()
        self._lock = threading.Lock()
        self._most = most

    def get(self, key: K, make: Callable[[], T]) -> T:
        """Return an asset; the same object while it is kept. Errors of `make` go through."""
        with self._lock:
            found = self._in_use.get(key)
            if found is None:
                found = self._in_use[key] = make()
            self._last[key] = found
            self._last.move_to_end(key)
            while len(self._last) > self._most:
                self._last.popitem(last=False)
            return found
