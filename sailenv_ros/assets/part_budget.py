"""Triangles that a model of some size may have; what has more is simplified."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from sailenv_ros.assets.meshes import RawMesh, simplified
from sailenv_ros.assets.model_files import RawPart

__all__ = ["simplified_parts"]

TRIANGLES_AT_ONE_METRE = 12_000
"""Greatest number of triangles of a model of one metre; a larger number is simplified."""


def simplified_parts(parts: Sequence[RawPart], diagonal_m: float) -> list[RawPart]:
    """Return the parts of a model with no more triangles than its diagonal [m] allows."""
    wanted = max(500.0, TRIANGLES_AT_ONE_METRE * diagonal_m**0.65)
    count = sum(len(part.mesh.triangles) for part in parts)
    if count <= wanted:
        return list(parts)
    share = wanted / count
    result = []
    for part in parts:
        target = max(64, int(share * len(part.mesh.triangles)))
        mesh: RawMesh = part.mesh
        if len(mesh.triangles) > target:
            mesh = simplified(mesh, target)
        result.append(dataclasses.replace(part, mesh=mesh))
    return result
