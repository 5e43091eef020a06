"""The triangles of a model, with all that rays ask of them; gathered for rays here alone.

From `Model` to arrays in the model's own frame. Knows neither poses nor scales.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.rays.cutouts import mostly_opaque
from sailenv_ros.types.model import Material, Model

__all__ = ["ModelTriangles", "joined", "triangles_of"]

Floats = NDArray[np.float32]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ModelTriangles:
    """All triangles of a model, part by part.

    Attributes
    ----------
    materials : tuple of Material
        Of the parts.
    part : (T,) int32
        Place in `materials` of each triangle.
    corners, normals : (T, 3, 3) float32
    uvs : (T, 3, 2) float32
        Texture coordinates of the corners.
    two_sided : (T,) bool
    passes : (T,) float32
        Share of light that is let through: 0 of solid triangles, 1 - alpha of glass, 1 of what a
        mask leaves mostly open.
    """

    materials: tuple[Material, ...]
    part: NDArray[np.int32]
    corners: Floats
    normals: Floats
    uvs: Floats
    two_sided: NDArray[np.bool_]
    passes: Floats

    @property
    def areas_m2(self) -> NDArray[np.float64]:
        """(T,) [m²], in the model's own frame."""
        corners = self.corners.astype(np.float64)
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        areas: NDArray[np.float64] = 0.5 * np.linalg.norm(across, axis=1)
        return areas

    def chosen_by(self, alpha: str) -> NDArray[np.bool_]:
        """Return (T,) bool: triangles whose material has this kind of alpha."""
        table = np.array([material.alpha == alpha for material in self.materials], np.bool_)
        return np.asarray(table[self.part], np.bool_)


def triangles_of(model: Model) -> ModelTriangles:
    """Gather the triangles of a model."""
    parts = model.parts
    materials = tuple(part.material for part in parts)
    counts = [len(part.mesh.triangles) for part in parts]
    uvs = [part.mesh.uvs[part.mesh.triangles] for part in parts]
    passes = [_passes(look, own) for look, own in zip(materials, uvs, strict=True)]
    sides = np.array([material.double_sided for material in materials], np.bool_)
    return ModelTriangles(
        materials=materials,
        part=np.repeat(np.arange(len(parts), dtype=np.int32), counts),
        corners=joined([p.mesh.positions[p.mesh.triangles] for p in parts], (3, 3)),
        normals=joined([p.mesh.normals[p.mesh.triangles] for p in parts], (3, 3)),
        uvs=joined(uvs, (3, 2)),
        two_sided=np.repeat(sides, counts),
        passes=joined(passes, ()),
    )


def _passes(material: Material, uvs: Floats) -> Floats:
    if material.alpha == "blend":
        return np.full(len(uvs), 1.0 - material.base_colour[3], np.float32)
    if material.alpha == "mask":
        return np.asarray(~mostly_opaque(material, uvs), np.float32)
    return np.zeros(len(uvs), np.float32)


def joined(arrays: Sequence[NDArray[Any]], shape: tuple[int, ...]) -> Floats:
    """Return (T, *shape) float32: arrays one after another."""
    none = np.zeros((0, *shape), np.float32)
    return np.concatenate([none, *arrays]).astype(np.float32, copy=False)
