"""The C library's allocator: what is in use."""

from __future__ import annotations

import ctypes


class Allocations(ctypes.Structure):
    """glibc's `mallinfo2`: of the main thread's heap, and of blocks outside of it [B]."""

    _fields_ = [
        (name, ctypes.c_size_t)
        for name in (
            *("arena", "ordblks", "smblks", "hblks", "hblkhd"),
            *("usmblks", "fsmblks", "uordblks", "fordblks", "keepcost"),
        )
    ]
    hblks: int
    hblkhd: int
    uordblks: int


def allocations() -> Allocations:
    """Return the present state: `uordblks` bytes in use, `hblkhd` in `hblks` own blocks."""
    libc = ctypes.CDLL(None)
    libc.mallinfo2.restype = Allocations
    found: Allocations = libc.mallinfo2()
    return found
