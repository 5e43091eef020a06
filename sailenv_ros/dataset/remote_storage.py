"""Data sets at places that `fsspec` reaches (s3://…), and the choice of a place by its name."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from sailenv_ros.dataset.folder_storage import FolderStorage
from sailenv_ros.dataset.storage import Storage
from sailenv_ros.errors import RecordingError, WriteFailed
from sailenv_ros.extras import need
from sailenv_ros.system.temporary_folders import temporary_folder

__all__ = ["RemoteStorage", "open_storage"]


def open_storage(where: str | Path) -> Storage:
    """Return the storage of a folder or a URL.

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


class RemoteStorage(Storage):
    """A place that `fsspec` reaches; credentials are its own matter (environment, files).

    Such places know no locks: who writes to one takes care to be alone.
    """

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

    def check_free(self) -> None:
        """Nothing to refuse: such places have no folders that could be empty."""

    @contextlib.contextmanager
    def held(self) -> Iterator[None]:
        """Yield."""
        yield

    def release(self) -> None:
        """Nothing to remove."""

    @contextlib.contextmanager
    def staging(self, scratch: Path | None = None) -> Iterator[Path]:
        """Yield an empty folder, which is removed at the end."""
        with temporary_folder("sailenv-dataset-", place=scratch) as made:
            yield made

    def publish(self, folder: Path, paths: Sequence[str]) -> None:
        """Put files of a staging folder into their places."""
        with self._told():
            for path in paths:
                self._files.put_file(str(folder / path), f"{self._root}/{path}")

    def sync(self) -> None:
        """Nothing to do: what was written is there."""

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

    def remove(self, paths: Sequence[str]) -> None:
        """Remove files, in this order."""
        with self._told():
            for path in paths:
                self._files.rm_file(f"{self._root}/{path}")

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
            raise WriteFailed(self._url, problem) from None
