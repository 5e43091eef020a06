"""Collision shapes: a compound of our shapes, scaled, becomes one PyBullet collision shape."""

from __future__ import annotations

import itertools
import threading
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.system.references import references_given_back
from sailenv_ros.system.temporary_folders import temporary_folder
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import (
    BoxShape,
    CollisionShape,
    ConvexShape,
    CylinderShape,
    SphereShape,
    TriangleShape,
)
from sailenv_ros.world.bullet import BulletClient

__all__ = ["NO_COLLISION", "HullFiles", "build_collision", "hull_files"]

NO_COLLISION = -1
"""PyBullet's number for a body that nothing collides with."""

Vector3 = tuple[float, float, float]

_UNTURNED = (0.0, 0.0, 0.0, 1.0)

MAX_SHAPES = 16
"""PyBullet silently leaves out what a compound has beyond (MAX_COMPOUND_COLLISION_SHAPES)."""

_LOCK = threading.Lock()


class HullFiles:
    """Files of hulls, of which PyBullet makes shapes and bodies; see `hull_files`.

    It keeps each name that it is given for good, so names are short and without their folder.
    It looks for them in the working directory first, where nothing has a name like these.
    """

    def __init__(self, client: BulletClient, temporary: ExitStack) -> None:
        self.client, self._temporary = client, temporary
        self._folder: Path | None = None
        self._names = (f".sailenv{number}.obj" for number in itertools.count())

    def write(self, text: str) -> str:
        """Return the name of a new file, by which PyBullet finds it."""
        if self._folder is None:
            self._folder = self._temporary.enter_context(temporary_folder("sailenv-hulls-"))
            self.client.setAdditionalSearchPath(str(self._folder))
        name = next(self._names)
        (self._folder / name).write_text(text, encoding="ascii")
        return name


@contextmanager
def hull_files(client: BulletClient) -> Iterator[HullFiles]:
    """Make shapes by `build_collision`, and bodies of them, within this.

    PyBullet keeps what it has read of files, by their names: it reads those of a body's hulls when
    it makes the shape, and again for the body. Afterwards it must forget them, or it would keep all
    hulls of the process.
    """
    # What it keeps, and where it looks for files, is one for all threads.
    with _LOCK, ExitStack() as temporary:
        yield HullFiles(client, temporary)
        for kept in (0, 1):
            client.setPhysicsEngineParameter(enableFileCaching=kept)


def build_collision(
    files: HullFiles,
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
    client = files.client
    parts = [_part(client, shape, scale, name) for shape in shapes]
    for part in parts:
        part["position"] = list(np.asarray(part["position"]) - np.asarray(centre_of_mass_m))
    if len(parts) == 1:
        part = parts[0]
        part["collisionFramePosition"] = part.pop("position")
        part["collisionFrameOrientation"] = part.pop("orientation", _UNTURNED)
        part["shapeType"] = part.pop("type")
        read = {key: part.pop(key).tolist() for key in ("vertices", "indices") if key in part}
        # PyBullet takes references to the lists that it reads, and never gives them back.
        with references_given_back(list(read.values())):
            return int(client.createCollisionShape(**part, **read))
    if len(parts) > MAX_SHAPES:
        parts = _joined(client, parts, name)
    names = [_hull_file(files, part, name) for part in parts]
    return int(client.createCollisionShapeArray(**_as_arrays(parts), fileNames=names))


def _joined(
    client: BulletClient, parts: Sequence[dict[str, Any]], name: str
) -> list[dict[str, Any]]:
    """Return parts with all hulls in one: several of one file are one shape to PyBullet.

    Where there are still too many, boxes are hulls, too.
    """
    solids = [part for part in parts if "vertices" not in part]
    hulls = [part for part in parts if "vertices" in part]
    if any("indices" in part for part in hulls):
        raise _hollow(name)
    if len(solids) + bool(hulls) > MAX_SHAPES:
        origin = hulls[0]["position"] if hulls else [0.0, 0.0, 0.0]
        kind = client.constants.GEOM_MESH
        hulls += [_box_hull(part, origin, kind) for part in solids if "halfExtents" in part]
        solids = [part for part in solids if "halfExtents" not in part]
    if len(solids) + bool(hulls) > MAX_SHAPES:
        accepted = f"at most {MAX_SHAPES - 1} balls and cylinders"
        raise InvalidRequest(f"collision shapes of {name!r}", len(solids), accepted)
    return [*solids, {**hulls[0], "hulls": [part["vertices"] for part in hulls]}]


def _box_hull(box: dict[str, Any], origin: Sequence[float], kind: int) -> dict[str, Any]:
    """Return a box as the hull of its corners, about another origin."""
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    turned = Pose(orientation_xyzw=box["orientation"]).matrix()[:3, :3]
    corners = signs * box["halfExtents"] @ turned.T + np.asarray(box["position"]) - origin
    return {"type": kind, "vertices": corners, "position": origin}


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
        points = shape.points * np.asarray(scale)
        return {"type": constants.GEOM_MESH, "vertices": points, "position": [0.0, 0.0, 0.0]}
    return _triangles(constants, shape, scale)


def _triangles(constants: Any, shape: TriangleShape, scale: Vector3) -> dict[str, Any]:
    return {
        "type": constants.GEOM_MESH,
        "vertices": shape.positions * np.asarray(scale),
        "indices": shape.triangles.reshape(-1),
        "flags": constants.GEOM_FORCE_CONCAVE_TRIMESH,
        "position": [0.0, 0.0, 0.0],
    }


def _hull_file(files: HullFiles, part: dict[str, Any], name: str) -> str:
    """Write a hull's points as OBJ: inside a compound PyBullet takes meshes from files alone.

    Returns
    -------
    file : str
        Empty for shapes that are no meshes.
    """
    if "vertices" not in part:
        return ""
    if "indices" in part:
        raise _hollow(name)
    lines, first = [], 1
    for number, points in enumerate(part.get("hulls", [part["vertices"]])):
        lines.append(f"o {number}")
        lines += ["v " + " ".join(f"{coordinate:.9g}" for coordinate in p) for p in points.tolist()]
        # A hull needs no faces, but the reader keeps only points that faces name.
        end = first + len(points)
        lines += [f"f {first} {corner} {corner + 1}" for corner in range(first + 1, end - 1)]
        first = end
    return files.write("\n".join(lines) + "\n")


def _hollow(name: str) -> InvalidRequest:
    what = f"collision shapes of {name!r}"
    return InvalidRequest(what, "hollow geometry beside others", "hulls and solids")


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
