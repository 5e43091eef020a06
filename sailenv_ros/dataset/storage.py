"""The contract of places that data sets are written to: a folder here, or one of another machine.

Files take their places one by one, each whole or not at all. Knows nothing of what is in them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path

__all__ = ["Storage"]


class Storage(ABC):
    """A data set's place; paths are relative to it, with ``/``."""

    @property
    @abstractmethod
    def shown(self) -> str:
        """Its name for people."""

    @abstractmethod
    def check_free(self) -> None:
        """Refuse a place in which there is something already.

        Raises
        ------
        PlaceTaken
        """

    @abstractmethod
    def held(self) -> AbstractContextManager[None]:
        """Be the only one that holds the place, and remove what broken-off writers left in it.

        Raises
        ------
        DeadlineExceeded
            If another process holds it.
        WriteFailed
            If it cannot be made.
        """

    @abstractmethod
    def release(self) -> None:
        """Remove what holding the place has put there: the work is finished."""

    @abstractmethod
    def staging(self, scratch: Path | None = None) -> AbstractContextManager[Path]:
        """Yield an empty folder on this machine to write into; it is removed at the end.

        Where the place is on another machine it lies in `scratch`, or among temporary files.
        """

    @abstractmethod
    def publish(self, folder: Path, paths: Sequence[str]) -> None:
        """Put files of a staging folder into their places; what is there is replaced.

        Raises
        ------
        WriteFailed
            If the place refuses it.
        """

    @abstractmethod
    def sync(self) -> None:
        """Bring all that was written to the place to its disk.

        Raises
        ------
        WriteFailed
            If the disk refuses it.
        """

    @abstractmethod
    def write(self, path: str, data: bytes) -> None:
        """Write one file, whole or not at all."""

    @abstractmethod
    def read(self, path: str) -> bytes | None:
        """Return a file's content; None if there is none."""

    @abstractmethod
    def remove(self, paths: Sequence[str]) -> None:
        """Remove files, in this order, and their folders if they are empty then."""

    @abstractmethod
    def names(self, folder: str) -> list[str]:
        """Return the names of the files in a folder, sorted; none if there is no such folder."""
