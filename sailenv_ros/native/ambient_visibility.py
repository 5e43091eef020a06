"""The kernel of ambient visibility: from depth and ids to how much light from around arrives.

The method and its constants stand in `render.ambient_occlusion`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.lens import LENS
from sailenv_ros.native.library import checked
from sailenv_ros.native.records import RecordKernel

__all__ = ["AmbientSettings", "find_ambient_visibility"]

_KERNEL = RecordKernel(
    "ambient_visibility",
    height="integer",
    width="integer",
    surface="array",
    baked="array",
    pattern="array",
    lens="array",
    radius_m="number",
    least_reach_px="number",
    reach_px="number",
    bias="number",
    scale="number",
    same_surface="number",
    step="integer",
    inverse="array",
    visibility="array",
)


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
    baked: NDArray[np.bool_],
    lens: NDArray[np.void],
    settings: AmbientSettings,
    pattern: NDArray[np.float32],
    *,
    threads: int,
) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Compute the share of the light from around that arrives, at half resolution.

    Parameters
    ----------
    surface : (H, W, 2) float32
        Depth [m] and instance id.
    baked : (65536,) bool
        By instance id: surfaces whose light was baked.
    lens : (1,) lens.LENS
    settings : AmbientSettings
    pattern : (16, 2, 12) float32
        For each place in a block, points in the unit disc.
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
        If there is no library, or no memory.
    """
    height, width = surface.shape[:2]
    checked("surface", surface, np.float32, (height, width, 2))
    checked("baked", baked, np.bool_, (65536,))
    checked("lens", lens, LENS, (1,))
    checked("pattern", pattern, np.float32, (16, 2, 12))
    shape = (height + 1) // 2, (width + 1) // 2
    inverse, visibility = np.empty(shape, np.float32), np.empty(shape, np.uint8)
    _KERNEL(
        threads,
        height=height,
        width=width,
        surface=surface,
        baked=baked,
        pattern=pattern,
        lens=lens,
        **settings._asdict(),
        inverse=inverse,
        visibility=visibility,
    )
    return visibility, inverse
