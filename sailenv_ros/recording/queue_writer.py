"""A thread between those who receive messages and the disk, with a bounded queue.

Messages in, from any thread; what does not fit is dropped and counted. Knows no ROS.
"""

from __future__ import annotations

import logging
import threading
from collections import deque
from typing import NamedTuple

from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.topics import RecordedTopic
from sailenv_ros.recording.writer import RecordingWriter, WriterStatistics

__all__ = ["QueueWriter"]

_log = logging.getLogger(__name__)


class _QueuedMessage(NamedTuple):
    topic: str
    data: bytes
    log_ns: int


class QueueWriter:
    """Writes in a thread of its own.

    Parameters
    ----------
    writer : RecordingWriter
        Owned from now on.
    limit_bytes : int
        How much may wait for the disk [B].
    """

    def __init__(self, writer: RecordingWriter, limit_bytes: int) -> None:
        self._writer = writer
        self._limit_bytes = limit_bytes
        self._queue: deque[_QueuedMessage] = deque()
        self._waiting_bytes = 0
        self._changed = threading.Condition()
        self._closing = False
        self._topics: deque[RecordedTopic] = deque()
        self.dropped = 0
        self.failure: RecordingError | None = None
        self._thread = threading.Thread(target=self._run, name="recording", daemon=True)
        self._thread.start()

    @property
    def statistics(self) -> WriterStatistics:
        """Counts of the messages and bytes written so far."""
        return self._writer.statistics

    def add_topic(self, topic: RecordedTopic) -> None:
        """Make a topic known, before its first message."""
        with self._changed:
            self._topics.append(topic)

    def put(self, topic: str, data: bytes, log_ns: int) -> None:
        """Take a message; it is dropped if too much is waiting or nothing can be written."""
        with self._changed:
            full = self._waiting_bytes + len(data) > self._limit_bytes and self._queue
            if full or self.failure is not None or self._closing:
                self.dropped += 1
                return
            self._queue.append(_QueuedMessage(topic, data, log_ns))
            self._waiting_bytes += len(data)
            self._changed.notify()

    def close(self) -> None:
        """Write what waits, and finish the recording.

        Raises
        ------
        RecordingError
            If it could not be written on, now or before; what was written is readable.
        """
        with self._changed:
            self._closing = True
            self._changed.notify()
        self._thread.join()
        try:
            self._writer.close()
        except RecordingError as problem:
            self.failure = self.failure or problem
        if self.failure is not None:
            raise self.failure

    def _run(self) -> None:
        while (batch := self._take()) is not None:
            topics, entries = batch
            try:
                for topic in topics:
                    self._writer.add_topic(topic)
                for number, entry in enumerate(entries):
                    self._write(entry, len(entries) - number)
            except RecordingError as problem:
                with self._changed:
                    self.failure = problem
                    self.dropped += len(self._queue)
                    self._queue.clear()
                return

    def _write(self, entry: _QueuedMessage, left: int) -> None:
        try:
            self._writer.write(entry.topic, (entry.data,), entry.log_ns)
        except RecordingError:
            # Those behind it in the batch go with it; the writer counts what it had taken.
            self.dropped += left - 1
            raise
        with self._changed:
            self._waiting_bytes -= len(entry.data)

    def _take(self) -> tuple[list[RecordedTopic], list[_QueuedMessage]] | None:
        """Wait for messages; None once all were given and no more will come."""
        with self._changed:
            while not self._queue and not self._closing:
                self._changed.wait()
            topics, entries = list(self._topics), list(self._queue)
            self._topics.clear()
            self._queue.clear()
            return (topics, entries) if entries or topics else None
