"""Mirrors among what stands still, and what they show of small things that shine. Arrays out."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.emitters import MOST_EMITTERS
from sailenv_ros.rays.mirror_faces import mirror_faces
from sailenv_ros.rays.static_geometry import StaticGeometry

__all__ = ["mirror_shares", "with_images"]

Floats = NDArray[np.float32]

LEAST_ALONG = 0.99
"""Least cosine between the normal of a mirror and those of its triangles."""


def mirror_shares(geometry: StaticGeometry, categories: Mapping[int, str]) -> Floats:
    """Return (T,) float32: the share of the light that each triangle mirrors, 0 of most.

    Parameters
    ----------
    categories : mapping of int to str
        Of the instances, by their ids.
    """
    shares = np.zeros(geometry.triangle_count, np.float32)
    for instance in geometry.instances:
        counts = [len(part.mesh.triangles) for part in instance.model.parts]
        firsts = instance.first_triangle + np.cumsum([0, *counts])
        for face in mirror_faces(instance.model, categories[instance.id]):
            own = slice(firsts[face.part], firsts[face.part + 1])
            along = np.abs(geometry.faces[own] @ instance.world_from_body[:3, face.axis])
            shares[own] = np.where(along > LEAST_ALONG, face.tint.mean(), np.float32(0.0))
    return shares


def with_images(emitters: Floats, geometry: StaticGeometry, shares: Floats) -> Floats:
    """Return (E, 4) float32: small emitters, and their images behind mirrors; see `emitters_of`.

    Parameters
    ----------
    emitters : (E, 4) float32
    shares : (T,) float32
        See `mirror_shares`.
    """
    chosen = np.flatnonzero(shares)
    normals = geometry.faces[chosen].astype(np.float64)
    far = np.einsum("tx,tx->t", normals, geometry.corners[chosen, 0])
    planes = np.unique(np.round(np.column_stack([normals, far]), 3), axis=0)
    images = [emitters]
    for *normal, distance in planes:
        before = emitters[:, :3] @ np.asarray(normal) - distance
        image = emitters[before > 0.0].copy()
        image[:, :3] -= 2.0 * before[before > 0.0, None] * np.asarray(normal)
        images.append(image)
    return np.concatenate(images)[:MOST_EMITTERS].astype(np.float32)
