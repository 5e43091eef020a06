"""From radiance to an 8-bit picture: ambient visibility, tone curve, sRGB.

Half-precision radiance and the share of it that came from around come in, sRGB goes out. The tone
curve is a table (`tone.code_table`).
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.picture_kernels import make_picture, resolve_samples

__all__ = ["SAME_SURFACE", "AmbientShade", "apply_visibility", "tone_map"]

AmbientShade: TypeAlias = tuple[NDArray[np.uint8], NDArray[np.float32]]
"""Result of `ambient_occlusion.ambient_visibility`: the visibility, and 1 / depth there."""

SAME_SURFACE = 0.04
"""Share of its depth by which a sample of the visibility may lie off a pixel's own surface."""


def tone_map(
    radiance: NDArray[np.float16],
    table: NDArray[np.uint8],
    shade: AmbientShade | None,
    surface: NDArray[np.float32] | None,
    *,
    threads: int = 1,
) -> NDArray[np.uint8]:
    """Apply the tone curve to a picture.

    Parameters
    ----------
    radiance : (H, W, 4) float16
        Linear, as the scene's exposure left it; the fourth number is the share of the light that
        came from around.
    table : (65536,) uint8
        See `tone.code_table`.
    shade : AmbientShade or None
        How much of that share arrives; None if all of it does.
    surface : (H, W, 2) float32 or None
        Depth, for telling surfaces apart; needed with `shade`.
    threads : int
        The picture does not depend on it.

    Returns
    -------
    rgb : (H, W, 3) uint8
        sRGB; a fresh array.
    """
    visibility, inverse = (None, None) if shade is None else shade
    return make_picture(
        radiance,
        table,
        visibility,
        inverse,
        surface,
        same_surface=SAME_SURFACE,
        threads=threads,
    )


def apply_visibility(
    radiance: NDArray[np.float16],
    visibility: NDArray[np.uint8],
    inverse: NDArray[np.float32],
    surface: NDArray[np.float32],
    *,
    threads: int = 1,
) -> NDArray[np.float16]:
    """Take away the light from around that does not arrive; a fresh array."""
    return resolve_samples(
        radiance,
        1,
        visibility,
        inverse,
        surface,
        same_surface=SAME_SURFACE,
        keep_ambient_share=True,
        threads=threads,
    )
