"""From radiance to an 8-bit picture: occlusion of the light from around, tone curve, sRGB.

Half-precision radiance and the share of it that came from around come in, sRGB with luma goes
out. One walk on the processor; the tone curve is a table (`tone.code_table`).
"""

from __future__ import annotations

from typing import TypeAlias

import numba
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.bands import Bands, alone

__all__ = ["Shade", "develop", "shaded", "warm_up"]

Shade: TypeAlias = tuple[NDArray[np.uint8], NDArray[np.float32]]
"""What `ambient_occlusion.open_share` gives: share and 1 / depth at half resolution."""

SAME_SURFACE = 0.04
"""Share of its depth by which a sample of the occlusion may lie off a pixel's own surface."""


def develop(
    radiance: NDArray[np.float16],
    table: NDArray[np.uint8],
    shade: Shade | None,
    surface: NDArray[np.float32],
    *,
    bands: Bands = alone,
) -> NDArray[np.uint8]:
    """Develop a picture.

    Parameters
    ----------
    radiance : (H, W, 4) float16
        Linear, as the scene's exposure left it; the fourth number is the share of the light that
        came from around.
    table : (65536,) uint8
        See `tone.code_table`.
    shade : Shade or None
        How much of that share arrives; None if all of it does.
    surface : (H, W, 2) float32
        Depth, for telling surfaces apart.

    Returns
    -------
    picture : (H, W, 4) uint8
        sRGB and luma; a fresh array.
    """
    picture = np.empty(radiance.shape, np.uint8)
    bits = radiance.view(np.uint16)
    if shade is None:
        bands(lambda first, last: _plain(bits, table, picture, first, last), len(bits))
    else:
        bands(
            lambda first, last: _develop(bits, table, *shade, surface, picture, first, last),
            len(bits),
        )
    return picture


def shaded(
    radiance: NDArray[np.float16],
    open_share: NDArray[np.uint8],
    inverse: NDArray[np.float32],
    surface: NDArray[np.float32],
) -> NDArray[np.float16]:
    """Take away the light from around that does not arrive; a fresh array."""
    result = radiance.copy()
    _shade(result.view(np.uint16), open_share, inverse, surface)
    return result


def warm_up() -> None:
    """Compile the walks now (or load them from numba's cache), not at the first frame."""
    radiance, table = np.zeros((8, 8, 4), np.float16), np.zeros(65536, np.uint8)
    half, surface = np.zeros((4, 4), np.float32), np.zeros((8, 8, 2), np.float32)
    read_only = table.view()
    read_only.flags.writeable = False
    for shade in (None, (half.astype(np.uint8), half)):
        develop(radiance, read_only, shade, surface)
    shaded(radiance, half.astype(np.uint8), half, surface)


@numba.njit(cache=True, nogil=True)
def _put(picture, v, u, r, g, b):  # type: ignore[no-untyped-def]  # compiled
    picture[v, u, 0] = r
    picture[v, u, 1] = g
    picture[v, u, 2] = b
    # Luma of ITU-R BT.601 in 256ths.
    picture[v, u, 3] = (77 * np.int32(r) + 150 * np.int32(g) + 29 * np.int32(b) + 128) >> 8


@numba.njit(cache=True, nogil=True)
def _plain(bits, table, picture, first, last):  # type: ignore[no-untyped-def]  # compiled
    for v in range(first, last):
        for u in range(bits.shape[1]):
            _put(picture, v, u, table[bits[v, u, 0]], table[bits[v, u, 1]], table[bits[v, u, 2]])


@numba.njit(cache=True, nogil=True)
def _develop(  # type: ignore[no-untyped-def]  # compiled
    bits, table, open_share, inverse, surface, picture, first, last
):
    factors = np.empty(bits.shape[1], np.float32)
    for v in range(first, last):
        _find_arriving(bits, open_share, inverse, surface, v, factors)
        for u in range(bits.shape[1]):
            r = _scaled(bits[v, u, 0], factors[u])
            g = _scaled(bits[v, u, 1], factors[u])
            b = _scaled(bits[v, u, 2], factors[u])
            _put(picture, v, u, table[r], table[g], table[b])


@numba.njit(cache=True, nogil=True)
def _shade(bits, open_share, inverse, surface):  # type: ignore[no-untyped-def]  # compiled
    factors = np.empty(bits.shape[1], np.float32)
    for v in range(bits.shape[0]):
        _find_arriving(bits, open_share, inverse, surface, v, factors)
        for u in range(bits.shape[1]):
            for c in range(3):
                bits[v, u, c] = _scaled(bits[v, u, c], factors[u])


@numba.njit(cache=True, nogil=True)
def _scaled(half, factor):  # type: ignore[no-untyped-def]  # compiled
    """Multiply a half-precision number of 0 or more, given by its bits, with 0 to 1; gives bits."""
    # The bits of a half, shifted, are those of a float 2^112 times smaller.
    number = np.int32(np.int32(half) << 13).view(np.float32) * factor
    return np.uint16((np.float32(number).view(np.int32) + 4096) >> 13)


@numba.njit(cache=True, nogil=True)
def _find_arriving(  # type: ignore[no-untyped-def]  # compiled
    bits, open_share, inverse, surface, v, factors
):
    """Share of each pixel's light in a row that is left, by the nearest sample on its surface."""
    one, off = np.float32(1.0), np.float32(SAME_SURFACE)
    above, below = v >> 1, min((v >> 1) + 1, open_share.shape[0] - 1)
    last = open_share.shape[1] - 1
    for u in range(bits.shape[1]):
        z = surface[v, u, 0]
        row, column = above, u >> 1
        found = abs(abs(inverse[row, column]) * z - one) <= off
        if not found:
            # An edge runs between the sample and the pixel: another may lie on its surface.
            for more in range(1, 4):
                row = below if more >= 2 else above
                column = min((u >> 1) + (more & 1), last)
                found = abs(abs(inverse[row, column]) * z - one) <= off
                if found:
                    break
        arriving = open_share[row, column] if found else np.uint8(255)
        share = np.int32(np.int32(bits[v, u, 3]) << 13).view(np.float32) * np.float32(2.0**112)
        closed = np.float32(np.int32(255) - np.int32(arriving)) * np.float32(1.0 / 255.0)
        factors[u] = one - min(share, one) * closed
