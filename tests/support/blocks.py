"""Furniture of blocks, whose surfaces are known by arithmetic."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sailenv_ros.types.model import Asset, BoxShape, Mesh, Model, ModelPart
from tests.support.tiny_scenes import box_mesh, model_of

__all__ = ["Block", "furniture"]

Block = tuple[tuple[float, float, float], tuple[float, float, float]]
"""Size, and the middle of the bottom [m]."""


def furniture(name: str, category: str, blocks: Sequence[Block]) -> Asset:
    """Blocks that are one piece."""
    look = model_of(box_mesh((1.0, 1.0, 1.0))).parts[0].material
    parts, shapes = [], []
    for size, (x, y, z) in blocks:
        mesh = box_mesh(size)
        middle = x, y, z + 0.5 * size[2]
        moved = Mesh(
            positions=mesh.positions + np.array(middle, np.float32),
            normals=mesh.normals,
            uvs=mesh.uvs,
            triangles=mesh.triangles,
        )
        parts.append(ModelPart(mesh=moved, material=look))
        half = 0.5 * size[0], 0.5 * size[1], 0.5 * size[2]
        shapes.append(BoxShape(half_extents_m=half, centre_m=middle))
    return Asset(
        name=name,
        display_name=name,
        category=category,
        model=Model(name=name, parts=tuple(parts)),
        collision=tuple(shapes),
    )
