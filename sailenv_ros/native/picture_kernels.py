"""The kernels of pictures: from what is seen and its radiance to 8-bit sRGB.

Method and constants stand in `render.picture`: `ambient_occlusion` (how much light from around
arrives), `sensor` (bloom and noise), `supersampling` (samples of a pixel) and `tone_map`. The tests
define all sums in plain NumPy.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.lens import LENS
from sailenv_ros.native.library import Kernel, checked
from sailenv_ros.native.records import RecordKernel

__all__ = [
    "AmbientSettings",
    "find_ambient_visibility",
    "gather_light",
    "make_picture",
    "resolve_samples",
]

_AMBIENT = RecordKernel(
    "ambient_visibility",
    ("integer", "height width"),
    ("array", "surface known pattern lens rays"),
    ("integer", "parallel"),
    ("number", "radius_m least_reach_px reach_px bias scale same_surface"),
    ("integer", "step"),
    ("array", "inverse visibility"),
)
_GATHER = Kernel("gather_light", "iiiannniaa")
_RESOLVE = Kernel("resolve", "iiiiaaaania")
_PICTURE = Kernel("make_picture", "iiiaaaaana")


Shade = tuple[NDArray[Any] | None, NDArray[Any] | None, NDArray[Any] | None]
"""Visibility, 1 / depth there, and depth and ids; or nothing."""


class AmbientSettings(NamedTuple):
    """How ambient visibility is found; the kernel rounds the numbers to single precision.

    Attributes
    ----------
    radius_m : float
        How far away surfaces hide light from each other [m].
    least_reach_px, reach_px : float
        The least and the greatest radius in samples.
    bias : float
        Sine of the angle above the tangent plane up to which nothing hides.
    scale : float
        How much one tap that hides everything takes away.
    same_surface : float
        Share of its depth by which a sample may lie off another's surface.
    step : int
        Samples from one to the next of the second average, 1 to 4.
    """

    radius_m: float
    least_reach_px: float
    reach_px: float
    bias: float
    scale: float
    same_surface: float
    step: int


def find_ambient_visibility(
    surface: NDArray[np.float32],
    known: NDArray[np.uint8],
    lens: NDArray[np.void],
    settings: AmbientSettings,
    pattern: NDArray[np.float32],
    *,
    rays: NDArray[np.float32] | None = None,
    parallel: bool = False,
    threads: int,
) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Compute the share of the light from around that arrives, at half resolution.

    Parameters
    ----------
    surface : (H, W, 2) float32
        Depth [m] and instance id.
    known : (65536,) uint8
        By instance id: 1 of surfaces whose light is known, which do not darken each other.
    lens : (1,) lens.LENS
    settings : AmbientSettings
    pattern : (16, 2, 12) float32
        For each place in a block, points in the unit disc.
    rays : (3, h, w) float32 or None
        Rays of the pixels of even row and column, of any length, along which the surface tells
        distances; None where it tells depths.
    parallel : bool
        Whether the lens has parallel rays.
    threads : int

    Returns
    -------
    visibility : (h, w) uint8
        255 = all of it; h and w are half of H and W, rounded up.
    inverse : (h, w) float32
        1 / depth [1/m], negative where light was baked, -1e-9 where nothing was hit.

    Raises
    ------
    InvalidRequest
        If an array has another type or shape.
    NativeLibraryError
        If there is no library, no memory, or an argument cannot be accepted.
    """
    height, width = surface.shape[:2]
    checked("surface", surface, np.float32, (height, width, 2))
    checked("known", known, np.uint8, (65536,))
    checked("lens", lens, LENS, (1,))
    checked("pattern", pattern, np.float32, (16, 2, 12))
    shape = (height + 1) // 2, (width + 1) // 2
    if rays is not None:
        checked("rays", rays, np.float32, (3, *shape))
    inverse, visibility = np.empty(shape, np.float32), np.empty(shape, np.uint8)
    _AMBIENT(
        threads,
        height=height,
        width=width,
        surface=surface,
        known=known,
        pattern=pattern,
        lens=lens,
        rays=rays,
        parallel=parallel,
        **settings._asdict(),
        inverse=inverse,
        visibility=visibility,
    )
    return visibility, inverse


def gather_light(
    radiance: NDArray[np.float16],
    bloom: float,
    shot: float,
    read: float,
    seed: int,
    normal: NDArray[np.float32] | None,
    *,
    threads: int,
) -> NDArray[np.float16]:
    """Spread light and add noise.

    Parameters
    ----------
    radiance : (H, W, 4) float16
        Linear, 0 or more; the fourth number is kept.
    bloom : float
        Share of the light that is spread.
    shot, read : float
        The variance of a radiance x is x · shot + read.
    seed : int
        64 bits, signed.
    normal : (65536,) float32 or None
        Numbers that noise is drawn from; None for no noise.
    threads : int

    Returns
    -------
    radiance : (H, W, 4) float16
        A fresh array, 0 to 6e4.

    Raises
    ------
    InvalidRequest, NativeLibraryError
        As `find_ambient_visibility`.
    """
    height, width = radiance.shape[:2]
    checked("radiance", radiance, np.float16, (height, width, 4))
    if normal is not None:
        checked("normal", normal, np.float32, (65536,))
    result = np.empty((height, width, 4), np.float16)
    _GATHER(threads, height, width, radiance, bloom, shot, read, seed, normal, result)
    return result


def resolve_samples(
    samples: NDArray[np.float16],
    times: int,
    visibility: NDArray[np.uint8] | None,
    inverse: NDArray[np.float32] | None,
    surface: NDArray[np.float32] | None,
    *,
    same_surface: float,
    keep_ambient_share: bool = False,
    threads: int,
) -> NDArray[np.float16]:
    """Average the samples of each pixel.

    Parameters
    ----------
    samples : (times H, times W, 4) float16
        Linear radiance, 0 or more, and the share of it that came from around.
    times : int
        Samples on a side of a pixel.
    visibility, inverse : arrays or None
        What `find_ambient_visibility` returns for the pixels; None where all light arrives.
    surface : (times H, times W, 2) float32 or None
        Depth [m] and instance id of the samples; needed beside `visibility`.
    same_surface : float
        Share of its depth by which a sample of `visibility` may lie off another's surface.
    keep_ambient_share : bool
        True keeps the fourth number, where there is one sample a pixel; else it becomes 0.
    threads : int

    Returns
    -------
    radiance : (H, W, 4) float16
        A fresh array.

    Raises
    ------
    InvalidRequest, NativeLibraryError
        As `find_ambient_visibility`.
    """
    height, width = samples.shape[0] // times, samples.shape[1] // times
    checked("samples", samples, np.float16, (times * height, times * width, 4))
    shade = _checked_shade((visibility, inverse, surface), height, width, times)
    radiance = np.empty((height, width, 4), np.float16)
    _RESOLVE(
        *(threads, height, width, times, samples, *shade),
        *(same_surface, int(keep_ambient_share), radiance),
    )
    return radiance


def make_picture(
    radiance: NDArray[np.float16],
    table: NDArray[np.uint8],
    visibility: NDArray[np.uint8] | None,
    inverse: NDArray[np.float32] | None,
    surface: NDArray[np.float32] | None,
    *,
    same_surface: float,
    threads: int,
) -> NDArray[np.uint8]:
    """Make the picture.

    Parameters
    ----------
    radiance : (H, W, 4) float16
        Linear, 0 or more; the fourth number is the share of the light that came from around.
    table : (65536,) uint8
        Stored value of each half-precision number, by its bits.
    visibility, inverse : arrays or None
        What `find_ambient_visibility` returns; None where all light arrives.
    surface : (H, W, 2) float32 or None
        Depth [m] and instance id; needed beside `visibility`.
    same_surface : float
        Share of its depth by which a sample of `visibility` may lie off a pixel's own surface.
    threads : int

    Returns
    -------
    rgb : (H, W, 3) uint8
        A fresh array.

    Raises
    ------
    InvalidRequest, NativeLibraryError
        As `find_ambient_visibility`.
    """
    height, width = radiance.shape[:2]
    checked("radiance", radiance, np.float16, (height, width, 4))
    checked("table", table, np.uint8, (65536,))
    shade = _checked_shade((visibility, inverse, surface), height, width)
    rgb = np.empty((height, width, 3), np.uint8)
    _PICTURE(
        *(threads, height, width, radiance, table, *shade),
        *(same_surface, rgb),
    )
    return rgb


def _checked_shade(given: Shade, height: int, width: int, times: int = 1) -> Shade:
    """Return what a kernel takes of a picture's shade: nothing, unless all three are there."""
    visibility, inverse, surface = given
    if visibility is None or inverse is None or surface is None:
        return None, None, None
    half = (height + 1) // 2, (width + 1) // 2
    return (
        checked("visibility", visibility, np.uint8, half),
        checked("inverse", inverse, np.float32, half),
        checked("surface", surface, np.float32, (times * height, times * width, 2)),
    )
