"""A glTF file → its description: the JSON that a `.glb` begins with, or that a `.gltf` is."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sailenv_ros.errors import AssetError

__all__ = ["GLB_HEAD_BYTES", "Description", "appended", "description_of", "glb_with"]

Description = dict[str, Any]

GLB_HEAD_BYTES = 20
"""Head of a binary file and of its first chunk [B]; the description follows."""

MOST_BYTES = 64 * 2**20
"""Largest description that is read [B]."""

_MAGIC = b"glTF"


def description_of(path: Path) -> tuple[Description, bytes]:
    """Read a file's description.

    Returns
    -------
    description : dict
        Of which nothing is certain but that it is JSON.
    rest : bytes
        Chunks that follow it in a binary file; empty for others.

    Raises
    ------
    AssetError
        If it is no glTF 2 file, or its description is no JSON object or too large.
    """
    data, rest = path.read_bytes(), b""
    if path.suffix.lower() == ".glb" or data.startswith(_MAGIC):
        if len(data) < GLB_HEAD_BYTES:
            raise AssetError(path.name, f"it has {len(data)} bytes, and no header")
        version, _, length = struct.unpack_from("<3I", data, 4)
        if (data[:4], version, data[16:20]) != (_MAGIC, 2, b"JSON"):
            raise AssetError(path.name, "it does not begin as a binary glTF 2 file does")
        end = GLB_HEAD_BYTES + length
        data, rest = data[GLB_HEAD_BYTES:end], data[end:]
    if len(data) > MOST_BYTES:
        raise AssetError(path.name, f"its description is larger than {MOST_BYTES // 2**20} MB")
    try:
        tree = json.loads(data)
    except (ValueError, RecursionError) as problem:
        raise AssetError(path.name, f"its description is no JSON ({problem})") from None
    if not isinstance(tree, dict):
        raise AssetError(path.name, "its description is no JSON object")
    return tree, rest


def appended(tree: Description, key: str, entry: Mapping[str, Any]) -> int:
    """Add an entry to a list of a description; return its number."""
    entries: list[Mapping[str, Any]] = tree.setdefault(key, [])
    entries.append(entry)
    return len(entries) - 1


def glb_with(tree: Description, rest: bytes) -> bytes:
    """Return a binary file of a description and the chunks that follow it."""
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    size = GLB_HEAD_BYTES + len(text) + len(rest)
    return _MAGIC + struct.pack("<3I", 2, size, len(text)) + b"JSON" + text + rest
