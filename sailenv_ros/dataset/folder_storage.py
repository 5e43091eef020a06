"""Data sets in a folder of this machine: what is there is whole, and on the disk."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from sailenv_ros.dataset.storage import Storage
from sailenv_ros.errors import PlaceTaken, RecordingError, WriteFailed
from sailenv_ros.system.files import (
    UNFINISHED,
    file_lock,
    make_folder,
    sync_file_system,
    sync_folder,
    write_errors,
    write_file,
)

__all__ = ["FolderStorage"]

STAGING = f"making{UNFINISHED}"
"""Folder in a data set in which parts grow until they are whole."""

LOCK = ".lock"

LOCK_TIMEOUT_S = 5.0


class FolderStorage(Storage):
    """A folder of this machine; made when something is written."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    @property
    def shown(self) -> str:
        """Its name for people."""
        return str(self.folder)

    def check_free(self) -> None:
        """Refuse a folder with a file in it, but for what broken-off writers left."""
        with write_errors(self.folder):
            if not os.path.lexists(self.folder):
                return
            if not self.folder.is_dir():
                raise PlaceTaken(self.shown, "is no folder")
            for _, folders, files in os.walk(self.folder):
                folders[:] = [name for name in folders if not name.endswith(UNFINISHED)]
                if any(name != LOCK and not name.endswith(UNFINISHED) for name in files):
                    raise PlaceTaken(self.shown)

    @contextlib.contextmanager
    def held(self) -> Iterator[None]:
        """Hold the folder's lock."""
        with contextlib.ExitStack() as stack:
            with write_errors(self.folder):
                try:
                    make_folder(self.folder)
                except ValueError as problem:  # a NUL in the name is no OSError
                    raise WriteFailed(self.folder, problem) from None
                lock = self.folder / LOCK
                stack.enter_context(file_lock(lock, self.shown, timeout_s=LOCK_TIMEOUT_S))
            for left in list(self.folder.rglob(f"*{UNFINISHED}")):
                _remove(left)
            try:
                yield
            finally:
                with contextlib.suppress(OSError):
                    (self.folder / STAGING).rmdir()

    def release(self) -> None:
        """Remove the staging folder and the lock."""
        shutil.rmtree(self.folder / STAGING, ignore_errors=True)
        with write_errors(self.folder):
            (self.folder / LOCK).unlink(missing_ok=True)

    def move(self, target: Path) -> None:
        """Rename the folder; it is the one of this storage from then on.

        Raises
        ------
        WriteFailed
            If that cannot be done; all stays where it is.
        """
        with write_errors(target):
            os.rename(self.folder, target)
            self.folder = target
            sync_folder(target.parent)

    @contextlib.contextmanager
    def staging(self, scratch: Path | None = None) -> Iterator[Path]:
        """Yield an empty folder, which is removed at the end."""
        with contextlib.ExitStack() as stack:
            with write_errors(self.folder):
                make_folder(self.folder / STAGING)
                made = tempfile.TemporaryDirectory(
                    dir=self.folder / STAGING, ignore_cleanup_errors=True
                )
                folder = Path(stack.enter_context(made))
            yield folder

    def publish(self, folder: Path, paths: Sequence[str]) -> None:
        """Put files of a staging folder into their places."""
        with write_errors(self.folder):
            # On the disk before a note says that they are there.
            sync_file_system(folder)
            changed = {}
            for path in paths:
                target = self.folder / path
                if target.parent not in changed:
                    make_folder(target.parent)
                    changed[target.parent] = True
                os.replace(folder / path, target)
            for parent in changed:
                sync_folder(parent)

    def sync(self) -> None:
        """Bring all that was written to the file system to the disk."""
        with write_errors(self.folder):
            sync_file_system(self.folder)

    def write(self, path: str, data: bytes) -> None:
        """Write one file, whole or not at all."""
        target = self.folder / path
        with write_errors(target):
            make_folder(target.parent)
            write_file(target, data)

    def read(self, path: str) -> bytes | None:
        """Return a file's content; None if there is none."""
        try:
            return (self.folder / path).read_bytes()
        except (FileNotFoundError, NotADirectoryError):
            return None
        except (OSError, ValueError) as problem:
            why = getattr(problem, "strerror", None) or str(problem)
            raise RecordingError(f"{self.folder / path} cannot be read: {why}") from None

    def remove(self, paths: Sequence[str]) -> None:
        """Remove files, in this order, and their folders if they are empty then."""
        with write_errors(self.folder):
            for path in paths:
                (self.folder / path).unlink(missing_ok=True)
        above = {parent for path in paths for parent in Path(path).parents if parent.name}
        for parent in sorted(above, reverse=True):
            with contextlib.suppress(OSError):
                (self.folder / parent).rmdir()

    def names(self, folder: str) -> list[str]:
        """Return the names of the files in a folder, sorted."""
        place = self.folder / folder
        if not place.is_dir():
            return []
        return sorted(one.name for one in place.iterdir() if UNFINISHED not in one.name)


def _remove(left: Path) -> None:
    """Remove a file or a folder that was growing when its writer was killed."""
    if left.is_dir() and not left.is_symlink():
        shutil.rmtree(left, ignore_errors=True)
    else:
        with contextlib.suppress(OSError):
            left.unlink()
