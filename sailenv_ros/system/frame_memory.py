"""Memory that two processes of one machine share for frames: segments that are used again.

The reader of frames owns the segments and has the writer fill them. A segment is free again once
no array on it is held any more, so that a held frame is never overwritten. Knows nothing of frames.
"""

from __future__ import annotations

import fcntl
import math
import mmap
import os
import threading
import weakref
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest

__all__ = ["ALIGNMENT", "SEGMENTS", "Segment", "SegmentPool", "map_segment", "padded", "view_of"]

SEGMENTS = 8
"""Segments of one reader that are held and used at once; a reader of more frames copies them."""

ALIGNMENT = 64
"""Every array begins at a multiple of this [B], a cache line."""

LARGEST_BYTES = 2**31
"""The most that a segment may have [B]."""

_SEALS = fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_SEAL
"""The size stays as it is: to read or write beyond a file's end would end the process."""


def padded(size: int) -> int:
    """Return a size rounded up to whole cache lines [B]."""
    return -(-size // ALIGNMENT) * ALIGNMENT


def map_segment(fd: int) -> mmap.mmap:
    """Map a segment that another process made.

    Raises
    ------
    InvalidRequest
        If its size could change, or is not acceptable.
    """
    try:
        sealed = fcntl.fcntl(fd, fcntl.F_GET_SEALS) & _SEALS == _SEALS
    except OSError:
        sealed = False
    size = os.fstat(fd).st_size
    if not sealed or not 0 < size <= LARGEST_BYTES:
        accepted = f"a sealed memory file of 1 to {LARGEST_BYTES} bytes"
        raise InvalidRequest("segment", f"{size} bytes, {sealed=}", accepted)
    return mmap.mmap(fd, size)


class Segment:
    """One piece of shared memory; its pages exist once they were written to.

    Parameters
    ----------
    number : int
        By which both sides know it.
    size : int
        [B]

    Attributes
    ----------
    fd : int
        To be handed to the writer, then closed by `forget_fd`; -1 afterwards.
    """

    def __init__(self, number: int, size: int) -> None:
        self.number = number
        self.size = size
        self.fd = os.memfd_create("sailenv_frame", os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
        try:
            os.ftruncate(self.fd, size)
            fcntl.fcntl(self.fd, fcntl.F_ADD_SEALS, _SEALS)
            self._memory = mmap.mmap(self.fd, size)
        except BaseException:
            self.forget_fd()
            raise

    def array(self) -> NDArray[np.uint8]:
        """Return a new array of all its bytes; every array made of it holds on to it."""
        return np.frombuffer(self._memory, np.uint8)

    def forget_fd(self) -> None:
        """Close the descriptor; the memory stays as long as it is mapped or an array is held."""
        if self.fd >= 0:
            os.close(self.fd)
            self.fd = -1


class SegmentPool:
    """The segments of one reader, each with at most one frame on it; safe to use in threads.

    A process that is forked has the same memory: what is held at that moment is not used again.
    """

    def __init__(self) -> None:
        self._lock = threading.RLock()  # a frame may be freed wherever Python frees things
        self._free: list[Segment] = []
        self._lent: dict[int, Segment] = {}
        _pools.add(self)

    def take(self, size: int) -> Segment | None:
        """Return a free segment of at least that size [B]; None if too many are held.

        The caller gives it back by `give_back`, or lends it out by `lend`.
        """
        with self._lock:
            fitting = [segment for segment in self._free if segment.size >= size]
            if fitting:
                # The one that was used last lies in the processor's caches, if any does.
                self._free.remove(fitting[-1])
                return self._noted(fitting[-1])
            self._drop_free()
            numbers = set(range(SEGMENTS)) - self._lent.keys()
            return self._noted(Segment(min(numbers), size)) if numbers else None

    def give_back(self, segment: Segment) -> None:
        """Take note that nothing of a segment is used any more."""
        with self._lock:
            if self._lent.get(segment.number) is segment:
                del self._lent[segment.number]
                self._free.append(segment)

    def lend(self, segment: Segment) -> NDArray[np.uint8]:
        """Return the bytes of a segment, which comes back when no array on them is held."""
        whole = segment.array()
        weakref.finalize(whole, self.give_back, segment).atexit = False
        return whole

    @property
    def is_short(self) -> bool:
        """True if nearly all segments are held: frames had better be copied."""
        return len(self._lent) >= SEGMENTS - 1

    def retire(self) -> None:
        """Use nothing again that is held now."""
        with self._lock:
            self._lent.clear()

    def close(self) -> None:
        """Let go of what is free; what is held stays as long as it is held."""
        with self._lock:
            self._drop_free()
            self._lent.clear()

    def _noted(self, segment: Segment) -> Segment:
        self._lent[segment.number] = segment
        return segment

    def _drop_free(self) -> None:
        for segment in self._free:
            segment.forget_fd()
        self._free.clear()


_pools: weakref.WeakSet[SegmentPool] = weakref.WeakSet()


def _retire_all() -> None:
    for pool in list(_pools):
        pool.retire()


os.register_at_fork(before=_retire_all)


def view_of(whole: Any, offset: int, dtype: Any, shape: tuple[int, ...]) -> NDArray[Any]:
    """Return an array of a type and shape within a segment's bytes.

    Raises
    ------
    InvalidRequest
        If it does not lie within them.
    """
    size = math.prod(shape) * np.dtype(dtype).itemsize
    if offset < 0 or offset % ALIGNMENT or offset + size > len(whole):
        raise InvalidRequest("place in a segment", (offset, size), f"within {len(whole)} bytes")
    return np.asarray(whole[offset : offset + size].view(dtype).reshape(shape))
