"""Colours as people write them (0 to 255, sRGB) and as light adds up (linear, 0 to 1 and more).

Three numbers in, three out; the curve is that of IEC 61966-2-1.
"""

from __future__ import annotations

import operator
from collections.abc import Iterable
from typing import Any

from sailenv_ros.errors import InvalidRequest

__all__ = ["linear_from_srgb8", "srgb8_from_linear"]

Rgb8 = tuple[int, int, int]
Rgb = tuple[float, float, float]


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


def _linear(encoded: float) -> float:
    if encoded <= 0.04045:
        return encoded / 12.92
    return float(((encoded + 0.055) / 1.055) ** 2.4)


def _encoded(linear: float) -> float:
    if linear <= 0.0031308:
        return linear * 12.92
    return float(1.055 * linear ** (1.0 / 2.4) - 0.055)
