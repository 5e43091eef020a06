"""Effects of glass on light: vignetting, lateral chromatic aberration, dirt.

Radiance comes in, radiance goes out. The first two follow the angle or the distance from the
optical axis; dirt stays where it is on the glass.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.lens_rays import depth_shares, ray_lengths
from sailenv_ros.native.lens_light import scale_light, weigh_light
from sailenv_ros.system.memory import cached_for_scenes
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.picture_settings import PictureSettings

__all__ = ["dirt_cover", "through_lens"]

SPOTS = 60
SPOT_RADII, SPOT_COVER = (0.015, 0.1), (0.1, 0.65)
"""Radii of spots in heights of the picture, and the light that they hold back in their middle."""

SMEAR_COVER, SMEAR_NODES = 0.35, 7
"""Light that smears hold back at most, and their knots along the picture's height."""

VEIL = 0.5
"""Share of the light held back that arrives elsewhere: it brightens all alike."""


def through_lens(
    radiance: NDArray[np.float16],
    lens: CameraIntrinsics,
    settings: PictureSettings,
    *,
    threads: int = 1,
) -> NDArray[np.float16]:
    """Let light through a lens.

    Parameters
    ----------
    radiance : (H, W, 4) float16
        Linear; the fourth number is kept.
    lens : CameraIntrinsics
    settings : PictureSettings
        Of which `dirt`, `lateral_colour` and `vignetting` count.
    threads : int
        The result does not depend on it.

    Returns
    -------
    radiance : (H, W, 4) float16
        A fresh array.
    """
    if settings.lateral_colour:
        light = radiance.astype(np.float32)
        for channel, share in ((0, settings.lateral_colour), (2, -settings.lateral_colour)):
            light[..., channel] = _scaled(light[..., channel], lens, 1.0 + share)
        radiance = light.astype(np.float16)
    if not (settings.vignetting or settings.dirt):
        return radiance
    left, held = _shares(lens, settings.vignetting, settings.dirt)
    veil = np.zeros(3, np.float32)
    if held is not None:
        sums = weigh_light(radiance, held, threads=threads)
        veil = (VEIL / held.size * sums).astype(np.float32)
    return scale_light(radiance, left, np.ones(3, np.float32), veil, threads=threads)


@cached_for_scenes(4)
def _shares(
    lens: CameraIntrinsics, vignetting: float, dirt: float
) -> tuple[NDArray[np.float32], NDArray[np.float32] | None]:
    """Return (H, W) float32 each: shares of light that pass, and that dirt holds back, if any."""
    arriving = np.ones((lens.height, lens.width), np.float32)
    if vignetting:
        arriving = _falloff(lens, vignetting)
    if not dirt:
        return arriving, None
    held = arriving * np.float32(dirt) * dirt_cover(lens.width, lens.height)
    return arriving - held, held


@lru_cache(maxsize=4)
def dirt_cover(width: int, height: int) -> NDArray[np.float32]:
    """Return (H, W) float32: the share of light that dirt holds back at its worst, 0 to 1.

    Spots are out of focus, so they have soft edges; smears are smooth noise. It is always the same
    dirt: as many pixels or fewer show the same.
    """
    from scipy.ndimage import zoom  # takes long to import, and few need it

    rng = np.random.default_rng([ord(letter) for letter in "dirt"])
    aspect = width / height
    places = rng.random((SPOTS, 2)) * np.array([1.0, aspect])
    (small, large), (thin, thick) = np.log(SPOT_RADII), SPOT_COVER
    radii = np.exp(rng.uniform(small, large, SPOTS))
    depths = rng.uniform(thin, thick, SPOTS)
    v, u = (np.mgrid[:height, :width] + 0.5).astype(np.float32) / np.float32(height)
    clear = np.ones((height, width), np.float32)
    for place, radius, depth in zip(places, radii, depths, strict=True):
        away = np.hypot(v - np.float32(place[0]), u - np.float32(place[1])) / radius
        edge = ((1.6 - away) / 1.4).clip(0.0, 1.0)
        clear *= 1.0 - depth * edge**2 * (3.0 - 2.0 * edge)
    nodes = rng.random((SMEAR_NODES, max(2, round(SMEAR_NODES * aspect))))
    factors = (height / nodes.shape[0], width / nodes.shape[1])
    smears = zoom(nodes, factors, order=3, mode="nearest", grid_mode=True)
    clear *= 1.0 - np.float32(SMEAR_COVER) * smears.astype(np.float32).clip(0.0, 1.0)
    cover: NDArray[np.float32] = (1.0 - clear).astype(np.float32)
    return cover


def _falloff(lens: CameraIntrinsics, strength: float) -> NDArray[np.float32]:
    """Return (H, W) float32: 1 on the axis, and less with the fourth power of the cosine.

    R. Kingslake, "Optics in Photography" (1992), chapter 7: natural vignetting. Where the lens
    sees to the side no light arrives.
    """
    if lens.is_pinhole:
        cosine = 1.0 / ray_lengths(lens)
    else:
        cosine = np.nan_to_num(depth_shares(lens).astype(np.float64)).clip(0.0, 1.0)
    falloff: NDArray[np.float32] = (1.0 - strength * (1.0 - cosine**4)).astype(np.float32)
    return falloff


def _scaled(
    channel: NDArray[np.float32], lens: CameraIntrinsics, scale: float
) -> NDArray[np.float32]:
    """Return a channel whose picture is so many times as large, around the optical axis."""
    from scipy.ndimage import map_coordinates  # takes long to import, and few need it

    height, width = channel.shape
    rows = lens.cy + (np.arange(height) - lens.cy) / scale
    columns = lens.cx + (np.arange(width) - lens.cx) / scale
    places = np.stack(np.meshgrid(rows, columns, indexing="ij"))
    scaled: NDArray[np.float32] = map_coordinates(channel, places, order=1, mode="nearest")
    return scaled
