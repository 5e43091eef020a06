"""An array → an HDF5 file with it alone, by the name ``dataset``, as Hypersim's files are.

The HDF Group, "HDF5 File Format Specification" 3.0: superblock 0, an old-style group, a contiguous
array.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest

__all__ = ["hdf5_bytes"]

_NAME = b"dataset\0"
_UNDEFINED = 0xFFFFFFFFFFFFFFFF
_FULL = 1
"""Stands for the first free place of a heap without one."""

_LEAF_K, _TREE_K = 4, 16
"""Half of the entries that nodes of symbols and of trees have room for."""

_HEAD, _ENTRY = 96, 40
_SYMBOL_TABLE, _SPACE, _TYPE, _FILL, _LAYOUT = 0x11, 0x01, 0x03, 0x05, 0x08

_FLOATS: Mapping[str, tuple[int, int, int, int]] = MappingProxyType(
    {"<f2": (15, 10, 5, 15), "<f4": (31, 23, 8, 127), "<f8": (63, 52, 11, 1023)}
)
"""Place of the sign, bits of the mantissa, bits and bias of the exponent."""

_INTEGERS = ("<i2", "<i4")


def hdf5_bytes(values: NDArray[Any]) -> bytes:
    """Return a file that holds an array.

    Parameters
    ----------
    values : array of float16, float32, float64, int16 or int32

    Raises
    ------
    InvalidRequest
        If it is of another type.
    """
    kind = values.dtype.newbyteorder("<").str
    if kind not in (*_FLOATS, *_INTEGERS):
        raise InvalidRequest("type of an array", str(values.dtype), "a float, int16 or int32")
    data = np.ascontiguousarray(values, kind).tobytes()
    root, tree = _HEAD, _HEAD + 40
    heap = tree + 24 + 8 * (4 * _TREE_K + 1)
    names = heap + 32
    node = names + 16
    own = node + 8 + 2 * _LEAF_K * _ENTRY
    head_size = len(_dataset(values, kind, 0, len(data)))
    begin = own + head_size
    parts = (
        _superblock(root, tree, heap, begin + len(data)),
        _object(((_SYMBOL_TABLE, struct.pack("<2Q", tree, heap)),)),
        _tree(node),
        b"HEAP" + struct.pack("<4x3Q", 16, _FULL, names),
        bytes(8) + _NAME,
        b"SNOD" + struct.pack("<BxH", 1, 1) + struct.pack("<2Q24x", 8, own),
        bytes((2 * _LEAF_K - 1) * _ENTRY),
        _dataset(values, kind, begin, len(data)),
        data,
    )
    return b"".join(parts)


def _superblock(root: int, tree: int, heap: int, end: int) -> bytes:
    versions = struct.pack("<8B", 0, 0, 0, 0, 0, 8, 8, 0)
    sizes = struct.pack("<2HI", _LEAF_K, _TREE_K, 0)
    places = struct.pack("<4Q", 0, _UNDEFINED, end, _UNDEFINED)
    entry = struct.pack("<2QI4x2Q", 0, root, 1, tree, heap)
    return b"\x89HDF\r\n\x1a\n" + versions + sizes + places + entry


def _tree(node: int) -> bytes:
    head = b"TREE" + struct.pack("<2BH2Q", 0, 0, 1, _UNDEFINED, _UNDEFINED)
    used = struct.pack("<3Q", 0, node, 8)
    return head + used + bytes(8 * (4 * _TREE_K + 1) - len(used))


def _object(messages: tuple[tuple[int, bytes], ...]) -> bytes:
    body = b""
    for kind, data in messages:
        padded = data + bytes(-len(data) % 8)
        body += struct.pack("<2HB3x", kind, len(padded), 0) + padded
    return struct.pack("<BxHII4x", 1, len(messages), 1, len(body)) + body


def _dataset(values: NDArray[Any], kind: str, begin: int, size: int) -> bytes:
    shape = struct.pack(f"<3B5x{values.ndim}Q", 1, values.ndim, 0, *values.shape)
    width = values.dtype.itemsize
    if kind in _FLOATS:
        sign, mantissa, exponent, bias = _FLOATS[kind]
        own = struct.pack("<4BI", 0x11, 0x20, sign, 0, width)
        own += struct.pack("<2H4BI", 0, 8 * width, mantissa, exponent, 0, mantissa, bias)
    else:
        own = struct.pack("<4BI2H", 0x10, 0x08, 0, 0, width, 0, 8 * width)
    layout = struct.pack("<2B2Q", 3, 1, begin, size)
    fill = struct.pack("<4B", 2, 1, 0, 0)
    return _object(((_SPACE, shape), (_TYPE, own), (_FILL, fill), (_LAYOUT, layout)))
