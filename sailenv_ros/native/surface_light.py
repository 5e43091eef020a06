"""Light that goes from surface to surface, by src/kernels/surface_light.cpp.

See `light.bake.gather`, `light.bake.bounces` and `light.bake.light_probes`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.bake_types import MappedTriangles, SkyWindows
from sailenv_ros.native.library import Kernel, checked

__all__ = [
    "add_radiance_met",
    "hand_on",
    "mean_radiance_met",
    "met_texels",
    "patch_sources",
    "probe_radiance",
]

Floats = NDArray[np.float32]
Integers = NDArray[np.int32]

_MET = Kernel("met_texels", "aiaaaaa")
_MEAN = Kernel("mean_radiance_met", "iiaiiaa")
_ADD = Kernel("add_radiance_met", "iaaaiiaia")
_PROBES = Kernel("probe_radiance", "iaiiaaaiiaa")
_SOURCES = Kernel("patch_sources", "iaaiiaaaaa")
_HAND_ON = Kernel("hand_on", "iiaaiaa")


def met_texels(
    triangles: MappedTriangles,
    triangle: Integers,
    second: Floats,
    third: Floats,
    directions: Floats,
) -> Integers:
    """Return (R,) int32: the texel that each ray met, -1 for the sky, -2 for a back.

    Parameters
    ----------
    triangle : (R,) int32
        Met by each ray, -1 for none.
    second, third : (R,) float32
        Weights of its second and third corner.
    directions : (R, 3) float32
    """
    rays = len(triangle)
    checked("triangles", triangle, np.int32, (None,))
    checked("second weights", second, np.float32, (rays,))
    checked("third weights", third, np.float32, (rays,))
    checked("directions", directions, np.float32, (rays, 3))
    found = np.empty(rays, np.int32)
    _MET(triangles.record, rays, triangle, second, third, directions, found)
    return found


def mean_radiance_met(texels: Integers, radiance: Floats) -> Floats:
    """Return (N, C) float32: irradiance / pi from the texels that rays met.

    Parameters
    ----------
    texels : (N, M) int32
        Negative ones are dark.
    radiance : (T, C) float32
    """
    checked("texels", texels, np.int32, (None, None))
    checked("radiance", radiance, np.float32, (None, None))
    light = np.empty((len(texels), radiance.shape[1]), np.float32)
    _MEAN(*texels.shape, texels, *radiance.shape, radiance, light)
    return light


def add_radiance_met(
    point: Integers, texel: Integers, weight: Floats, radiance: Floats, light: Floats
) -> None:
    """Add what single rays met, times their weights, to the light of points.

    Parameters
    ----------
    point, texel : (R,) int32
    weight : (R,) float32
    radiance : (T, C) float32
    light : (N, C) float32
        Irradiance / pi; added to.
    """
    rays = len(point)
    checked("points", point, np.int32, (None,))
    checked("texels", texel, np.int32, (rays,))
    checked("weights", weight, np.float32, (rays,))
    checked("radiance", radiance, np.float32, (None, None))
    checked("light", light, np.float32, (None, radiance.shape[1]))
    _ADD(rays, point, texel, weight, *radiance.shape, radiance, len(light), light)


def probe_radiance(
    directions: Floats,
    texels: Integers,
    clear: Floats,
    sky: SkyWindows,
    radiance: Floats,
    *,
    threads: int,
) -> Floats:
    """Return (N, 4, C) float32: what arrives at points in the air; see `LightLayer`.

    Parameters
    ----------
    directions : (M, 3) float32
    texels : (N, M) int32
        What the rays met: -1 for the sky, -2 for a back.
    clear : (N, M) float32
        How much glass lets through.
    radiance : (T, C) float32
        The sky adds to the first three channels.
    """
    count, rays = texels.shape
    checked("directions", directions, np.float32, (rays, 3))
    checked("texels", texels, np.int32, (None, None))
    checked("clearness", clear, np.float32, (count, rays))
    checked("radiance", radiance, np.float32, (None, None))
    light = np.empty((count, 4, radiance.shape[1]), np.float32)
    _PROBES(
        threads, sky.record, count, rays, directions, texels, clear, *radiance.shape, radiance,
        light,
    )  # fmt: skip
    return light


def patch_sources(
    members: Integers,
    bounds: NDArray[np.int64],
    seen: Integers,
    met: Integers,
    turns: NDArray[np.int64],
) -> tuple[NDArray[np.int64], Integers]:
    """List the patches that the rays of each patch met.

    Parameters
    ----------
    members : (M,) int32
        Texels of the patches, patch by patch.
    bounds : (P + 1,) int64
        Where those of each patch begin and end.
    seen : (T, R) int32
        Texels that the rays of each texel met; negative ones are dark.
    met : (T,) int32
        The patch of each texel.
    turns : (P,) int64
        How many texels of a patch share the R rays.

    Returns
    -------
    ends : (P + 1,) int64
        Where the sources of each patch begin and end.
    sources : (S,) int32
        Negative ones are dark.
    """
    patches, (texels, rays) = len(turns), seen.shape
    checked("members", members, np.int32, (None,))
    checked("bounds", bounds, np.int64, (patches + 1,))
    checked("texels seen", seen, np.int32, (None, None))
    checked("patches met", met, np.int32, (texels,))
    checked("turns", turns, np.int64, (patches,))
    sizes = np.diff(bounds) * (rays // np.maximum(turns, 1))
    ends = np.concatenate([np.zeros(1, np.int64), np.cumsum(sizes, dtype=np.int64)])
    sources = np.empty(int(ends[-1]), np.int32)
    _SOURCES(patches, members, bounds, texels, rays, seen, met, turns, ends, sources)
    return ends, sources


def hand_on(
    ends: NDArray[np.int64], sources: Integers, radiance: Floats, *, threads: int
) -> Floats:
    """Return (P, C) float32: the mean radiance of the sources of each patch.

    Parameters
    ----------
    ends, sources
        As `patch_sources` returns them.
    radiance : (P, C) float32
        C is a multiple of eight.
    """
    patches, channels = radiance.shape
    checked("ends", ends, np.int64, (patches + 1,))
    checked("sources", sources, np.int32, (int(ends[-1]),))
    checked("radiance", radiance, np.float32, (None, None))
    arriving = np.empty_like(radiance)
    _HAND_ON(threads, patches, ends, sources, channels, radiance, arriving)
    return arriving
