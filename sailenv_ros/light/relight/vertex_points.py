"""Points on models on which light changes much within little space, for light at their vertices.

In the folds of a curtain and in a cup a lamp shines on one flank and not on the other, or on all
though half of the room is hidden; a net is dark where it hangs beside a heavy curtain. No few terms
tell that: the light is found at points of each triangle, and told at each vertex.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.rays.model_triangles import triangles_of
from sailenv_ros.rays.self_occlusion import LEAST_WEIGHT, POINTS, spread_points, vertex_occlusion
from sailenv_ros.types.digests import once
from sailenv_ros.types.model import Model

__all__ = ["VertexPoints", "vertex_points"]

Doubles: TypeAlias = NDArray[np.float64]

LEAST_HIDDEN = 0.1
"""Share that a model's surface hides of itself on average, from which its vertices are asked."""

MOST_VERTICES = 8192
"""Of a model that are asked: leaves of a plant are too many, and too small."""

LARGE_M, LEAST_POINTS = 0.25, 512
"""Models of this radius and more have `POINTS` [m]; smaller ones fewer, but so many at least."""

RAYS = 1 << 17
"""From all points of a model together, as long as each has no fewer and no more than these."""

LEAST_RAYS, MOST_RAYS = 16, 64

NEAR_M = 0.04
"""Neighbours that are so far away count by half [m]."""

MOST_RISE = 1.5
"""More light than so many times what terms say of a place in the open is noise."""

ROUNDS, VEIL_ROUNDS = 1, 5
"""In which neighbours share their light: in veils across some centimetres."""


class VertexPoints(NamedTuple):
    """Where the light is asked for, in the model's own frame, and the vertices that it is for.

    Attributes
    ----------
    positions, normals : (P, 3) float64
        Of the points.
    open_shares : (P,) float64
        Of the light from around, what the model itself does not hide; `LEAST_WEIGHT` or more.
    corners : (P, 3) int64
        Vertices around each point.
    weights : (P, 3) float64
        How much each of them counts there; 1 in all.
    edges : (E, 2) int64
        Vertices beside each other.
    nearness : (E,) float64
        How much they count for each other, 0 to 1.
    vertex_count : int
    is_veil : bool
        Whether light passes all of the model: rays do not meet it.
    """

    positions: Doubles
    normals: Doubles
    open_shares: Doubles
    corners: NDArray[np.int64]
    weights: Doubles
    edges: NDArray[np.int64]
    nearness: Doubles
    vertex_count: int
    is_veil: bool

    @property
    def ray_count(self) -> int:
        """How many rays each point sends out."""
        return min(max(RAYS // len(self.positions), LEAST_RAYS), MOST_RAYS)

    def at_vertices(self, found: Doubles, fitted: Doubles) -> tuple[Doubles, Doubles]:
        """Return (L, V, 2) light that rays found, and that by terms, without the noise of few rays.

        What rarely meets something small and bright, as a lamp's shade, is held to what terms say
        of that place if nothing hid it. The mean of what lies around a vertex stands for it; of a
        large triangle it is that of all of it. Then neighbours share their quotients to the terms;
        in veils they share the bounced light itself, which goes from fold to fold.

        Parameters
        ----------
        found, fitted : (L, P, 2) float64
            At the points: as `ObjectLight` has it at vertices.
        """
        fitted = np.maximum(fitted, 1e-9)
        open_light = fitted[..., 0] / self.open_shares
        most = MOST_RISE * np.maximum(open_light, open_light.mean(axis=1, keepdims=True))
        rows = np.concatenate(
            [np.minimum(found[..., 0], most), found[..., 1], fitted[..., 0], fitted[..., 1]]
        )
        rows = self._around_vertices(rows)
        bounced, direct, of_bounced, of_direct = np.split(rows, 4)
        beside = np.ones_like(of_bounced) if self.is_veil else of_bounced
        rounds = VEIL_ROUNDS if self.is_veil else ROUNDS
        shared, by = np.split(self._shared(np.concatenate([bounced, beside]), rounds), 2)
        return (
            np.stack([shared / by * beside, direct], axis=-1),
            np.stack([of_bounced, of_direct], axis=-1),
        )

    def _around_vertices(self, values: Doubles) -> Doubles:
        """Return (N, V): the mean of the points around each vertex; 0 of those of no triangle."""
        places, count = self.corners.ravel(), self.vertex_count
        each = np.maximum(np.bincount(places, self.weights.ravel(), count), 1e-12)
        return np.stack(
            [
                np.bincount(places, (self.weights * row[:, None]).ravel(), count) / each
                for row in values
            ]
        )

    def _shared(self, values: Doubles, rounds: int) -> Doubles:
        """Return (N, V): sums over each vertex and its neighbours, again and again."""
        ends, count = self.edges.T, values.shape[1]
        for _ in range(rounds):
            values = values + np.stack(
                [
                    np.bincount(ends[0], self.nearness * row[ends[1]], count)
                    + np.bincount(ends[1], self.nearness * row[ends[0]], count)
                    for row in values
                ]
            )
        return values


@once
def vertex_points(model: Model) -> VertexPoints | None:
    """Return points for the vertices of a model's parts, one part after another.

    None for models that hide little of themselves and are no veils, and for those with glass.
    """
    *firsts, vertex_count = model.first_vertices
    every = triangles_of(model)
    if not 0 < vertex_count <= MOST_VERTICES or not len(every.areas_m2):
        return None
    if not (model.is_veil or every.passes.max() == 0.0):
        return None
    own = (part.mesh.triangles.astype(np.int64) for part in model.parts)
    triangles = np.concatenate([one + first for one, first in zip(own, firsts, strict=True)])
    hidden = np.concatenate(vertex_occlusion(model)).astype(np.float64)
    if not model.is_veil and hidden[triangles].mean() < LEAST_HIDDEN:
        return None
    radius_m = float(np.linalg.norm(np.ptp(model.bounds(), axis=0))) / 2.0
    count = int(np.clip(POINTS * (radius_m / LARGE_M) ** 2, LEAST_POINTS, POINTS))
    owners, weights = spread_points(every.areas_m2, count)
    corners = triangles[owners]

    def between(values: Doubles) -> Doubles:
        return np.asarray(np.einsum("pc,pc...->p...", weights, values[corners]))

    normals = between(model.normals.astype(np.float64))
    pairs = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    # As numbers they are sorted in a tenth of the time that rows take.
    numbers = np.unique(pairs[:, 0] * vertex_count + pairs[:, 1])
    edges = np.stack(np.divmod(numbers, vertex_count), axis=1)
    lengths = np.linalg.norm(np.diff(model.positions[edges], axis=1)[:, 0], axis=1)
    return VertexPoints(
        positions=between(model.positions.astype(np.float64)),
        normals=normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12),
        open_shares=np.maximum(1.0 - between(hidden), LEAST_WEIGHT),
        corners=corners,
        weights=weights,
        edges=edges,
        nearness=1.0 / (1.0 + (lengths.astype(np.float64) / NEAR_M) ** 2),
        vertex_count=vertex_count,
        is_veil=model.is_veil,
    )
