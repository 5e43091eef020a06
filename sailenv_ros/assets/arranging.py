"""Places the objects of a scene: against walls, on other objects, or at given poses.

Entries of a scene and their assets in, poses out. Knows no physics engine: what carries an object
is found from the collision shapes of both, so that it rests there from the first step on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene.spec_objects import ObjectSpec
from sailenv_ros.scene.spec_room import RoomSpec
from sailenv_ros.system.array_cache import Arrays, cached_arrays, code_digest
from sailenv_ros.system.memory import cached_for_scenes
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import (
    Asset,
    BoxShape,
    CollisionShape,
    CylinderShape,
    SphereShape,
    TriangleShape,
)
from sailenv_ros.types.shapes import box_corners

__all__ = ["RESTING_GAP_M", "WALL_GAP_M", "arranged", "shape_points", "support_heights"]

RESTING_GAP_M = 0.001
"""Gap between an object and its carrier [m]: shapes in contact would be pushed apart."""

WALL_GAP_M = 0.004

_SAMPLES = np.linspace(-0.45, 0.45, 9)
"""Points below an object at which the height of its carrier is sampled, as shares of its size."""

_UNTURNED = (0.0, 0.0, 0.0, 1.0)

_EDGE_M = 1e-9
"""By how much a point may be beside a box that it counts as being over [m]."""

Floats = NDArray[np.float64]

_FACING: Mapping[str, float] = {"north": -90.0, "east": 180.0, "south": 90.0, "west": 0.0}
"""Yaw of what stands with its back to a wall [deg]."""


def arranged(
    entries: Sequence[ObjectSpec], assets: Mapping[str, Asset], room: RoomSpec | None
) -> Mapping[str, Pose]:
    """Return the pose of each object, by its name.

    Parameters
    ----------
    entries : sequence of ObjectSpec
    assets : mapping of str to Asset
        By the object's name.
    room : RoomSpec or None
        Its walls; needed by entries that name one.

    Raises
    ------
    InvalidRequest
        If an entry names a wall where there is no room, or a carrier that is not there or that
        it carries itself.
    """
    by_name = {entry.name: entry for entry in entries}
    poses: dict[str, Pose] = {}
    for entry in entries:
        _place(entry, by_name, assets, room, poses, ())
    return poses


def _place(
    entry: ObjectSpec,
    by_name: Mapping[str, ObjectSpec],
    assets: Mapping[str, Asset],
    room: RoomSpec | None,
    poses: dict[str, Pose],
    above: tuple[str, ...],
) -> Pose:
    if entry.name in poses:
        return poses[entry.name]
    if entry.on is not None:
        if entry.on not in by_name or entry.on in (*above, entry.name):
            raise InvalidRequest(f"on of {entry.name!r}", entry.on, "another object of the scene")
        carrier = by_name[entry.on]
        base = _place(carrier, by_name, assets, room, poses, (*above, entry.name))
        pose = _upon(entry, assets[entry.name], carrier, assets[entry.on], base)
    elif entry.joint is not None and entry.joint.parent is not None:
        parent = by_name[entry.joint.parent]  # rules of scenes see to it that it is there
        base = _place(parent, by_name, assets, room, poses, (*above, entry.name))
        pose = Pose.from_matrix(base.matrix() @ entry.pose.matrix())
    elif entry.wall is not None:
        if room is None:
            raise InvalidRequest(f"wall of {entry.name!r}", entry.wall, "left out without a room")
        pose = _beside_wall(entry, assets[entry.name], room)
    else:
        pose = entry.pose
    poses[entry.name] = pose
    return pose


def _upon(
    entry: ObjectSpec, asset: Asset, carrier: ObjectSpec, carrying: Asset, base: Pose
) -> Pose:
    """Return the pose on a carrier, whose turn the object takes along."""
    given = entry.pose.matrix()
    x, y, z = entry.position
    points = _points(asset.collision or _box_of(asset), entry.scale) @ given[:3, :3].T
    low, high = points.min(axis=0), points.max(axis=0)
    middle, size = (low + high) / 2.0, high - low
    offsets = np.stack(np.meshgrid(_SAMPLES, _SAMPLES), axis=-1).reshape(-1, 2)
    under = np.array([x, y]) + middle[:2] + offsets * size[:2]
    height = float(support_heights(carrying, carrier.scale, under, entry.level).max())
    if not np.isfinite(height):
        raise InvalidRequest(
            f"position of {entry.name!r}", entry.position, f"a place that {entry.on!r} lies under"
        )
    given[:3, 3] = (x, y, z + height - low[2] + RESTING_GAP_M)
    return Pose.from_matrix(base.matrix() @ given)


def support_heights(
    asset: Asset,
    scale: tuple[float, float, float],
    under: Floats,
    level: tuple[float, float] | None = None,
) -> Floats:
    """Return the heights at which an asset would carry something.

    Parameters
    ----------
    asset : Asset
    scale : (3,) tuple of float
    under : (N, 2) float64
        Points below, in the body frame [m].
    level : (2,) tuple of float or None
        Least and greatest height of an upper side that counts, such as a worktop's below
        cupboards, in the body frame [m].

    Returns
    -------
    (N,) float64
        In the body frame [m]; -inf where nothing of it is above.
    """
    shapes = asset.collision or _box_of(asset)
    heights = np.stack([_heights(shape, scale, under) for shape in shapes])
    if level is not None:
        heights[(heights < level[0]) | (heights > level[1])] = -np.inf
    return np.asarray(heights.max(axis=0))


def _beside_wall(entry: ObjectSpec, asset: Asset, room: RoomSpec) -> Pose:
    """Return the pose with the back to a wall, the front to the room."""
    assert entry.wall is not None
    facing = Pose.from_rpy_deg((0.0, 0.0, 0.0), (0.0, 0.0, _FACING[entry.wall])).matrix()
    turn = facing @ entry.pose.matrix()
    turn[:3, 3] = 0.0
    model = asset.model.bounds() * np.asarray(entry.scale)
    corners = np.stack(np.meshgrid(*model.T), axis=-1).reshape(-1, 3) @ turn[:3, :3].T
    low, high = corners.min(axis=0), corners.max(axis=0)
    half_x, half_y = room.size[0] / 2.0, room.size[1] / 2.0
    gap = WALL_GAP_M + entry.gap + _skirting(room, entry.height)
    x, y = {
        "north": (entry.at, half_y - high[1] - gap),
        "south": (entry.at, -half_y - low[1] + gap),
        "east": (half_x - high[0] - gap, entry.at),
        "west": (-half_x - low[0] + gap, entry.at),
    }[entry.wall]
    turn[:3, 3] = (x, y, entry.height + RESTING_GAP_M * (entry.height == 0.0))
    return Pose.from_matrix(turn)


def _skirting(room: RoomSpec, height_m: float) -> float:
    """Return how far the skirting keeps off what stands on the floor."""
    return room.skirting.depth if room.skirting is not None and height_m == 0.0 else 0.0


def _box_of(asset: Asset) -> tuple[CollisionShape, ...]:
    low, high = asset.model.bounds()
    half, centre = (high - low) / 2.0, (high + low) / 2.0
    return (BoxShape(half_extents_m=tuple(half), centre_m=tuple(centre)),)


def _points(shapes: Sequence[CollisionShape], scale: tuple[float, float, float]) -> Floats:
    return np.asarray(shape_points(shapes) * np.asarray(scale))


def shape_points(shapes: Sequence[CollisionShape]) -> Floats:
    """Return (N, 3): points whose hull is that of collision shapes, or nearly so [m]."""
    return np.concatenate([_corners(shape) for shape in shapes])


def _corners(shape: CollisionShape) -> Floats:
    """Return points whose convex hull is a shape, or nearly so for round ones; triangles' own."""
    if isinstance(shape, BoxShape):
        return box_corners(shape)
    if isinstance(shape, SphereShape):
        signs = np.concatenate([np.eye(3), -np.eye(3)])
        return _moved(signs * shape.radius_m, shape.centre_m)
    if isinstance(shape, CylinderShape):
        turns = np.linspace(0.0, 2.0 * np.pi, 32, endpoint=False)
        ring = np.stack([np.cos(turns), np.sin(turns)], axis=1) * shape.radius_m
        halves = (-shape.height_m / 2.0, shape.height_m / 2.0)
        rings = [np.insert(ring, 2, z, axis=1) for z in halves]
        return _moved(np.concatenate(rings), shape.centre_m)
    return shape.positions if isinstance(shape, TriangleShape) else shape.points


def _moved(points: Floats, centre_m: tuple[float, float, float]) -> Floats:
    return np.asarray(points + np.asarray(centre_m))


def _heights(shape: CollisionShape, scale: tuple[float, float, float], under: Floats) -> Floats:
    """Return (N,): the greatest heights of a shape over points of the floor; -inf beside it."""
    points = _corners(shape) * np.asarray(scale)
    heights = np.full(len(under), -np.inf)
    low, high = points.min(axis=0), points.max(axis=0)
    near = ((under >= low[:2] - _EDGE_M) & (under <= high[:2] + _EDGE_M)).all(axis=1)
    if isinstance(shape, BoxShape) and shape.orientation_xyzw == _UNTURNED:
        heights[near] = high[2]
    elif near.any():
        heights[near] = _over_triangles(points, _triangles_of(shape), under[near])
    return heights


def _over_triangles(points: Floats, triangles: NDArray[np.int32], under: Floats) -> Floats:
    a, b, c = (points[triangles[:, k]] for k in range(3))
    ab, ac = (b - a)[:, :2], (c - a)[:, :2]
    area = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
    seen = np.abs(area) > 1e-12
    a, b, c, ab, ac, area = a[seen], b[seen], c[seen], ab[seen], ac[seen], area[seen]
    offset = under[:, None, :] - a[None, :, :2]
    v = (offset[..., 0] * ac[:, 1] - offset[..., 1] * ac[:, 0]) / area
    w = (ab[:, 0] * offset[..., 1] - ab[:, 1] * offset[..., 0]) / area
    inside = (v >= -1e-9) & (w >= -1e-9) & (v + w <= 1.0 + 1e-9)
    heights = a[:, 2] + v * (b - a)[:, 2] + w * (c - a)[:, 2]
    return np.asarray(np.where(inside, heights, -np.inf).max(axis=1, initial=-np.inf))


@cached_for_scenes(1024)
def _triangles_of(shape: CollisionShape) -> NDArray[np.int32]:
    """Return (N, 3): the faces of a shape, as rows of its corners; kept, as scipy loads slowly."""
    if isinstance(shape, TriangleShape):
        return shape.triangles
    points = _corners(shape)

    def hull() -> Arrays:
        from scipy.spatial import ConvexHull

        return {"faces": np.asarray(ConvexHull(points).simplices, np.int32)}

    code = code_digest(libraries=("scipy",))
    # A copy: each mapped file takes pages of its own.
    return cached_arrays("hull", [points.tobytes()], hull, code=code)["faces"].copy()
