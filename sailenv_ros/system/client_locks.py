"""Whether a client of a simulator still lives, and names for agents: locks that end with a process.

A client holds the lock of its name while it lives, so a simulator of the same user on the same host
learns of its end at once, whatever it ended by, and one that was only stopped (a debugger, Ctrl-Z)
is not taken for dead.

A simulator remembers the topics of every agent's name that it ever had (Fast DDS), so names of
agents come again. Knows nothing of ROS.
"""

from __future__ import annotations

import contextlib
import os
import socket
import time
import uuid
import weakref
from hashlib import blake2b
from pathlib import Path

from sailenv_ros.errors import InvalidRequest, NameTaken
from sailenv_ros.system.process_locks import ProcessLock, holder_of, private_folder

__all__ = ["AgentName", "ClientLock", "client_lives", "unique_agent_name"]

KEPT_S = 60.0
"""Age up to which the lock file of a killed client is kept, so that simulators notice its end
[s]."""


_NAMES = ".agent"

MOST_NAMES = 64
"""Names of agents that come again; four times as many as a simulator has agents."""


class _OwnLock(ProcessLock):
    """A lock that no fork of its process holds."""

    def __init__(self, file: str, kind: str, name: str) -> None:
        super().__init__(file, kind, name)
        _held.add(self)

    def leave_to_parent(self) -> None:
        """Have it end with the parent of this process, which was forked."""
        ProcessLock.release(self)


class ClientLock(_OwnLock):
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

    def release(self) -> None:
        """Let go of it, and leave nothing; a second call does nothing."""
        if self._fd is not None:
            with contextlib.suppress(OSError):
                (private_folder() / self._file).unlink()
        super().release()


class AgentName:
    """A name for an agent: no other client that lives has it.

    It is the one of a few of this user on this host that was let go of longest ago, or, where all
    are in use, one that never comes again.

    Attributes
    ----------
    text : str
    """

    def __init__(self) -> None:
        self._lock: _NameLock | None = None
        with contextlib.suppress(InvalidRequest):  # no folder for locks
            for number in sorted(range(MOST_NAMES), key=_let_go_ns):
                with contextlib.suppress(NameTaken):
                    self._lock = _NameLock(number)
                    self.text = f"agent_{_here()}_{number}"
                    return
        self.text = unique_agent_name()

    def release(self) -> None:
        """Let another have it; a second call does nothing."""
        if self._lock is not None:
            self._lock.release()


class _NameLock(_OwnLock):
    def __init__(self, number: int) -> None:
        super().__init__(f"{number}{_NAMES}", "name", str(number))

    def release(self) -> None:
        if self._fd is not None:
            now = time.time_ns()  # finer than the kernel's own stamps: names have an order
            os.utime(self._fd, ns=(now, now))
        super().release()


def unique_agent_name() -> str:
    """Return a name for an agent that nobody had."""
    return f"agent_{uuid.uuid4().hex[:10]}"


def _let_go_ns(number: int) -> int:
    """Return when a name was let go of, or taken by a process that was killed."""
    try:
        return (private_folder() / f"{number}{_NAMES}").stat().st_mtime_ns
    except OSError:
        return 0


def _here() -> str:
    """Return what tells this folder of locks from those of other hosts, containers and users."""
    folder = private_folder().stat()
    boot = Path("/proc/sys/kernel/random/boot_id").read_text()
    told = f"{socket.gethostname()} {boot} {folder.st_dev} {folder.st_ino} {os.getuid()}"
    return blake2b(told.encode(), digest_size=3).hexdigest()


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


_held: weakref.WeakSet[_OwnLock] = weakref.WeakSet()


def _leave_to_parents() -> None:
    # A fork would keep the lock beyond its parent's end.
    for lock in tuple(_held):
        lock.leave_to_parent()


os.register_at_fork(after_in_child=_leave_to_parents)
