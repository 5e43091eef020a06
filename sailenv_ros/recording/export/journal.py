"""What was written of a data set so far: lines of a file, by which a writer goes on after a break.

The first line says what is written, each other line is a frame. A line is there only when the
frame's files are on the disk.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.export.data_files import finish, write_errors
from sailenv_ros.recording.export.dataset_format import WriteResult

__all__ = ["JOURNAL", "Entry", "Journal"]

JOURNAL = "unfinished.jsonl"
"""The journal's name in the folder of a data set; it goes away when the data set is finished."""

FRAMES_PER_SYNC = 32

Entry = Mapping[str, WriteResult]
"""What each format made of one frame."""


class Journal:
    """The journal of one data set.

    Parameters
    ----------
    folder : Path
        Of the data set; it must be there.
    head : mapping
        What is written, as JSON: a journal with another head is refused.

    Attributes
    ----------
    splits : list of str
        Split of each frame that was written.
    entries : list of mapping of str to Made
        What was made of each, in their order.

    Raises
    ------
    RecordingError
        If there is a journal of something else, or it cannot be read or written.
    """

    def __init__(self, folder: Path, head: Mapping[str, Any]) -> None:
        self._folder = folder
        self._path = folder / JOURNAL
        self._waiting: list[str] = []
        self.entries: list[Entry] = []
        self.splits: list[str] = []
        text = json.dumps(head, sort_keys=True)
        try:
            if self._path.exists():
                self._read(text)
            else:
                self._append([text])
        except (OSError, ValueError, KeyError, TypeError, AttributeError) as problem:
            why = getattr(problem, "strerror", None) or str(problem)
            raise RecordingError(f"{self._path} cannot be used: {why}") from None

    def add(self, split: str, entry: Entry) -> None:
        """Note a frame whose files were written."""
        self.entries.append(entry)
        self.splits.append(split)
        made = {
            name: {
                "record": one.record,
                "written": dict(one.written),
                "left_out": dict(one.left_out),
            }
            for name, one in entry.items()
        }
        self._waiting.append(json.dumps({"split": split, "made": made}))
        if len(self._waiting) >= FRAMES_PER_SYNC:
            self.flush()

    def flush(self) -> None:
        """Bring the frames' files to the disk, and then what was noted of them."""
        if self._waiting:
            finish(self._folder)
            with write_errors(self._path):
                self._append(self._waiting)
            self._waiting = []

    def remove(self) -> None:
        """Remove the file: the data set is finished."""
        self._path.unlink(missing_ok=True)

    def _read(self, head: str) -> None:
        data = self._path.read_bytes()
        whole = data[: data.rfind(b"\n") + 1]
        lines = whole.decode().splitlines()
        if lines and lines[0] != head:
            raise RecordingError(
                f"{self._folder} was begun with other options ({lines[0]}); choose another folder"
            )
        for line in lines[1:]:
            value = json.loads(line)
            self.splits.append(value["split"])
            self.entries.append({name: WriteResult(**made) for name, made in value["made"].items()})
        if len(whole) != len(data):
            os.truncate(self._path, len(whole))
        if not lines:
            self._append([head])

    def _append(self, lines: Sequence[str]) -> None:
        with self._path.open("a", encoding="utf-8") as file:
            file.write("".join(f"{line}\n" for line in lines))
            file.flush()
            os.fsync(file.fileno())
