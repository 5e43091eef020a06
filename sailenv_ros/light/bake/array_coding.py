"""Arrays of baked light in few bytes, without loss. From an array to bytes and back.

Neighbouring texels have nearly the same light. Each number is told by its difference to the one
before it in its row, and red and blue by what they differ from green in that; bytes of like weight
lie together and are deflated.
"""

from __future__ import annotations

import json
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["coded", "decoded"]

LEVEL = 4
"""Effort of deflating: more takes three times as long for some percent."""

_INTEGERS = {1: np.uint8, 2: np.uint16, 4: np.uint32, 8: np.uint64}
_SIGNED = {1: np.int8, 2: np.int16, 4: np.int32, 8: np.int64}


def coded(array: NDArray[Any]) -> NDArray[np.uint8]:
    """Return an array as bytes: one line that says what it is, then its numbers."""
    told = json.dumps([array.dtype.str, array.shape]).encode() + b"\n"
    numbers = np.ascontiguousarray(array).view(_INTEGERS[array.itemsize])
    steps = _differences(numbers.reshape(_rows(array.shape)))
    signed = steps.view(_SIGNED[array.itemsize])
    # Small steps down are small numbers, too.
    small = ((steps << 1) ^ (signed >> (8 * array.itemsize - 1)).view(steps.dtype)).reshape(-1)
    planes = small.view(np.uint8).reshape(-1, array.itemsize).T
    return np.frombuffer(told + zlib.compress(planes.tobytes(), LEVEL), np.uint8)


def decoded(data: NDArray[np.uint8]) -> NDArray[Any]:
    """Return the array of `coded`.

    Raises
    ------
    ValueError
        If the bytes are none of an array.
    """
    told, _, packed = data.tobytes().partition(b"\n")
    name, shape = json.loads(told)
    kind = np.dtype(name)
    try:
        planes = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(kind.itemsize, -1)
    except zlib.error as problem:
        raise ValueError(str(problem)) from problem
    small = np.ascontiguousarray(planes.T).view(_INTEGERS[kind.itemsize]).reshape(_rows(shape))
    one = small.dtype.type(1)
    steps = (small >> one) ^ (~(small & one) + one)
    return _sums(steps).view(kind).reshape(shape)


def _rows(shape: tuple[int, ...]) -> tuple[int, int, int]:
    """Return rows, numbers in a row, and channels of an array of any shape."""
    channels = 3 if len(shape) > 2 and shape[-1] == 3 else 1
    count = int(np.prod(shape, dtype=np.int64)) // channels
    length = shape[1] if len(shape) > 1 else count
    return (count // length if length else 0), length, channels


def _differences(numbers: NDArray[Any]) -> NDArray[Any]:
    steps = numbers.copy()
    steps[:, 1:] -= numbers[:, :-1]
    if steps.shape[2] == 3:
        steps[..., 0] -= steps[..., 1]
        steps[..., 2] -= steps[..., 1]
    return steps


def _sums(steps: NDArray[Any]) -> NDArray[Any]:
    if steps.shape[2] == 3:
        steps[..., 0] += steps[..., 1]
        steps[..., 2] += steps[..., 1]
    return np.cumsum(steps, axis=1, dtype=steps.dtype)
