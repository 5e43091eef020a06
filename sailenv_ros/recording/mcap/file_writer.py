"""Sealed chunks → one MCAP file that is readable at every moment up to its last whole chunk.

Each chunk is given to the operating system at once, so that a killed process loses nothing of it.
When the disk is full the file is cut back to whole chunks and finished. Knows no topics' meaning.
"""

from __future__ import annotations

import errno
import io
import os
import zlib
from collections.abc import Sequence
from pathlib import Path

from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.mcap.chunks import Buffer, SealedChunk
from sailenv_ros.system.files import sync_folder

__all__ = ["MAGIC", "McapFile"]

MAGIC = b"\x89MCAP0\r\n"
"""First and last bytes of every file."""

PROFILE = "ros2"

_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


class McapFile:
    """One file that is being written.

    Parameters
    ----------
    path : Path
        Must not exist yet.

    Raises
    ------
    RecordingError
        If it cannot be made.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._chunks: list[ChunkIndex] = []
        self._counts: list[dict[int, int]] = []
        self._metadata: list[MetadataIndex] = []
        try:
            self._file = io.FileIO(path, "x")
            try:
                sync_folder(path.parent)
            except OSError:
                self.abandon()
                raise
        except OSError as problem:
            raise RecordingError(f"{path} cannot be written: {problem.strerror}") from None
        self._end = 0
        try:
            self._append((MAGIC, _bytes(Header(profile=PROFILE, library="sailenv_ros"))))
        except RecordingError:
            self.abandon()
            raise

    @property
    def size(self) -> int:
        """Bytes written so far."""
        return self._end

    @property
    def finished(self) -> bool:
        """True once the file was closed."""
        return self._file.closed

    @property
    def message_count(self) -> int:
        """Messages in the chunks that were written."""
        return sum(sum(counts.values()) for counts in self._counts)

    def counts(self) -> dict[int, int]:
        """Return the number of messages of each channel."""
        total = {channel.id: 0 for channel in self._channels}
        for counts in self._counts:
            for channel, count in counts.items():
                total[channel] = total.get(channel, 0) + count
        return total

    def span_ns(self) -> tuple[int, int]:
        """Return the earliest and the latest log time [ns]; zeros if there is no message."""
        filled = [chunk for chunk, counts in zip(self._chunks, self._counts, strict=True) if counts]
        starts = [chunk.message_start_time for chunk in filled]
        ends = [chunk.message_end_time for chunk in filled]
        return min(starts, default=0), max(ends, default=0)

    def add_schema(self, schema: Schema) -> None:
        """Write a schema, which channels refer to by its number."""
        self._append((_bytes(schema),))
        self._schemas.append(schema)

    def add_channel(self, channel: Channel) -> None:
        """Write a channel, which messages refer to by its number."""
        self._append((_bytes(channel),))
        self._channels.append(channel)

    def add_metadata(self, metadata: Metadata) -> None:
        """Write a named table of words."""
        record = _bytes(metadata)
        self._append((record,))
        index = MetadataIndex(
            offset=self._end - len(record), length=len(record), name=metadata.name
        )
        self._metadata.append(index)

    def add_chunk(self, chunk: SealedChunk) -> None:
        """Write a chunk and its indexes.

        Raises
        ------
        RecordingError
            If there is no room for it; the file is then as it was before.
        """
        start = self._end
        self._append((chunk.head, *chunk.data, *(record for _, record in chunk.indexes)))
        at = start + chunk.chunk_length
        offsets = {}
        for channel, record in chunk.indexes:
            offsets[channel] = at
            at += len(record)
        self._chunks.append(
            ChunkIndex(
                chunk_length=chunk.chunk_length,
                chunk_start_offset=start,
                compression=chunk.compression,
                compressed_size=chunk.compressed_bytes,
                message_end_time=chunk.end_ns,
                message_index_length=at - start - chunk.chunk_length,
                message_index_offsets=offsets,
                message_start_time=chunk.start_ns,
                uncompressed_size=chunk.uncompressed_bytes,
            )
        )
        self._counts.append(chunk.counts)

    def finish(self) -> int:
        """Write the summary and close; a second call does nothing.

        Returns
        -------
        lost : int
            Messages that had to be given up to make room for the summary on a full disk.

        Raises
        ------
        RecordingError
            If there was no room even without them, or the disk did not take the bytes to itself;
            the file is closed then.
        """
        lost = 0
        while not self._file.closed:
            try:
                self._append(self._ending())
            except RecordingError:
                if not self._chunks:
                    self._file.close()
                    raise
                lost += self._drop_last_chunk()
                continue
            try:
                os.fsync(self._file.fileno())
            except OSError as problem:
                raise RecordingError(
                    f"{self.path} is written, but the disk may not keep it: {problem.strerror}"
                ) from None
            finally:
                self._file.close()
        return lost

    def abandon(self) -> None:
        """Close and remove the file."""
        self._file.close()
        self.path.unlink(missing_ok=True)

    # -- inside ----------------------------------------------------------------------------

    def _drop_last_chunk(self) -> int:
        start = self._chunks.pop().chunk_start_offset
        # Whatever came after it goes too: the summary repeats schemas and channels.
        self._metadata = [index for index in self._metadata if index.offset < start]
        self._cut(start)
        return sum(self._counts.pop().values())

    def _append(self, parts: Sequence[Buffer]) -> None:
        try:
            for part in parts:
                self._write(memoryview(part))
        except OSError as problem:
            self._cut(self._end)
            why = "the disk is full" if problem.errno in _FULL else problem.strerror
            raise RecordingError(
                f"{self.path} cannot be written on: {why}; what was recorded before is kept"
            ) from None
        self._end += sum(map(len, parts))

    def _write(self, data: memoryview) -> None:
        while len(data):
            # A disk that fills up takes a part first and refuses the rest.
            data = data[self._file.write(data) or 0 :]

    def _cut(self, size: int) -> None:
        self._file.truncate(size)
        self._file.seek(size)
        self._end = size

    def _ending(self) -> list[bytes]:
        """Return everything behind the data: summary and footer."""
        data_end = _bytes(DataEnd(data_section_crc=0))
        summary_start = self._end + len(data_end)
        groups: list[tuple[Opcode, list[McapRecord]]] = [
            (Opcode.SCHEMA, [*self._schemas]),
            (Opcode.CHANNEL, [*self._channels]),
            (Opcode.STATISTICS, [self._statistics()]),
            (Opcode.CHUNK_INDEX, [*self._chunks]),
            (Opcode.METADATA_INDEX, [*self._metadata]),
        ]
        records: list[bytes] = []
        offsets: list[bytes] = []
        at = summary_start
        for opcode, group in groups:
            written = b"".join(map(_bytes, group))
            if written:
                place = SummaryOffset(
                    group_opcode=opcode, group_start=at, group_length=len(written)
                )
                offsets.append(_bytes(place))
            records.append(written)
            at += len(written)
        summary = b"".join([*records, *offsets])
        footer = _bytes(Footer(summary_start=summary_start, summary_offset_start=at, summary_crc=0))
        # The sum covers the footer too, up to where the sum itself stands.
        footer = footer[:-4] + zlib.crc32(summary + footer[:-4]).to_bytes(4, "little")
        return [data_end, summary, footer, MAGIC]

    def _statistics(self) -> Statistics:
        start_ns, end_ns = self.span_ns()
        return Statistics(
            attachment_count=0,
            channel_count=len(self._channels),
            channel_message_counts=self.counts(),
            chunk_count=len(self._chunks),
            message_count=self.message_count,
            message_end_time=end_ns,
            message_start_time=start_ns,
            metadata_count=len(self._metadata),
            schema_count=len(self._schemas),
        )


def _bytes(record: McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return bytes(builder.end())
