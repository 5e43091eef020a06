"""Textures as renderers hold them: square, of three sizes, bottom row first.

The textures of materials come in, texels for look-ups go out. Knows no graphics library: every back
end draws the same texels.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.colour import LINEAR_OF_SRGB8
from sailenv_ros.types.model import Texture

__all__ = ["SIZES_PX", "array_of", "square_texels"]

SIZES_PX = (128, 512, 1024)
"""Edge lengths that textures are brought to [px]."""

_ROOT_OF_LINEAR = np.round(255.0 * np.sqrt(LINEAR_OF_SRGB8)).astype(np.uint8)
"""(256,) uint8: the square root of linear colour, 0 to 255, over the sRGB code."""

_TEXEL_OF_PIXEL = np.stack([*[_ROOT_OF_LINEAR] * 3, np.arange(256, dtype=np.uint8)], axis=1)[None]
"""(1, 256, 4) uint8: the same for red, green and blue; alpha stays."""


LARGER = 1.25
"""A texture that is at most so many times as large as a size is brought to it: the next one takes
four to sixteen times the memory."""


def array_of(texture: Texture | None) -> int:
    """Return the place in `SIZES_PX` of the size that suits a texture; the last for larger ones.

    No texture lies in array -1.
    """
    if texture is None:
        return -1
    longest = max(texture.shape[:2])
    suits = (place for place, edge in enumerate(SIZES_PX) if longest <= LARGER * edge)
    return next(suits, len(SIZES_PX) - 1)


def square_texels(texture: Texture, edge: int, *, is_colour: bool) -> NDArray[np.uint8]:
    """Return the finest level of a texture.

    Parameters
    ----------
    texture : (H, W, 4) uint8
    edge : int
        Rows and columns that are wanted.
    is_colour : bool
        True for sRGB colours: the texels hold the square root of linear colour (see
        `geometry.frag`). Other textures are held as they are.

    Returns
    -------
    texels : (edge, edge, 4) uint8
        The bottom row first.
    """
    pixels = _resized(texture, edge)
    if is_colour:
        pixels = np.asarray(cv2.LUT(pixels, _TEXEL_OF_PIXEL), np.uint8)
    return pixels


def _resized(texture: Texture, edge: int) -> NDArray[np.uint8]:
    """Bring a texture to a square, its bottom row first as OpenGL has it."""
    flipped = np.ascontiguousarray(texture[::-1])
    if flipped.shape[:2] == (edge, edge):
        return flipped
    shrinks = max(flipped.shape[:2]) > edge
    method = cv2.INTER_AREA if shrinks else cv2.INTER_CUBIC
    return np.asarray(cv2.resize(flipped, (edge, edge), interpolation=method), dtype=np.uint8)
