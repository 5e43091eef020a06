"""Whether a simulator of some name runs on this host: a lock that ends with its process.

A simulator holds the lock of its ROS domain and namespace while it lives, and the kernel lets go
of it however the process ends. So a second simulator of the same name is refused at once, and a
client learns of a simulator's death without waiting for the network. Knows nothing of ROS.

The locks lie in a folder that nobody else can write to: ``$XDG_RUNTIME_DIR/sailenv_ros``, else
``/run/user/<uid>/sailenv_ros``, else ``sailenv_ros_<uid>`` in the folder of temporary files. Links
are not followed, and a folder of another owner is refused.
"""

from __future__ import annotations

import fcntl
import os
import re
import stat
import struct
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

from sailenv_ros.errors import InvalidRequest, NameTaken

__all__ = [
    "ClockLock",
    "SimulatorLock",
    "checked_namespace",
    "clock_publisher",
    "open_private_folder",
    "present_simulator",
    "private_folder",
    "simulator_is_present",
]

_NAMESPACE_PART = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")

_FLOCK = "hhqqi4x"
"""`struct flock` of 64-bit Linux: type, whence, start, length, process."""


_Lock = TypeVar("_Lock", bound="_ProcessLock")


class _ProcessLock:
    """A lock of this user on this host that ends with its process; a context manager."""

    def __init__(self, file: str, kind: str, name: str) -> None:
        self._fd: int | None = _opened(file, os.O_CREAT)
        try:
            fcntl.fcntl(self._fd, fcntl.F_OFD_SETLK, _whole_file(fcntl.F_WRLCK))
        except OSError:
            self.release()
            raise NameTaken(kind, name) from None
        os.truncate(self._fd, 0)
        os.pwrite(self._fd, str(os.getpid()).encode(), 0)

    def release(self) -> None:
        """Let go of it; a second call does nothing."""
        if self._fd is not None:
            os.close(self._fd)
            self._fd = None

    def __enter__(self: _Lock) -> _Lock:
        return self

    def __exit__(self, *exc: object) -> None:
        self.release()


class SimulatorLock(_ProcessLock):
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
    InvalidRequest
        If the folder of locks is not this user's alone, or the lock is not a plain file.
    """

    def __init__(self, domain_id: int, namespace: str) -> None:
        kind = f"simulator (ROS domain {domain_id})"
        super().__init__(_file_of_simulator(domain_id, namespace), kind, namespace)


class ClockLock(_ProcessLock):
    """The right to publish ``/clock`` in a ROS domain, of all simulators on this host.

    Parameters
    ----------
    domain_id : int

    Raises
    ------
    NameTaken
        If another process has it.
    InvalidRequest
        As `SimulatorLock`.
    """

    def __init__(self, domain_id: int) -> None:
        super().__init__(_file_of_clock(domain_id), f"clock (ROS domain {domain_id})", "/clock")


def clock_publisher(domain_id: int) -> int | None:
    """Return the process id of the simulator that publishes ``/clock``; None if none does."""
    return _holder(_file_of_clock(domain_id))


def checked_namespace(namespace: object) -> str:
    """Return a ROS namespace in full, with a slash before it and none behind it.

    Raises
    ------
    InvalidRequest
        If ROS would not accept it.
    """
    parts = namespace.strip("/").split("/") if isinstance(namespace, str) else ["not a text"]
    whole = "/" + "/".join(parts)
    if whole != "/" and (len(whole) > 200 or not all(map(_NAMESPACE_PART.fullmatch, parts))):
        accepted = (
            "names divided by '/', each a letter or '_', then letters, digits or '_', e.g. /sailenv"
        )
        raise InvalidRequest("namespace", namespace, accepted)
    return whole


def simulator_is_present(domain_id: int, namespace: str) -> bool:
    """Say whether a simulator of that name runs on this host as this user."""
    return present_simulator(domain_id, namespace) is not None


def present_simulator(domain_id: int, namespace: str) -> int | None:
    """Return the process id of the simulator of that name on this host; None if there is none.

    0 is returned for one that has only just begun.

    Raises
    ------
    InvalidRequest
        If the folder of locks is not this user's alone, or the lock is not a plain file.
    """
    return _holder(_file_of_simulator(domain_id, namespace))


def _holder(file: str) -> int | None:
    """Return the process id that holds a lock; None if nobody does."""
    try:
        fd = _opened(file, 0)
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


def _file_of_simulator(domain_id: int, namespace: str) -> str:
    name = re.sub(r"[^A-Za-z0-9_]+", "-", namespace.strip("/")) or "root"
    return f"domain_{domain_id}_{name}.lock"


def _file_of_clock(domain_id: int) -> str:
    return f"clock_of_domain_{domain_id}.lock"


def _whole_file(kind: int) -> bytes:
    return struct.pack(_FLOCK, kind, os.SEEK_SET, 0, 0, 0)


def _opened(file: str, flags: int) -> int:
    """Open the file of a lock, through a folder that was looked at and cannot be exchanged."""
    path = private_folder()
    with _checked_folder(path) as folder:
        try:
            # O_NONBLOCK: a named pipe in its place must not hold anybody up.
            kind = os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC | os.O_NONBLOCK
            return os.open(file, kind | flags, 0o600, dir_fd=folder)
        except FileNotFoundError:
            raise
        except OSError as problem:
            accepted = f"a plain file that this user can write ({problem.strerror}); remove it"
            raise InvalidRequest("simulator's lock", str(path / file), accepted) from None


@contextmanager
def open_private_folder() -> Iterator[Path]:
    """Make and check the folder of `private_folder`; it stays the same one within the block.

    Raises
    ------
    InvalidRequest
        If it is not this user's alone.
    """
    with _checked_folder(private_folder()):
        yield private_folder()


@contextmanager
def _checked_folder(path: Path) -> Iterator[int]:
    """Open the folder, which must be this user's and let nobody else in; closed afterwards."""
    try:
        path.mkdir(mode=0o700, exist_ok=True)
        folder = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC)
    except OSError as problem:
        raise _refused(path, problem.strerror or "it cannot be opened") from None
    try:
        found = os.fstat(folder)
        mode = stat.S_IMODE(found.st_mode)
        if found.st_uid != os.getuid():
            raise _refused(path, f"it belongs to user {found.st_uid}")
        if mode & 0o077:
            raise _refused(path, f"its mode is {mode:o}")
        yield folder
    finally:
        os.close(folder)


def _refused(folder: Path, why: str) -> InvalidRequest:
    accepted = (
        f"a folder of user {os.getuid()} alone, mode 700 ({why}); remove it, or set "
        "XDG_RUNTIME_DIR to such a folder"
    )
    return InvalidRequest("folder of simulators' locks", str(folder), accepted)


def private_folder() -> Path:
    """Return the folder of locks and other files of processes that run, which may not exist."""
    runtime = os.environ.get("XDG_RUNTIME_DIR", "")
    # A shell without the variable (cron, `docker exec`) must find the same locks.
    for base in (runtime, f"/run/user/{os.getuid()}"):
        if base.startswith("/") and _is_private(base):
            return Path(base) / "sailenv_ros"
    return Path(tempfile.gettempdir()) / f"sailenv_ros_{os.getuid()}"


def _is_private(folder: str) -> bool:
    try:
        found = os.stat(folder)
    except OSError:
        return False
    mine = found.st_uid == os.getuid() and not stat.S_IMODE(found.st_mode) & 0o022
    return stat.S_ISDIR(found.st_mode) and mine and os.access(folder, os.W_OK)
