"""Temporary folders that do not outlive their process for long, however it ends.

A folder's maker holds a lock on it. One that a killed process left is locked by nobody, and is
removed by the maker of the next of that kind.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["temporary_folder"]

_HELD = ".held"
"""End of the names of such folders: others are not known to be locked while they are in use."""


@contextmanager
def temporary_folder(prefix: str, *, place: Path | None = None) -> Iterator[Path]:
    """Yield an empty folder that is gone afterwards.

    Parameters
    ----------
    prefix : str
        How its name begins; those of killed processes that begin so are removed.
    place : Path or None
        Folder that it is made in; None means that of temporary files.

    Raises
    ------
    OSError
        If it cannot be made.
    """
    parent = Path(tempfile.gettempdir()) if place is None else place
    _remove_abandoned(parent, prefix)
    folder, lock = _made(parent, prefix)
    try:
        yield folder
    finally:
        # In this order: what is not locked may be removed by others.
        shutil.rmtree(folder, ignore_errors=True)
        os.close(lock)


def _made(parent: Path, prefix: str) -> tuple[Path, int]:
    while True:
        folder = Path(tempfile.mkdtemp(prefix=prefix, suffix=_HELD, dir=parent))
        try:
            lock = _opened(folder)
        except FileNotFoundError:
            continue  # another one has taken it for abandoned, for it was not locked yet
        except OSError:
            with contextlib.suppress(OSError):
                folder.rmdir()
            raise
        with contextlib.suppress(OSError):  # a file system without locks: nobody removes it
            fcntl.flock(lock, fcntl.LOCK_EX)
        if _is_there(folder, lock):
            return folder, lock
        os.close(lock)


def _remove_abandoned(parent: Path, prefix: str) -> None:
    for folder in parent.glob(f"{prefix}*{_HELD}"):
        # Others' and links cannot be opened, those in use not be locked.
        with contextlib.suppress(OSError):
            lock = _opened(folder)
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if os.fstat(lock).st_uid == os.getuid():
                    shutil.rmtree(folder, ignore_errors=True)
            finally:
                os.close(lock)


def _opened(folder: Path) -> int:
    return os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC)


def _is_there(folder: Path, lock: int) -> bool:
    try:
        return os.path.samestat(os.lstat(folder), os.fstat(lock))
    except FileNotFoundError:
        return False
