"""Free space, ways through it, and what rays met, to and from messages."""

from __future__ import annotations

import array
import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from geometry_msgs.msg import Point, Quaternion, Vector3
from geometry_msgs.msg import Pose as PoseMsg
from nav_msgs.msg import OccupancyGrid
from numpy.typing import NDArray

from sailenv_msgs_py.frame_info import WORLD_FRAME_ID
from sailenv_msgs_py.stamps import ns_from_stamp, stamp_from_ns
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.space import FreeSpace, RayCast
from sailenv_ros.space.free_space import BodySize

__all__ = [
    "free_space_from_response",
    "free_space_to_response",
    "occupancy_grid_to_msg",
    "points_to_msg",
    "ray_cast_from_response",
    "ray_cast_to_response",
    "reach_to_msg",
    "triples_from_msg",
    "vectors_to_msg",
]

Doubles = NDArray[np.float64]


def points_to_msg(points: Doubles) -> list[Point]:
    """Make points of (N, 3) [m]."""
    return [Point(x=x, y=y, z=z) for x, y, z in points.tolist()]


def vectors_to_msg(vectors: Doubles) -> list[Vector3]:
    """Make vectors of (N, 3)."""
    return [Vector3(x=x, y=y, z=z) for x, y, z in vectors.tolist()]


def triples_from_msg(messages: Iterable[Point | Vector3]) -> Doubles:
    """Read points or vectors as (N, 3) float64."""
    rows = [(message.x, message.y, message.z) for message in messages]
    return np.array(rows, np.float64).reshape(-1, 3)


def free_space_to_response(response: Any, space: FreeSpace) -> None:
    """Fill the response of GetFreeSpace."""
    response.stamp = stamp_from_ns(space.stamp_ns)
    body = space.body
    response.body_height_m, response.body_radius_m = body.height_m, body.radius_m
    response.body_step_m = body.step_m
    response.map_resolution_m = space.resolution_m
    response.height, response.width = space.cells.shape
    x, y = space.origin_m
    response.origin = Point(x=x, y=y, z=space.body.floor_m)
    response.data = array.array("b", space.cells.tobytes())


def free_space_from_response(response: Any) -> FreeSpace:
    """Read the response of GetFreeSpace.

    Raises
    ------
    InvalidRequest
        If there are not as many cells as the size says.
    """
    shape = int(response.height), int(response.width)
    cells = np.array(response.data, np.int8)
    if cells.size != shape[0] * shape[1]:
        raise InvalidRequest("data of a map", cells.size, f"{shape[0] * shape[1]} cells")
    cells = cells.reshape(shape)
    cells.flags.writeable = False
    return FreeSpace(
        cells=cells,
        origin_m=(float(response.origin.x), float(response.origin.y)),
        body=BodySize(
            height_m=response.body_height_m,
            radius_m=response.body_radius_m,
            floor_m=response.origin.z,
            step_m=response.body_step_m,
            resolution_m=response.map_resolution_m,
        ),
        stamp_ns=ns_from_stamp(response.stamp),
    )


def occupancy_grid_to_msg(space: FreeSpace) -> OccupancyGrid:
    """Make the map as map servers publish it."""
    message = OccupancyGrid()
    message.header.stamp = stamp_from_ns(space.stamp_ns)
    message.header.frame_id = WORLD_FRAME_ID
    message.info.map_load_time = stamp_from_ns(space.stamp_ns)
    message.info.resolution = space.resolution_m
    message.info.height, message.info.width = space.cells.shape
    x, y = space.origin_m
    message.info.origin = PoseMsg(
        position=Point(x=x, y=y, z=space.body.floor_m), orientation=Quaternion(w=1.0)
    )
    message.data = array.array("b", space.cells.tobytes())
    return message


def ray_cast_to_response(response: Any, cast: RayCast) -> None:
    """Fill the response of CastRays."""
    response.ids = array.array("H", cast.instance_ids.tobytes())
    response.distances_m = array.array("d", cast.distances_m.tobytes())
    response.points = points_to_msg(cast.points_m)
    response.normals = vectors_to_msg(cast.normals)


def ray_cast_from_response(response: Any) -> RayCast:
    """Read the response of CastRays."""
    return RayCast(
        instance_ids=np.array(response.ids, np.uint16),
        distances_m=np.array(response.distances_m, np.float64),
        points_m=triples_from_msg(response.points),
        normals=triples_from_msg(response.normals),
    )


def reach_to_msg(max_distance_m: float) -> float:
    """Return a greatest distance as requests have it: 0 for no limit."""
    return 0.0 if max_distance_m == math.inf else max_distance_m
