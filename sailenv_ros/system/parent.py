"""Ends child processes: together with their parent, however that ends, or at once. Linux alone."""

from __future__ import annotations

import ctypes
import os
import signal
from collections.abc import Sequence
from multiprocessing.process import BaseProcess

__all__ = ["end_at_once", "end_with_parent"]

_PR_SET_PDEATHSIG = 1
GRACE_S = 5.0

_libc = ctypes.CDLL(None, use_errno=True)


def end_with_parent(parent: int) -> None:
    """Have the kernel kill this process when the thread that started it ends.

    Parameters
    ----------
    parent : int
        Process id of the parent: if it has ended already, this process ends at once.
    """
    if _libc.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0):
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    if os.getppid() != parent:
        os._exit(1)


def end_at_once(processes: Sequence[BaseProcess]) -> None:
    """End child processes that may still run, by SIGKILL if they take longer than `GRACE_S`."""
    for process in processes:
        process.terminate()
    for process in processes:
        process.join(GRACE_S)
        if process.exitcode is None:
            process.kill()
            process.join()
