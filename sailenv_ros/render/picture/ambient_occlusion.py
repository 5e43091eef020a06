"""Ambient occlusion in screen space: the share of the ambient light that reaches each surface.

Depth and instance ids come in, the ambient visibility at half resolution goes out. Each sample
looks at twelve points around it, within a radius on the surface and the denser the nearer: what
rises above its tangent plane hides a part of the half space before it, the less the farther it is
(after McGuire et al. 2011, "The alchemy screen-space ambient obscurance algorithm"). With x hidden,
1 / (1 + x) of the light is left: what hides light gives some of it back, so nothing gets black.
Which twelve differs from pixel to pixel in blocks of four by four; averaging over such a block on
one surface removes the pattern, and averaging once more over four by four samples farther apart
removes what is left of it.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.lens_rays import tells_depth, unit_ray_planes
from sailenv_ros.native.picture_kernels import AmbientSettings, find_ambient_visibility
from sailenv_ros.types.camera import CameraIntrinsics

__all__ = ["PATTERN", "ambient_visibility", "kernel_settings"]

TAPS = 12
REACH_PX = 48
"""Farthest point that is looked at, in samples: near things would else reach across the picture."""

LEAST_REACH_PX = 1.5
"""Radius in samples below which nothing can be told."""

BIAS = 0.08
"""Sine of the angle above the tangent plane up to which nothing hides: surfaces are not flat, and
slanted ones have coarse normals."""

GAIN = 16.0
"""A right-angled joint of two planes loses about half of the light at strength 1, as it should."""

SAME_SURFACE = 0.03
"""Share of its depth by which a sample may lie off another's surface and count as on it."""

LEAST_FORWARD = 0.3
"""Cosine from the axis down to which rays lead forwards."""

STEP_PER_PX, MOST_STEP = 86.0, 4
"""The second average goes over four samples that are this share of the focal length apart, and at
most so many samples: about 2 cm at 2 m, in small pictures too."""


def _pattern() -> NDArray[np.float32]:
    """Return (16, 2, TAPS): for each place in a block, points in the unit disc."""
    order = np.array([0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5]) / 16.0
    number = np.arange(TAPS)
    # A spiral by the golden angle covers the disc evenly; turning and growing it varies it.
    angle = 2.0 * np.pi * (order[:, None] + number * 0.381966)
    radius = (number + 0.25 + 0.75 * order[::-1, None]) / TAPS
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    return np.ascontiguousarray(points, np.float32)


PATTERN = _pattern()


def ambient_visibility(
    surface: NDArray[np.float32],
    intrinsics: CameraIntrinsics,
    *,
    strength: float,
    radius_m: float,
    known: NDArray[np.uint8],
    threads: int = 1,
) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Compute the share of the light from around that arrives.

    Parameters
    ----------
    surface : (H, W, 2) float32
        Depth along the optical axis [m], ``inf`` where nothing was hit, and the instance id.
    intrinsics : CameraIntrinsics
    strength : float
        0 to 1.
    radius_m : float
        How far away surfaces hide light from each other [m].
    known : (65536,) uint8
        By instance id, 1 of surfaces whose light is known, which do not darken each other.
    threads : int
        The result does not depend on it.

    Returns
    -------
    share : (h, w) uint8
        255 = all of it; at pixels of even row and column, h and w half of H and W, rounded up.
    inverse : (h, w) float32
        1 / depth at these pixels [1/m], negative where light was baked, -1e-9 where
        nothing was hit.
    """
    settings = kernel_settings(intrinsics, strength, radius_m)
    return find_ambient_visibility(
        surface,
        known,
        intrinsics.lens_record,
        settings,
        PATTERN,
        rays=None if tells_depth(intrinsics) else _halved_rays(intrinsics),
        parallel=intrinsics.is_parallel,
        threads=threads,
    )


@lru_cache(maxsize=8)
def _halved_rays(intrinsics: CameraIntrinsics) -> NDArray[np.float32]:
    rays = unit_ray_planes(intrinsics)[:, ::2, ::2]
    # Of depth 1 where they all lead forwards, as a pin-hole's, else of length 1.
    if np.nanmin(rays[2], initial=1.0) > LEAST_FORWARD:
        rays = rays / rays[2]
    return np.ascontiguousarray(rays, np.float32)


def kernel_settings(
    intrinsics: CameraIntrinsics, strength: float, radius_m: float
) -> AmbientSettings:
    """Return what `find_ambient_visibility` takes beside the picture."""
    return AmbientSettings(
        radius_m=radius_m,
        least_reach_px=LEAST_REACH_PX,
        reach_px=REACH_PX,
        bias=BIAS,
        scale=float(np.float32(GAIN / TAPS) * np.float32(strength)),
        same_surface=SAME_SURFACE,
        step=min(max(round(0.5 * intrinsics.fx / STEP_PER_PX), 1), MOST_STEP),
    )
