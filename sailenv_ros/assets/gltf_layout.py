"""Description of a glTF file → whether all that it points at is there.

trimesh follows indices and lengths as they stand, and where one leads beyond the file its errors
tell of Python. Here each is compared with what it points into, before anything is read.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from sailenv_ros.assets.gltf_description import description_of
from sailenv_ros.errors import AssetError

__all__ = ["check_layout"]

CHUNK_HEAD_BYTES = 8

_ITEM_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
"""Size of a number by its ``componentType`` [B]."""

_ITEMS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
"""Number of numbers in an element by its ``type``."""

_POINTERS = {
    "scene": "scenes",
    "scenes/*/nodes/*": "nodes",
    "nodes/*/mesh": "meshes",
    "nodes/*/children/*": "nodes",
    "meshes/*/primitives/*/indices": "accessors",
    "meshes/*/primitives/*/attributes/*": "accessors",
    "meshes/*/primitives/*/material": "materials",
    "textures/*/source": "images",
    "images/*/bufferView": "bufferViews",
    "accessors/*/bufferView": "bufferViews",
    "bufferViews/*/buffer": "buffers",
}
"""Places of indices, and the list that each counts in."""


def check_layout(path: Path) -> None:
    """Refuse a glTF file whose description points beyond what is there.

    Parameters
    ----------
    path : Path
        Ends in ``.glb`` or ``.gltf``.

    Raises
    ------
    AssetError
        With the place in the description.
    """
    tree, rest = description_of(path)
    binary = max(0, len(rest) - CHUNK_HEAD_BYTES)
    for pattern, target in _POINTERS.items():
        for place, value in _places(path, tree, pattern):
            count = len(_entries(path, tree, target))
            if type(value) is not int or not 0 <= value < count:
                raise AssetError(path.name, f"{place} is {_short(value)}, of {count} {target}")
    for place, view in _places(path, tree, "bufferViews/*"):
        number = _number(path, view, "buffer", place)
        end = _number(path, view, "byteOffset", place, 0)
        end += _number(path, view, "byteLength", place)
        room = _buffer_bytes(path, tree["buffers"][number], f"buffers/{number}", binary)
        if end > room:
            why = f"{place} ends at byte {end}, and buffer {number} has {room}"
            raise AssetError(path.name, why)
    for place, accessor in _places(path, tree, "accessors/*"):
        _check_accessor(path, tree, accessor, place)


def _check_accessor(path: Path, tree: Any, accessor: Any, place: str) -> None:
    count = _number(path, accessor, "count", place)
    number_bytes = _one_of(path, accessor, "componentType", place, _ITEM_BYTES)
    element_bytes = number_bytes * _one_of(path, accessor, "type", place, _ITEMS)
    if "bufferView" not in accessor or not count:
        return
    view = tree["bufferViews"][accessor["bufferView"]]
    above = f"bufferViews/{accessor['bufferView']}"
    stride = _number(path, view, "byteStride", above, element_bytes)
    end = _number(path, accessor, "byteOffset", place, 0) + (count - 1) * stride + element_bytes
    room = _number(path, view, "byteLength", above)
    if stride < element_bytes:
        why = f"{place} has elements of {element_bytes} bytes every {stride} bytes"
        raise AssetError(path.name, why)
    if end > room:
        raise AssetError(path.name, f"{place} ends at byte {end}, and {above} has {room}")


def _buffer_bytes(path: Path, buffer: Any, place: str, binary: int) -> int:
    """Return how many bytes a buffer has: as it says, or fewer if there are fewer."""
    told = _number(path, buffer, "byteLength", place)
    uri = buffer.get("uri")
    if uri is None:
        return min(told, binary)
    if not isinstance(uri, str):
        raise AssetError(path.name, f"{place}/uri is {_short(uri)}, and a text is accepted")
    if uri.startswith("data:"):
        try:
            return min(told, len(base64.b64decode(uri.partition("base64,")[2])))
        except ValueError:
            raise AssetError(path.name, f"{place}/uri is no base64") from None
    if "\0" not in uri and (path.parent / uri).is_file():
        return min(told, (path.parent / uri).stat().st_size)
    raise AssetError(path.name, f"{_short(uri)}, of {place}, is not there")


def _places(path: Path, tree: Any, pattern: str) -> Iterator[tuple[str, Any]]:
    """Yield the entries of a pattern such as ``nodes/*/mesh``, as far as they are there."""
    found = [("", tree)]
    for key in pattern.split("/"):
        inner: list[tuple[str, Any]] = []
        for place, value in found:
            if key == "*":
                if not isinstance(value, (list, dict)):
                    raise AssetError(path.name, f"{place} is {_short(value)}, and no list")
                pairs = value.items() if isinstance(value, dict) else enumerate(value)
                inner += [(f"{place}/{name}", one) for name, one in pairs]
            elif not isinstance(value, dict):
                raise AssetError(path.name, f"{place} is {_short(value)}, and no JSON object")
            elif key in value:
                inner.append((f"{place}/{key}".lstrip("/"), value[key]))
        found = inner
    yield from found


def _entries(path: Path, tree: Mapping[str, Any], name: str) -> list[Any]:
    value = tree.get(name, [])
    if not isinstance(value, list):
        raise AssetError(path.name, f"{name} is {_short(value)}, and no list")
    return value


def _number(path: Path, table: Any, key: str, place: str, default: int | None = None) -> int:
    if not isinstance(table, dict):
        raise AssetError(path.name, f"{place} is {_short(table)}, and no JSON object")
    value = table.get(key, default)
    if type(value) is not int or value < 0:
        why = f"{place}/{key} is {_short(value)}, and an integer from 0 on is accepted"
        raise AssetError(path.name, why)
    return value


def _one_of(path: Path, table: Any, key: str, place: str, known: Mapping[Any, int]) -> int:
    value = table.get(key)
    if not isinstance(value, (int, str)) or value not in known:
        accepted = ", ".join(map(str, known))
        raise AssetError(path.name, f"{place}/{key} is {_short(value)}, of {accepted}")
    return known[value]


def _short(value: object) -> str:
    text = "missing" if value is None else json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
