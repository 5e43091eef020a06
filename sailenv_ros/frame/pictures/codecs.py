"""Pictures as PNG and JPEG files, and back: the one place that calls OpenCV's codecs.

Colours are red, green, blue everywhere but within OpenCV.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, Literal, TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest

__all__ = ["PngEffort", "decode_picture", "encode_jpeg", "encode_png"]

PngEffort: TypeAlias = Literal["default", "quick", "fastest", "small"]
"""``quick``: level 1, five times as fast as others for areas of one id. ``fastest``: that with the
filter and the strategy that suit colours or labels. ``small``: level 3."""

_LEVEL = cv2.IMWRITE_PNG_COMPRESSION

_EFFORTS: Mapping[str, Sequence[int]] = MappingProxyType(
    {"default": (), "quick": (_LEVEL, 1), "small": (_LEVEL, 3)}
)

_FILTER: int | None = getattr(cv2, "IMWRITE_PNG_FILTER", None)
"""None for versions of OpenCV that choose the filter of each row themselves."""


def _fastest(strategy: int, filter_name: str) -> Sequence[int]:
    options = (_LEVEL, 1, cv2.IMWRITE_PNG_STRATEGY, strategy)
    return options if _FILTER is None else (*options, _FILTER, getattr(cv2, filter_name))


# Of a picture nothing repeats: looking for repetitions takes half of the time and gains nothing.
_FASTEST_COLOURS = _fastest(cv2.IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY, "IMWRITE_PNG_FILTER_PAETH")
# Labels are the same as those above: what is left is runs of zeros.
_FASTEST_LABELS = _fastest(cv2.IMWRITE_PNG_STRATEGY_RLE, "IMWRITE_PNG_FILTER_UP")


def encode_png(picture: NDArray[Any], effort: PngEffort = "default") -> bytes:
    """Return a picture as a PNG file, without loss.

    Parameters
    ----------
    picture : (H, W) or (H, W, 3) uint8, uint16 or bool
        Labels, or red, green and blue. Truth values become 0 and 255.
    effort : {'default', 'quick', 'fastest', 'small'}

    Raises
    ------
    InvalidRequest
        If it is no such array.
    """
    if picture.dtype == np.bool_:
        picture = picture.view(np.uint8) * np.uint8(255)
    if effort == "fastest":
        options = _FASTEST_LABELS if picture.ndim == 2 else _FASTEST_COLOURS
    else:
        options = _EFFORTS[effort]
    return _encoded(".png", picture, (np.uint8, np.uint16), options)


def encode_jpeg(picture: NDArray[np.uint8], quality: int) -> bytes:
    """Return a picture as a JPEG file.

    Parameters
    ----------
    picture : (H, W) or (H, W, 3) uint8
        Grey, or red, green and blue.
    quality : int
        From 0 to 100.

    Raises
    ------
    InvalidRequest
        If it is no such array.
    """
    return _encoded(".jpg", picture, (np.uint8,), (cv2.IMWRITE_JPEG_QUALITY, quality))


def decode_picture(data: bytes) -> NDArray[Any]:
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
    found = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED) if data else None
    if found is None:
        raise InvalidRequest("picture", f"{len(data)} bytes", "a PNG or JPEG file")
    return found if found.ndim == 2 else cv2.cvtColor(found, cv2.COLOR_BGR2RGB)


def _encoded(
    ending: str, picture: NDArray[Any], depths: Sequence[type], options: Sequence[int]
) -> bytes:
    shaped = picture.ndim == 2 or (picture.ndim == 3 and picture.shape[2] == 3)
    if not shaped or not picture.size or picture.dtype not in depths:
        bits = " or ".join(str(np.dtype(one).itemsize * 8) for one in depths)
        accepted = f"an array (H, W) or (H, W, 3) of truth values or {bits} bits"
        raise InvalidRequest("picture", f"{picture.shape} {picture.dtype}", accepted)
    ordered = picture if picture.ndim == 2 else cv2.cvtColor(picture, cv2.COLOR_RGB2BGR)
    _, data = cv2.imencode(ending, ordered, options)
    return bytes(data)
