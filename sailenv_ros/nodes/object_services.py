"""The services about objects, models and scenarios, each a few lines around one request."""

from __future__ import annotations

from rclpy.node import Node

from sailenv_msgs.srv import (
    DespawnObject,
    GetObject,
    LoadScenario,
    MoveObject,
    SpawnObject,
    UploadModel,
)
from sailenv_msgs_py.objects import behaviour_from_msg, object_state_to_response, scale_from_msg
from sailenv_msgs_py.transforms import pose_from_msg
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.nodes.requests import Requests, ServiceTable, offer
from sailenv_ros.scene.entries import read_document

__all__ = ["ObjectServices"]


class ObjectServices:
    """Serves objects, models and scenarios.

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
            ("spawn_object", SpawnObject, self._spawn_object),
            ("despawn_object", DespawnObject, self._despawn_object),
            ("move_object", MoveObject, self._move_object),
            ("get_object", GetObject, self._get_object),
            ("upload_model", UploadModel, self._upload_model),
            ("load_scenario", LoadScenario, self._load_scenario),
        )

    async def _spawn_object(
        self, request: SpawnObject.Request, response: SpawnObject.Response
    ) -> None:
        if request.frustum_limited:
            accepted = "false: an object cannot be kept within the view of an agent"
            raise InvalidRequest("frustum_limited", True, accepted)
        response.id = await self._ask(
            "spawn_object",
            request.asset,
            name=request.name or None,
            pose=pose_from_msg(request.pose),
            scale=scale_from_msg(request.scale),
            static=request.is_static,
            category=request.category or None,
            behaviours=[behaviour_from_msg(behaviour) for behaviour in request.behaviours],
            mass_kg=request.mass_kg or None,
        )
        names = {instance.id: instance.name for instance in self._ask.info.instances}
        # Unless somebody else has taken it out again already.
        response.spawned_name = names.get(response.id, request.name)

    async def _despawn_object(
        self, request: DespawnObject.Request, response: DespawnObject.Response
    ) -> None:
        await self._ask("despawn_object", request.id)

    async def _move_object(
        self, request: MoveObject.Request, response: MoveObject.Response
    ) -> None:
        pose = pose_from_msg(request.pose)
        await self._ask("move_object", request.id, pose, teleport=request.teleport)

    async def _get_object(self, request: GetObject.Request, response: GetObject.Response) -> None:
        object_state_to_response(await self._ask("get_object", request.id), response)

    async def _upload_model(
        self, request: UploadModel.Request, response: UploadModel.Response
    ) -> None:
        response.asset = await self._ask(
            "upload_model",
            bytes(request.data),
            name=request.name,
            filename=request.filename,
            category=request.category or None,
            height_m=request.height_m or None,
        )

    async def _load_scenario(
        self, request: LoadScenario.Request, response: LoadScenario.Response
    ) -> None:
        response.ids = list(await self._ask("load_scenario", read_document(request.document)))
