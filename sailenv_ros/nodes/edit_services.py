"""The services by which a scene is edited and saved, each a few lines around one request."""

from __future__ import annotations

import array

from rclpy.node import Node

from sailenv_msgs.srv import (
    ChangeObject,
    DriveMover,
    GetThumbnail,
    SaveScene,
    SetEnvironment,
    SetWaypoints,
)
from sailenv_msgs_py.objects import keys_from_json
from sailenv_msgs_py.transforms import pose_from_msg, xyz_from_msg
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.nodes.requests import Requests, ServiceTable, offer

__all__ = ["EditServices"]

_LOOP = {
    SetWaypoints.Request.AS_IT_IS: None,
    SetWaypoints.Request.CLOSED: True,
    SetWaypoints.Request.OPEN: False,
}


class EditServices:
    """Serves changes of objects, surroundings and tracks, saving, and the catalogue's pictures.

    Parameters
    ----------
    node : Node
    requests : Requests
    """

    def __init__(self, node: Node, requests: Requests) -> None:
        self._ask = requests
        offer(node, self._table())

    def _table(self) -> ServiceTable:
        return (
            ("change_object", ChangeObject, self._change_object),
            ("set_environment", SetEnvironment, self._set_environment),
            ("set_waypoints", SetWaypoints, self._set_waypoints),
            ("drive_mover", DriveMover, self._drive_mover),
            ("save_scene", SaveScene, self._save_scene),
            ("get_thumbnail", GetThumbnail, self._get_thumbnail),
        )

    async def _change_object(
        self, request: ChangeObject.Request, response: ChangeObject.Response
    ) -> None:
        accepted = 'a JSON object such as {"scale": 2, "category": "chair"}'
        changes = keys_from_json("changes_json", request.changes_json, accepted)
        await self._ask("change_object", request.id, **changes)

    async def _set_environment(
        self, request: SetEnvironment.Request, response: SetEnvironment.Response
    ) -> None:
        accepted = 'a JSON object such as {"exposure": 0.5}'
        changes = keys_from_json("changes_json", request.changes_json, accepted)
        await self._ask("set_environment", **changes)

    async def _set_waypoints(
        self, request: SetWaypoints.Request, response: SetWaypoints.Response
    ) -> None:
        if request.loop not in _LOOP:
            accepted = "0 (as it is), 1 (closed) or 2 (open)"
            raise InvalidRequest("loop", request.loop, accepted)
        await self._ask(
            "set_waypoints",
            [pose_from_msg(pose) for pose in request.waypoints],
            mover=request.mover,
            append=request.append,
            total_time_s=request.total_time or None,
            loop=_LOOP[request.loop],
        )

    async def _drive_mover(
        self, request: DriveMover.Request, response: DriveMover.Response
    ) -> None:
        await self._ask(
            "drive_mover",
            request.mover,
            linear_m_s=xyz_from_msg(request.command.linear),
            angular_rad_s=xyz_from_msg(request.command.angular),
        )

    async def _save_scene(self, request: SaveScene.Request, response: SaveScene.Response) -> None:
        response.path = await self._ask(
            "save_scene",
            request.name,
            overwrite=request.overwrite,
            title=request.title or None,
            cameras=tuple(request.cameras),
            keep_models=request.keep_models,
        )

    async def _get_thumbnail(
        self, request: GetThumbnail.Request, response: GetThumbnail.Response
    ) -> None:
        response.png = array.array("B", await self._ask("thumbnail", request.asset))
