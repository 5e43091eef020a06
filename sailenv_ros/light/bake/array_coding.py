"""Arrays of baked light in few bytes, without loss. From an array to bytes and back.

Neighbouring texels have nearly the same light. Each number is told by how much it differs from the
one before it in its row, less by how much that did in the row above, and red and blue by what they
differ from green in that; bytes of like weight lie together and are deflated.
"""

from __future__ import annotations

import json
import math
import operator
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.array_kernel import sum_steps

__all__ = ["LEVEL", "QUICK_LEVEL", "coded", "decoded", "rounded"]

LEVEL, QUICK_LEVEL = 6, 1
"""Efforts of deflating: more than 6 takes three times as long for less than a percent."""

DROPPED_BITS = 2
"""Last bits of half-precision light that are left out: they are below the noise of its rays."""

MOST_BYTES = 2**30
"""Of an array: an untrusted file may claim any size, and deflate zeros to little."""

_INTEGERS = {1: np.uint8, 2: np.uint16, 4: np.uint32, 8: np.uint64}
_SIGNED = {1: np.int8, 2: np.int16, 4: np.int32, 8: np.int64}


def rounded(light: NDArray[np.float16]) -> NDArray[np.float16]:
    """Return light to nine binary places, at most 0.2 % off, which takes fewer bytes.

    Parameters
    ----------
    light : float16 array
        Finite, 0 or more.
    """
    bits = light.view(np.uint16)
    half, last = np.uint16(1 << (DROPPED_BITS - 1)), np.uint16(1 << DROPPED_BITS)
    # Up to the next number if that is nearer, but not up to infinity.
    up = np.minimum(bits, np.uint16(0x7C00 - last)) + half
    found: NDArray[np.float16] = (up - up % last).view(np.float16)
    return found


def coded(array: NDArray[Any], level: int = LEVEL) -> NDArray[np.uint8]:
    """Return an array as bytes: one line that says what it is, then its numbers."""
    told = json.dumps([array.dtype.str, array.shape]).encode() + b"\n"
    numbers = np.ascontiguousarray(array).view(_INTEGERS[array.itemsize])
    steps = _differences(numbers.reshape(_rows(array.shape)))
    signed = steps.view(_SIGNED[array.itemsize])
    # Small steps down are small numbers, too.
    small = ((steps << 1) ^ (signed >> (8 * array.itemsize - 1)).view(steps.dtype)).reshape(-1)
    planes = small.view(np.uint8).reshape(-1, array.itemsize).T
    return np.frombuffer(told + _deflated(planes.tobytes(), level), np.uint8)


def decoded(data: NDArray[np.uint8]) -> NDArray[Any]:
    """Return the array of `coded`.

    Raises
    ------
    ValueError
        If the bytes are none of an array of numbers, or one of more than `MOST_BYTES`.
    """
    told, _, packed = data.tobytes().partition(b"\n")
    try:
        kind, shape = _told(told)
        planes = np.frombuffer(_inflated(packed, math.prod(shape) * kind.itemsize), np.uint8)
        return sum_steps(planes, _rows(shape), kind).reshape(shape)
    except (ValueError, TypeError, zlib.error) as problem:
        raise ValueError(f"it is no coded array ({problem})") from problem


def _told(line: bytes) -> tuple[np.dtype[Any], tuple[int, ...]]:
    """Return the type and the shape that a line tells of."""
    name, given = json.loads(line)
    kind, shape = np.dtype(name), tuple(operator.index(size) for size in given)
    if kind.kind not in "fiub" or kind.itemsize not in _INTEGERS or min(shape, default=0) < 0:
        raise ValueError(f"{kind} of shape {shape} are no numbers")
    if math.prod(shape) * kind.itemsize > MOST_BYTES:
        raise ValueError(f"shape {shape} is more than {MOST_BYTES // 2**20} MiB")
    return kind, shape


def _inflated(packed: bytes, size: int) -> bytes:
    """Return so many bytes, without ever holding more."""
    inflating = zlib.decompressobj()
    found = inflating.decompress(packed, size + 1)
    if len(found) != size or not inflating.eof:
        raise ValueError(f"it does not hold {size} bytes")
    return found


def _deflated(data: bytes, level: int) -> bytes:
    deflating = zlib.compressobj(level, zlib.DEFLATED, zlib.MAX_WBITS, 9, zlib.Z_FILTERED)
    return deflating.compress(data) + deflating.flush()


def _rows(shape: tuple[int, ...]) -> tuple[int, int, int]:
    """Return rows, numbers in a row, and channels of an array of any shape."""
    channels = 3 if len(shape) > 2 and shape[-1] == 3 else 1
    rows = shape[0] if len(shape) > 1 else 1
    length = int(np.prod(shape, dtype=np.int64)) // max(rows * channels, 1)
    return rows, length, channels


def _differences(numbers: NDArray[Any]) -> NDArray[Any]:
    steps = numbers.copy()
    steps[:, 1:] -= numbers[:, :-1]
    steps[1:] -= steps[:-1].copy()
    if steps.shape[2] == 3:
        steps[..., 0] -= steps[..., 1]
        steps[..., 2] -= steps[..., 1]
    return steps
