"""Reads a client's bytes as they come into messages, and writes the pieces of answers.

Bytes in, `Message` out; no socket, no simulation. What a peer sends is bounded before it is kept:
a length over its limit ends the conversation when it is read, not when it has arrived.
"""

from __future__ import annotations

import codecs
import struct
from collections.abc import Generator, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from sailenv_ros.errors import ProtocolError
from sailenv_ros.gateway.protocol_commands import HELLO, CommandKind, Field, commands_of
from sailenv_ros.simulation.models.uploads import MAX_UPLOAD_BYTES

__all__ = [
    "MAX_DOCUMENT_LENGTH",
    "MAX_NAME_LENGTH",
    "Message",
    "MessageReader",
    "pack_floats",
    "pack_ints",
    "pack_string",
    "pack_strings",
]

MAX_NAME_LENGTH = 4096
"""Longest name of anything [characters]."""

MAX_DOCUMENT_LENGTH = 2**20
"""Longest JSON text [characters]."""

_Parsing: TypeAlias = Generator[int, bytes, Any]
"""Yields how many bytes it needs next and is sent exactly these."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Message:
    """One command of a client.

    Attributes
    ----------
    name : str
        Of its kind, see `commands`.
    fields : mapping of str to object
        By the kind's names: int, float, bool, str, bytes, or a tuple of three floats. Floats may
        be anything that 4 bytes can hold, NaN too.
    """

    name: str
    fields: Mapping[str, Any]


class MessageReader:
    """Turns one connection's bytes into messages; the first is the registration.

    Parameters
    ----------
    protocol : {'0.5', '0.6'}
    """

    def __init__(self, protocol: str) -> None:
        self._commands = commands_of(protocol)
        self._buffer = bytearray()
        self._parsing: _Parsing = _fields_of(HELLO)
        self._needed = next(self._parsing)
        self._idle = False

    @property
    def held_bytes(self) -> int:
        """Number of bytes that wait here for more, or to be taken."""
        return len(self._buffer)

    @property
    def is_idle(self) -> bool:
        """True between two messages, if none of the next has come."""
        return self._idle and not self._buffer

    def feed(self, data: bytes) -> None:
        """Take bytes as they came."""
        self._buffer += data

    def take(self) -> Message | None:
        """Return the next message if it is complete.

        Raises
        ------
        ProtocolError
            If the bytes are none; nothing can be read from this peer any more.
        """
        while len(self._buffer) >= self._needed:
            piece = bytes(memoryview(self._buffer)[: self._needed])
            del self._buffer[: self._needed]
            self._idle = False
            try:
                self._needed = self._parsing.send(piece)
            except StopIteration as done:
                message: Message = done.value
                self._parsing = self._next_message()
                self._needed = next(self._parsing)
                self._idle = True
                return message
        return None

    def _next_message(self) -> _Parsing:
        byte = (yield 1)[0]
        if byte not in self._commands:
            raise ProtocolError(f"the byte {byte:#04x} is no command of this protocol's revision")
        return (yield from _fields_of(self._commands[byte]))


def _fields_of(kind: CommandKind) -> _Parsing:
    values: dict[str, Any] = {}
    for name, field in kind.fields:
        values[name] = yield from _value(f"{name} of {kind.name}", field)
    if kind.extra and values[kind.fields[-1][0]]:
        for name, field in kind.extra:
            values[name] = yield from _value(f"{name} of {kind.name}", field)
    return Message(name=kind.name, fields=values)


def _value(what: str, field: Field) -> _Parsing:
    if field is Field.BYTE:
        return (yield 1)[0]
    if field is Field.BOOL:
        return (yield 1)[0] != 0
    if field is Field.INT:
        return struct.unpack("<i", (yield 4))[0]
    if field is Field.FLOAT:
        return struct.unpack("<f", (yield 4))[0]
    if field is Field.VECTOR:
        return struct.unpack("<3f", (yield 12))
    if field is Field.FILE:
        length = yield from _length(what, MAX_UPLOAD_BYTES, "bytes")
        return (yield length) if length else b""
    limit = MAX_DOCUMENT_LENGTH if field is Field.DOCUMENT else MAX_NAME_LENGTH
    return (yield from _text(what, limit))


def _length(what: str, limit: int, unit: str) -> _Parsing:
    length = struct.unpack("<i", (yield 4))[0]
    if not 0 <= length <= limit:
        raise ProtocolError(f"the {what} must have from 0 to {limit} {unit}, got {length}")
    return length


def _text(what: str, limit: int) -> _Parsing:
    """Read a text whose length is told in characters, as the SAILenv client tells it."""
    length = yield from _length(what, limit, "characters")
    decoder = codecs.getincrementaldecoder("utf-8")()
    text = ""
    while len(text) < length:
        # Each character that is missing has at least one byte that is missing.
        piece = yield length - len(text)
        try:
            text += decoder.decode(piece)
        except UnicodeDecodeError as error:
            raise ProtocolError(f"the {what} is not UTF-8 ({error.reason})") from None
    return text


def pack_ints(*values: int) -> bytes:
    """Write integers of 4 bytes."""
    return struct.pack(f"<{len(values)}i", *values)


def pack_floats(*values: float) -> bytes:
    """Write floats of 4 bytes."""
    return struct.pack(f"<{len(values)}f", *values)


def pack_string(text: str) -> bytes:
    """Write a text, its length in bytes before it, which is how clients read."""
    data = text.encode("utf-8", errors="replace")
    return pack_ints(len(data)) + data


def pack_strings(texts: Iterable[str]) -> bytes:
    """Write a list of texts, their number before them."""
    packed = [pack_string(text) for text in texts]
    return pack_ints(len(packed)) + b"".join(packed)
