"""Journal of the frames of a data set made so far, by which its writer continues after a break."""

from __future__ import annotations

import json
from collections.abc import Mapping

from sailenv_ros.dataset.formats.dataset_format import WriteResult
from sailenv_ros.dataset.store import ResumableStore
from sailenv_ros.errors import RecordingError

__all__ = ["IDENTITY_FILE", "NOTES_FOLDER", "Entry", "FrameJournal"]

IDENTITY_FILE = "unfinished/begun.json"
NOTES_FOLDER = "unfinished/frames"
"""Both go away when the data set is finished."""

FRAMES_PER_NOTE = 32

Entry = Mapping[str, WriteResult]
"""Result of each format for one frame."""


class FrameJournal:
    """The frames that were written, noted by the dozen when their files are on the disk.

    Parameters
    ----------
    store : ResumableStore
        It must be open.

    Attributes
    ----------
    splits : list of str
        Split of each frame that was written.
    entries : list of mapping of str to WriteResult
        What was made of each, in their order.

    Raises
    ------
    RecordingError
        If a note cannot be read.
    """

    def __init__(self, store: ResumableStore) -> None:
        self._store = store
        self._names: list[str] = []
        self.entries: list[Entry] = []
        self.splits: list[str] = []
        for name, data in store.notes(NOTES_FOLDER).items():
            try:
                for line in data.splitlines():
                    value = json.loads(line)
                    made = {one: WriteResult(**result) for one, result in value["made"].items()}
                    self.splits.append(value["split"])
                    self.entries.append(made)
            except (ValueError, KeyError, TypeError, AttributeError) as problem:
                path = f"{store.storage.shown}/{NOTES_FOLDER}/{name}"
                raise RecordingError(f"{path} cannot be used: {problem}") from None
            self._names.append(name)
        self._noted = len(self.entries)

    def add(self, split: str, entry: Entry) -> None:
        """Add a frame whose files were written."""
        self.entries.append(entry)
        self.splits.append(split)
        if len(self.entries) - self._noted >= FRAMES_PER_NOTE:
            self.flush()

    def flush(self) -> None:
        """Bring the frames' files to the disk, and then a note of them."""
        if self._noted == len(self.entries):
            return
        lines = [
            json.dumps({"split": split, "made": {name: _plain(one) for name, one in entry.items()}})
            for split, entry in zip(
                self.splits[self._noted :], self.entries[self._noted :], strict=True
            )
        ]
        name = f"{self._noted:08d}.jsonl"
        self._store.note(f"{NOTES_FOLDER}/{name}", "".join(f"{one}\n" for one in lines).encode())
        self._names.append(name)
        self._noted = len(self.entries)

    def finish(self) -> None:
        """Remove notes and identity: the data set is finished."""
        # The last note first: after a break in between fewer frames are noted, and none wrongly.
        notes = [f"{NOTES_FOLDER}/{name}" for name in reversed(self._names)]
        self._store.finish([*notes, IDENTITY_FILE])


def _plain(result: WriteResult) -> Mapping[str, object]:
    return {
        "record": result.record,
        "written": dict(result.written),
        "left_out": dict(result.left_out),
    }
