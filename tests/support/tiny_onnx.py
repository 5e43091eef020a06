"""Networks of one operation as ONNX files, written byte by byte: no library is needed for them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

_FLOAT = 1
_TYPES = {"float32": _FLOAT, "int64": 7}
_TENSOR = 4
_INTS = 7


def constant_network(
    outputs: Mapping[str, np.ndarray[Any, Any]], *, size: tuple[int, int]
) -> bytes:
    """Return a network of one picture (1, 3, H, W), of size (W, H), whose answer never changes."""
    graph = b""
    for name, array in outputs.items():
        tensor = b"".join(_number(1, length) for length in array.shape)
        tensor += _number(2, _TYPES[array.dtype.name]) + _field(9, array.tobytes())
        attribute = _field(1, b"value") + _field(5, tensor) + _number(20, _TENSOR)
        graph += _field(1, _field(2, name.encode()) + _field(4, b"Constant") + _field(5, attribute))
    graph += _field(2, b"g") + _field(11, _value(b"picture", (1, 3, size[1], size[0])))
    for name, array in outputs.items():
        kind = _TYPES[array.dtype.name]
        graph += _field(12, _value(name.encode(), array.shape, kind))
    return _model(graph)


def slice_network(*, height: int, width: int) -> bytes:
    """Return a network of two pictures (1, 3, H, W) that gives the first's first two channels."""
    node = _field(1, b"a") + _field(2, b"out") + _field(4, b"Slice")
    for name, value in (("axes", 1), ("starts", 0), ("ends", 2)):
        attribute = _field(1, name.encode()) + _number(8, value) + _number(20, _INTS)
        node += _field(5, attribute)
    spare = _field(1, b"b") + _field(2, b"unused") + _field(4, b"Identity")
    shape, cut = (1, 3, height, width), (1, 2, height, width)
    graph = _field(1, spare) + _field(1, node) + _field(2, b"g")
    graph += b"".join(_field(11, _value(name, shape)) for name in (b"a", b"b"))
    graph += _field(12, _value(b"unused", shape)) + _field(12, _value(b"out", cut))
    return _model(graph)


def _model(graph: bytes) -> bytes:
    opset = _number(2, 9)
    return _number(1, 4) + _field(7, graph) + _field(8, opset)


def _value(name: bytes, shape: tuple[int, ...], kind: int = _FLOAT) -> bytes:
    dimensions = b"".join(_field(1, _number(1, length)) for length in shape)
    tensor = _number(1, kind) + _field(2, dimensions)
    return _field(1, name) + _field(2, _field(1, tensor))


def _field(number: int, data: bytes) -> bytes:
    return _varint(number << 3 | 2) + _varint(len(data)) + data


def _number(number: int, value: int) -> bytes:
    return _varint(number << 3) + _varint(value)


def _varint(value: int) -> bytes:
    parts = []
    while value >= 0x80:
        parts.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*parts, value])
