"""Colours as they are stored (sRGB) and as light adds up (linear): the curve of IEC 61966-2-1.

Arrays and single colours in, the same out. An sRGB value is 0 to 1, 0 to 255 or ``#rrggbb``.
"""

from __future__ import annotations

import operator
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.errors import InvalidRequest

__all__ = [
    "LINEAR_OF_SRGB8",
    "HALF_MOST",
    "LUMINANCE",
    "XYZ_FROM_RGB",
    "hex_from_linear",
    "linear_from_hex",
    "linear_from_srgb",
    "linear_from_srgb8",
    "srgb8_from_linear",
    "srgb_from_linear",
]

Rgb8 = tuple[int, int, int]
Rgb = tuple[float, float, float]


def linear_from_srgb(srgb: ArrayLike) -> NDArray[np.float64]:
    """Return linear light, 0 to 1, for sRGB values; what is outside 0 to 1 is clipped."""
    c = np.clip(np.asarray(srgb, np.float64), 0.0, 1.0)
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def srgb_from_linear(linear: ArrayLike) -> NDArray[np.float64]:
    """Return sRGB values, 0 to 1, for linear light; what is outside 0 to 1 is clipped."""
    c = np.clip(np.asarray(linear, np.float64), 0.0, 1.0)
    return np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1.0 / 2.4) - 0.055)


LINEAR_OF_SRGB8: NDArray[np.float64] = linear_from_srgb(np.arange(256) / 255.0)
"""(256,) float64: linear light, 0 to 1, by the 8-bit code."""
LINEAR_OF_SRGB8.flags.writeable = False

HALF_MOST = 6e4
"""Brightest light that is kept in half precision; what is brighter becomes it."""

LUMINANCE: NDArray[np.float64] = np.array([0.2126, 0.7152, 0.0722])
"""(3,) float64: share of linear red, green and blue in luminance (ITU-R BT.709)."""
LUMINANCE.flags.writeable = False


XYZ_FROM_RGB: NDArray[np.float64] = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
"""(3, 3) float64: CIE 1931 XYZ of linear red, green and blue (IEC 61966-2-1)."""
XYZ_FROM_RGB.flags.writeable = False


def linear_from_srgb8(what: str, colour: Iterable[Any]) -> Rgb:
    """Turn red, green, blue from 0 to 255 into linear ones from 0 to 1.

    Parameters
    ----------
    what : str
        The name that an error tells.
    colour : iterable of int

    Raises
    ------
    InvalidRequest
        If there are not three integers from 0 to 255.
    """
    accepted = "three integers from 0 to 255 (red, green, blue)"
    values = tuple(colour)
    try:
        channels = tuple(operator.index(value) for value in values)
    except TypeError:
        raise InvalidRequest(what, values, accepted) from None
    if len(channels) != 3 or not all(0 <= channel <= 255 for channel in channels):
        raise InvalidRequest(what, values, accepted)
    red, green, blue = (_linear(channel / 255.0) for channel in channels)
    return red, green, blue


def srgb8_from_linear(colour: Iterable[float]) -> Rgb8:
    """Turn linear red, green, blue into integers from 0 to 255; what is brighter becomes 255."""
    red, green, blue = (round(255.0 * _encoded(min(max(v, 0.0), 1.0))) for v in colour)
    return red, green, blue


def linear_from_hex(colour: str) -> Rgb:
    """Turn ``#rrggbb`` into linear red, green, blue, 0 to 1."""
    red, green, blue = (_linear(int(colour[at : at + 2], 16) / 255.0) for at in (1, 3, 5))
    return red, green, blue


def hex_from_linear(colour: Iterable[float]) -> str:
    """Turn linear red, green, blue into the nearest ``#rrggbb``."""
    return "#" + "".join(f"{channel:02x}" for channel in srgb8_from_linear(colour))


# One number at a time by the C library's power: NumPy's may differ from it in the last bit, and
# scene files are read to the same bits on every processor.


def _linear(encoded: float) -> float:
    return encoded / 12.92 if encoded <= 0.04045 else float(((encoded + 0.055) / 1.055) ** 2.4)


def _encoded(linear: float) -> float:
    if linear <= 0.0031308:
        return 12.92 * linear
    return float(1.055 * linear ** (1.0 / 2.4) - 0.055)
