"""Pictures as PNG and JPEG files, and back: the one place that calls codecs.

Colours are red, green, blue everywhere but within OpenCV.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping, Sequence
from functools import lru_cache
from types import MappingProxyType
from typing import Any, Literal, TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.native.png_kernel import png_data, png_rows
from sailenv_ros.types.picture_settings import MAX_SIZE_PX

__all__ = ["PngEffort", "decode_picture", "encode_inverse_depth", "encode_jpeg", "encode_png"]

PngEffort: TypeAlias = Literal["default", "quick", "fastest", "small"]
"""``quick``: level 1, five times as fast as others for areas of one id. ``fastest``: by
the project's own encoder (`native.png_kernel`), larger by a few per cent. ``small``: level 3."""

_STEPS = 65534
"""Steps from the greatest depth, 1, to the least, 65535."""

_LEVEL = cv2.IMWRITE_PNG_COMPRESSION

_EFFORTS: Mapping[str, Sequence[int]] = MappingProxyType(
    {"default": (), "quick": (_LEVEL, 1), "small": (_LEVEL, 3)}
)


def encode_png(picture: NDArray[Any], effort: PngEffort = "default") -> bytes:
    """Return a picture as a PNG file, without loss.

    Parameters
    ----------
    picture : (H, W), (H, W, 3) or (H, W, 4) uint8, uint16 or bool
        Labels, or red, green, blue, and alpha. Truth values become 0 and 255.
    effort : {'default', 'quick', 'fastest', 'small'}
        ``fastest`` knows no alpha.

    Raises
    ------
    InvalidRequest
        If it is no such array.
    """
    if picture.dtype == np.bool_:
        picture = picture.view(np.uint8) * np.uint8(255)
    depths = (np.uint8, np.uint16)
    if effort == "fastest":
        _check(picture, depths)
        return _fastest(picture)
    return _encoded(".png", picture, depths, _EFFORTS[effort], most=4)


def encode_inverse_depth(depth_m: NDArray[np.float32]) -> bytes:
    """Return depths as ROS's `compressed_depth_image_transport` has them: 65535 steps of 1/depth.

    Parameters
    ----------
    depth_m : (H, W) float32
        [m]; what is not finite, or not above 0, has no depth afterwards.

    Returns
    -------
    data : bytes
        Int32 0, float32 A and B, little-endian, then a PNG of uint16 q: the depth is A / (q - B),
        and there is none where q is 0. Over a picture's depths from least to most, a depth z is
        exact to half a step, z² / (2 A), and A = 65534 / (1/least - 1/most).
    """
    known = np.isfinite(depth_m) & (depth_m > 0.0)
    inverse = np.divide(1.0, depth_m, where=known, out=np.zeros(depth_m.shape))
    lowest = float(inverse[known].min()) if known.any() else 0.0
    span = float(inverse[known].max()) - lowest if known.any() else 0.0
    scale = np.float32(_STEPS / span if span > 0.0 else _STEPS)
    offset = np.float32(1.0 - float(scale) * lowest)
    steps = np.clip(np.rint(float(scale) * inverse + float(offset)), 1, 65535)
    levels = np.where(known, steps, 0).astype(np.uint16)
    return struct.pack("<iff", 0, scale, offset) + encode_png(levels, "quick")


def encode_jpeg(picture: NDArray[np.uint8], quality: int, *, full_colour: bool = False) -> bytes:
    """Return a picture as a JPEG file.

    Parameters
    ----------
    picture : (H, W) or (H, W, 3) uint8
        Grey, or red, green and blue.
    quality : int
        From 0 to 100.
    full_colour : bool
        True keeps the resolution of colours, which is halved else.

    Raises
    ------
    InvalidRequest
        If it is no such array.
    """
    options = [cv2.IMWRITE_JPEG_QUALITY, quality]
    if full_colour:
        options += [cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444]
    return _encoded(".jpg", picture, (np.uint8,), options)


def decode_picture(data: bytes | memoryview) -> NDArray[Any]:
    """Return the picture of a PNG or JPEG file, with the depth that it has.

    Returns
    -------
    picture : (H, W) or (H, W, 3) uint8 or uint16
        Labels or grey, or red, green and blue.

    Raises
    ------
    InvalidRequest
        If it is no such file.
    """
    own = _read_fastest(data)
    if own is not None:
        return own
    found = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED) if data else None
    if found is None:
        raise InvalidRequest("picture", f"{len(data)} bytes", "a PNG or JPEG file")
    return found if found.ndim == 2 else _reordered(found, cv2.COLOR_BGR2RGB)


def _fastest(picture: NDArray[Any]) -> bytes:
    """Return a PNG file whose bytes depend on the picture alone, not on a library's version."""
    height, width = picture.shape[:2]
    # Numbers of 16 bits stand with their high byte first.
    values = np.ascontiguousarray(picture, picture.dtype.newbyteorder(">"))
    rows = values.view(np.uint8).reshape(height, -1)
    is_colour = picture.ndim == 3
    head = _head(width, height, 8 * picture.dtype.itemsize, _COLOUR if is_colour else _GREY)
    data = png_data(rows, rows.shape[1] // width, paeth=is_colour)
    return b"".join((head, *_chunk(b"IDAT", data), _TAIL))


def _read_fastest(data: bytes | memoryview) -> NDArray[Any] | None:
    """Return the picture of a file as `_fastest` writes it; None if it is another, or damaged.

    Faster than OpenCV, which reads all others and says what is none.
    """
    if len(data) < _HEAD_BYTES + 8 + 4 + len(_TAIL) or data[-len(_TAIL) :] != _TAIL:
        return None
    width, height, depth, kind = struct.unpack_from(">IIBB", data, 16)
    is_known = depth in (8, 16) and kind in (_GREY, _COLOUR)
    if not is_known or not 0 < width <= MAX_SIZE_PX or not 0 < height <= MAX_SIZE_PX:
        return None
    size, name = struct.unpack_from(">I4s", data, _HEAD_BYTES)
    begin = _HEAD_BYTES + 8
    end = len(data) - len(_TAIL) - 4
    is_written_so = data[:_HEAD_BYTES] == _head(width, height, depth, kind)
    if not is_written_so or (size, name) != (end - begin, b"IDAT"):
        return None
    content = memoryview(data)[begin:end]
    if struct.unpack_from(">I", data, end)[0] != zlib.crc32(content, zlib.crc32(name)):
        return None
    step = (3 if kind == _COLOUR else 1) * depth // 8
    shape = height, 1 + width * step
    filtered = _inflated(content, shape[0] * shape[1])
    if filtered is None:
        return None
    rows = png_rows(np.frombuffer(filtered, np.uint8).reshape(shape), step)
    if rows is None:
        return None
    values = rows if depth == 8 else rows.view(">u2").astype(np.uint16)
    return values.reshape(height, width, 3) if kind == _COLOUR else values


def _inflated(data: memoryview, size: int) -> bytes | None:
    """Return `size` bytes that are compressed in all of `data`, or None."""
    stream = zlib.decompressobj()
    try:
        found = stream.decompress(data, size + 1)
    except zlib.error:
        return None
    is_whole = len(found) == size and stream.eof and not stream.unused_data
    return found if is_whole else None


@lru_cache(maxsize=64)
def _head(width: int, height: int, depth: int, kind: int) -> bytes:
    """Return what a PNG file has before its content."""
    told = struct.pack(">IIBBBBB", width, height, depth, kind, 0, 0, 0)
    return b"".join((b"\x89PNG\r\n\x1a\n", *_chunk(b"IHDR", told)))


def _chunk(kind: bytes, data: bytes | memoryview) -> tuple[bytes | memoryview, ...]:
    checksum = zlib.crc32(data, zlib.crc32(kind))
    return struct.pack(">I", len(data)), kind, data, struct.pack(">I", checksum)


_GREY, _COLOUR = 0, 2
"""Kinds of pixels in the head of a PNG file."""

_TAIL = b"".join(_chunk(b"IEND", b""))
_HEAD_BYTES = len(_head(1, 1, 8, _GREY))


def _check(picture: NDArray[Any], depths: Sequence[type], most: int = 3) -> None:
    shaped = picture.ndim == 2 or (picture.ndim == 3 and 3 <= picture.shape[2] <= most)
    if not shaped or not picture.size or picture.dtype not in depths:
        bits = " or ".join(str(np.dtype(one).itemsize * 8) for one in depths)
        accepted = f"an array (H, W) or (H, W, 3) of truth values or {bits} bits"
        raise InvalidRequest("picture", f"{picture.shape} {picture.dtype}", accepted)


def _encoded(
    ending: str,
    picture: NDArray[Any],
    depths: Sequence[type],
    options: Sequence[int],
    most: int = 3,
) -> bytes:
    _check(picture, depths, most)
    ordered = picture
    if picture.ndim == 3:
        has_alpha = picture.shape[2] == 4
        ordered = _reordered(picture, cv2.COLOR_RGBA2BGRA if has_alpha else cv2.COLOR_RGB2BGR)
    _, data = cv2.imencode(ending, ordered, options)
    return bytes(data)


def _reordered(picture: NDArray[Any], order: int) -> NDArray[Any]:
    """Return a picture with its channels in another order.

    As one long row, which OpenCV does not share among threads: where it does, it keeps 0.9 kB for
    each thread that ever asked, and threads of pages and agents come and go.
    """
    row = cv2.cvtColor(picture.reshape(1, -1, picture.shape[2]), order)
    reordered: NDArray[Any] = row.reshape(*picture.shape[:2], -1)
    return reordered
