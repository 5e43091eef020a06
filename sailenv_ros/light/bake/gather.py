"""Gathers the light that arrives at points from the surfaces around them and from the sky.

From points and the radiance of texels to irradiance / pi. Sky that comes in through glass is
looked for in two ways, by rays in all directions and by rays to the panes, which are joined by the
balance heuristic (Veach and Guibas 1995): neither far nor near windows make noise.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.back_to_back import BackToBack
from sailenv_ros.light.bake.direct import Points
from sailenv_ros.native.bake_types import Emitters, LitPoints, MappedTriangles, SkyWindows
from sailenv_ros.native.gather_kernels import (
    emitter_rays,
    emitter_weights,
    hemisphere_rays,
    pane_rays,
    sky_by_chance,
    sky_by_choice,
    weights_within_cones,
)
from sailenv_ros.native.ray_kernels import LightHits
from sailenv_ros.native.surface_light import add_radiance_met, mean_radiance_met, met_texels
from sailenv_ros.rays.light_rays import LIFT_M, NEVER, RayScene
from sailenv_ros.rays.ray_patterns import low_discrepancy_points

__all__ = ["BACK", "NOTHING", "Looks", "Met", "Seen", "Surroundings", "seen_from"]

Floats = NDArray[np.float32]

NOTHING = -1
"""Stands for the sky where a texel is named."""

BACK = -2
"""Stands for the back of a surface that has none: such light is lost."""

EMITTER_RAYS = 4
"""Rays from each point to each emitter; texels of a tile of 4 by 4 use different ones."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Met:
    """Result of some rays.

    Attributes
    ----------
    texels : (R,) int32
        The texel, `NOTHING` or `BACK`; where a mirror was met first, what it shows.
    distance : (R,) float32
        Of what was met first, such as the mirror [m].
    share : (R,) float32 or None
        Share of the light that mirrors let arrive; None if there is no mirror.
    """

    texels: NDArray[np.int32]
    distance: Floats
    share: Floats | None


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Surroundings:
    """Surroundings that rays are traced through.

    Attributes
    ----------
    scene : RayScene
    faces : (T, 3) float32
        Normals of the triangles.
    two_sided : (T,) bool
    paired : BackToBack
    places : (T, 3, 2) float32
        Of the triangles' corners in the map.
    index : (H, W) int32
        Texels of the map.
    sky : (H, W, 3) float32
    panes : (P, 4, 3) float32
    emitters : (E, 4) float32
        Small things that shine; see `emitters_of`.
    mirrors : (T,) float32
        Share of the light that triangles mirror; empty if there is no mirror.
    """

    scene: RayScene
    faces: Floats
    two_sided: NDArray[np.bool_]
    paired: BackToBack
    places: Floats
    index: NDArray[np.int32]
    sky: Floats
    panes: Floats
    emitters: Floats = field(default_factory=lambda: np.zeros((0, 4), np.float32))
    mirrors: Floats = field(default_factory=lambda: np.zeros(0, np.float32))

    def met(self, origins: Floats, directions: Floats) -> Met:
        """Find what rays meet; where that is a mirror, what it shows.

        Parameters
        ----------
        origins, directions : (R, 3) float32
            Directions of unit length.
        """
        hits = self.scene.hits(origins, directions)
        texels, share = self.texels_hit(hits, directions), None
        if len(self.mirrors):
            share = np.ones(len(texels), np.float32)
            at = np.flatnonzero((hits.triangle >= 0) & (self.mirrors[hits.triangle] > 0.0))
            ahead = np.einsum("rx,rx->r", directions[at], self.faces[hits.triangle[at]])
            at, ahead = at[ahead < 0.0], ahead[ahead < 0.0, None]
            normals = self.faces[hits.triangle[at]]
            points = origins[at] + directions[at] * hits.distance[at, None]
            onwards = directions[at] - 2.0 * ahead * normals
            beyond = self.scene.hits(points + np.float32(LIFT_M) * normals, onwards)
            found = self.texels_hit(beyond, onwards)
            # A mirror that shows the sky, or the inside of something, is as any other surface.
            at, found = at[found >= 0], found[found >= 0]
            texels[at], share[at] = found, self.mirrors[hits.triangle[at]]
        return Met(texels=texels, distance=hits.distance, share=share)

    def transmittance(
        self, texels: NDArray[np.int32], origins: Floats, directions: Floats
    ) -> Floats:
        """Return (R,) float32: how much glass lets through of rays that met nothing, else 1."""
        clear = np.ones(len(texels), dtype=np.float32)
        out = np.flatnonzero(texels == NOTHING)
        never = np.full(len(out), NEVER, np.float32)
        clear[out] = self.scene.transmittance(origins[out], directions[out], never)
        return clear

    def texels_hit(self, hits: LightHits, directions: Floats) -> NDArray[np.int32]:
        """Return (R,) int32: the texel that each ray met, `NOTHING` or `BACK`."""
        triangles = MappedTriangles(
            self.faces, self.two_sided, self.paired.other, self.paired.corner, self.places,
            self.index,
        )  # fmt: skip
        return met_texels(triangles, hits.triangle, hits.second, hits.third, directions)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Looks:
    """Contributions of small emitters to the light of points.

    Attributes
    ----------
    point : (R,) int32
    texel : (R,) int32
        What was seen from it.
    weight : (R,) float32
        What it counts; below 0 where another ray counts already.
    """

    point: NDArray[np.int32]
    texel: NDArray[np.int32]
    weight: Floats

    def add(self, radiance: Floats, light: Floats) -> None:
        """Add (N, C) irradiance / pi to points."""
        add_radiance_met(self.point, self.texel, self.weight, radiance, light)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Seen:
    """View from points into their half spaces.

    Attributes
    ----------
    texels : (N, M) int32
        Which texel each ray met, `NOTHING` or `BACK`.
    sky : (N, 3) float32
        Irradiance / pi that comes straight from the sky.
    closeness : (N,) float32
        Mean of one over the distances of what is seen [1/m].
    looks : Looks
    """

    texels: NDArray[np.int32]
    sky: Floats
    closeness: Floats
    looks: Looks

    def light(self, radiance: Floats) -> Floats:
        """Return (N, C) float32: irradiance / pi at the points, from surfaces and from the sky.

        Parameters
        ----------
        radiance : (texels, C) float32
            What each texel sends to everywhere; the sky adds to the first three channels.
        """
        light = mean_radiance_met(self.texels, radiance)
        self.looks.add(radiance, light)
        light[:, :3] += self.sky
        return light


def seen_from(
    around: Surroundings, points: Points, pattern: Floats, window_pattern: Floats
) -> Seen:
    """Look into the half spaces before points, with the density of the cosine, and at windows.

    Parameters
    ----------
    pattern, window_pattern : (M, 2), (W, 2) float32
        Nets, for rays in all directions and to each pane.
    """
    count, rays = len(points.positions), len(pattern)
    lit = points.lit()
    windows = SkyWindows(around.sky, around.panes)
    origins, directions = hemisphere_rays(lit, pattern)
    flat, begins = directions.reshape(-1, 3), origins.reshape(-1, 3)
    met = around.met(begins, flat)
    texels = met.texels
    clear = around.transmittance(texels, begins, flat).reshape(count, rays)
    texels = texels.reshape(count, rays)
    shots = len(window_pattern)
    sky = sky_by_chance(lit, windows, directions, texels, clear, shots=shots)
    for pane in around.panes:
        point, begins, towards = pane_rays(lit, pane, window_pattern)
        never = np.full(len(point), NEVER, np.float32)
        share = around.scene.share_that_passes(begins, towards, never)
        seen = point, towards, share
        sky_by_choice(lit, windows, seen, shots=shots, others=rays, light=sky)
    near = np.reciprocal(np.maximum(met.distance.reshape(count, rays), np.float32(1e-3)))
    looks = _looks(around, lit, directions, texels, met.share)
    return Seen(texels=texels, sky=sky, closeness=near.mean(axis=1), looks=looks)


def _looks(
    around: Surroundings,
    points: LitPoints,
    directions: Floats,
    texels: NDArray[np.int32],
    share: Floats | None,
) -> Looks:
    """Look at the emitters, and find which rays in all directions lie in their cones.

    What mirrors swallow is taken off.
    """
    emitters, pattern = Emitters(around.emitters), low_discrepancy_points(EMITTER_RAYS)
    shots, rays = len(pattern), texels.shape[1]
    found = [(np.zeros(0, np.int32), np.zeros(0, np.int32), np.zeros(0, np.float32))]
    if share is not None:
        dimmed = np.flatnonzero(share < 1.0)
        lost = (share[dimmed] - 1.0) / np.float32(rays)
        found.append(((dimmed // rays).astype(np.int32), texels.ravel()[dimmed], lost))
    if len(around.emitters):
        found.append(weights_within_cones(points, emitters, directions, texels, shots=shots))
    # Of a net of 2 by 2, steps of a quarter would lean to one side of its cells.
    moved = LitPoints(
        points.arrays["positions"], points.arrays["normals"], points.arrays["faces"],
        points.arrays["shifts"] + np.float32(0.125),
    )  # fmt: skip
    for emitter in around.emitters:
        point, begins, towards = emitter_rays(moved, emitter, pattern)
        met = around.met(begins, towards)
        weight = emitter_weights(points, emitters, point, towards, shots=shots, others=rays)
        if met.share is not None:
            weight = weight * met.share
        known = met.texels >= 0
        found.append((point[known], met.texels[known], weight[known]))
    point, texel, weight = (np.concatenate(arrays) for arrays in zip(*found, strict=True))
    return Looks(point=point, texel=texel, weight=weight)
