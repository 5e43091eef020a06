"""From several samples a pixel to one: the mean of their light.

Radiance of samples comes in, radiance of pixels goes out, less the light from around that does not
arrive. Light is averaged before the tone curve, as a sensor's pixel gathers it; what is done to
the picture afterwards works on pixels and means what it means without supersampling.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.picture_kernels import resolve_samples
from sailenv_ros.render.picture.tone_map import SAME_SURFACE, AmbientShade

__all__ = ["mean_radiance"]


def mean_radiance(
    samples: NDArray[np.float16],
    times: int,
    shade: AmbientShade | None,
    surface: NDArray[np.float32] | None,
    *,
    threads: int = 1,
) -> NDArray[np.float16]:
    """Average the samples of each pixel.

    Parameters
    ----------
    samples : (times H, times W, 4) float16
        Linear radiance, and the share of it that came from around.
    times : int
        Samples on a side of a pixel.
    shade : AmbientShade or None
        How much of that share arrives at the pixels; None if all of it does.
    surface : (times H, times W, 2) float32 or None
        Depth of the samples, for telling surfaces apart; needed beside a shade.
    threads : int
        The result does not depend on it.

    Returns
    -------
    radiance : (H, W, 4) float16
        A fresh array; the fourth number is 0, for the share has been settled.
    """
    visibility, inverse = (None, None) if shade is None else shade
    return resolve_samples(
        samples,
        times,
        visibility,
        inverse,
        surface,
        same_surface=SAME_SURFACE,
        threads=threads,
    )
