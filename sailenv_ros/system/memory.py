"""Memory of this process: how much there may be, and a setting of the C library's allocator.

Frames are some megabytes, made and freed many times a second. By default the memory goes back to
the system each time, and each page of the next frame is faulted in again. Knows nothing of frames.
"""

from __future__ import annotations

import contextlib
import ctypes
import resource
from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, TypeVar

from sailenv_ros.errors import InvalidState

if TYPE_CHECKING:
    from functools import _lru_cache_wrapper

__all__ = [
    "cached_for_scenes",
    "forget_scenes",
    "give_back_freed_memory",
    "keep_freed_memory",
    "no_memory",
    "require_address_space",
    "share_freed_memory",
]

Result = TypeVar("Result")

_M_TRIM_THRESHOLD = -1
_M_MMAP_THRESHOLD = -3
_M_ARENA_MAX = -8

LARGEST_KEPT_BYTES = 32 * 2**20
"""The largest block that is kept [B]: the most that glibc takes from its heap at all."""

LARGEST_KEPT_OF_SCENES_BYTES = 2**20
"""The largest where scenes come and go [B]: most textures are larger."""

KEPT_BYTES = 256 * 2**20
"""Free memory at the heap's end that is kept."""


_decided = False
"""Whether `keep_freed_memory` was called."""

_of_scenes: list[Callable[[], None]] = []
"""Empty the caches of `cached_for_scenes`."""


def keep_freed_memory(*, many_scenes: bool = False) -> bool:
    """Have this process keep what it frees; False where the C library is not glibc.

    Measured in sim_node at 640x480, five views: 3500 page faults per frame without, 1 with it.

    Parameters
    ----------
    many_scenes : bool
        Large blocks go back to the system, so that models and textures of scenes that come and go
        leave no holes among what stays: after 40 rooms of 340 MiB with it, 436 MiB without. A
        frame of 640x480 takes as long, one of 1920x1080 2 % longer.
    """
    global _decided
    _decided = True
    largest_bytes = LARGEST_KEPT_OF_SCENES_BYTES if many_scenes else LARGEST_KEPT_BYTES
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError):
        return False
    kept = mallopt(_M_MMAP_THRESHOLD, largest_bytes)
    return bool(kept and mallopt(_M_TRIM_THRESHOLD, KEPT_BYTES))


def share_freed_memory() -> bool:
    """Have all threads of this process use one heap; False where the C library is not glibc.

    By default there are up to eight heaps a core, and each keeps what the largest work of any
    thread that it ever served took. To be called before there are threads. Measured in sim_node
    while scenes change and agents come and go: 195 to 205 MiB with it, 236 to 275 without.
    """
    try:
        return bool(ctypes.CDLL(None).mallopt(_M_ARENA_MAX, 1))
    except (OSError, AttributeError):
        return False


def give_back_freed_memory() -> None:
    """Give back mapped files and, where the C library is glibc, what this process keeps free.

    In sim_node's way of keeping memory, twelve changes among the three rooms: 0.9 to 2.0 GiB with
    it, 2.0 to 2.2 GiB without; it takes 55 ms at most. A process that has not said how it keeps
    memory has many scenes from here on: before, while the first one is made, that costs time.
    """
    from sailenv_ros.system.mapped_file import give_back_pages  # needs NumPy, and commands do not

    give_back_pages()
    if not _decided:
        keep_freed_memory(many_scenes=True)
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).malloc_trim(0)


def cached_for_scenes(
    most: int,
) -> Callable[[Callable[..., Result]], _lru_cache_wrapper[Result]]:
    """Return a decorator: `lru_cache` with at most so many results, which `forget_scenes` drops.

    For large results that depend on a scene, as on its cameras or the shape of its room: in a
    stream of scenes each has others.
    """

    def decorated(function: Callable[..., Result]) -> _lru_cache_wrapper[Result]:
        cached = lru_cache(maxsize=most)(function)
        _of_scenes.append(cached.cache_clear)
        return cached

    return decorated


def forget_scenes() -> None:
    """Drop all that functions of `cached_for_scenes` keep."""
    for clear in _of_scenes:
        clear()


def require_address_space(least_bytes: int) -> None:
    """Make sure that a process may become as large as it will.

    Native libraries that find no room as they are loaded end the process with "Segmentation
    fault", and nobody could say why.

    Parameters
    ----------
    least_bytes : int
        Addresses that it needs, of which only a part is ever memory [B].

    Raises
    ------
    InvalidState
        If the limit, `ulimit -v`, is lower.
    """
    limit = _address_limit()
    if limit is not None and limit < least_bytes:
        raise InvalidState(
            f"this process may have {limit >> 20} MiB of addresses (ulimit -v), and a node needs "
            f"{least_bytes >> 20} MiB to start"
        )


def no_memory() -> str:
    """Return the sentence for a `MemoryError`."""
    limit = _address_limit()
    if limit is None:
        return "there is not enough memory for this"
    return f"there is not enough memory for this: {limit >> 20} MiB are allowed (ulimit -v)"


def _address_limit() -> int | None:
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    return None if limit == resource.RLIM_INFINITY else limit
