"""Whether a simulator of some name runs on this host: a lock that ends with its process.

A simulator holds the lock of its ROS domain and namespace while it lives, and the kernel lets go
of it however the process ends. So a second simulator of the same name is refused at once, and a
client learns of a simulator's death without waiting for the network. Knows nothing of ROS.
"""

from __future__ import annotations

import fcntl
import os
import re
import struct
import tempfile
from pathlib import Path

from sailenv_ros.errors import NameTaken

__all__ = ["SimulatorLock", "present_simulator", "simulator_is_present"]

_FLOCK = "hhqqi4x"
"""`struct flock` of 64-bit Linux: type, whence, start, length, process."""


class SimulatorLock:
    """The right to be the simulator of that name on this host; a context manager.

    Parameters
    ----------
    domain_id : int
        ROS domain.
    namespace : str
        Full namespace, e.g. ``"/sailenv"``.

    Raises
    ------
    NameTaken
        If another process has it.
    """

    def __init__(self, domain_id: int, namespace: str) -> None:
        self._fd: int | None = os.open(_path(domain_id, namespace), os.O_RDWR | os.O_CREAT, 0o600)
        try:
            fcntl.fcntl(self._fd, fcntl.F_OFD_SETLK, _whole_file(fcntl.F_WRLCK))
        except OSError:
            self.release()
            raise NameTaken(f"simulator (ROS domain {domain_id})", namespace) from None
        os.truncate(self._fd, 0)
        os.pwrite(self._fd, str(os.getpid()).encode(), 0)

    def release(self) -> None:
        """Let go of it; a second call does nothing."""
        if self._fd is not None:
            os.close(self._fd)
            self._fd = None

    def __enter__(self) -> SimulatorLock:
        return self

    def __exit__(self, *exc: object) -> None:
        self.release()


def simulator_is_present(domain_id: int, namespace: str) -> bool:
    """Say whether a simulator of that name runs on this host as this user."""
    return present_simulator(domain_id, namespace) is not None


def present_simulator(domain_id: int, namespace: str) -> int | None:
    """Give the process id of the simulator of that name on this host; None if there is none.

    0 is given for one that has only just begun.
    """
    try:
        fd = os.open(_path(domain_id, namespace), os.O_RDWR)
    except FileNotFoundError:
        return None
    try:
        # Asks who would be in the way, so that looking gets in nobody's way.
        answer = fcntl.fcntl(fd, fcntl.F_OFD_GETLK, _whole_file(fcntl.F_WRLCK))
        if struct.unpack(_FLOCK, answer)[0] == fcntl.F_UNLCK:
            return None
        return int(os.pread(fd, 32, 0) or b"0")
    finally:
        os.close(fd)


def _whole_file(kind: int) -> bytes:
    return struct.pack(_FLOCK, kind, os.SEEK_SET, 0, 0, 0)


def _path(domain_id: int, namespace: str) -> Path:
    folder = Path(tempfile.gettempdir()) / f"sailenv_ros_{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    name = re.sub(r"[^A-Za-z0-9_]+", "-", namespace.strip("/")) or "root"
    return folder / f"domain_{domain_id}_{name}.lock"
