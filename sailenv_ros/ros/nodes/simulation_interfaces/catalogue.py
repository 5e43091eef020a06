"""Handlers of what a simulator has to offer: spawnables, named poses, features."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from geometry_msgs.msg import Vector3
from simulation_interfaces.msg import Bounds, NamedPose, Result, Spawnable

from sailenv_msgs_py.transforms import pose_to_msg
from sailenv_ros.ros.nodes.simulation_interfaces.desk import Desk
from sailenv_ros.ros.nodes.simulation_interfaces.filters import box_to_bounds, tags_filter
from sailenv_ros.ros.nodes.simulation_interfaces.resources import asset_uri
from sailenv_ros.ros.nodes.simulation_interfaces.results import Refusal
from sailenv_ros.ros.nodes.simulation_interfaces.versions import set_resource_uri
from sailenv_ros.simulation.operations.entity_operations import EntityOperations
from sailenv_ros.types import entities

__all__ = ["get_named_pose_bounds", "get_named_poses", "get_spawnables"]

AT_ONCE = 4
"""Assets that are looked at in one request of the simulation, which waits meanwhile."""


async def get_spawnables(desk: Desk, request: Any, response: Any) -> None:
    """Tell the catalogue."""
    names = desk.info.spawnables
    missing = [name for name in names if name not in desk.outlines]
    for first in range(0, len(missing), AT_ONCE):
        some = tuple(missing[first : first + AT_ONCE])
        outlines = await desk.do(EntityOperations.asset_outlines, some)
        desk.outlines.update({one.name: one for one in outlines})
    response.spawnables = [_spawnable(desk.outlines[name]) for name in names]
    if request.sources:
        response.result.error_message = f"not searched: {', '.join(request.sources)}"


async def get_named_poses(desk: Desk, request: Any, response: Any) -> None:
    """Tell the named poses whose tags pass a filter."""
    wanted = tags_filter(request.tags)
    response.poses = [
        NamedPose(
            name=one.name,
            description=one.description,
            tags=list(one.tags),
            pose=pose_to_msg(one.pose),
        )
        for one in await _named_poses(desk)
        if wanted(one.tags)
    ]


async def get_named_pose_bounds(desk: Desk, request: Any, response: Any) -> None:
    """Tell the ball around a named pose in which there is nothing now; its centre is the pose."""
    found = [one for one in await _named_poses(desk) if one.name == request.name]
    if not found:
        sentence = f"there is no named pose {request.name!r}; see get_named_poses"
        raise Refusal(Result.RESULT_NOT_FOUND, sentence)
    radius_m = await desk.do(EntityOperations.clearance_m, found[0].pose.position_m)
    if math.isfinite(radius_m):
        points = [Vector3(), Vector3(x=radius_m)]
        response.bounds = Bounds(type=Bounds.TYPE_SPHERE, points=points)


async def _named_poses(desk: Desk) -> Sequence[entities.NamedPose]:
    # Once in the life of a scene, so that a name stays where it is.
    if desk.notes.named_poses is None:
        found = await desk.do(EntityOperations.named_poses)
        desk.notes.named_poses = found
    return desk.notes.named_poses


def _spawnable(outline: entities.AssetOutline) -> Any:
    told = Spawnable(
        description=f"{outline.display_name} ({outline.category})",
        spawn_bounds=box_to_bounds(*outline.box_m),
    )
    set_resource_uri(told, "entity_resource", asset_uri(outline.name))
    return told
