"""Effects of glass on light: vignetting and lateral chromatic aberration.

Radiance comes in, radiance goes out. Both follow the angle or the distance from the optical axis.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.lens_rays import depth_shares
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.picture_settings import PictureSettings

__all__ = ["through_lens"]


def through_lens(
    radiance: NDArray[np.float16], lens: CameraIntrinsics, settings: PictureSettings
) -> NDArray[np.float16]:
    """Let light through a lens.

    Parameters
    ----------
    radiance : (H, W, 4) float16
        Linear; the fourth number is kept.
    lens : CameraIntrinsics
    settings : PictureSettings
        Of which `lateral_colour` and `vignetting` count.

    Returns
    -------
    radiance : (H, W, 4) float16
        A fresh array.
    """
    light = radiance.astype(np.float32)
    if settings.lateral_colour:
        for channel, share in ((0, settings.lateral_colour), (2, -settings.lateral_colour)):
            light[..., channel] = _scaled(light[..., channel], lens, 1.0 + share)
    if settings.vignetting:
        light[..., :3] *= _falloff(lens, settings.vignetting)[..., None]
    return light.astype(np.float16)


@lru_cache(maxsize=8)
def _falloff(lens: CameraIntrinsics, strength: float) -> NDArray[np.float32]:
    """Return (H, W) float32: 1 on the axis, and less with the fourth power of the cosine.

    R. Kingslake, "Optics in Photography" (1992), chapter 7: natural vignetting. Where the lens
    sees to the side no light arrives.
    """
    if lens.is_pinhole:
        cosine = 1.0 / np.linalg.norm(lens.rays(), axis=-1)
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
