"""Parts of a model file → an `ImportedAsset`: simplified, smoothed, with what it collides as."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_content.scene_import.imported import ImportedAsset
from sailenv_ros.assets.hulls import hulls_of_pieces, merged
from sailenv_ros.assets.meshes import RawMesh, components, is_open, simplified, smooth_mesh
from sailenv_ros.assets.model_files import RawPart
from sailenv_ros.assets.part_budget import simplified_parts
from sailenv_ros.errors import AssetError
from sailenv_ros.types.model import ConvexShape, Material, ModelPart

__all__ = ["asset_of_parts"]

Doubles = NDArray[np.float64]

LARGEST_M = 100.0
SMALLEST_M = 1e-4

HOLLOW = 0.25
"""A piece that fills less of its hull is hollow, like a room in one mesh."""

LARGE_M = 1.5
"""Size from which hollow pieces collide by their surfaces, not by their hull [m]."""

MOST_PLATES = 400
PLATE_M = 0.01


def asset_of_parts(
    name: str,
    parts: Sequence[RawPart],
    *,
    display_name: str,
    category: str,
    collides: bool = True,
    author: str = "",
    licence: str = "",
    source: str = "",
) -> ImportedAsset:
    """Make an asset of the parts of a model, as they stand in its body frame.

    Raises
    ------
    AssetError
        If it has no extent, or one that no scene has.
    """
    points = np.concatenate(
        [part.mesh.positions[part.mesh.triangles.reshape(-1)] for part in parts]
    )
    size = points.max(axis=0) - points.min(axis=0)
    if not SMALLEST_M <= float(size.max()) <= LARGEST_M:
        raise AssetError(
            display_name,
            f"it would be {float(size.max()):.4g} m large, and {SMALLEST_M} to {LARGEST_M} m are "
            "accepted",
        )
    parts = simplified_parts(parts, float(np.linalg.norm(size)))
    drawn = []
    for part in parts:
        mesh = smooth_mesh(part.mesh)
        material = part.material
        if is_open(part.mesh):
            material = _two_sided(material)
        if len(mesh.triangles):
            drawn.append(ModelPart(mesh=mesh, material=material))
    if not drawn:
        raise AssetError(display_name, "none of its triangles has an area")
    hulls = _hulls(merged([part.mesh for part in parts])) if collides else ()
    volume = float(np.prod(np.maximum(size, 0.01)))
    return ImportedAsset(
        name=name,
        display_name=display_name,
        category=category,
        parts=tuple(drawn),
        hulls=hulls,
        # Household objects are mostly air.
        mass_kg=round(float(np.clip(150.0 * volume, 0.05, 500.0)), 2),
        author=author[:300],
        licence=licence[:300],
        source=source[:300],
    )


def _two_sided(material: Material) -> Material:
    return dataclasses.replace(material, double_sided=True)


def _hulls(mesh: RawMesh) -> tuple[ConvexShape, ...]:
    """Return convex pieces; of what is large and hollow, one plate for each triangle."""
    of_triangle = components(mesh)
    plates: list[ConvexShape] = []
    rest = np.ones(len(mesh.triangles), np.bool_)
    for number in range(int(of_triangle.max()) + 1):
        own = of_triangle == number
        corners = mesh.positions[mesh.triangles[own]]
        size = np.ptp(corners.reshape(-1, 3), axis=0)
        # Below 0 where its triangles face inwards, as in a room.
        volume = float(np.einsum("ni,ni->n", corners[:, 0], _cross(corners)).sum()) / 6.0
        if float(size.max()) >= LARGE_M and volume < HOLLOW * float(
            np.prod(np.maximum(size, 0.01))
        ):
            piece = dataclasses.replace(mesh, triangles=mesh.triangles[own], normals=None)
            if len(piece.triangles) > MOST_PLATES:
                piece = simplified(piece, MOST_PLATES, max_error=0.02)
            plates += _plates(piece)
            rest &= ~own
    if not rest.any():
        return tuple(plates)
    solid = dataclasses.replace(mesh, triangles=mesh.triangles[rest])
    return (*plates, *hulls_of_pieces(solid))


def _plates(mesh: RawMesh) -> list[ConvexShape]:
    corners = mesh.positions[mesh.triangles]
    normals = _cross(corners)
    area = np.linalg.norm(normals, axis=1)
    kept = area > 1e-8
    behind = corners[kept] - PLATE_M * (normals[kept] / area[kept, None])[:, None]
    pairs = zip(corners[kept], behind, strict=True)
    return [ConvexShape(points=np.concatenate(pair)) for pair in pairs]


def _cross(corners: Doubles) -> Doubles:
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
