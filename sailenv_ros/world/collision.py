"""Collision shapes: a compound of our shapes, scaled, becomes one PyBullet collision shape."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.model import (
    BoxShape,
    CollisionShape,
    ConvexShape,
    CylinderShape,
    SphereShape,
    TriangleShape,
)
from sailenv_ros.world.bullet import BulletClient

__all__ = ["NO_COLLISION", "build_collision"]

NO_COLLISION = -1
"""PyBullet's number for a body that nothing collides with."""

Vector3 = tuple[float, float, float]

_UNTURNED = (0.0, 0.0, 0.0, 1.0)


def build_collision(
    client: BulletClient,
    shapes: Sequence[CollisionShape],
    *,
    scale: Vector3,
    centre_of_mass_m: Vector3,
    name: str,
) -> int:
    """Make one PyBullet collision shape.

    Parameters
    ----------
    scale : (3,) tuple of float
        Applied in the body frame.
    centre_of_mass_m : (3,) tuple of float
        In the body frame after scaling [m]; PyBullet wants shapes relative to it.
    name : str
        The object's name, for errors.

    Returns
    -------
    shape : int
        PyBullet's number, `NO_COLLISION` for no shapes.

    Raises
    ------
    InvalidRequest
        If a round shape would have to be scaled unequally.
    """
    if not shapes:
        return NO_COLLISION
    parts = [_part(client, shape, scale, name) for shape in shapes]
    for part in parts:
        part["position"] = list(np.asarray(part["position"]) - np.asarray(centre_of_mass_m))
    if len(parts) == 1:
        part = parts[0]
        part["collisionFramePosition"] = part.pop("position")
        part["collisionFrameOrientation"] = part.pop("orientation", _UNTURNED)
        part["shapeType"] = part.pop("type")
        return int(client.createCollisionShape(**part))
    with TemporaryDirectory(prefix="sailenv-hulls-") as folder:
        files = [_hull_file(Path(folder), number, part, name) for number, part in enumerate(parts)]
        return int(client.createCollisionShapeArray(**_as_arrays(parts), fileNames=files))


def _part(client: BulletClient, shape: CollisionShape, scale: Vector3, name: str) -> dict[str, Any]:
    constants = client.constants
    sx, sy, sz = scale
    if isinstance(shape, BoxShape):
        hx, hy, hz = shape.half_extents_m
        if shape.orientation_xyzw != _UNTURNED:
            _require_equal(name, scale, (0, 1, 2), "a turned box")
        return {
            "type": constants.GEOM_BOX,
            "halfExtents": [hx * sx, hy * sy, hz * sz],
            "position": _scaled(shape.centre_m, scale),
            "orientation": shape.orientation_xyzw,
        }
    if isinstance(shape, SphereShape):
        _require_equal(name, scale, (0, 1, 2), "a ball")
        return {
            "type": constants.GEOM_SPHERE,
            "radius": shape.radius_m * sx,
            "position": _scaled(shape.centre_m, scale),
        }
    if isinstance(shape, CylinderShape):
        _require_equal(name, scale, (0, 1), "a cylinder")
        return {
            "type": constants.GEOM_CYLINDER,
            "radius": shape.radius_m * sx,
            "height": shape.height_m * sz,
            "position": _scaled(shape.centre_m, scale),
        }
    if isinstance(shape, ConvexShape):
        points = (shape.points * np.asarray(scale)).tolist()
        return {"type": constants.GEOM_MESH, "vertices": points, "position": [0.0, 0.0, 0.0]}
    return _triangles(constants, shape, scale)


def _triangles(constants: Any, shape: TriangleShape, scale: Vector3) -> dict[str, Any]:
    return {
        "type": constants.GEOM_MESH,
        "vertices": (shape.positions * np.asarray(scale)).tolist(),
        "indices": shape.triangles.reshape(-1).tolist(),
        "flags": constants.GEOM_FORCE_CONCAVE_TRIMESH,
        "position": [0.0, 0.0, 0.0],
    }


def _hull_file(folder: Path, number: int, part: dict[str, Any], name: str) -> str:
    """Write a hull's points as OBJ: inside a compound PyBullet takes meshes from files alone.

    Returns
    -------
    path : str
        Empty for shapes that are no meshes.
    """
    if "vertices" not in part:
        return ""
    if "indices" in part:
        raise InvalidRequest(
            f"collision shapes of {name!r}", "hollow geometry beside others", "hulls and solids"
        )
    points = part["vertices"]
    lines = ["v " + " ".join(f"{coordinate:.9g}" for coordinate in point) for point in points]
    # A hull needs no faces, but the reader keeps only points that faces name.
    lines += [f"f 1 {corner} {corner + 1}" for corner in range(2, len(points))]
    # Bullet remembers files by name: the folder's name is never used again.
    path = folder / f"{number}.obj"
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return str(path)


def _as_arrays(parts: list[dict[str, Any]]) -> dict[str, Any]:
    """Turn dicts of single shapes into PyBullet's parallel lists, with its own defaults."""
    return {
        "shapeTypes": [part["type"] for part in parts],
        "radii": [part.get("radius", 0.5) for part in parts],
        "halfExtents": [part.get("halfExtents", [1.0, 1.0, 1.0]) for part in parts],
        "lengths": [part.get("height", 1.0) for part in parts],
        "meshScales": [[1.0, 1.0, 1.0]] * len(parts),
        "collisionFramePositions": [part["position"] for part in parts],
        "collisionFrameOrientations": [part.get("orientation", _UNTURNED) for part in parts],
    }


def _scaled(position: Vector3, scale: Vector3) -> list[float]:
    return [p * s for p, s in zip(position, scale, strict=True)]


def _require_equal(name: str, scale: Vector3, axes: tuple[int, ...], what: str) -> None:
    values = [scale[axis] for axis in axes]
    if max(values) - min(values) > 1e-9 * max(values):
        letters = ", ".join("xyz"[axis] for axis in axes)
        raise InvalidRequest(
            f"scale of {name!r}", scale, f"equal along {letters}, because it collides as {what}"
        )
