"""A damaged or unfinished MCAP file → a whole one with everything of it that is intact.

Goes through the file from its beginning and copies each chunk whose check sum is right, without
packing it again. Of a file that was cut off every complete chunk is kept.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import BinaryIO

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Schema

from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.mcap.chunks import MESSAGE_HEAD, ChunkBuilder, records_in, resealed
from sailenv_ros.recording.mcap.file_writer import MAGIC, McapFile

__all__ = ["Recovered", "recover_file"]

_HEAD_BYTES = 9
_LOOSE_BYTES = 2**20


@dataclass(frozen=True, slots=True, kw_only=True)
class Recovered:
    """Result of restoring one file.

    Attributes
    ----------
    path : Path
        The new file.
    kept : Path or None
        Where the damaged file is now; None if it was left where it is.
    messages : int
        How many were restored.
    lost_chunks : int
        Chunks that were there in part or damaged.
    unread_bytes : int
        Bytes behind the last place at which a record could be told [B].
    """

    path: Path
    kept: Path | None
    messages: int
    lost_chunks: int
    unread_bytes: int


def recover_file(path: Path, output: Path) -> Recovered:
    """Write everything of a file that is intact into a new one.

    Raises
    ------
    RecordingError
        If the file is no MCAP file, or the new one exists or cannot be written.
    """
    try:
        stream = path.open("rb")
    except OSError as problem:
        raise RecordingError(f"{path} cannot be read: {problem.strerror}") from None
    with stream:
        size = os.fstat(stream.fileno()).st_size
        if stream.read(len(MAGIC)) != MAGIC:
            raise RecordingError(f"{path} is no MCAP file; there is nothing to restore from")
        file = McapFile(output)
        try:
            copy = _Copy(file)
            end = copy.take_all(stream, size)
            file.finish()
        except BaseException:
            file.abandon()
            raise
    return Recovered(
        path=output,
        kept=None,
        messages=file.message_count,
        lost_chunks=copy.lost_chunks,
        unread_bytes=size - end,
    )


class _Copy:
    """Takes records of a damaged file over into a new one."""

    def __init__(self, file: McapFile) -> None:
        self._file = file
        self._schemas: set[int] = set()
        self._channels: set[int] = set()
        self._loose = ChunkBuilder("zstd")
        self.lost_chunks = 0

    def take_all(self, stream: BinaryIO, size: int) -> int:
        """Take every record that is whole; return where the last of them ends."""
        end = len(MAGIC)
        for opcode, record, after in _records(stream, size):
            if opcode in (Opcode.DATA_END, Opcode.FOOTER):
                end = size
                break
            try:
                self._take(opcode, record)
            except _BadRecord:
                self.lost_chunks += 1
            end = after
        else:
            # What follows is a record that was cut off; nearly always it was a chunk.
            self.lost_chunks += end < size
        self._flush()
        return end

    def _take(self, opcode: int, record: bytes) -> None:
        if opcode == Opcode.CHUNK:
            self._take_chunk(record[_HEAD_BYTES:])
        elif opcode == Opcode.MESSAGE:
            _, _, channel, sequence, log_ns, publish_ns = MESSAGE_HEAD.unpack_from(record)
            if channel not in self._channels:
                raise _BadRecord
            self._loose.add(channel, sequence, log_ns, publish_ns, (record[MESSAGE_HEAD.size :],))
            if self._loose.size >= _LOOSE_BYTES:
                self._flush()
        else:
            self._define(opcode, record[_HEAD_BYTES:])

    def _take_chunk(self, body: bytes) -> None:
        try:
            sealed, data = resealed(body)
        except RecordingError:
            raise _BadRecord from None
        for record in records_in(data):
            self._define(record.opcode, bytes(data[record.start + _HEAD_BYTES : record.end]))
        if not set(sealed.counts) <= self._channels:
            raise _BadRecord
        self._file.add_chunk(sealed)

    def _define(self, opcode: int, body: bytes) -> None:
        """Take a schema or a channel over, where it is new."""
        try:
            if opcode == Opcode.SCHEMA:
                schema = Schema.read(ReadDataStream(BytesIO(body)))
                if schema.id not in self._schemas:
                    self._file.add_schema(schema)
                    self._schemas.add(schema.id)
            elif opcode == Opcode.CHANNEL:
                channel = Channel.read(ReadDataStream(BytesIO(body)))
                if channel.id not in self._channels:
                    self._file.add_channel(channel)
                    self._channels.add(channel.id)
        except (McapError, ValueError, OverflowError):
            raise _BadRecord from None

    def _flush(self) -> None:
        if self._loose.size:
            self._file.add_chunk(self._loose.seal())


class _BadRecord(Exception):
    """A record that cannot be taken over."""


def _records(stream: BinaryIO, size: int) -> Iterator[tuple[int, bytes, int]]:
    """Return opcode, bytes and end of each record up to the first that is cut off."""
    at = len(MAGIC)
    while at + _HEAD_BYTES <= size:
        stream.seek(at)
        head = stream.read(_HEAD_BYTES)
        end = at + _HEAD_BYTES + int.from_bytes(head[1:], "little")
        if head[0] == 0 or end > size:
            return
        yield head[0], head + stream.read(end - at - _HEAD_BYTES), end
        at = end
