"""Texels of baked light in world coordinates, and patches of them. From `BakedLight` to arrays.

Rasterised again from the charts; for light that was read from disk the arrays are kept there, too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.bounces import patches_of
from sailenv_ros.light.bake.emitters import emitters_of, without_nested
from sailenv_ros.light.bake.facing import lit_texels
from sailenv_ros.light.bake.lamp_glow import glows_of
from sailenv_ros.light.bake.layout import Layout
from sailenv_ros.light.bake.reflectance import albedo_of, emission_of
from sailenv_ros.native.library import native_library
from sailenv_ros.rays.light_rays import RayScene
from sailenv_ros.rays.static_geometry import StaticGeometry
from sailenv_ros.system.array_cache import cached_arrays, code_digest
from sailenv_ros.types.baked_light import BakedLight

__all__ = ["BakedTexels", "baked_texels", "patch_means"]

Floats = NDArray[np.float32]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class BakedTexels:
    """The texels in use, row by row, and tiles of them.

    Attributes
    ----------
    places : (N,) int32
        In the map.
    triangle : (N,) int32
        Of the geometry.
    positions, normals : (N, 3) float32
        World frame [m]; unit normals of the lit side.
    of_texel : (N,) int32
        Patch of each; see `patches_of`.
    chosen : (P,) int64
        Texel that stands for each patch.
    irradiance : (P, 3 L) float32
        Means of the layers' bounced light, the three colours of each layer in turn.
    direct : (P, L) float32
        Means of the layers' direct light.
    emitters : (E, 4) float32
        Small things that shine, none within another; see `emitters_of`.
    """

    places: NDArray[np.int32]
    triangle: NDArray[np.int32]
    positions: Floats
    normals: Floats
    of_texel: NDArray[np.int32]
    chosen: NDArray[np.int64]
    irradiance: Floats
    direct: Floats
    emitters: Floats


def baked_texels(
    baked: BakedLight,
    geometry: StaticGeometry,
    lit_by: Mapping[int, Sequence[str]],
    threads: int,
) -> BakedTexels:
    """Return the texels of a bake.

    Parameters
    ----------
    geometry : StaticGeometry
        As it was baked.
    lit_by : mapping of int to sequence of str
        Names of the lights that are in an instance, by its id.
    """

    def make() -> dict[str, NDArray[Any]]:
        made = _laid_out(baked, geometry, lit_by, threads)
        return {field.name: getattr(made, field.name) for field in fields(made)}

    if not baked.checksum:
        return BakedTexels(**make())
    ids = (instance.id for instance in geometry.instances)
    key = baked.checksum, native_library().digest, *ids, str(sorted(lit_by.items()))
    code = code_digest("light/bake", "light/relight", "native", "rays", "types")
    return BakedTexels(**cached_arrays("texels", key, make, code=code))


def patch_means(of_texel: NDArray[np.int32], values: Floats, size: Floats) -> Floats:
    """Return (P,) float32: means of (N,) values of texels over patches of so many."""
    sums = np.bincount(of_texel, weights=values, minlength=len(size))
    return (sums / size).astype(np.float32)


def _laid_out(
    baked: BakedLight,
    geometry: StaticGeometry,
    lit_by: Mapping[int, Sequence[str]],
    threads: int,
) -> BakedTexels:
    side = len(baked.layers[0].direct)
    layout = Layout(side=side, charts={}, places=_corners(baked, geometry, side))
    texels = lit_texels(geometry, RayScene(geometry), layout, threads)
    patches = patches_of(geometry, texels)
    places = (texels.rows * side + texels.columns).astype(np.int32)
    size = np.bincount(patches.of_texel, minlength=patches.count).astype(np.float32)

    def means(light: NDArray[np.float16]) -> Floats:
        return patch_means(patches.of_texel, light[places].astype(np.float32), size)

    lights = [layer.light for layer in baked.layers if layer.light is not None]
    glows = glows_of(geometry, texels.triangle, lit_by)
    emitted = (emission_of(geometry, layout, texels), *glows.values())
    albedo = albedo_of(geometry, layout, texels)
    bounced = [layer.bounced.reshape(-1, 3) for layer in baked.layers]
    return BakedTexels(
        places=places,
        triangle=texels.triangle,
        positions=np.ascontiguousarray(texels.positions, np.float32),
        normals=np.ascontiguousarray(texels.normals, np.float32),
        of_texel=patches.of_texel,
        chosen=patches.middles(texels),
        irradiance=np.stack([means(colour) for light in bounced for colour in light.T], axis=1),
        direct=np.stack([means(layer.direct.reshape(-1)) for layer in baked.layers], axis=1),
        emitters=without_nested(emitters_of(geometry, texels, emitted, lights, albedo)),
    )


def _corners(baked: BakedLight, geometry: StaticGeometry, side: int) -> Floats:
    """Return (T, 3, 2) float32: the corners of the triangles in the map [texels]."""
    corners = np.zeros((geometry.triangle_count, 3, 2), np.float32)
    for instance in geometry.instances:
        chart = baked.charts[instance.id]
        first = instance.first_triangle
        size, offset = np.asarray(chart.scale), np.asarray(chart.offset)
        flat = chart.unwrapping
        for triangles, uvs in zip(flat.triangles, flat.uvs, strict=True):
            own = (uvs * size + offset) * side
            corners[first : first + len(triangles)] = own[triangles]
            first += len(triangles)
    return corners
