"""Ambient occlusion of a model by itself: from `Model` to a share of each vertex.

In the folds of a curtain, in a cup or between keys little of the light from around arrives. How
much is the same wherever the model stands, so it is found once: rays from points of every triangle
tell which share of the cosine-weighted hemisphere is hidden, and a fit gives it to the vertices,
between which it is interpolated. Glass hides what it does not let through.
"""

from __future__ import annotations

from hashlib import blake2b
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.bake_types import LitPoints
from sailenv_ros.native.gather_kernels import hemisphere_rays
from sailenv_ros.native.library import native_library
from sailenv_ros.native.ray_kernels import light_share
from sailenv_ros.rays.light_rays import NEVER
from sailenv_ros.rays.model_triangles import ModelTriangles, triangles_of
from sailenv_ros.rays.ray_patterns import low_discrepancy_points
from sailenv_ros.rays.triangle_tree import in_leaves, triangle_tree
from sailenv_ros.system.array_cache import cached_arrays, code_digest
from sailenv_ros.system.threads import thread_count
from sailenv_ros.types.digests import add_array, once
from sailenv_ros.types.model import Model

__all__ = ["LEAST_WEIGHT", "POINTS", "arriving_share", "spread_points", "vertex_occlusion"]

Floats: TypeAlias = NDArray[np.float32]
Doubles: TypeAlias = NDArray[np.float64]

RAYS = 64
"""Of each point."""

POINTS = 4096
"""Of a model, by area; each triangle has one at least, and no more than `MOST_OF_TRIANGLE`."""

MOST_OF_TRIANGLE = 64

ROUNDS = 8
"""Of the fit; its error is below the noise of the rays after these."""

LEAST_WEIGHT = 0.02
"""Of what is hidden altogether, in means and fits: it is seldom seen."""

STIFFNESS = 4.0
"""Vertices that fewer points than this tell of hardly follow the noise of their rays."""

PLASTIC = np.array([0.7548776662466927, 0.5698402909980532])
"""Steps of the R2 sequence of Roberts (2018), "The unreasonable effectiveness of quasirandom
sequences"."""

POINTS_AT_ONCE = 1 << 14


@once
def vertex_occlusion(model: Model) -> tuple[Floats, ...]:
    """Return which share of the light from around a model hides from its own surface.

    Materials count by what they let through alone, so painted models share what was found.

    Returns
    -------
    tuple of (V,) float32
        Of the vertices of each part, 0 to 1; 0 of what nothing hides.
    """
    triangles = triangles_of(model)
    digest = blake2b(native_library().digest.encode(), digest_size=16)
    for array in (triangles.corners, triangles.normals, triangles.passes):
        add_array(digest, array)
    for part in model.parts:
        add_array(digest, part.mesh.triangles)
    made = cached_arrays(
        "occlusion",
        [digest.digest()],
        lambda: _arrays(model, triangles),
        code=code_digest("rays"),
    )
    return tuple(made[f"part_{number}"] for number in range(len(model.parts)))


def arriving_share(hidden: Doubles, albedo: Doubles) -> Doubles:
    """Return which share of the light from around arrives where a share is hidden.

    With what light a surface sends on between its own parts: the law of light_law.h, by the fit of
    Jimenez et al. 2016, "Practical real-time strategies for accurate indirect occlusion".
    """
    share = 1.0 - hidden
    third, second = 2.0404 * albedo - 0.3324, 0.6417 - 4.7951 * albedo
    first = 2.7552 * albedo + 0.6903
    return np.asarray(share * np.maximum((third * share + second) * share + first, 1.0))


def _arrays(model: Model, triangles: ModelTriangles) -> dict[str, Floats]:
    meshes = [part.mesh for part in model.parts]
    firsts = np.array(model.first_vertices)
    own = [mesh.triangles + first for mesh, first in zip(meshes, firsts[:-1], strict=True)]
    vertices = np.concatenate([np.zeros((0, 3), np.int64), *own])
    there = triangles.passes < 1.0
    hidden = np.zeros(firsts[-1])
    if there.any():
        owners, weights = spread_points(triangles.areas_m2[there])
        shares = _hidden_at(triangles, np.flatnonzero(there)[owners], weights)
        if shares.any():
            hidden = _fitted(shares, vertices[there][owners], weights, len(hidden))
    parts = np.split(hidden.astype(np.float32), firsts[1:-1])
    return {f"part_{number}": part for number, part in enumerate(parts)}


def spread_points(areas: Doubles, count: int = POINTS) -> tuple[NDArray[np.intp], Doubles]:
    """Spread some points or more: (P,) the triangle of each, and (P, 3) weights of its corners."""
    wanted = np.ceil(count * areas / max(float(areas.sum()), 1e-30))
    each = np.clip(wanted, 1, MOST_OF_TRIANGLE).astype(np.intp)
    owners = np.repeat(np.arange(len(areas)), each)
    number = np.arange(len(owners)) - np.repeat(np.cumsum(each) - each, each)
    # Even however many points a triangle has.
    u, v = np.modf((number[:, None] + 0.5) * PLASTIC)[0].T
    root = np.sqrt(u)
    alone = np.repeat(each == 1, each)[:, None]
    weights = np.stack([1.0 - root, root * (1.0 - v), root * v], axis=1)
    return owners, np.where(alone, 1.0 / 3.0, weights)


def _hidden_at(triangles: ModelTriangles, owners: NDArray[np.intp], weights: Doubles) -> Doubles:
    """Return (P,) the share of light that the model itself keeps from each point."""
    corners, normals = triangles.corners.astype(np.float64), triangles.normals.astype(np.float64)
    passes = triangles.passes
    clear = (passes > 0.0) & (passes < 1.0)
    solid, panes = (triangle_tree(triangles.corners[one]) for one in (passes == 0.0, clear))
    glass = panes.record, in_leaves(passes[clear], panes.order)
    middle = corners.mean(axis=1, keepdims=True)
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    flat *= np.where((flat * normals.mean(axis=1)).sum(axis=1) < 0.0, -1.0, 1.0)[:, None]
    flat = _unit(flat)
    # A little inwards from the edges, where a neighbour may stand on end.
    inner = middle + 0.98 * (corners - middle)
    points = np.einsum("pc,pcx->px", weights, inner[owners])
    turned = _unit(np.einsum("pc,pcx->px", weights, normals[owners]))
    # Each point moves the pattern by its own numbers: what remains is noise.
    shifts = np.modf(np.arange(len(points))[:, None] * PLASTIC)[0]
    pattern = low_discrepancy_points(RAYS)
    shares = np.empty(len(points))
    for first in range(0, len(points), POINTS_AT_ONCE):
        some = slice(first, first + POINTS_AT_ONCE)
        given = (points[some], turned[some], flat[owners[some]], shifts[some])
        lit = LitPoints(*(np.ascontiguousarray(array, np.float32) for array in given))
        origins, towards = (array.reshape(-1, 3) for array in hemisphere_rays(lit, pattern))
        never = np.full(len(origins), NEVER, np.float32)
        arrives = light_share(solid.record, glass, origins, towards, never, threads=thread_count())
        shares[some] = 1.0 - arrives.reshape(-1, RAYS).mean(axis=1, dtype=np.float64)
    return shares


def _unit(vectors: Doubles) -> Doubles:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-30))


def _fitted(shares: Doubles, vertices: NDArray[np.int64], weights: Doubles, count: int) -> Doubles:
    """Return (V,) what interpolates to the shares: Landweber's iteration, scaled by rows' sums.

    What is hidden is seldom seen, and counts less: a board below keys is as dark as between them.
    """
    counts = np.maximum(1.0 - shares, LEAST_WEIGHT)
    places, by = vertices.ravel(), weights * counts[:, None]
    known = np.maximum(np.bincount(places, by.ravel(), count), 1e-12)
    fitted, trust = np.zeros(count), np.ones(count)
    for _ in range(ROUNDS):
        missing = shares - (fitted[vertices] * weights).sum(axis=1)
        step = np.bincount(places, (by * missing[:, None]).ravel(), count)
        fitted += trust * step / known
        trust = known / (known + STIFFNESS)
    return np.asarray(np.clip(fitted, 0.0, 1.0))
