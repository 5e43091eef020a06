"""Writes what a client sends, for tests: the counterpart of the codec, after the protocol."""

from __future__ import annotations

import struct
from typing import Any

from hypothesis import strategies as st

from sailenv_ros.gateway.protocol_commands import CommandKind, Field

FLOATS = st.floats(width=32, allow_nan=False)

VALUES: dict[Field, st.SearchStrategy[Any]] = {
    Field.BYTE: st.integers(0, 255),
    Field.BOOL: st.booleans(),
    Field.INT: st.integers(-(2**31), 2**31 - 1),
    Field.FLOAT: FLOATS,
    Field.VECTOR: st.tuples(FLOATS, FLOATS, FLOATS),
    Field.NAME: st.text(max_size=40),
    Field.DOCUMENT: st.text(max_size=200),
    Field.FILE: st.binary(max_size=300),
}


def written(field: Field, value: Any) -> bytes:
    """Write a value as the SAILenv client does: a text's length is that of its characters."""
    if field in (Field.BYTE, Field.BOOL):
        return bytes([value])
    if field is Field.INT:
        return struct.pack("<i", value)
    if field is Field.FLOAT:
        return struct.pack("<f", value)
    if field is Field.VECTOR:
        return struct.pack("<3f", *value)
    data = value if isinstance(value, bytes) else value.encode()
    return struct.pack("<i", len(value)) + data


def command(byte: int, kind: CommandKind, values: dict[str, Any]) -> bytes:
    """Write a command with its fields."""
    fields = dict((*kind.fields, *kind.extra))
    return bytes([byte]) + b"".join(written(fields[name], values[name]) for name in values)


def hello(width: int = 64, height: int = 48, *, use_gzip: bool = False) -> bytes:
    """Write what a connection begins with."""
    return struct.pack("<iiB", width, height, use_gzip)


@st.composite
def messages(
    draw: st.DrawFn, commands: dict[int, CommandKind]
) -> tuple[bytes, str, dict[str, Any]]:
    """Return the bytes of some command, its name and its fields."""
    byte, kind = draw(st.sampled_from(sorted(commands.items(), key=lambda item: item[0])))
    values = {name: draw(VALUES[field]) for name, field in kind.fields}
    if kind.extra and values[kind.fields[-1][0]]:
        values |= {name: draw(VALUES[field]) for name, field in kind.extra}
    return command(byte, kind, values), kind.name, values
