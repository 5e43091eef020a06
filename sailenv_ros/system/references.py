"""References to objects that a library in C takes and forgets to give back."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

__all__ = ["references_given_back"]


@contextmanager
def references_given_back(lists: Sequence[list[Any]]) -> Iterator[None]:
    """Drop the references to lists, and to lists in them, that are taken within this.

    Nothing may still use them afterwards, nor another thread have them. After an error nothing is
    dropped, for its traceback has some.
    """
    held = [one for values in lists for one in (values, *values) if isinstance(one, list)]
    before = [sys.getrefcount(held[place]) for place in range(len(held))]
    yield
    for place, count in enumerate(before):
        for _ in range(sys.getrefcount(held[place]) - count):
            ctypes.pythonapi.Py_DecRef(ctypes.py_object(held[place]))
