"""What arrives at points from all the surfaces around them and from the sky.

From points and the radiance of texels to irradiance / pi. Sky that comes in through glass is
looked for in two ways, by rays in all directions and by rays to the panes, which are joined by the
balance heuristic (Veach and Guibas 1995): neither far nor near windows make noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.bake.back_to_back import BackToBack
from sailenv_ros.bake.direct import LIFT_M, Points
from sailenv_ros.bake.rays import NEVER, Hits, RayScene
from sailenv_ros.bake.sampling import hemisphere_rays, shifted
from sailenv_ros.bake.sky import sky_at

__all__ = ["BACK", "NOTHING", "Surroundings", "gathered", "seen_from", "window_light"]

Floats = NDArray[np.float32]

NOTHING = -1
"""Stands for the sky where a texel is named."""

BACK = -2
"""Stands for the back of a surface that has none: such light is lost."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Surroundings:
    """What rays may meet.

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
    """

    scene: RayScene
    faces: Floats
    two_sided: NDArray[np.bool_]
    paired: BackToBack
    places: Floats
    index: NDArray[np.int32]
    sky: Floats
    panes: Floats

    def transmittance(
        self, texels: NDArray[np.int32], origins: Floats, directions: Floats
    ) -> Floats:
        """Return (R,) float32: how much glass lets through of rays that met nothing, else 1."""
        clear = np.ones(len(texels), dtype=np.float32)
        out = np.flatnonzero(texels == NOTHING)
        never = np.full(len(out), NEVER, np.float32)
        clear[out] = self.scene.transmittance(origins[out], directions[out], never)
        return clear

    def texels_hit(self, hits: Hits, directions: Floats) -> NDArray[np.int32]:
        """Return (R,) int32: the texel that each ray met, `NOTHING` or `BACK`."""
        found = np.empty(len(directions), dtype=np.int32)
        _texels_hit(
            hits.triangle, hits.second, hits.third, directions,
            self.faces, self.two_sided, self.paired.other, self.paired.corner,
            self.places, self.index, found,
        )  # fmt: skip
        return found


def seen_from(
    around: Surroundings, points: Points, pattern: Floats
) -> tuple[NDArray[np.int32], Floats, Floats]:
    """Look into the hemispheres of points, with the density of the cosine.

    Returns
    -------
    texels : (N, M) int32
    distances : (N, M) float32
    directions : (N, M, 3) float32
    """
    count, rays = len(points.positions), len(pattern)
    directions = np.empty((count, rays, 3), dtype=np.float32)
    squares = shifted(pattern, points.shifts)
    hemisphere_rays(points.normals, points.faces, squares, directions)
    origins = np.repeat(points.positions + points.faces * np.float32(LIFT_M), rays, axis=0)
    flat = directions.reshape(-1, 3)
    hits = around.scene.hits(origins, flat)
    texels = around.texels_hit(hits, flat).reshape(count, rays)
    return texels, hits.distance.reshape(count, rays), directions


def gathered(
    around: Surroundings,
    points: Points,
    pattern: Floats,
    window_pattern: Floats,
    radiance: Floats,
) -> tuple[Floats, Floats]:
    """Return (N, C) float32 irradiance / pi, and (N,) the harmonic mean of the distances seen.

    Parameters
    ----------
    radiance : (texels, C) float32
        What each texel sends to everywhere; the sky adds to the first three.
    """
    texels, distances, directions = seen_from(around, points, pattern)
    light = np.zeros((len(texels), radiance.shape[1]), dtype=np.float32)
    nearness = np.empty(len(texels), dtype=np.float32)
    _surfaces_light(texels, distances, radiance, light, nearness)
    light[:, :3] += window_light(around, points, texels, directions, window_pattern)
    return light, nearness


def window_light(
    around: Surroundings,
    points: Points,
    texels: NDArray[np.int32],
    directions: Floats,
    window_pattern: Floats,
) -> Floats:
    """Return (N, 3) float32: irradiance / pi from the sky, by rays that were cast and some more."""
    light = np.zeros((len(texels), 3), dtype=np.float32)
    panes = around.panes if len(window_pattern) else around.panes[:0]
    shots = max(len(window_pattern), 1)
    rays = texels.shape[1]
    origins = np.repeat(points.positions, rays, axis=0)
    clear = around.transmittance(texels.reshape(-1), origins, directions.reshape(-1, 3))
    _sky_by_chance(
        points.positions, points.normals, directions, texels, clear.reshape(-1, rays),
        around.sky, panes, shots, light,
    )  # fmt: skip
    for pane in panes:
        _look_through(around, points, pane, panes, window_pattern, texels.shape[1], light)
    return light


def _look_through(
    around: Surroundings,
    points: Points,
    pane: Floats,
    panes: Floats,
    pattern: Floats,
    others: int,
    light: Floats,
) -> None:
    at = 2.0 * shifted(pattern, points.shifts) - 1.0
    spots = pane[0] + at[..., :1] * pane[1] + at[..., 1:] * pane[2]
    towards = (spots - points.positions[:, None]).astype(np.float32)
    towards /= np.maximum(np.linalg.norm(towards, axis=2, keepdims=True), 1e-9)
    wanted = (np.einsum("nmx,nx->nm", towards, points.normals) > 0.0) & (
        np.einsum("nmx,nx->nm", towards, points.faces) > 0.0
    )
    point, _ = np.nonzero(wanted)
    chosen = towards[wanted]
    origins = points.positions[point] + points.faces[point] * np.float32(LIFT_M)
    never = np.full(len(chosen), NEVER, np.float32)
    share = around.scene.share_that_passes(origins, chosen, never)
    free = share > 0.0
    _sky_by_choice(
        points.positions, points.normals, point[free], chosen[free], share[free],
        around.sky, panes, len(pattern), others, light,
    )  # fmt: skip


@numba.njit(cache=True, nogil=True)
def _texels_hit(  # type: ignore[no-untyped-def]
    triangle, second, third, directions, faces, two_sided, twin, corner, places, index, found
):
    height, width = index.shape
    weights = np.empty(3, np.float32)
    for ray in range(len(triangle)):
        t = triangle[ray]
        if t < 0:
            found[ray] = NOTHING
            continue
        facing = (
            directions[ray, 0] * faces[t, 0]
            + directions[ray, 1] * faces[t, 1]
            + directions[ray, 2] * faces[t, 2]
        )
        b, c = second[ray], third[ray]
        weights[0], weights[1], weights[2] = 1.0 - b - c, b, c
        if facing > 0.0 and not two_sided[t]:
            if twin[t] < 0:
                found[ray] = BACK
                continue
            weights[corner[t, 0]], weights[corner[t, 1]], weights[corner[t, 2]] = 1.0 - b - c, b, c
            t = twin[t]
        x = y = 0.0
        for k in range(3):
            x += weights[k] * places[t, k, 0]
            y += weights[k] * places[t, k, 1]
        column = min(max(int(x), 0), width - 1)
        row = min(max(int(y), 0), height - 1)
        found[ray] = index[row, column] if index[row, column] >= 0 else BACK


@numba.njit(cache=True, nogil=True)
def _surfaces_light(texels, distances, radiance, light, nearness):  # type: ignore[no-untyped-def]
    count, rays = texels.shape
    for k in range(count):
        near = 0.0
        for m in range(rays):
            near += 1.0 / max(distances[k, m], 1e-3)
            texel = texels[k, m]
            if texel >= 0:
                for c in range(light.shape[1]):
                    light[k, c] += radiance[texel, c]
        nearness[k] = rays / max(near, 1e-6)
        for c in range(light.shape[1]):
            light[k, c] /= rays


@numba.njit(cache=True, nogil=True)
def _density(panes, position, dx, dy, dz):  # type: ignore[no-untyped-def]
    """Return the density, over solid angle, of directions to evenly chosen points of all panes."""
    density = 0.0
    for p in range(len(panes)):
        nx, ny, nz = panes[p, 3]
        slant = dx * nx + dy * ny + dz * nz
        if abs(slant) < 1e-6:
            continue
        ox = panes[p, 0, 0] - position[0]
        oy = panes[p, 0, 1] - position[1]
        oz = panes[p, 0, 2] - position[2]
        far = (ox * nx + oy * ny + oz * nz) / slant
        if far <= 0.0:
            continue
        hx, hy, hz = dx * far - ox, dy * far - oy, dz * far - oz
        area = 4.0
        inside = True
        for side in range(1, 3):
            sx, sy, sz = panes[p, side]
            length2 = sx * sx + sy * sy + sz * sz
            area *= np.sqrt(length2)
            if abs(hx * sx + hy * sy + hz * sz) > length2:
                inside = False
        if inside:
            density += far * far / (area * abs(slant))
    return density


@numba.njit(cache=True, nogil=True)
def _sky_by_chance(  # type: ignore[no-untyped-def]
    positions, normals, directions, texels, clear, sky, panes, shots, light
):
    count, rays = texels.shape
    for k in range(count):
        for m in range(rays):
            if texels[k, m] != NOTHING:
                continue
            dx, dy, dz = directions[k, m]
            # Rays that were mirrored at the face may lie below the normal's horizon.
            cosine = max(dx * normals[k, 0] + dy * normals[k, 1] + dz * normals[k, 2], 1e-3)
            own = cosine / np.pi
            weight = own / (rays * own + shots * _density(panes, positions[k], dx, dy, dz))
            weight *= clear[k, m]
            for c in range(3):
                light[k, c] += weight * sky_at(sky, dx, dy, dz, c)


@numba.njit(cache=True, nogil=True)
def _sky_by_choice(  # type: ignore[no-untyped-def]
    positions, normals, point, directions, share, sky, panes, shots, others, light
):
    for ray in range(len(point)):
        k = point[ray]
        dx, dy, dz = directions[ray]
        own = (dx * normals[k, 0] + dy * normals[k, 1] + dz * normals[k, 2]) / np.pi
        weight = own / (others * own + shots * _density(panes, positions[k], dx, dy, dz))
        weight *= share[ray]
        for c in range(3):
            light[k, c] += weight * sky_at(sky, dx, dy, dz, c)
