"""Texels of surfaces whose relief is finer than they are: ribs, grooves, slats.

From `Texels` and rays to `Texels`. The middle of such a texel lies on a crest, in a groove, under
a rib or in a panel's hollow by chance, which would show as stripes. A point stands for it that
sees as much of the surroundings as those of the texel's points do on average that can be seen.
Knows no light.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.texels import TexelPoints, Texels, block_points, normals_at
from sailenv_ros.light.bake.worker_pool import in_chunks
from sailenv_ros.rays.light_rays import LIFT_M, RayScene
from sailenv_ros.rays.ray_patterns import fibonacci_sphere
from sailenv_ros.rays.static_geometry import StaticGeometry

__all__ = ["with_typical_points"]

Floats = NDArray[np.float32]

RISE_M = 2e-3
"""Height above a texel's point from which anything counts as relief [m]."""

REACH = 0.8
"""Relief counts this near to a texel's point [sides of a texel]."""

VIEW = 2.0
"""How far a point looks around [sides of a texel]."""

DIRECTIONS = fibonacci_sphere(64)
"""Half of them lie above any surface."""

INSIDE = 0.1
"""A point that sees less than this share lies under something, or nearly."""

ALIKE = 0.08
"""Greatest difference of openness from the mean at which the middle of a texel stands for it."""

BESIDE = 0.4
"""Points so near to each other have nothing between them that rises [sides of a texel]."""

LEAST_FACING = 0.5
"""Cosine between two normals below which points belong to different surfaces."""

CHUNK_TEXELS = 4096


def with_typical_points(
    geometry: StaticGeometry, scene: RayScene, places: Floats, texels: Texels, workers: int = 1
) -> Texels:
    """Return the texels with other points where relief is finer than they are.

    Parameters
    ----------
    places : (T, 3, 2) float32
        Of the triangles' corners in the map [texels].
    """
    sides = _sides_m(geometry, places)[texels.triangle]
    uneven = np.zeros(texels.count, bool)

    def find(first: int, end: int) -> None:
        chosen = slice(first, end)
        uneven[chosen] = _is_uneven(
            scene, texels.positions[chosen], texels.faces[chosen], sides[chosen]
        )

    in_chunks(find, texels.count, 8 * CHUNK_TEXELS, workers)
    asked = np.flatnonzero(uneven)
    triangle, weights = texels.triangle.copy(), texels.weights.copy()
    positions, faces, normals = (
        array.copy() for array in (texels.positions, texels.faces, texels.normals)
    )

    def choose(first: int, end: int) -> None:
        own = asked[first:end]
        points = _points_of(geometry, places, texels, own)
        shape = points.triangle.shape
        at, turned = points.positions.reshape(-1, 3), points.faces.reshape(-1, 3)
        each = np.repeat(sides[own], shape[1])
        covered = _are_covered(scene, at, turned, each).reshape(shape)
        # What is covered as a whole, the foot of a cupboard, is seen by nobody.
        seen = np.flatnonzero(~covered.all(axis=1))
        own = own[seen]
        points = _some(points, seen)
        moves, one = _most_typical(geometry, scene, texels, points, covered[seen], own, sides[own])
        moved = own[moves]
        triangle[moved], weights[moved], positions[moved], faces[moved] = one
        normals[moved] = normals_at(geometry, one.triangle, one.weights, one.faces)

    in_chunks(choose, len(asked), CHUNK_TEXELS, workers)
    return replace(
        texels,
        triangle=triangle,
        weights=weights,
        positions=positions,
        faces=faces,
        normals=normals,
    )


def _sides_m(geometry: StaticGeometry, places: Floats) -> Floats:
    """Return (T,) float32: the side of a texel upon each triangle [m]."""
    first, second = places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]
    mapped = np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    edges = geometry.corners[:, 1:] - geometry.corners[:, :1]
    real = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    sides: Floats = np.sqrt(real / np.maximum(mapped, 1e-6)).astype(np.float32)
    return sides


def _is_uneven(
    scene: RayScene, positions: Floats, faces: Floats, sides: Floats
) -> NDArray[np.bool_]:
    """Return (N,) bool: texels with something close above their points, or on both sides."""
    origins = positions + faces * np.float32(RISE_M)
    found = _are_covered(scene, positions, faces, sides)
    for along in _across(faces):
        sides_passed = (
            scene.share_that_passes(origins, along * np.float32(sign), REACH * sides)
            for sign in (1.0, -1.0)
        )
        found |= np.maximum(*sides_passed) == 0.0
    return found


def _are_covered(
    scene: RayScene, positions: Floats, faces: Floats, sides: Floats
) -> NDArray[np.bool_]:
    """Return (N,) bool: points with something close right above them."""
    origins = positions + faces * np.float32(RISE_M)
    covered: NDArray[np.bool_] = scene.share_that_passes(origins, faces, REACH * sides) == 0.0
    return covered


def _across(faces: Floats) -> tuple[Floats, Floats]:
    """Return two (N, 3) float32 of unit vectors at right angles to normals and to each other."""
    axis = np.where(np.abs(faces[:, 2:]) < 0.7, (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
    first = np.cross(axis, faces)
    # Triangles without an area face nowhere.
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-12)
    return first.astype(np.float32), np.cross(faces, first).astype(np.float32)


def _points_of(
    geometry: StaticGeometry, places: Floats, texels: Texels, chosen: NDArray[np.intp]
) -> TexelPoints:
    """Return (K, P, …) points of each chosen texel: the one that it has first."""
    more = block_points(geometry, places, texels, chosen)
    own = (getattr(texels, name)[chosen] for name in TexelPoints._fields)
    return TexelPoints(
        *(
            np.concatenate([a[:, None], b.reshape(len(chosen), -1, *b.shape[1:])], axis=1)
            for a, b in zip(own, more, strict=True)
        )
    )


def _some(points: TexelPoints, chosen: NDArray[np.bool_ | np.intp]) -> TexelPoints:
    """Return the points of chosen texels."""
    return TexelPoints(
        points.triangle[chosen],
        points.weights[chosen],
        points.positions[chosen],
        points.faces[chosen],
    )


def _most_typical(
    geometry: StaticGeometry,
    scene: RayScene,
    texels: Texels,
    points: TexelPoints,
    covered: NDArray[np.bool_],
    chosen: NDArray[np.intp],
    sides: Floats,
) -> tuple[NDArray[np.bool_], TexelPoints]:
    """Return (K,) bool, which texels another point than the first is to stand for, and those."""
    openness = _openness(scene, points, sides)
    useful = openness > INSIDE
    facing = np.einsum("kpx,kx->kp", points.faces, texels.faces[chosen])
    owners = geometry.owner[points.triangle]
    useful &= (facing > LEAST_FACING) & (owners == owners[:, :1])
    # Who looks at the texel sees hardly any point that something covers.
    shown = useful & ~covered
    useful = np.where(shown[:, 1:].any(axis=1, keepdims=True), shown, useful)
    # The middle says no more of the texel than the others.
    counted = useful[:, 1:]
    mean = (openness[:, 1:] * counted).sum(axis=1) / np.maximum(counted.sum(axis=1), 1)
    more = openness - mean[:, None]
    moves = counted.any(axis=1) & ~(useful[:, 0] & (np.abs(more[:, 0]) < ALIKE))
    points = _some(points, moves)
    return moves, _between(points, more[moves], useful[moves], sides[moves])


def _between(
    points: TexelPoints, more: NDArray[np.float64], useful: NDArray[np.bool_], sides: Floats
) -> TexelPoints:
    """Return (K, …) points between two of each (K, P), one more open than the mean, one less."""
    every = np.arange(len(more))
    best = np.argmin(np.where(useful, np.abs(more), np.inf), axis=1)
    nearest, own = TexelPoints(*(array[every, best] for array in points)), more[every, best]
    away = np.linalg.norm(points.positions - nearest.positions[:, None], axis=2)
    other = useful & (points.triangle == nearest.triangle[:, None])
    other &= (more * own[:, None] < 0.0) & (away < BESIDE * sides[:, None])
    second = np.argmin(np.where(other, np.abs(more), np.inf), axis=1)
    across = own - more[every, second]
    share = np.where(other.any(axis=1), own / np.where(across == 0.0, 1.0, across), 0.0)
    share = share.astype(np.float32)[:, None]

    def mixed(array: Floats) -> Floats:
        first, rest = array[every, best], array[every, second]
        between: Floats = first + share * (rest - first)
        return between

    return nearest._replace(weights=mixed(points.weights), positions=mixed(points.positions))


def _openness(scene: RayScene, points: TexelPoints, sides: Floats) -> NDArray[np.float64]:
    """Return (K, P) float64: the share of the light of an even sky that nothing near hides."""
    shape = points.triangle.shape
    faces = points.faces.reshape(-1, 3)
    origins = points.positions.reshape(-1, 3) + faces * np.float32(LIFT_M)
    reach = np.repeat(VIEW * sides, shape[1])
    seen, weight = np.zeros((2, len(faces)))
    for direction in DIRECTIONS:
        cosine = faces @ direction
        above = np.flatnonzero(cosine > 0.0)
        towards = np.broadcast_to(direction, (len(above), 3))
        passed = scene.share_that_passes(origins[above], towards, reach[above]) > 0.0
        seen[above] += cosine[above] * passed
        weight[above] += cosine[above]
    shares: NDArray[np.float64] = seen / np.maximum(weight, 1e-9)
    return shares.reshape(shape)
