"""Where a stream grows: a folder beside its place, which takes that place when all parts are there.

Knows no frames.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from sailenv_ros.dataset.folder_storage import FolderStorage
from sailenv_ros.dataset.identity import WorkIdentity
from sailenv_ros.dataset.store import ResumableStore
from sailenv_ros.recording.bag_metadata import METADATA_FILE
from sailenv_ros.recording.bag_recovery import restore_metadata
from sailenv_ros.system.files import UNFINISHED, write_errors

__all__ = ["IDENTITY_FILE", "StreamFolder"]

IDENTITY_FILE = "stream.json"


class StreamFolder:
    """A stream's folder, and the one beside it in which it grows.

    Parameters
    ----------
    path : Path
        Where the stream is to be.
    settings : mapping
        JSON; another call must agree in them to continue.

    Raises
    ------
    PlaceTaken, BegunOtherwise
        If one of the two folders holds something else. Nothing was written then.
    """

    def __init__(self, path: Path, settings: Mapping[str, Any]) -> None:
        self.path = path
        self._growing = path.with_name(f"{path.name}{UNFINISHED}")
        identity = WorkIdentity(file=IDENTITY_FILE, settings=settings)
        self._whole = ResumableStore(FolderStorage(path), identity)
        self._storage = FolderStorage(self._growing)
        self._store = ResumableStore(self._storage, identity)
        self._check()

    @property
    def is_whole(self) -> bool:
        """True if all of it is there."""
        return (self.path / METADATA_FILE).is_file()

    def missing(self, count: int) -> list[int]:
        """Return the numbers of the parts that are not there, of so many."""
        return [
            number for number in range(count) if not (self._growing / self._part(number)).is_file()
        ]

    @contextmanager
    def opened(self) -> Iterator[None]:
        """Make the growing folder and hold it alone.

        Raises
        ------
        WriteFailed
            If it cannot be made.
        DeadlineExceeded
            If another process is writing this stream.
        """
        with ExitStack() as stack:
            if self.is_whole:
                self._whole.storage.release()
            else:
                stack.enter_context(self._store.opened())
                self._check()
            yield

    def filled(self, parts: int, make: Callable[[list[int]], None]) -> Path:
        """Make what is missing, and return the folder.

        Parameters
        ----------
        parts : int
            Of the whole stream.
        make : callable
            Makes the parts of these numbers; told of none if all of it is there.

        Raises
        ------
        RecordingError, WriteFailed, DeadlineExceeded
            As of `opened` and `finish`.
        """
        with self.opened():
            missing = [] if self.is_whole else self.missing(parts)
            make(missing)
            return self.path if self.is_whole else self.finish()

    @contextmanager
    def part(self, number: int) -> Iterator[Path]:
        """Yield the name of a bag to be written; its one file becomes the part of that number."""
        with self._store.part() as part:
            draft = part.folder / "bag"
            yield draft
            with write_errors(draft):
                os.replace(draft / f"{draft.name}_0.mcap", part.folder / self._part(number))
                shutil.rmtree(draft)

    def finish(self) -> Path:
        """Put the whole stream into its place; return it.

        Raises
        ------
        RecordingError
            If that cannot be done; the parts stay where they are.
        """
        restore_metadata(self._growing)
        self._storage.move(self.path)
        self._store.finish()
        return self.path

    # -- inside ----------------------------------------------------------------------------

    def _part(self, number: int) -> str:
        # Names of a bag's files begin with that of its folder, which is the one it will have.
        return f"{self.path.resolve().name}_{number}.mcap"

    def _check(self) -> None:
        self._whole.check()
        self._store.check()
