"""Writing files so that they are whole or not there, and locks for those who write.

A file is written beside its place under another name, synced (fsync), renamed, and its folder is
synced. So a reader, a killed process and a machine that loses power find the
old file or the new one, never a part. To read, change and write needs a `file_lock`.
"""

from __future__ import annotations

import contextlib
import ctypes
import errno
import fcntl
import os
import secrets
import shutil
import stat
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from sailenv_ros.errors import DeadlineExceeded, StorageError, WriteFailed

__all__ = [
    "UNFINISHED",
    "begin_write_back",
    "file_lock",
    "make_folder",
    "remove_unfinished",
    "replaced_folder",
    "storage_errors",
    "sync_file_system",
    "sync_folder",
    "write_errors",
    "write_file",
    "written_file",
]

UNFINISHED = ".unfinished"
"""End of the names of files and folders that are being written."""

LOOK_AGAIN_S = 0.02

_NO_REPLACE, _EXCHANGE = 1, 2
"""`RENAME_NOREPLACE`, `RENAME_EXCHANGE` of renameat2(2)."""

_SYNC_FILE_RANGE_WRITE = 2

_UNSUPPORTED = (errno.EINVAL, errno.ENOSYS, errno.ENOTSUP)

_libc = ctypes.CDLL(None, use_errno=True)


def write_file(
    path: Path, data: bytes | bytearray, *, overwrite: bool = True, durable: bool = True
) -> None:
    """Write a file, all of it or nothing.

    Parameters
    ----------
    path : Path
        Its folder must be there.
    data : bytes or bytearray
    overwrite : bool
        False leaves a file that is there, with a `FileExistsError`.
    durable : bool
        False leaves it to the operating system when the bytes reach the disk: for many files of
        which `sync_file_system` takes care at the end.

    Raises
    ------
    OSError
        If it cannot be written; what was there is there.
    """
    with written_file(path, overwrite=overwrite, durable=durable) as file:
        file.write(data)


@contextmanager
def written_file(path: Path, *, overwrite: bool = True, durable: bool = True) -> Iterator[BinaryIO]:
    """Open a file to be written, which takes its place when the block ends well.

    See `write_file` for the parameters and the errors.
    """
    draft = path.with_name(f".{path.name[:150]}.{secrets.token_hex(6)}{UNFINISHED}")
    mode = _mode_of(path)
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC | os.O_NOFOLLOW
    fd = os.open(draft, flags, 0o666 if mode is None else mode)
    try:
        with os.fdopen(fd, "wb") as file:
            yield file
            file.flush()
            if durable:
                os.fsync(file.fileno())
        if overwrite:
            os.replace(draft, path)
        else:
            _rename_new(draft, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(draft)
        raise
    if durable:
        try:
            sync_folder(path.parent)
        except OSError:
            if not overwrite:
                # Nobody is told of it, so it must not be in the way of the next attempt.
                with contextlib.suppress(OSError):
                    os.unlink(path)
            raise


@contextmanager
def replaced_folder(folder: Path) -> Iterator[Path]:
    """Yield an empty folder to fill, which takes the place of `folder` when the block ends well.

    There is a whole folder in that place at every moment, where the file system can exchange two.

    Raises
    ------
    OSError
        If it cannot be put there; what was there is there.
    """
    make_folder(folder.parent)
    draft = folder.with_name(f".{folder.name}.{secrets.token_hex(6)}{UNFINISHED}")
    os.mkdir(draft)
    try:
        yield draft
        _sync_tree(draft)
        if not folder.exists():
            os.rename(draft, folder)
        elif not _renameat2(draft, folder, _EXCHANGE):
            old = draft.with_name(f".{folder.name}.{secrets.token_hex(6)}.old{UNFINISHED}")
            os.rename(folder, old)
            try:
                os.rename(draft, folder)
            except OSError:
                os.rename(old, folder)
                raise
            shutil.rmtree(old, ignore_errors=True)
        sync_folder(folder.parent)
    finally:
        # After an exchange this is what was there before.
        shutil.rmtree(draft, ignore_errors=True)


def make_folder(folder: Path) -> None:
    """Make a folder and those above it where they are missing, and bring them to the disk.

    Raises
    ------
    OSError
        If it cannot be made.
    """
    missing = []
    while not folder.is_dir():
        missing.append(folder)
        folder = folder.parent
    for new in reversed(missing):
        with contextlib.suppress(FileExistsError):  # another one was quicker
            os.mkdir(new)
        sync_folder(new.parent)


def sync_folder(folder: Path) -> None:
    """Bring a folder's names to the disk: only then a renamed file stays renamed.

    Raises
    ------
    OSError
        If the disk refuses it.
    """
    with _opened(folder) as fd:
        try:
            os.fsync(fd)
        except OSError as problem:
            if problem.errno not in _UNSUPPORTED:  # some network file systems know no such thing
                raise


def sync_file_system(folder: Path) -> None:
    """Bring all that was written to a folder's file system to the disk; see `sync_folder`."""
    with _opened(folder) as fd:
        _syncfs(fd)


@contextmanager
def _opened(folder: Path) -> Iterator[int]:
    fd = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        yield fd
    finally:
        os.close(fd)


def begin_write_back(fd: int) -> None:
    """Have the system begin to bring what was written to a file to the disk, and wait for nothing.

    Otherwise it may keep all of a large file until somebody syncs, and does nothing else then.
    A file system that knows no such thing is left as it is.
    """
    _libc.sync_file_range(fd, ctypes.c_int64(0), ctypes.c_int64(0), _SYNC_FILE_RANGE_WRITE)


@contextmanager
def file_lock(
    path: Path,
    what: str,
    *,
    timeout_s: float = 60.0,
    waiting: Callable[[], None] = lambda: None,
) -> Iterator[None]:
    """Be the only one, among threads and processes, that holds the lock of a file.

    The kernel lets go of it however the process ends.

    Parameters
    ----------
    path : Path
        The lock's own file, which its holder may remove; its folder is made.
    what : str
        What is locked, as an error names it: ``"the own pack"``.
    timeout_s : float
        How long to wait [s].
    waiting : callable
        Called once if another holds it.

    Raises
    ------
    DeadlineExceeded
        If another held it all the time.
    OSError
        If the lock's file cannot be opened.
    """
    make_folder(path.parent)
    deadline = time.monotonic() + timeout_s
    told = False
    while (fd := _open_locked(path)) is None:
        if not told:
            waiting()
            told = True
        if time.monotonic() > deadline:
            raise DeadlineExceeded(f"{what}, which another process writes to", timeout_s)
        time.sleep(LOOK_AGAIN_S)
    try:
        yield
    finally:
        os.close(fd)


def remove_unfinished(folder: Path) -> int:
    """Remove what writers left behind that were killed; how many that were is returned.

    Only for who holds the lock of all writers to that folder.
    """
    removed = 0
    for left in sorted(folder.glob(f".*{UNFINISHED}")):
        if left.is_dir() and not left.is_symlink():
            shutil.rmtree(left, ignore_errors=True)
        else:
            with contextlib.suppress(OSError):
                left.unlink()
        removed += not left.exists()
    return removed


@contextmanager
def storage_errors(what: str, path: Path) -> Iterator[None]:
    """Turn an `OSError` of the block into a `StorageError` that names what was being written."""
    try:
        yield
    except OSError as problem:
        if isinstance(problem, DeadlineExceeded):
            raise
        raise StorageError(what, str(path), problem) from problem


def _syncfs(fd: int) -> None:
    if _libc.syncfs(fd):
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


@contextmanager
def write_errors(path: Path) -> Iterator[None]:
    """Turn an `OSError` of the block into a `WriteFailed` that names what was being written."""
    try:
        yield
    except DeadlineExceeded:
        raise
    except OSError as problem:
        raise WriteFailed(path, problem) from None


def _open_locked(path: Path) -> int | None:
    """Open the file of a lock and take it; None if another holds it."""
    fd = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o666)
    taken = False
    try:
        fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
        # Its last holder may have removed it: then another file is in its place, or none.
        taken = os.path.samestat(os.fstat(fd), os.stat(path))
        return fd if taken else None
    except (BlockingIOError, FileNotFoundError):
        return None
    finally:
        if not taken:
            os.close(fd)


def _mode_of(path: Path) -> int | None:
    """Return the rights of a file that is there, which the new one shall have too."""
    try:
        found = os.lstat(path)
    except OSError:
        return None
    return stat.S_IMODE(found.st_mode) & 0o777 if stat.S_ISREG(found.st_mode) else None


def _rename_new(draft: Path, path: Path) -> None:
    """Rename to a name that must be free."""
    if not _renameat2(draft, path, _NO_REPLACE):
        os.link(draft, path)  # refuses a name that is in use, too
        os.unlink(draft)


def _renameat2(old: Path, new: Path, flags: int) -> bool:
    """Rename with `flags`; False if the kernel or the file system cannot."""
    at_cwd = -100
    done = _libc.renameat2(at_cwd, os.fsencode(old), at_cwd, os.fsencode(new), flags)
    if done == 0:
        return True
    number = ctypes.get_errno()
    if number in _UNSUPPORTED:
        return False
    raise OSError(number, os.strerror(number), str(old), None, str(new))


def _sync_tree(folder: Path) -> None:
    """Bring every file and folder in a folder to the disk."""
    for here, _, files in os.walk(folder):
        for name in files:
            fd = os.open(Path(here) / name, os.O_RDONLY | os.O_CLOEXEC)
            try:
                os.fsync(fd)
            finally:
                os.close(fd)
        sync_folder(Path(here))
