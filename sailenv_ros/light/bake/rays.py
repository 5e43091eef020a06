"""Rays against the static geometry with Embree: `StaticGeometry` to `RayScene`. Knows no light."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.extras import need
from sailenv_ros.light.bake.static_geometry import StaticGeometry

__all__ = ["Hits", "RayScene", "in_chunks", "through_glass"]

Floats = NDArray[np.float32]

NEVER = 1e30
"""Length of rays without end [m]."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Hits:
    """First hits of rays.

    Attributes
    ----------
    triangle : (R,) int32
        -1 where they met nothing.
    distance : (R,) float32
        In lengths of the direction; huge where they met nothing.
    second, third : (R,) float32
        Weights of the triangle's second and third corner.
    """

    triangle: NDArray[np.int32]
    distance: Floats
    second: Floats
    third: Floats


class RayScene:
    """The triangles of the static geometry, ready to be met by rays from any thread."""

    def __init__(self, geometry: StaticGeometry) -> None:
        self._triangles = np.flatnonzero(geometry.solid).astype(np.int32)
        self._scene, self._mesh = _tree(geometry.corners[self._triangles])
        glass = np.flatnonzero(~geometry.solid & (geometry.passes < 1.0))
        self._glass, self._glass_mesh = _tree(geometry.corners[glass])
        self._passes, self._glass_faces = geometry.passes[glass], geometry.faces[glass]

    def hits(self, origins: Floats, directions: Floats) -> Hits:
        """Find what solid triangles rays meet first."""
        if not len(self._triangles):
            none = np.zeros(len(origins), np.float32)
            never = np.full(len(origins), NEVER, np.float32)
            found = np.full(len(origins), -1, np.int32)
            return Hits(triangle=found, distance=never, second=none, third=none)
        answer = self._scene.run(origins, directions, output=1)
        met = answer["primID"]
        return Hits(
            triangle=np.where(met >= 0, self._triangles[met], np.int32(-1)),
            distance=answer["tfar"],
            second=answer["u"],
            third=answer["v"],
        )

    def share_that_passes(self, origins: Floats, directions: Floats, lengths: Floats) -> Floats:
        """Return (R,) float32: how much of the light on each ray's length is let through, 0 to 1.

        Lengths are in lengths of the direction. Glass counts once, however many faces it has.
        """
        share = np.ones(len(origins), dtype=np.float32)
        if len(self._triangles) and len(origins):
            share[self._scene.run(origins, directions, lengths, query="OCCLUDED") >= 0] = 0.0
        if len(self._passes):
            free = np.flatnonzero(share)
            share[free] = self.transmittance(origins[free], directions[free], lengths[free])
        return share

    def transmittance(self, origins: Floats, directions: Floats, lengths: Floats) -> Floats:
        """Return (R,) float32: the same, if nothing solid is in the way."""
        share = np.ones(len(origins), dtype=np.float32)
        if len(self._passes) and len(origins):
            answer = self._glass.run(origins, directions, output=1)
            met = (answer["primID"] >= 0) & (answer["tfar"] < lengths)
            pane = answer["primID"][met]
            slant = np.abs(np.einsum("rx,rx->r", directions[met], self._glass_faces[pane]))
            slant /= np.maximum(np.linalg.norm(directions[met], axis=1), 1e-12)
            share[met] = self._passes[pane] * through_glass(slant)
        return share


def through_glass(cosine: Floats) -> Floats:
    """Return how much light clear double glazing lets through: 0.85 of what meets it head-on.

    Fresnel's equations for an index of 1.5, both polarisations alike, with all that goes to and
    fro between the two faces of each of the two sheets.

    Parameters
    ----------
    cosine : (R,) float32
        Of the angle between the ray and the pane's normal, 0 to 1.
    """
    inside = np.sqrt(1.0 - (1.0 - np.square(np.minimum(cosine, 1.0))) / 1.5**2)
    across = (cosine - 1.5 * inside) / (cosine + 1.5 * inside)
    along = (1.5 * cosine - inside) / (1.5 * cosine + inside)
    mirrored = 0.5 * (np.square(across) + np.square(along))
    return np.asarray(np.square((1.0 - mirrored) / (1.0 + mirrored)), dtype=np.float32)


def _tree(corners: Floats) -> tuple[Any, Any]:
    """Build embree's tree over (T, 3, 3) float32 corners; the mesh is to be kept with it."""
    scene, mesh = need("embreex.rtcore_scene", "baking light").EmbreeScene(), None
    if len(corners):
        mesh = need("embreex.mesh_construction", "baking light").TriangleMesh(scene, corners)
        # The first query builds the tree; threads shall find it built.
        nowhere = np.zeros((1, 3), np.float32)
        scene.run(nowhere, nowhere + 1)
    return scene, mesh


def in_chunks(
    work: Callable[[int, int], None],
    count: int,
    size: int,
    workers: int,
    report: Callable[[float], None] = lambda share: None,
) -> None:
    """Do ``work(first, end)`` for all of `count` items in several threads.

    Results do not depend on the number of threads as long as pieces do not share what they write.
    """
    pieces = [(first, min(first + size, count)) for first in range(0, count, size)]
    pool = ThreadPoolExecutor(workers)
    try:
        for done, future in enumerate([pool.submit(work, *piece) for piece in pieces]):
            future.result()
            report((done + 1) / len(pieces))
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
