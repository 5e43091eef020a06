"""Keeps the last seconds of what is recorded in memory, and writes them when somebody asks.

Messages in, from any thread; a bag for each request out. Of topics whose last message counts for
late subscribers, the last one before the kept seconds is kept too. Knows no ROS.
"""

from __future__ import annotations

import threading
from collections import deque
from pathlib import Path
from typing import NamedTuple

from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.topics import RecordedTopic, RecordingOptions
from sailenv_ros.recording.writer import RecordingWriter, WriterStatistics

__all__ = ["SnapshotBuffer"]


class _Entry(NamedTuple):
    topic: str
    data: bytes
    log_ns: int


class SnapshotBuffer:
    """The last seconds of several topics.

    Parameters
    ----------
    folder : Path
        The bags are called after it: ``folder_0``, ``folder_1``, …
    options : RecordingOptions
    keep_s : float
        How much of the past is kept [s].
    limit_bytes : int
        How many bytes at most, whatever time they cover [B].
    """

    def __init__(
        self, folder: Path, options: RecordingOptions, *, keep_s: float, limit_bytes: int
    ) -> None:
        self._folder = folder
        self._options = options
        self._keep_ns = round(keep_s * 1e9)
        self._limit_bytes = limit_bytes
        self._lock = threading.Lock()
        self._topics: dict[str, RecordedTopic] = {}
        self._entries: deque[_Entry] = deque()
        self._latched: dict[str, _Entry] = {}
        self._bytes = 0
        self._latest_ns = 0
        self._taken = 0
        self._taken_bytes = 0
        self._file_bytes = 0
        self.written: list[Path] = []
        self.dropped = 0
        self.failure: RecordingError | None = None

    @property
    def statistics(self) -> WriterStatistics:
        """Counts of the messages and bytes taken so far, and of the bytes that lie in files."""
        return WriterStatistics(
            messages=self._taken,
            message_bytes=self._taken_bytes,
            file_bytes=self._file_bytes,
            lost=0,
        )

    def add_topic(self, topic: RecordedTopic) -> None:
        """Make a topic known, before its first message."""
        with self._lock:
            self._topics[topic.name] = topic

    def put(self, topic: str, data: bytes, log_ns: int) -> None:
        """Take a message, and forget those that are too old or too many."""
        with self._lock:
            self._entries.append(_Entry(topic, data, log_ns))
            self._bytes += len(data)
            self._taken += 1
            self._taken_bytes += len(data)
            self._latest_ns = max(self._latest_ns, log_ns)
            oldest_ns = self._latest_ns - self._keep_ns
            while self._entries[0].log_ns < oldest_ns or self._bytes > self._limit_bytes:
                self._forget_oldest()
                if not self._entries:
                    return

    def write(self) -> Path:
        """Write what is kept into a new bag; return its folder.

        Raises
        ------
        RecordingError
            If nothing is kept, or it cannot be written.
        """
        with self._lock:
            entries = [*self._latched.values(), *self._entries]
            topics = list(self._topics.values())
            number = len(self.written)
        if not entries:
            raise RecordingError("nothing has been recorded yet; there is nothing to write")
        start_ns = min((entry.log_ns for entry in self._entries), default=0)
        folder = self._free_folder(number)
        with RecordingWriter(folder, self._options) as writer:
            for topic in topics:
                writer.add_topic(topic)
            for entry in entries:
                # What was latched before counts from the beginning on.
                writer.write(entry.topic, (entry.data,), max(entry.log_ns, start_ns))
        with self._lock:
            self.written.append(folder)
            self._file_bytes += writer.statistics.file_bytes
        return folder

    def close(self) -> None:
        """Forget everything."""
        with self._lock:
            self._entries.clear()
            self._latched.clear()
            self._bytes = 0

    def _forget_oldest(self) -> None:
        oldest = self._entries.popleft()
        self._bytes -= len(oldest.data)
        if self._topics[oldest.topic].qos.durability == "transient_local":
            self._latched[oldest.topic] = oldest

    def _free_folder(self, number: int) -> Path:
        while True:
            folder = self._folder.with_name(f"{self._folder.name}_{number}")
            if not folder.exists():
                return folder
            number += 1
