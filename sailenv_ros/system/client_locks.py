"""Whether a client of a simulator still lives: a lock that ends with its process.

A client holds the lock of its name while it lives, so a simulator of the same user on the same host
learns of its end at once, whatever it ended by, and one that was only stopped (a debugger, Ctrl-Z)
is not taken for dead. Knows nothing of ROS.
"""

from __future__ import annotations

import contextlib
import os
import time
import weakref

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.system.process_locks import ProcessLock, holder_of, private_folder

__all__ = ["ClientLock", "client_lives"]

KEPT_S = 60.0
"""Age up to which the lock file of a killed client is kept, so that simulators notice its end
[s]."""


class ClientLock(ProcessLock):
    """The sign that a client lives; a context manager.

    Parameters
    ----------
    name : str
        As no other client of this user on this host is named.

    Raises
    ------
    InvalidRequest
        If the folder of locks is not this user's alone, or the lock is not a plain file.
    """

    def __init__(self, name: str) -> None:
        _remove_abandoned()
        self._file = _file_of(name)
        super().__init__(self._file, "client", name)
        _held.add(self)

    def release(self) -> None:
        """Let go of it, and leave nothing; a second call does nothing."""
        if self._fd is not None:
            with contextlib.suppress(OSError):
                (private_folder() / self._file).unlink()
        super().release()

    def leave_to_parent(self) -> None:
        """Have it end with the parent of this process, which was forked."""
        super().release()


def client_lives(name: str) -> bool | None:
    """Return whether the client of that name lives.

    Returns
    -------
    lives : bool or None
        None if this host does not know: it is another's or another user's, or has ended in order.
    """
    try:
        if holder_of(_file_of(name)) is not None:
            return True
        return False if (private_folder() / _file_of(name)).exists() else None
    except InvalidRequest:
        return None


def _file_of(name: str) -> str:
    return f"{name}.client"


def _remove_abandoned() -> None:
    """Remove what killed clients left."""
    folder = private_folder()
    for path in folder.glob("*.client"):
        with contextlib.suppress(OSError, InvalidRequest):  # another removes it just now
            old = time.time() - path.stat().st_mtime > KEPT_S
            if old and holder_of(path.name) is None:
                path.unlink()


_held: weakref.WeakSet[ClientLock] = weakref.WeakSet()


def _leave_to_parents() -> None:
    # A fork would keep the lock beyond its parent's end.
    for lock in tuple(_held):
        lock.leave_to_parent()


os.register_at_fork(after_in_child=_leave_to_parents)
