"""Support of an object: found from drawn surfaces, not from the hulls of the physics engine.

A world, an object and a place in; the height at which it stands there, and upon what, out.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.world import World

__all__ = ["overlap_m", "standing_place"]

Floats = NDArray[np.float64]

FOOT_SHARE = 0.02
LEAST_FOOT_M = 0.003
"""Height of an object's foot above its lowest point [m]: a share of its height, but at least
this."""

MOST_FOOT_POINTS = 64

STEP_M = 0.04
"""A surface that is higher than the place by no more is stood on, too [m]."""


def standing_place(world: World, instance_id: int, pose: Pose) -> tuple[float, Body | None]:
    """Return the height of its origin [m] at which an object stands at a place, and upon what.

    Parameters
    ----------
    world : World
    instance_id : int
        What is to stand there.
    pose : Pose
        Its lowest point is where it is wanted. It stands on the highest surface of another object
        or of the room below its foot, which may be a little higher than that.

    Returns
    -------
    z_m : float
        That of the pose where there is nothing below.
    carrier : Body or None
        None where there is nothing below.
    """
    body = world.body(instance_id)
    rotation, origin = pose.matrix()[:3, :3], np.asarray(pose.position_m, dtype=np.float64)
    corners = np.concatenate(list(_points(body))) @ rotation.T
    bottom = float(corners[:, 2].min())
    tall = float(corners[:, 2].max()) - bottom
    foot = corners[corners[:, 2] <= bottom + max(LEAST_FOOT_M, FOOT_SHARE * tall)]
    foot = np.unique(foot[:, :2].round(4), axis=0)
    foot = foot[:: -(-len(foot) // MOST_FOOT_POINTS)] + origin[:2]
    wanted = float(origin[2]) + bottom
    highest, carrier = -np.inf, None
    for other in world.bodies:
        for triangles in _triangles(other) if other is not body else ():
            height = _highest_below(triangles, foot, wanted + STEP_M)
            if height > highest:
                highest, carrier = height, other
    return (float(origin[2]) if carrier is None else float(highest - bottom)), carrier


def overlap_m(world: World, first: Body, second: Body) -> float:
    """Return how deep physics finds an object within another [m]; 0 where it does not."""
    if not (first.collides and second.collides):
        return 0.0
    points = world.client.getClosestPoints(
        first.bullet_id, second.bullet_id, 0.0, linkIndexA=first.link, linkIndexB=second.link
    )
    return max(0.0, -min((float(point[8]) for point in points), default=0.0))


def _points(body: Body) -> Iterator[Floats]:
    """Yield the corners of each part in the body's axes, its scale included."""
    for part in body.placement.asset.model.parts:
        yield part.mesh.positions.astype(np.float64) * np.asarray(body.placement.scale)


def _triangles(body: Body) -> Iterator[Floats]:
    """Yield (M, 3, 3): the corners of each part's triangles that look up, in the world [m]."""
    matrix = body.world_from_body()
    parts = body.placement.asset.model.parts
    for part, points in zip(parts, _points(body), strict=True):
        corners = (points @ matrix[:3, :3].T + matrix[:3, 3])[part.mesh.triangles]
        upwards = _cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) > 0.0
        yield corners if part.material.double_sided else corners[upwards]


def _highest_below(triangles: Floats, places: Floats, limit_m: float) -> float:
    """Return the height of the highest point of triangles under places, no higher than a limit."""
    if not len(triangles):
        return -np.inf
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    near = (
        (low[:, :2] <= places.max(axis=0)).all(axis=1)
        & (high[:, :2] >= places.min(axis=0)).all(axis=1)
        & (low[:, 2] <= limit_m)
    )
    a, b, c = (triangles[near, k] for k in range(3))
    area = _cross(b - a, c - a)
    flat = np.abs(area) > 1e-14
    a, b, c, area = a[flat], b[flat], c[flat], area[flat]
    if not len(a):
        return -np.inf
    # Barycentric coordinates of every place in every triangle, seen from above.
    at = places[:, None, :]
    u = _cross(at - a[:, :2], (c - a)[:, :2]) / area
    v = _cross((b - a)[:, :2], at - a[:, :2]) / area
    heights = a[:, 2] + u * (b - a)[:, 2] + v * (c - a)[:, 2]
    inside = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1.0 + 1e-9) & (heights <= limit_m)
    return float(heights[inside].max()) if inside.any() else -np.inf


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
