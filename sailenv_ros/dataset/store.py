"""A work that grows at a place until it is whole, and continues after a break at any moment.

Data sets by recipe, exports and streams are written through it. What is done is known by *notes*:
a note is written last, when all that it names is on the disk. So after Ctrl-C, `kill -9`, a
full disk or a power cut the same call finds what is whole by its notes and makes the rest again.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from sailenv_ros.dataset.identity import WorkIdentity
from sailenv_ros.dataset.storage import Storage

__all__ = ["Part", "ResumableStore"]


@dataclass(slots=True)
class Part:
    """A part of the work that is being made.

    Attributes
    ----------
    folder : Path
        Empty at first; files in it take the places that they have relative to it.
    note : (str, bytes) or None
        Path and content of the file that says that the part is whole.
    """

    folder: Path
    note: tuple[str, bytes] | None = None


class ResumableStore:
    """A work's place, its identity, and what is done of it.

    Parameters
    ----------
    storage : Storage
    identity : WorkIdentity
    """

    def __init__(self, storage: Storage, identity: WorkIdentity) -> None:
        self.storage = storage
        self._identity = identity

    def check(self, *, resume: bool = True) -> bool:
        """Return whether the work was begun; refuse a place in which something else is.

        Parameters
        ----------
        resume : bool
            False refuses this work as well, if it was begun.

        Raises
        ------
        BegunOtherwise
            If it was begun with other settings.
        PlaceTaken
            If something else is there. Nothing was written.
        """
        if not resume:
            self.storage.check_free()
        if self._identity.is_begun(self.storage):
            return True
        self.storage.check_free()
        return False

    @contextmanager
    def opened(self, *, resume: bool = True) -> Iterator[None]:
        """Hold the place alone, and begin the work or continue it; see `check`.

        Raises
        ------
        BegunOtherwise, PlaceTaken
            See `check`.
        DeadlineExceeded
            If another process is at this work.
        WriteFailed
            If the place cannot be made.
        """
        self.check(resume=resume)
        with self.storage.held():
            # Again: another one may have been quicker.
            if not self.check(resume=resume):
                self.storage.write(self._identity.file, self._identity.to_bytes())
            yield

    @contextmanager
    def part(self, scratch: Path | None = None) -> Iterator[Part]:
        """Yield a part to make; its files take their places, and then its note, if all goes well.

        Several processes may make parts at once.

        Parameters
        ----------
        scratch : Path or None
            Where parts for other machines grow; None among temporary files.
        """
        with self.storage.staging(scratch) as folder:
            part = Part(folder)
            yield part
            files = sorted(path for path in folder.rglob("*") if path.is_file())
            self.storage.publish(folder, [path.relative_to(folder).as_posix() for path in files])
            if part.note is not None:
                self.storage.write(*part.note)

    def note(self, path: str, data: bytes) -> None:
        """Note what was written to the place directly, when all of it is on the disk."""
        self.storage.sync()
        self.storage.write(path, data)

    def notes(self, folder: str) -> dict[str, bytes]:
        """Return the notes in a folder, by their names, sorted."""
        found = {name: self.storage.read(f"{folder}/{name}") for name in self.storage.names(folder)}
        return {name: data for name, data in found.items() if data is not None}

    def finish(self, forgotten: Sequence[str] = ()) -> None:
        """Bring all to the disk and remove what only unfinished works have.

        Parameters
        ----------
        forgotten : sequence of str
            Files of the work that go now, in this order.
        """
        self.storage.sync()
        if forgotten:
            self.storage.remove(forgotten)
            self.storage.sync()
        self.storage.release()
