"""Locks that end with their process, however it ends: the kernel lets go of them.

They lie in a folder that nobody else can write to: ``$XDG_RUNTIME_DIR/sailenv_ros``, else
``/run/user/<uid>/sailenv_ros``, else ``sailenv_ros_<uid>`` in the folder of temporary files. Links
are not followed, and a folder of another owner is refused. Knows nothing of what is locked.

The package `filelock` does not serve here: it cannot tell who holds a lock without taking it
(`F_OFD_GETLK` can), nor open the lock's file within a folder that was checked.
"""

from __future__ import annotations

import fcntl
import os
import stat
import struct
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

from sailenv_ros.errors import InvalidRequest, NameTaken

__all__ = ["ProcessLock", "holder_of", "open_private_folder", "private_folder"]

_FLOCK = "hhqqi4x"
"""`struct flock` of 64-bit Linux: type, whence, start, length, process."""

_Lock = TypeVar("_Lock", bound="ProcessLock")


class ProcessLock:
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


def holder_of(file: str) -> int | None:
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
