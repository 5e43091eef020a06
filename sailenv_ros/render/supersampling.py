"""From several samples a pixel to one: the mean of their light.

Radiance of samples comes in, radiance of pixels goes out, less the light from around that does not
arrive. Light is averaged before the tone curve, as a sensor's pixel gathers it; what is done to
the picture afterwards works on pixels and means what it means without supersampling.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.bands import Bands, alone
from sailenv_ros.render.develop import SAME_SURFACE, Shade

__all__ = ["mean_radiance", "warm_up"]

_OPEN: Shade = np.zeros((1, 1), np.uint8), np.zeros((1, 1), np.float32)
_NOWHERE = np.zeros((1, 1, 2), np.float32)
"""Stand for a shade and its surfaces where there are none."""


def mean_radiance(
    samples: NDArray[np.float16],
    times: int,
    shade: Shade | None,
    surface: NDArray[np.float32] | None,
    *,
    bands: Bands = alone,
) -> NDArray[np.float16]:
    """Average the samples of each pixel.

    Parameters
    ----------
    samples : (times H, times W, 4) float16
        Linear radiance, and the share of it that came from around.
    times : int
        Samples on a side of a pixel.
    shade : Shade or None
        How much of that share arrives at the pixels; None if all of it does.
    surface : (times H, times W, 2) float32 or None
        Depth of the samples, for telling surfaces apart; needed beside a shade.

    Returns
    -------
    radiance : (H, W, 4) float16
        A fresh array; the fourth number is 0, for the share has been settled.
    """
    height, width = samples.shape[0] // times, samples.shape[1] // times
    radiance = np.empty((height, width, 4), np.float16)
    bits, out = samples.view(np.uint16), radiance.view(np.uint16)
    open_share, inverse = _OPEN if shade is None else shade
    depths = _NOWHERE if surface is None else surface
    shaded = shade is not None
    bands(
        lambda first, last: _average(
            bits, times, shaded, open_share, inverse, depths, out, first, last
        ),
        height,
    )
    return radiance


def warm_up() -> None:
    """Compile the walk now (or load it from numba's cache), not at the first frame."""
    mean_radiance(np.zeros((8, 8, 4), np.float16), 2, None, None)


@numba.njit(cache=True, nogil=True)
def _average(  # type: ignore[no-untyped-def]  # compiled
    bits, times, shaded, open_share, inverse, surface, out, first, last
):
    part = np.float32(1.0 / (times * times))
    one, off = np.float32(1.0), np.float32(SAME_SURFACE)
    bottom, right = open_share.shape[0] - 1, open_share.shape[1] - 1
    for v in range(first, last):
        above, below = v >> 1, min((v >> 1) + 1, bottom)
        for u in range(out.shape[1]):
            r = g = b = np.float32(0.0)
            for i in range(v * times, v * times + times):
                for j in range(u * times, u * times + times):
                    weight = part
                    if shaded:
                        # As in develop: by the nearest number that is of the sample's surface.
                        z = surface[i, j, 0]
                        arriving = np.uint8(255)
                        for more in range(4):
                            row = below if more >= 2 else above
                            column = min((u >> 1) + (more & 1), right)
                            if abs(abs(inverse[row, column]) * z - one) <= off:
                                arriving = open_share[row, column]
                                break
                        share = _number(bits[i, j, 3]) * np.float32(2.0**112)
                        closed = np.float32(np.int32(255) - np.int32(arriving))
                        weight *= one - min(share, one) * closed * np.float32(1.0 / 255.0)
                    r += weight * _number(bits[i, j, 0])
                    g += weight * _number(bits[i, j, 1])
                    b += weight * _number(bits[i, j, 2])
            out[v, u, 0] = _bits(r)
            out[v, u, 1] = _bits(g)
            out[v, u, 2] = _bits(b)
            out[v, u, 3] = 0


@numba.njit(cache=True, nogil=True)
def _number(half):  # type: ignore[no-untyped-def]  # compiled
    """Give a half-precision number of 0 or more by its bits, 2^112 times smaller."""
    return np.int32(np.int32(half) << 13).view(np.float32)


@numba.njit(cache=True, nogil=True)
def _bits(number):  # type: ignore[no-untyped-def]  # compiled
    return np.uint16((np.float32(number).view(np.int32) + 4096) >> 13)
