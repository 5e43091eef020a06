"""Messages → one sealed chunk of an MCAP file, with the indexes of its messages; and back.

The format is that of https://mcap.dev/spec. Images are compressed and summed from where they lie
and never copied into one piece. Knows no file.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import lz4.frame
import zstandard
from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Chunk, MessageIndex

from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.mcap import Compression

__all__ = [
    "MESSAGE_HEAD",
    "Buffer",
    "ChunkBuilder",
    "ChunkRecord",
    "SealedChunk",
    "records_in",
    "resealed",
    "seal_records",
    "unpacked",
]

Buffer = bytes | bytearray | memoryview
"""Bytes that are looked at where they are."""

MESSAGE_HEAD = struct.Struct("<BQHIQQ")
"""A message's opcode and length; its channel, sequence, log time, publish time [ns]."""

_RECORD_HEAD = struct.Struct("<BQ")
_CHUNK_HEAD = struct.Struct("<QQQI")
_ZSTD_LEVEL = 1

LARGEST_CHUNK_BYTES = 2**31
"""A chunk that says that it holds more is refused; writers make chunks of some megabytes [B]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SealedChunk:
    """A chunk ready to be written.

    Attributes
    ----------
    head : bytes
        The record up to the compressed data.
    data : tuple of buffers
        The compressed data, in pieces.
    indexes : tuple of (int, bytes)
        A message index record for each channel, by the channel's number.
    compression : str
    start_ns, end_ns : int
        Earliest and latest log time [ns].
    uncompressed_bytes, compressed_bytes : int
    counts : dict of int to int
        How many messages each channel has in it.
    """

    head: bytes
    data: tuple[Buffer, ...]
    indexes: tuple[tuple[int, bytes], ...]
    compression: str
    start_ns: int
    end_ns: int
    uncompressed_bytes: int
    compressed_bytes: int
    counts: dict[int, int]

    @property
    def chunk_length(self) -> int:
        """Length of the chunk record [B]."""
        return len(self.head) + self.compressed_bytes


class ChunkBuilder:
    """Gathers messages until they are sealed.

    Parameters
    ----------
    compression : {'zstd', 'lz4', 'none'}
    """

    def __init__(self, compression: Compression) -> None:
        self._compression = compression
        self._parts: list[Buffer] = []
        self._indexes: dict[int, list[tuple[int, int]]] = {}
        self.size = 0

    def add(
        self, channel: int, sequence: int, log_ns: int, publish_ns: int, parts: Sequence[Buffer]
    ) -> None:
        """Take a message, whose bytes must not change until the chunk is sealed."""
        length = sum(map(len, parts))
        body = MESSAGE_HEAD.size - _RECORD_HEAD.size + length
        head = MESSAGE_HEAD.pack(Opcode.MESSAGE, body, channel, sequence, log_ns, publish_ns)
        self._indexes.setdefault(channel, []).append((log_ns, self.size))
        self._parts += (head, *parts)
        self.size += len(head) + length

    def seal(self) -> SealedChunk:
        """Compress everything and begin the next chunk."""
        sealed = seal_records(self._parts, self._indexes, self._compression)
        self._parts, self._indexes, self.size = [], {}, 0
        return sealed


def seal_records(
    parts: Sequence[Buffer],
    indexes: dict[int, list[tuple[int, int]]],
    compression: Compression,
) -> SealedChunk:
    """Make a chunk of records that are already in their binary form.

    Parameters
    ----------
    parts : sequence of buffers
        The records one after another, cut anywhere.
    indexes : dict of int to list of (int, int)
        Log time [ns] and offset of each message, by channel.
    compression : {'zstd', 'lz4', 'none'}
    """
    crc = 0
    for part in parts:
        crc = zlib.crc32(part, crc)
    data = _COMPRESSORS[compression](parts)
    size, packed = sum(map(len, parts)), sum(map(len, data))
    times = [log_ns for entries in indexes.values() for log_ns, _ in entries]
    start_ns, end_ns = min(times, default=0), max(times, default=0)
    name = b"" if compression == "none" else compression.encode()
    length = _CHUNK_HEAD.size + 4 + len(name) + 8 + packed
    head = (
        _RECORD_HEAD.pack(Opcode.CHUNK, length)
        + _CHUNK_HEAD.pack(start_ns, end_ns, size, crc)
        + struct.pack("<I", len(name))
        + name
        + struct.pack("<Q", packed)
    )
    return SealedChunk(
        head=head,
        data=data,
        indexes=tuple((channel, _index_record(channel, e)) for channel, e in indexes.items()),
        compression=name.decode(),
        start_ns=start_ns,
        end_ns=end_ns,
        uncompressed_bytes=size,
        compressed_bytes=packed,
        counts={channel: len(entries) for channel, entries in indexes.items()},
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ChunkRecord:
    """One record within a chunk's unpacked bytes.

    Attributes
    ----------
    opcode : int
    start, end : int
        Where it lies; `start` is that of its opcode.
    """

    opcode: int
    start: int
    end: int


def records_in(data: Buffer) -> Iterator[ChunkRecord]:
    """Walk over the records of an unpacked chunk.

    Raises
    ------
    RecordingError
        If a record ends beyond the data.
    """
    at = 0
    while at < len(data):
        if at + _RECORD_HEAD.size > len(data):
            raise RecordingError("a record within a chunk is cut off")
        opcode, length = _RECORD_HEAD.unpack_from(data, at)
        end = at + _RECORD_HEAD.size + length
        if end > len(data):
            raise RecordingError("a record within a chunk is cut off")
        yield ChunkRecord(opcode=opcode, start=at, end=end)
        at = end


def unpacked(body: bytes) -> bytes:
    """Return the records of a chunk, checked by their sum.

    Parameters
    ----------
    body : bytes
        The chunk record behind its opcode and length.

    Raises
    ------
    RecordingError
        If they cannot be unpacked or the sum is wrong.
    """
    return _unpacked(_chunk(body))


def resealed(body: bytes) -> tuple[SealedChunk, bytes]:
    """Take a chunk out of a file as it is, with indexes made from its messages.

    Parameters
    ----------
    body : bytes
        The chunk record behind its opcode and length.

    Returns
    -------
    sealed : SealedChunk
    data : bytes
        Its records, unpacked.

    Raises
    ------
    RecordingError
        If it is damaged.
    """
    chunk = _chunk(body)
    data = _unpacked(chunk)
    indexes: dict[int, list[tuple[int, int]]] = {}
    for record in records_in(data):
        if record.opcode == Opcode.MESSAGE:
            if record.end - record.start < MESSAGE_HEAD.size:
                raise RecordingError("a message within a chunk is cut off")
            _, _, channel, _, log_ns, _ = MESSAGE_HEAD.unpack_from(data, record.start)
            indexes.setdefault(channel, []).append((log_ns, record.start))
    packed = len(chunk.data)
    sealed = SealedChunk(
        head=_RECORD_HEAD.pack(Opcode.CHUNK, len(body)) + body[: len(body) - packed],
        data=(body[len(body) - packed :],),
        indexes=tuple((channel, _index_record(channel, e)) for channel, e in indexes.items()),
        compression=chunk.compression,
        start_ns=chunk.message_start_time,
        end_ns=chunk.message_end_time,
        uncompressed_bytes=chunk.uncompressed_size,
        compressed_bytes=packed,
        counts={channel: len(entries) for channel, entries in indexes.items()},
    )
    return sealed, data


def _chunk(body: bytes) -> Chunk:
    try:
        return Chunk.read(ReadDataStream(BytesIO(body)))
    except (McapError, struct.error, ValueError, OverflowError) as problem:
        raise RecordingError(f"a chunk cannot be read: {problem}") from None


def _unpacked(chunk: Chunk) -> bytes:
    unpack = _DECOMPRESSORS.get(chunk.compression)
    if unpack is None:
        known = ", ".join(repr(name) for name in _DECOMPRESSORS)
        raise RecordingError(f"a chunk's compression must be one of {known}: {chunk.compression!r}")
    if chunk.uncompressed_size > LARGEST_CHUNK_BYTES:
        raise RecordingError(
            f"a chunk says that it holds {chunk.uncompressed_size} bytes, and "
            f"{LARGEST_CHUNK_BYTES} are accepted"
        )
    try:
        data = unpack(chunk)
    except (zstandard.ZstdError, RuntimeError, ValueError, MemoryError) as problem:
        raise RecordingError(f"a chunk cannot be unpacked: {problem}") from None
    if len(data) != chunk.uncompressed_size:
        raise RecordingError("a chunk has not the size that it says")
    if chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc:
        raise RecordingError("a chunk's check sum is wrong")
    return data


def _index_record(channel: int, entries: list[tuple[int, int]]) -> bytes:
    builder = RecordBuilder()
    MessageIndex(channel_id=channel, records=entries).write(builder)
    return bytes(builder.end())


def _zstd(parts: Sequence[Buffer]) -> tuple[Buffer, ...]:
    size = sum(map(len, parts))
    packer = zstandard.ZstdCompressor(level=_ZSTD_LEVEL).compressobj(size=size)
    return (*(packer.compress(part) for part in parts), packer.flush())


def _lz4(parts: Sequence[Buffer]) -> tuple[Buffer, ...]:
    packer = lz4.frame.LZ4FrameCompressor()
    begun = packer.begin(sum(map(len, parts)))
    return (begun, *(packer.compress(part) for part in parts), packer.flush())


def _unpack_zstd(chunk: Chunk) -> bytes:
    return zstandard.ZstdDecompressor().decompress(chunk.data, chunk.uncompressed_size)


_COMPRESSORS: dict[str, Callable[[Sequence[Buffer]], tuple[Buffer, ...]]] = {
    "zstd": _zstd,
    "lz4": _lz4,
    "none": tuple,
}
_DECOMPRESSORS: dict[str, Callable[[Chunk], Any]] = {
    "zstd": _unpack_zstd,
    "lz4": lambda chunk: lz4.frame.decompress(chunk.data),
    "": lambda chunk: chunk.data,
}
