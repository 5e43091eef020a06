"""Rays from points of surfaces, and the sky that they meet.

By src/kernels/hemisphere_rays.cpp and sky_gathering.cpp; see `light.bake.gather` and
`light.bake.emitters`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.bake_types import Emitters, LitPoints, RayList, SkyWindows
from sailenv_ros.native.library import Kernel, checked

__all__ = [
    "emitter_rays",
    "emitter_weights",
    "hemisphere_rays",
    "pane_rays",
    "sky_by_chance",
    "sky_by_choice",
    "weights_within_cones",
]

Floats = NDArray[np.float32]
Integers = NDArray[np.int32]

_HEMISPHERE = Kernel("hemisphere_rays", "aiaaa")
_PANE = Kernel("pane_rays", "aaiaa")
_EMITTER = Kernel("emitter_rays", "aaiaa")
_EMITTER_WEIGHTS = Kernel("emitter_weights", "aaiaaiia")
_WITHIN_CONES = Kernel("weights_within_cones", "aaiaaiiaaaa")
_BY_CHANCE = Kernel("sky_by_chance", "aaiaaaia")
_BY_CHOICE = Kernel("sky_by_choice", "aaiaaaiia")


def hemisphere_rays(points: LitPoints, pattern: Floats) -> tuple[Floats, Floats]:
    """Make rays whose density is the cosine to the normal, over pi.

    Parameters
    ----------
    points : LitPoints
        Directions that would run into their faces are mirrored at these.
    pattern : (M, 2) float32
        A net of points of the unit square that become the directions; see `light.bake.sampling`.

    Returns
    -------
    origins, directions : (N, M, 3) float32
        A little off the face; unit length.
    """
    checked("pattern", pattern, np.float32, (None, 2))
    origins, directions = np.empty((2, points.count, len(pattern), 3), np.float32)
    _HEMISPHERE(points.record, len(pattern), pattern, origins, directions)
    return origins, directions


def pane_rays(points: LitPoints, pane: Floats, pattern: Floats) -> tuple[Integers, Floats, Floats]:
    """Make rays to points of a pane, (4, 3) float32, that lie above the horizon; see `RayList`."""
    checked("pane", pane, np.float32, (4, 3))
    checked("pattern", pattern, np.float32, (None, 2))
    made = RayList(points.count * len(pattern))
    _PANE(points.record, pane, len(pattern), pattern, made.record)
    return made.rays()


def emitter_rays(
    points: LitPoints, emitter: Floats, pattern: Floats
) -> tuple[Integers, Floats, Floats]:
    """Make rays into the cone of an emitter, (4,) float32, above the horizon; see `RayList`."""
    checked("emitter", emitter, np.float32, (4,))
    checked("pattern", pattern, np.float32, (None, 2))
    made = RayList(points.count * len(pattern))
    _EMITTER(points.record, emitter, len(pattern), pattern, made.record)
    return made.rays()


def emitter_weights(
    points: LitPoints,
    emitters: Emitters,
    point: Integers,
    towards: Floats,
    *,
    shots: int,
    others: int,
) -> Floats:
    """Return (R,) float32: how much rays into cones of emitters count.

    Parameters
    ----------
    point : (R,) int32
        Where each begins.
    towards : (R, 3) float32
    shots, others : int
        Rays from each point into each cone, and in all directions.
    """
    rays = len(point)
    checked("points of rays", point, np.int32, (None,))
    checked("directions", towards, np.float32, (rays, 3))
    weights = np.empty(rays, np.float32)
    _EMITTER_WEIGHTS(points.record, emitters.record, rays, point, towards, shots, others, weights)
    return weights


def weights_within_cones(
    points: LitPoints, emitters: Emitters, directions: Floats, texels: Integers, *, shots: int
) -> tuple[Integers, Integers, Floats]:
    """Find rays in all directions that lie in cones of emitters, and how much less they count.

    Parameters
    ----------
    directions : (N, M, 3) float32
    texels : (N, M) int32
        What the rays met; below 0 for no texel.
    shots : int
        Rays from each point into each cone.

    Returns
    -------
    point, texel : (R,) int32
    weight : (R,) float32
        Below 0: without cones each ray counts 1 / M.
    """
    count, rays = texels.shape
    checked("directions", directions, np.float32, (points.count, rays, 3))
    checked("texels", texels, np.int32, (points.count, rays))
    room, made = texels.size // 16, np.zeros(1, np.int64)
    while True:
        point, texel = np.empty((2, room), np.int32)
        weight = np.empty(room, np.float32)
        _WITHIN_CONES(
            points.record, emitters.record, rays, directions, texels, shots, room,
            point, texel, weight, made,
        )  # fmt: skip
        count = int(made[0])
        if count <= room:
            return point[:count], texel[:count], weight[:count]
        room = count


def sky_by_chance(
    points: LitPoints,
    sky: SkyWindows,
    directions: Floats,
    texels: Integers,
    clear: Floats,
    *,
    shots: int,
) -> Floats:
    """Return (N, 3) float32: irradiance / pi of the sky that rays in all directions meet.

    Parameters
    ----------
    directions : (N, M, 3) float32
    texels : (N, M) int32
        -1 where a ray met nothing.
    clear : (N, M) float32
        How much glass lets through.
    shots : int
        Rays from each point to each pane; both together are one estimate.
    """
    count, rays = texels.shape
    checked("directions", directions, np.float32, (points.count, rays, 3))
    checked("texels", texels, np.int32, (points.count, rays))
    checked("clearness", clear, np.float32, (points.count, rays))
    light = np.zeros((count, 3), np.float32)
    _BY_CHANCE(points.record, sky.record, rays, directions, texels, clear, shots, light)
    return light


def sky_by_choice(
    points: LitPoints,
    sky: SkyWindows,
    rays: tuple[Integers, Floats, Floats],
    *,
    shots: int,
    others: int,
    light: Floats,
) -> None:
    """Add the sky that rays to panes meet.

    Parameters
    ----------
    rays : (R,) int32, (R, 3) float32, (R,) float32
        The point where each begins, its direction, and how much of its light arrives.
    shots, others : int
        Rays from each point to each pane, and in all directions.
    light : (N, 3) float32
        Irradiance / pi; added to.
    """
    point, towards, share = rays
    checked("points of rays", point, np.int32, (None,))
    checked("directions", towards, np.float32, (len(point), 3))
    checked("shares", share, np.float32, (len(point),))
    checked("light", light, np.float32, (points.count, 3))
    _BY_CHOICE(
        points.record, sky.record, len(point), point, towards, share, shots, others, light
    )  # fmt: skip
