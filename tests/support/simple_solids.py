"""Small assets and placements made in code, so that a test shows its own data."""

from __future__ import annotations

from typing import Any

import numpy as np

from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Asset, BoxShape, Material, Mesh, Model, ModelPart, SphereShape
from sailenv_ros.world.bodies import Placement


def one_triangle() -> Mesh:
    """A mesh that is as small as can be."""
    return Mesh(
        positions=np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]]),
        normals=np.array([[0, 0, 1]] * 3),
        uvs=np.zeros((3, 2), np.float32),
        triangles=np.array([[0, 1, 2]]),
    )


def solid(shape: BoxShape | SphereShape, **kwargs: Any) -> Asset:
    """An asset that collides as the shape; what it looks like does not matter."""
    model = Model(name="solid", parts=(ModelPart(mesh=one_triangle(), material=Material()),))
    return Asset(
        name="solid",
        display_name="Solid",
        category="solid",
        model=model,
        collision=(shape,),
        **kwargs,
    )


UNIT_BOX = solid(BoxShape(half_extents_m=(0.5, 0.5, 0.5)))
UNIT_BALL = solid(SphereShape(radius_m=0.5))


def placed(
    name: str, position: tuple[float, float, float] = (0.0, 0.0, 0.0), **kwargs: Any
) -> Placement:
    """Place a unit box (or `asset`) without turning it."""
    kwargs.setdefault("asset", UNIT_BOX)
    kwargs.setdefault("pose", Pose(position))
    return Placement(name=name, category_id=1, **kwargs)
