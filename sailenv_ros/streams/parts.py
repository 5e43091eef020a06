"""Where a stream grows: a folder beside its place, with its identity and the parts that are whole.

It takes its place, as a bag of several files, when all is there. Knows no frames.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sailenv_ros.errors import RecordingError, SailenvError
from sailenv_ros.recording.bag_metadata import METADATA_FILE
from sailenv_ros.recording.bag_recovery import restore_metadata
from sailenv_ros.system.files import (
    UNFINISHED,
    file_lock,
    make_folder,
    sync_file_system,
    sync_folder,
    write_file,
)

__all__ = ["IDENTITY_FILE", "StreamFolder"]

IDENTITY_FILE = "stream.json"

_MOST_BYTES = 1_000_000
"""An identity is shorter."""

LOCK_TIMEOUT_S = 5.0


class StreamFolder:
    """A stream's folder, and the one beside it in which it grows.

    Parameters
    ----------
    path : Path
        Where the stream is to be.
    identity : mapping
        JSON; what another call must agree in to go on.

    Raises
    ------
    RecordingError
        If one of the two folders holds something else. Nothing was written then.
    """

    def __init__(self, path: Path, identity: Mapping[str, Any]) -> None:
        self.path = path
        self._identity = dict(identity)
        self._growing = path.with_name(f"{path.name}{UNFINISHED}")
        self._check()

    @property
    def is_whole(self) -> bool:
        """True if all of it is there."""
        return (self.path / METADATA_FILE).is_file()

    @property
    def parts(self) -> int:
        """How many parts are whole, counted from the first on."""
        count = 0
        while self._part(count).is_file():
            count += 1
        return count

    @contextmanager
    def opened(self) -> Iterator[None]:
        """Make the growing folder and hold it alone.

        Raises
        ------
        RecordingError
            If it cannot be made.
        DeadlineExceeded
            If another process is writing this stream.
        """
        if self.is_whole:
            yield
            return
        try:
            make_folder(self._growing)
            with file_lock(self._growing / ".lock", str(self.path), timeout_s=LOCK_TIMEOUT_S):
                self._check()
                identity = json.dumps(self._identity, indent=2) + "\n"
                write_file(self._growing / IDENTITY_FILE, identity.encode())
                shutil.rmtree(self._draft, ignore_errors=True)
                yield
        except SailenvError:  # some of them are OSErrors too
            raise
        except OSError as problem:
            raise _refused(self._growing, problem) from None

    @contextmanager
    def part(self) -> Iterator[Path]:
        """Yield the name of a bag to be written; its one file becomes the next part."""
        place = self._part(self.parts)
        yield self._draft
        try:
            sync_file_system(self._draft)
            os.replace(self._draft / f"{self._draft.name}_0.mcap", place)
            sync_folder(self._growing)
            shutil.rmtree(self._draft)
        except OSError as problem:
            raise _refused(place, problem) from None

    def finish(self) -> Path:
        """Put the whole stream into its place; return it.

        Raises
        ------
        RecordingError
            If that cannot be done; the parts stay where they are.
        """
        restore_metadata(self._growing)
        try:
            (self._growing / ".lock").unlink(missing_ok=True)
            os.rename(self._growing, self.path)
            sync_folder(self.path.parent)
        except OSError as problem:
            raise _refused(self.path, problem) from None
        return self.path

    # -- inside ----------------------------------------------------------------------------

    @property
    def _draft(self) -> Path:
        return self._growing / f"part{UNFINISHED}"

    def _part(self, number: int) -> Path:
        # Names of a bag's files begin with that of its folder, which is the one it will have.
        return self._growing / f"{self.path.resolve().name}_{number}.mcap"

    def _check(self) -> None:
        for folder in (self.path, self._growing):
            if not os.path.lexists(folder):
                continue
            known = _read_identity(folder)
            if known is None:
                if folder == self._growing and _is_new(folder):
                    continue
                raise RecordingError(
                    f"{folder} is there already and is no stream of ours; name a folder that is not"
                )
            other = [key for key in self._identity if known.get(key) != self._identity[key]]
            if other:
                key = other[0]
                raise RecordingError(
                    f"{folder} is another stream: {key} is {known.get(key)!r}, not"
                    f" {self._identity[key]!r}; name another folder, or repeat its options"
                )


def _is_new(folder: Path) -> bool:
    """Return whether a folder is empty, but for a lock: broken off before anything was written."""
    return folder.is_dir() and not [name for name in os.listdir(folder) if name != ".lock"]


def _read_identity(folder: Path) -> dict[str, Any] | None:
    try:
        with (folder / IDENTITY_FILE).open("rb") as file:
            found = json.loads(file.read(_MOST_BYTES))
    except (OSError, ValueError, RecursionError):
        return None
    return found if isinstance(found, dict) else None


def _refused(path: Path, problem: OSError) -> RecordingError:
    return RecordingError(f"{path} cannot be written: {problem.strerror or problem}")
