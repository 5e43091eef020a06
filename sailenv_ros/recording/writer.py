"""Serialized messages → a bag folder: MCAP files, split by size or time, and `metadata.yaml`.

Images go into chunks of their own, so that what describes them can be read without unpacking
them. Used by one thread at a time. Knows no ROS.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mcap.records import Channel, Metadata, Schema

from sailenv_ros.errors import InvalidRequest, RecordingError
from sailenv_ros.recording.bag_metadata import FileSummary, metadata_text, write_metadata
from sailenv_ros.recording.mcap.chunks import Buffer, ChunkBuilder
from sailenv_ros.recording.mcap.file_writer import McapFile
from sailenv_ros.recording.topics import RecordedTopic, RecordingOptions

__all__ = ["RecordingWriter", "WriterStatistics", "check_free"]

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class WriterStatistics:
    """Counts of the messages and bytes that a writer has taken so far.

    Attributes
    ----------
    messages : int
    message_bytes : int
        Before compression [B].
    file_bytes : int
        Written to files [B].
    lost : int
        Messages that were taken and could not be kept, because the disk was full.
    """

    messages: int
    message_bytes: int
    file_bytes: int
    lost: int


class RecordingWriter:
    """A recording that is being written; a context manager.

    Parameters
    ----------
    folder : str or Path
        The bag; is made, must not exist. Its files are called after it.
    options : RecordingOptions

    Raises
    ------
    RecordingError
        If the folder exists or cannot be made.
    """

    def __init__(self, folder: str | Path, options: RecordingOptions | None = None) -> None:
        self.folder = Path(folder)
        self._options = options or RecordingOptions()
        self._topics: dict[str, RecordedTopic] = {}
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._sequences: dict[str, int] = {}
        self._files: list[FileSummary] = []
        self._messages = 0
        self._message_bytes = 0
        self._closed_bytes = 0
        self._lost = 0
        self._began_ns: int | None = None
        self._bulky = ChunkBuilder(self._options.compression)
        self._small = ChunkBuilder(self._options.compression)
        self._pending = {id(self._bulky): 0, id(self._small): 0}
        self._failed = False
        self._closed = False
        self._problem: RecordingError | None = None
        _make_folder(self.folder)
        self._file = McapFile(self._path(0))

    @property
    def topics(self) -> tuple[RecordedTopic, ...]:
        """Every topic that was added."""
        return tuple(self._topics.values())

    @property
    def statistics(self) -> WriterStatistics:
        """Counts of the messages and bytes taken so far."""
        return WriterStatistics(
            messages=self._messages,
            message_bytes=self._message_bytes,
            file_bytes=self._closed_bytes + (0 if self._closed else self._file.size),
            lost=self._lost,
        )

    def add_topic(self, topic: RecordedTopic) -> None:
        """Make a topic known; a second time with the same type it does nothing.

        Raises
        ------
        InvalidRequest
            If it is known with another type.
        """
        known = self._topics.get(topic.name)
        if known is not None:
            if known.type != topic.type:
                raise InvalidRequest(f"type of {topic.name}", topic.type, repr(known.type))
            return
        self._topics[topic.name] = topic

    def write(
        self, topic: str, parts: Sequence[Buffer], log_ns: int, publish_ns: int | None = None
    ) -> None:
        """Take one message.

        Parameters
        ----------
        topic : str
            One that was added.
        parts : sequence of buffers
            The message in CDR, cut anywhere; not to be changed any more.
        log_ns, publish_ns : int
            When it was recorded, and when it was sent if that is another time [ns].

        Raises
        ------
        RecordingError
            If it cannot be written; everything that was written before is kept and readable.
        """
        if self._closed or self._failed:
            raise RecordingError(f"the recording {self.folder} has ended")
        spec = self._topics[topic]
        builder = self._bulky if spec.bulky else self._small
        if self._began_ns is None:
            self._began_ns = log_ns
        if self._split_due(log_ns):
            self._split(log_ns)
        sequence = self._sequences.get(topic, 0) + 1
        self._sequences[topic] = sequence
        sent_ns = log_ns if publish_ns is None else publish_ns
        builder.add(self._channel(spec), sequence & 0xFFFFFFFF, log_ns, sent_ns, parts)
        self._messages += 1
        self._message_bytes += sum(map(len, parts))
        self._pending[id(builder)] += 1
        if builder.size >= self._options.chunk_bytes:
            self.flush()

    def flush(self) -> None:
        """Write what is gathered, as chunks."""
        for builder in (self._bulky, self._small):
            if builder.size:
                pending, self._pending[id(builder)] = self._pending[id(builder)], 0
                try:
                    self._file.add_chunk(builder.seal())
                except RecordingError:
                    self._failed = True
                    self._lost += pending
                    raise

    def close(self) -> None:
        """Finish the file and write `metadata.yaml`; a second call does nothing.

        Raises
        ------
        RecordingError
            If the last of it could not be written; the files are readable even then.
        """
        if self._closed:
            return
        self._closed = True
        if not self._failed:
            try:
                self.flush()
            except RecordingError as error:
                self._problem = self._problem or error
        for builder in (self._bulky, self._small):
            # Gathered after the disk was full.
            self._lost += self._pending[id(builder)]
        self._finish_file()
        write_metadata(self.folder, self.topics, self._files)
        if self._problem is not None:
            raise self._problem

    def __enter__(self) -> RecordingWriter:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    # -- inside ----------------------------------------------------------------------------

    def _path(self, number: int) -> Path:
        return self.folder / f"{self.folder.resolve().name}_{number}.mcap"

    def _channel(self, topic: RecordedTopic) -> int:
        """Return the channel's number in the present file; write its schema where it is new."""
        number = self._channels.get(topic.name)
        if number is not None:
            return number
        try:
            if topic.type not in self._schemas:
                self._schemas[topic.type] = len(self._schemas) + 1
                self._file.add_schema(_schema(topic, self._schemas[topic.type]))
            number = len(self._channels) + 1
            self._file.add_channel(_channel(topic, number, self._schemas[topic.type]))
        except RecordingError:
            self._failed = True
            raise
        self._channels[topic.name] = number
        return number

    def _split_due(self, log_ns: int) -> bool:
        options = self._options
        size = self._file.size + self._bulky.size + self._small.size
        by_size = options.split_bytes and size >= options.split_bytes
        covered_ns = log_ns - (self._began_ns or 0)
        by_time = options.split_s and covered_ns >= options.split_s * 1e9
        return bool(by_size or by_time) and bool(self._channels)

    def _split(self, log_ns: int) -> None:
        self.flush()
        self._finish_file()
        self._channels.clear()
        self._schemas.clear()
        self._began_ns = log_ns
        try:
            self._file = McapFile(self._path(len(self._files)))
        except RecordingError:
            self._failed = True
            raise

    def _finish_file(self) -> None:
        if self._file.finished:
            return  # and the next one could not be begun
        try:
            self._file.add_metadata(self._embedded())
        except RecordingError as problem:
            _log.warning("%s", problem)  # readers of files do without it
        try:
            self._lost += self._file.finish()
        except RecordingError as problem:
            # The files are closed and described all the same; `close` tells of it.
            self._problem = self._problem or problem
        self._files.append(self._summary())
        self._closed_bytes += self._file.path.stat().st_size

    def _summary(self) -> FileSummary:
        """Return what is in the present file."""
        topics = {number: name for name, number in self._channels.items()}
        start_ns, end_ns = self._file.span_ns()
        counts = {topics[number]: count for number, count in self._file.counts().items()}
        return FileSummary(
            name=self._file.path.name, start_ns=start_ns, end_ns=end_ns, counts=counts
        )

    def _embedded(self) -> Metadata:
        """Return the bag's metadata as rosbag2 puts it into the file, for a file that is alone.

        It says what is in this file.
        """
        text = metadata_text(self.topics, [self._summary()])
        return Metadata(name="rosbag2", metadata={"serialized_metadata": text})


def check_free(folder: Path) -> None:
    """Refuse a recording's folder that is there already.

    Raises
    ------
    RecordingError
    """
    if os.path.lexists(folder):
        raise _exists_already(folder)


def _exists_already(folder: Path) -> RecordingError:
    return RecordingError(
        f"{folder} exists already; a recording is never overwritten, choose another name"
    )


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True)
    except FileExistsError:
        raise _exists_already(folder) from None
    except (OSError, ValueError) as problem:  # a NUL in the name is no OSError
        why = getattr(problem, "strerror", None) or str(problem)
        raise RecordingError(f"{str(folder)!r} cannot be made: {why}") from None


def _schema(topic: RecordedTopic, number: int) -> Schema:
    return Schema(id=number, name=topic.type, encoding="ros2msg", data=topic.schema.encode())


def _channel(topic: RecordedTopic, number: int, schema: int) -> Channel:
    metadata = {"offered_qos_profiles": topic.qos.yaml(), "topic_type_hash": topic.type_hash}
    return Channel(
        id=number, topic=topic.name, message_encoding="cdr", metadata=metadata, schema_id=schema
    )
