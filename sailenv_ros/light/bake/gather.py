"""What arrives at points from all the surfaces around them and from the sky.

From points and the radiance of texels to irradiance / pi. Sky that comes in through glass is
looked for in two ways, by rays in all directions and by rays to the panes, which are joined by the
balance heuristic (Veach and Guibas 1995): neither far nor near windows make noise.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.back_to_back import BackToBack
from sailenv_ros.light.bake.direct import LIFT_M, Points
from sailenv_ros.light.bake.emitters import chance_weights, choice_weights, towards_emitter
from sailenv_ros.light.bake.ray_patterns import net
from sailenv_ros.light.bake.rays import NEVER, Hits, RayScene
from sailenv_ros.light.bake.sampling import hemisphere_rays
from sailenv_ros.light.bake.sky import sky_at

__all__ = ["BACK", "NOTHING", "Looks", "Seen", "Surroundings", "seen_from", "surfaces_light"]

Floats = NDArray[np.float32]

NOTHING = -1
"""Stands for the sky where a texel is named."""

BACK = -2
"""Stands for the back of a surface that has none: such light is lost."""

EMITTER_RAYS = 4
"""From each point to each emitter; texels of a tile of 4 by 4 use different ones."""


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
    emitters : (E, 4) float32
        Small things that shine; see `emitters_of`.
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


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Looks:
    """What is added to the light of points for small things that shine.

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
        _add_looks(self.point, self.texel, self.weight, radiance, light)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Seen:
    """What points see of the half spaces before them.

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
    directions = np.empty((count, rays, 3), dtype=np.float32)
    hemisphere_rays(points.normals, points.faces, pattern, points.shifts, directions)
    lifted = points.positions + points.faces * np.float32(LIFT_M)
    origins = np.repeat(lifted, rays, axis=0)
    flat = directions.reshape(-1, 3)
    hits = around.scene.hits(origins, flat)
    texels = around.texels_hit(hits, flat)
    clear = around.transmittance(texels, origins, flat).reshape(count, rays)
    texels = texels.reshape(count, rays)
    sky = np.zeros((count, 3), dtype=np.float32)
    _sky_by_chance(
        points.positions, points.normals, directions, texels, clear,
        around.sky, around.panes, len(window_pattern), sky,
    )  # fmt: skip
    for number in range(len(around.panes)):
        _look_through(around, points, lifted, number, window_pattern, rays, sky)
    near = np.reciprocal(np.maximum(hits.distance.reshape(count, rays), np.float32(1e-3)))
    looks = _looks(around, points, lifted, directions, texels)
    return Seen(texels=texels, sky=sky, closeness=near.mean(axis=1), looks=looks)


def surfaces_light(texels: NDArray[np.int32], radiance: Floats) -> Floats:
    """Return (N, C) float32: irradiance / pi from the surfaces that rays met.

    Parameters
    ----------
    texels : (N, M) int32
        As in `Seen`.
    radiance : (texels, C) float32
        What each texel sends to everywhere.
    """
    light = np.zeros((len(texels), radiance.shape[1]), dtype=np.float32)
    _surfaces_light(texels, radiance, light)
    return light


def _looks(
    around: Surroundings, points: Points, lifted: Floats, directions: Floats, texels: NDArray[Any]
) -> Looks:
    """Look at the emitters, and find which rays in all directions lie in their cones."""
    found: list[tuple[NDArray[np.int32], NDArray[np.int32], Floats]] = []
    lit = points.positions, points.normals
    if len(around.emitters):
        room = texels.size // 16
        while not found:
            point, texel = np.empty((2, room), np.int32)
            weight = np.empty(room, np.float32)
            count = chance_weights(
                *lit, around.emitters, directions, texels, EMITTER_RAYS, point, texel, weight
            )
            if count <= room:
                found.append((point[:count], texel[:count], weight[:count]))
            room = count
    pattern = net(EMITTER_RAYS)
    # Of a net of 2 by 2, steps of a quarter would lean to one side of its cells.
    shifts = points.shifts + np.float32(0.125)
    for emitter in around.emitters:
        point = np.empty(len(lifted) * len(pattern), np.int32)
        towards = np.empty((len(point), 3), np.float32)
        count = towards_emitter(
            *lit, points.faces, shifts, emitter, pattern, point, towards
        )  # fmt: skip
        point, towards = point[:count], towards[:count]
        met = around.texels_hit(around.scene.hits(lifted[point], towards), towards)
        weight = np.empty(count, np.float32)
        choice_weights(
            *lit, around.emitters, point, towards, len(pattern), texels.shape[1], weight
        )  # fmt: skip
        found.append((point[met >= 0], met[met >= 0], weight[met >= 0]))
    none = np.zeros(0, np.int32), np.zeros(0, np.int32), np.zeros(0, np.float32)
    point, texel, weight = (np.concatenate(arrays) for arrays in zip(none, *found, strict=True))
    return Looks(point=point, texel=texel, weight=weight)


def _look_through(
    around: Surroundings,
    points: Points,
    lifted: Floats,
    number: int,
    pattern: Floats,
    others: int,
    light: Floats,
) -> None:
    """Add the sky that is seen through a pane."""
    most = len(points.positions) * len(pattern)
    point = np.empty(most, dtype=np.int32)
    origins, towards = np.empty((2, most, 3), dtype=np.float32)
    count = _towards_pane(
        points.positions, points.normals, points.faces, points.shifts, lifted,
        around.panes[number], pattern, point, origins, towards,
    )  # fmt: skip
    never = np.full(count, NEVER, np.float32)
    share = around.scene.share_that_passes(origins[:count], towards[:count], never)
    _sky_by_choice(
        points.positions, points.normals, point[:count], towards[:count], share,
        around.sky, around.panes, len(pattern), others, light,
    )  # fmt: skip


@numba.njit(cache=True, nogil=True)
def _towards_pane(  # type: ignore[no-untyped-def]
    positions, normals, faces, shifts, lifted, pane, pattern, point, origins, towards
):
    """Fill in rays to points of a pane that lie above the horizon; return how many there are."""
    cells = np.sqrt(len(pattern))
    count = 0
    for k in range(len(positions)):
        for m in range(len(pattern)):
            u, v = pattern[m, 0] * cells, pattern[m, 1] * cells
            left, low = np.floor(u), np.floor(v)
            u, v = u - left + shifts[k, 0], v - low + shifts[k, 1]
            u = 2.0 * (left + u - np.floor(u)) / cells - 1.0
            v = 2.0 * (low + v - np.floor(v)) / cells - 1.0
            x = pane[0, 0] + u * pane[1, 0] + v * pane[2, 0] - positions[k, 0]
            y = pane[0, 1] + u * pane[1, 1] + v * pane[2, 1] - positions[k, 1]
            z = pane[0, 2] + u * pane[1, 2] + v * pane[2, 2] - positions[k, 2]
            if x * normals[k, 0] + y * normals[k, 1] + z * normals[k, 2] <= 0.0:
                continue
            if x * faces[k, 0] + y * faces[k, 1] + z * faces[k, 2] <= 0.0:
                continue
            length = max(np.sqrt(x * x + y * y + z * z), 1e-9)
            point[count] = k
            origins[count] = lifted[k]
            towards[count, 0], towards[count, 1], towards[count, 2] = (
                x / length,
                y / length,
                z / length,
            )
            count += 1
    return count


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
def _surfaces_light(texels, radiance, light):  # type: ignore[no-untyped-def]
    count, rays = texels.shape
    for k in range(count):
        for m in range(rays):
            texel = texels[k, m]
            if texel >= 0:
                for c in range(light.shape[1]):
                    light[k, c] += radiance[texel, c]
        for c in range(light.shape[1]):
            light[k, c] /= rays


@numba.njit(cache=True, nogil=True)
def _add_looks(point, texel, weight, radiance, light):  # type: ignore[no-untyped-def]
    for ray in range(len(point)):
        for c in range(light.shape[1]):
            light[point[ray], c] += weight[ray] * radiance[texel[ray], c]


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
        if share[ray] <= 0.0:
            continue
        k = point[ray]
        dx, dy, dz = directions[ray]
        own = (dx * normals[k, 0] + dy * normals[k, 1] + dz * normals[k, 2]) / np.pi
        weight = own / (others * own + shots * _density(panes, positions[k], dx, dy, dz))
        weight *= share[ray]
        for c in range(3):
            light[k, c] += weight * sky_at(sky, dx, dy, dz, c)
