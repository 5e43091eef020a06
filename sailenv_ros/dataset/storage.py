"""Where a data set is written to: a folder here, or any place that `fsspec` knows (s3://…).

What is there is whole: files take their places one by one, and a shard counts once its summary,
which is written last, is there.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from sailenv_ros.errors import RecordingError
from sailenv_ros.extras import need
from sailenv_ros.system.files import UNFINISHED, make_folder, sync_file_system, write_file

__all__ = ["FolderStorage", "RemoteStorage", "Storage", "open_storage"]

STAGING = f"making{UNFINISHED}"
"""Folder in a data set in which shards grow until they are whole."""


class Storage(ABC):
    """A data set's place; paths are relative to it, with ``/``."""

    @property
    @abstractmethod
    def shown(self) -> str:
        """Its name for people."""

    @abstractmethod
    def staging(self, scratch: Path | None = None) -> contextlib.AbstractContextManager[Path]:
        """Yield an empty folder on this machine to write into; it goes in the end.

        Where the place is on another machine it lies in `scratch`, or among temporary files.
        """

    @abstractmethod
    def publish(self, folder: Path, paths: Sequence[str]) -> None:
        """Put files of a staging folder into their places; what is there is replaced.

        Raises
        ------
        RecordingError
            If the place refuses it.
        """

    @abstractmethod
    def write(self, path: str, data: bytes) -> None:
        """Write one file, whole or not at all."""

    @abstractmethod
    def read(self, path: str) -> bytes | None:
        """Return a file's content; None if there is none."""

    @abstractmethod
    def names(self, folder: str) -> list[str]:
        """Return the names of the files in a folder, sorted; none if there is no such folder."""


def open_storage(where: str | Path) -> Storage:
    """Return the store of a folder or a URL.

    Raises
    ------
    MissingPackage
        If `fsspec`, or what it needs for that kind of URL, is not installed.
    RecordingError
        If there is no such kind of URL.
    """
    text = str(where)
    if "://" in text and not text.startswith("file://"):
        return RemoteStorage(text)
    return FolderStorage(Path(text.removeprefix("file://")))


class FolderStorage(Storage):
    """A folder of this machine."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        try:
            make_folder(folder)
        except (OSError, ValueError) as problem:
            raise _refused(folder, problem) from None

    @property
    def shown(self) -> str:
        """Its name for people."""
        return str(self.folder)

    @contextlib.contextmanager
    def staging(self, scratch: Path | None = None) -> Iterator[Path]:
        """Yield an empty folder, which goes in the end."""
        place = self.folder / STAGING
        make_folder(place)
        with tempfile.TemporaryDirectory(dir=place) as made:
            yield Path(made)

    def remove_staging(self) -> None:
        """Remove what workers that were killed have left."""
        shutil.rmtree(self.folder / STAGING, ignore_errors=True)

    def publish(self, folder: Path, paths: Sequence[str]) -> None:
        """Put files of a staging folder into their places."""
        try:
            # On the disk before a summary says that they are there.
            sync_file_system(folder)
            for path in paths:
                target = self.folder / path
                make_folder(target.parent)
                os.replace(folder / path, target)
        except OSError as problem:
            raise _refused(self.folder, problem) from None

    def write(self, path: str, data: bytes) -> None:
        """Write one file, whole or not at all."""
        target = self.folder / path
        try:
            make_folder(target.parent)
            write_file(target, data)
        except OSError as problem:
            raise _refused(target, problem) from None

    def read(self, path: str) -> bytes | None:
        """Return a file's content; None if there is none."""
        try:
            return (self.folder / path).read_bytes()
        except FileNotFoundError:
            return None
        except OSError as problem:
            raise _refused(self.folder / path, problem) from None

    def names(self, folder: str) -> list[str]:
        """Return the names of the files in a folder, sorted."""
        place = self.folder / folder
        if not place.is_dir():
            return []
        return sorted(one.name for one in place.iterdir() if UNFINISHED not in one.name)


class RemoteStorage(Storage):
    """A place that `fsspec` reaches; credentials are its own matter (environment, files)."""

    def __init__(self, url: str) -> None:
        core: Any = need("fsspec.core", "a data set at a remote place")
        try:
            self._files, self._root = core.url_to_fs(url)
        except (ImportError, ValueError) as problem:
            raise RecordingError(f"{url} cannot be reached: {problem}") from None
        self._url = url

    @property
    def shown(self) -> str:
        """Its name for people."""
        return self._url

    @contextlib.contextmanager
    def staging(self, scratch: Path | None = None) -> Iterator[Path]:
        """Yield an empty folder, which goes in the end."""
        with tempfile.TemporaryDirectory(prefix="sailenv-dataset-", dir=scratch) as made:
            yield Path(made)

    def publish(self, folder: Path, paths: Sequence[str]) -> None:
        """Put files of a staging folder into their places."""
        with self._told():
            for path in paths:
                self._files.put_file(str(folder / path), f"{self._root}/{path}")

    def write(self, path: str, data: bytes) -> None:
        """Write one file, whole or not at all."""
        with self._told():
            self._files.pipe_file(f"{self._root}/{path}", data)

    def read(self, path: str) -> bytes | None:
        """Return a file's content; None if there is none."""
        with self._told():
            try:
                return bytes(self._files.cat_file(f"{self._root}/{path}"))
            except FileNotFoundError:
                return None

    def names(self, folder: str) -> list[str]:
        """Return the names of the files in a folder, sorted."""
        with self._told():
            # Others write there: what was listed before may be old.
            self._files.invalidate_cache()
            try:
                found = self._files.ls(f"{self._root}/{folder}", detail=False)
            except FileNotFoundError:
                return []
        return sorted(str(path).rpartition("/")[2] for path in found)

    @contextlib.contextmanager
    def _told(self) -> Iterator[None]:
        try:
            yield
        except OSError as problem:
            raise RecordingError(f"{self._url} refuses it: {problem}") from None


def _refused(path: Path, problem: Exception) -> RecordingError:
    why = getattr(problem, "strerror", None) or str(problem)
    return RecordingError(f"{path} cannot be written or read: {why}")
