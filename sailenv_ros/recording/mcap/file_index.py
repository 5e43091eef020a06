"""One MCAP file → where each of its messages lies, and its bytes.

Reads the summary and the message indexes; a file that has none of them but is whole is walked
through. A file that was not finished is refused by name of the command that repairs it.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections import OrderedDict
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import BinaryIO

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import SeekingReader
from mcap.records import Channel, ChunkIndex, MessageIndex, Schema
from numpy.typing import NDArray

from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.mcap.chunks import MESSAGE_HEAD, records_in, unpacked
from sailenv_ros.recording.mcap.file_writer import MAGIC

__all__ = ["ENTRY", "FileIndex", "RawMessage", "damaged"]

ENTRY = np.dtype([("log_ns", "<u8"), ("channel", "<u2"), ("chunk", "<i4"), ("offset", "<u8")])
"""One message: when, of which channel, in which chunk (-1: in none), where within it."""

_FOOTER = struct.Struct("<BQQQI")
_HEAD_BYTES = 9
_OUTSIDE = -1


@dataclass(frozen=True, slots=True, kw_only=True)
class RawMessage:
    """One message as it lies in the file.

    Attributes
    ----------
    log_ns, publish_ns : int
        When it was recorded and sent [ns].
    sequence : int
    data : memoryview
        Its bytes; they stay as they are.
    """

    log_ns: int
    publish_ns: int
    sequence: int
    data: memoryview


class FileIndex:
    """One file, opened to be read; used by one thread at a time.

    Parameters
    ----------
    path : Path
    cache_bytes : int
        How many bytes of unpacked chunks are kept, at least one chunk [B].

    Raises
    ------
    RecordingError
        If it cannot be read, is no MCAP file, or was not finished.
    """

    def __init__(self, path: Path, *, cache_bytes: int = 2**26) -> None:
        self.path = path
        self._cache_bytes = cache_bytes
        self._cache: OrderedDict[int, memoryview] = OrderedDict()
        self._chunks: list[tuple[int, int]] = []
        self._stream = _open(path)
        self._size = os.fstat(self._stream.fileno()).st_size
        try:
            self._check_ends()
            self.schemas, self.channels, self.entries = self._read_index()
        except (McapError, struct.error, ValueError, KeyError, OverflowError, OSError) as problem:
            self.close()
            raise damaged(path, str(problem) or type(problem).__name__) from None
        except RecordingError as problem:
            self.close()
            raise problem if str(path) in str(problem) else damaged(path, str(problem)) from None

    def message(self, entry: np.void) -> RawMessage:
        """Read the message of an entry.

        Raises
        ------
        RecordingError
            If its chunk is damaged.
        """
        chunk, offset = int(entry["chunk"]), int(entry["offset"])
        data = self._outside(offset) if chunk == _OUTSIDE else self._chunk(chunk)
        at = 0 if chunk == _OUTSIDE else offset
        if at + MESSAGE_HEAD.size > len(data):
            raise damaged(self.path, "an index points beyond its chunk")
        opcode, length, channel, sequence, log_ns, publish_ns = MESSAGE_HEAD.unpack_from(data, at)
        # Indexes have no check sum of their own.
        if (opcode, channel, log_ns) != (Opcode.MESSAGE, entry["channel"], entry["log_ns"]):
            raise damaged(self.path, "an index points to another message than it says")
        body = data[at + MESSAGE_HEAD.size : at + _HEAD_BYTES + length]
        return RawMessage(log_ns=log_ns, publish_ns=publish_ns, sequence=sequence, data=body)

    def close(self) -> None:
        """Close the file; a second call does nothing."""
        self._cache.clear()
        self._stream.close()

    # -- bytes -----------------------------------------------------------------------------

    def _chunk(self, number: int) -> memoryview:
        if number in self._cache:
            self._cache.move_to_end(number)
            return self._cache[number]
        start, length = self._chunks[number]
        record = self._read(start + _HEAD_BYTES, length - _HEAD_BYTES)
        try:
            data = memoryview(unpacked(record))
        except RecordingError as problem:
            raise damaged(self.path, str(problem)) from None
        self._cache[number] = data
        while len(self._cache) > 1 and sum(map(len, self._cache.values())) > self._cache_bytes:
            self._cache.popitem(last=False)
        return data

    def _outside(self, offset: int) -> memoryview:
        length = int.from_bytes(self._read(offset + 1, 8), "little")
        return memoryview(self._read(offset, _HEAD_BYTES + length))

    def _read(self, start: int, length: int) -> bytes:
        # Where a record says that it is longer than any file, there is nothing to seek either.
        if not 0 <= length <= self._size - start:
            raise damaged(self.path, "it is shorter than its index says")
        self._stream.seek(start)
        data = self._stream.read(length)
        if len(data) != length:
            raise damaged(self.path, "it is shorter than its index says")
        return data

    # -- the index -------------------------------------------------------------------------

    def _check_ends(self) -> None:
        size = self._size
        if size < len(MAGIC) or self._read(0, len(MAGIC)) != MAGIC:
            raise RecordingError(f"{self.path} is no MCAP file")
        if size < 2 * len(MAGIC) or self._read(size - len(MAGIC), len(MAGIC)) != MAGIC:
            raise damaged(self.path, "it was not finished")
        self._check_summary(size - len(MAGIC))

    def _check_summary(self, end: int) -> None:
        footer = self._read(max(0, end - _FOOTER.size), min(end, _FOOTER.size))
        if len(footer) < _FOOTER.size or footer[0] != Opcode.FOOTER:
            raise damaged(self.path, "its footer is not where it should be")
        _, _, start, _, crc = _FOOTER.unpack(footer)
        # The sum covers everything from the summary on, up to where it stands itself.
        if start >= end:
            raise damaged(self.path, "its summary is not where its footer says")
        if start and crc and zlib.crc32(self._read(start, end - 4 - start)) != crc:
            raise damaged(self.path, "the check sum of its summary is wrong")

    def _read_index(self) -> tuple[dict[int, Schema], dict[int, Channel], NDArray[np.void]]:
        self._stream.seek(0)
        summary = SeekingReader(self._stream).get_summary()
        statistics = None if summary is None else summary.statistics
        if summary is None or statistics is None or not summary.channels:
            return self._walk()
        parts = [self._entries_of(index) for index in summary.chunk_indexes]
        if statistics.message_count != sum(map(len, parts)):
            return self._walk()  # messages outside chunks, or chunks without indexes
        return summary.schemas, summary.channels, _joined(parts)

    def _entries_of(self, index: ChunkIndex) -> NDArray[np.void]:
        """Read a chunk's message indexes, which lie behind it."""
        number = len(self._chunks)
        self._chunks.append((index.chunk_start_offset, index.chunk_length))
        data = self._read(index.chunk_start_offset + index.chunk_length, index.message_index_length)
        parts = []
        for record in records_in(data):
            if record.opcode == Opcode.MESSAGE_INDEX:
                body = data[record.start + _HEAD_BYTES : record.end]
                found = MessageIndex.read(ReadDataStream(BytesIO(body)))
                # What says which channel it is of has no check sum, what names them all has one.
                if found.channel_id in index.message_index_offsets:
                    parts.append(_entries(found.channel_id, number, found.records))
        return _joined(parts)

    def _walk(self) -> tuple[dict[int, Schema], dict[int, Channel], NDArray[np.void]]:
        """Make the index of a whole file by going through all of it."""
        self._chunks = []
        schemas: dict[int, Schema] = {}
        channels: dict[int, Channel] = {}
        parts: list[NDArray[np.void]] = []
        at = len(MAGIC)
        while True:
            head = self._read(at, _HEAD_BYTES)
            opcode, length = head[0], int.from_bytes(head[1:], "little")
            if opcode in (Opcode.DATA_END, Opcode.FOOTER):
                return schemas, channels, _joined(parts)
            if opcode == Opcode.CHUNK:
                number = len(self._chunks)
                self._chunks.append((at, _HEAD_BYTES + length))
                data = self._chunk(number)
                for record in records_in(data):
                    body = bytes(data[record.start : record.end]) if record.opcode != 5 else b""
                    _take_definition(body, schemas, channels)
                    if record.opcode == Opcode.MESSAGE:
                        parts.append(_entry_at(data, record.start, number, record.start))
            elif opcode == Opcode.MESSAGE:
                parts.append(_entry_at(self._read(at, MESSAGE_HEAD.size), 0, _OUTSIDE, at))
            elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                _take_definition(self._read(at, _HEAD_BYTES + length), schemas, channels)
            at += _HEAD_BYTES + length


def damaged(path: Path, why: str) -> RecordingError:
    """Return the error of a file that has to be repaired first."""
    return RecordingError(
        f"{path} is damaged ({why}); `sailenv bag recover {path}` restores what is whole of it"
    )


def _open(path: Path) -> BinaryIO:
    try:
        return path.open("rb")
    except OSError as problem:
        raise RecordingError(f"{path} cannot be read: {problem.strerror}") from None


def _entries(channel: int, chunk: int, records: list[tuple[int, int]]) -> NDArray[np.void]:
    result = np.empty(len(records), ENTRY)
    result["channel"], result["chunk"] = channel, chunk
    result["log_ns"] = [log_ns for log_ns, _ in records]
    result["offset"] = [offset for _, offset in records]
    return result


def _entry_at(data: bytes | memoryview, at: int, chunk: int, offset: int) -> NDArray[np.void]:
    _, _, channel, _, log_ns, _ = MESSAGE_HEAD.unpack_from(data, at)
    return _entries(channel, chunk, [(log_ns, offset)])


def _joined(parts: list[NDArray[np.void]]) -> NDArray[np.void]:
    return np.concatenate(parts) if parts else np.empty(0, ENTRY)


def _take_definition(
    record: bytes, schemas: dict[int, Schema], channels: dict[int, Channel]
) -> None:
    if record[:1] == bytes([Opcode.SCHEMA]):
        schema = Schema.read(ReadDataStream(BytesIO(record[_HEAD_BYTES:])))
        schemas[schema.id] = schema
    elif record[:1] == bytes([Opcode.CHANNEL]):
        channel = Channel.read(ReadDataStream(BytesIO(record[_HEAD_BYTES:])))
        channels[channel.id] = channel
