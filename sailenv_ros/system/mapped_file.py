"""Files as arrays whose memory can be given back: pages are read again where they are used again.

Python's `mmap` keeps a descriptor open for each file, and a node has hundreds of files.
"""

from __future__ import annotations

import ctypes
import os
import weakref
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["give_back_pages", "mapped_file"]

_PROT_READ, _MAP_PRIVATE, _MADV_DONTNEED = 1, 2, 4
_FAILED = ctypes.c_void_p(-1).value

_libc = ctypes.CDLL(None, use_errno=True)
_libc.mmap.restype = ctypes.c_void_p
_libc.mmap.argtypes = (
    *(ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int),
    *(ctypes.c_int, ctypes.c_int, ctypes.c_long),
)
_libc.munmap.argtypes = ctypes.c_void_p, ctypes.c_size_t
_libc.madvise.argtypes = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int

_mapped: weakref.WeakValueDictionary[int, Any] = weakref.WeakValueDictionary()
"""Memory of all files that some array has, by its address."""


def mapped_file(path: Path) -> NDArray[np.uint8]:
    """Return the bytes of a file, read-only.

    The file must not be written to any more; it may be removed, and another may take its name.

    Raises
    ------
    OSError
        If it cannot be opened or mapped.
    """
    with path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size
        if not size:
            return np.zeros(0, np.uint8)
        address = _libc.mmap(None, size, _PROT_READ, _MAP_PRIVATE, file.fileno(), 0)
    if address == _FAILED:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number), str(path))
    memory = (ctypes.c_uint8 * size).from_address(address)
    weakref.finalize(memory, _libc.munmap, address, size)
    _mapped[address] = memory
    # Arrays made of it keep it.
    array: NDArray[np.uint8] = np.frombuffer(memoryview(memory), np.uint8)
    array.flags.writeable = False
    return array


def give_back_pages() -> None:
    """Give the memory of all mapped files back to the system."""
    for address, memory in list(_mapped.items()):
        _libc.madvise(address, ctypes.sizeof(memory), _MADV_DONTNEED)
