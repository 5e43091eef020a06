"""Passes light from patch to patch. From what arrives straight to what arrives after all bounces.

A patch is a tile of 4 by 4 texels, as far as they belong to one object and face one way. Which
patches see which is found once, with few rays from each texel, and serves all lights and bounces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.texels import Texels
from sailenv_ros.native.surface_light import hand_on, patch_sources
from sailenv_ros.rays.ray_patterns import TURN
from sailenv_ros.rays.static_geometry import StaticGeometry

__all__ = ["Patches", "bounced_radiance", "patches_of"]

Floats = NDArray[np.float32]


FEWEST_RAYS = 2 * TURN
"""Least number of rays of each texel that count in a patch of many texels."""

BLOCK = 8
"""Channels that are added up at a time."""

MOST_LEFT = 0.9
"""Share of its light that a bounce leaves to the next, at most."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Patches:
    """Texels in groups.

    Attributes
    ----------
    of_texel : (N,) int32
    count : int
    """

    of_texel: NDArray[np.int32]
    count: int

    def means(self, values: Floats, valid: NDArray[np.bool_]) -> Floats:
        """Return (count, C) float32: means over the valid texels of each, 0 where it has none."""
        owner = self.of_texel[valid]
        number = np.maximum(np.bincount(owner, minlength=self.count), 1)
        sums = [
            np.bincount(owner, weights=values[valid, c], minlength=self.count)
            for c in range(values.shape[1])
        ]
        means: Floats = (np.stack(sums, axis=1) / number[:, None]).astype(np.float32)
        return means

    def middles(self, texels: Texels) -> NDArray[np.intp]:
        """Return (count,) the texel that is nearest to the middle of each."""
        size = np.bincount(self.of_texel, minlength=self.count)
        far = np.zeros(texels.count)
        for at in (texels.rows, texels.columns):
            middle = np.bincount(self.of_texel, weights=at, minlength=self.count) / size
            far += (at - middle[self.of_texel]) ** 2
        order = np.lexsort((far, self.of_texel))
        return order[np.concatenate([[0], np.cumsum(size)[:-1]])] if len(order) else order


def patches_of(geometry: StaticGeometry, texels: Texels) -> Patches:
    """Group the texels."""
    side = texels.index.shape[1]
    tile = (texels.rows // 4).astype(np.int64) * (side // 4 + 1) + texels.columns // 4
    axis = np.argmax(np.abs(texels.normals), axis=1)
    sign = texels.normals[np.arange(texels.count), axis] > 0
    owner = geometry.owner[texels.triangle].astype(np.int64)
    key = ((tile * 6 + axis * 2 + sign) * (len(geometry.instances) + 1)) + owner
    _, of_texel = np.unique(key, return_inverse=True)
    count = int(of_texel.max()) + 1 if len(of_texel) else 0
    return Patches(of_texel=of_texel.astype(np.int32), count=count)


def bounced_radiance(
    patches: Patches,
    seen: NDArray[np.int32],
    valid: NDArray[np.bool_],
    stands_in: NDArray[np.int32],
    first: Floats,
    albedo: Floats,
    bounces: int,
    workers: int = 1,
) -> Floats:
    """Return (N, C) float32: radiance of each texel with all that was handed on to it.

    Parameters
    ----------
    seen : (N, M) int32
        Texels that the rays of each texel met; negative ones are dark. Of each texel in a patch of
        many only some count, one after another: see `ray_patterns.in_turns`.
    valid : (N,) bool
        Texels inside of something know nothing.
    stands_in : (N,) int32
        Which texel's light rays to each texel meet; see `denoise.stand_ins`.
    first : (N, C) float32
        Radiance of each texel by what arrives straight and what it emits.
    albedo : (N, 3) float32
    """
    channels = first.shape[1]
    start = patches.means(first, valid)
    share = np.tile(patches.means(albedo, valid), channels // 3)
    order = np.argsort(patches.of_texel, kind="stable")
    members = order[valid[order]].astype(np.int32)
    bounds = np.searchsorted(patches.of_texel[members], np.arange(patches.count + 1))
    met = patches.of_texel[stands_in]
    ends, sources = _sources_of(members, bounds, seen, met)
    # Padded, so that channels are added up in blocks of a fixed size.
    radiance = np.zeros((patches.count, -(-channels // BLOCK) * BLOCK), np.float32)
    radiance[:, :channels] = start
    arriving = np.zeros_like(start)
    grown = [np.ones(channels), np.ones(channels)]
    for _ in range(bounces):
        before = arriving
        arriving = hand_on(ends, sources, radiance, threads=workers)[:, :channels]
        radiance[:, :channels] = start + share * arriving
        grown = [grown[1], np.sum(arriving - before, axis=0, dtype=np.float64)]
    if bounces > 1:
        # All further bounces shrink like the last: they are a geometric series.
        ratio = np.clip(grown[1] / np.maximum(grown[0], 1e-12), 0.0, MOST_LEFT)
        arriving += ((arriving - before) * (ratio / (1.0 - ratio))).astype(np.float32)
    return first + np.tile(albedo, channels // 3) * arriving[patches.of_texel]


def _sources_of(
    members: NDArray[np.int32],
    bounds: NDArray[np.intp],
    seen: NDArray[np.int32],
    met: NDArray[np.int32],
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Return (count + 1,) where the rays of each patch end in a list, and which patches they met.

    `met` is the patch of each texel; rays that met nothing have -1.
    """
    size = np.diff(bounds)
    turns = np.clip(size, 1, max(seen.shape[1] // FEWEST_RAYS, 1))
    return patch_sources(members, bounds.astype(np.int64), seen, met, turns.astype(np.int64))
