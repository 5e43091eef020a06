"""The services about lights and surroundings, each a few lines around one request."""

from __future__ import annotations

from rclpy.node import Node

from sailenv_msgs.srv import (
    AddLight,
    GetAmbientLight,
    GetLight,
    RemoveLight,
    SetAmbientLight,
    SetBackground,
    SetLight,
)
from sailenv_msgs_py.objects import light_changes_from_msg
from sailenv_msgs_py.scene_info import colour_to_msg, light_to_msg, rgb_from_msg
from sailenv_ros.lights import light_named
from sailenv_ros.nodes.requests import Requests, ServiceTable, offer

__all__ = ["LightServices"]


class LightServices:
    """Serves lights, ambient light and background.

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
            ("add_light", AddLight, self._add_light),
            ("remove_light", RemoveLight, self._remove_light),
            ("get_light", GetLight, self._get_light),
            ("set_light", SetLight, self._set_light),
            ("get_ambient_light", GetAmbientLight, self._get_ambient_light),
            ("set_ambient_light", SetAmbientLight, self._set_ambient_light),
            ("set_background", SetBackground, self._set_background),
        )

    async def _add_light(self, request: AddLight.Request, response: AddLight.Response) -> None:
        attributes = light_changes_from_msg(request.light, request.fields)
        attributes.pop("type", None)
        name, type_ = request.light.name, request.light.type
        response.light = light_to_msg(await self._ask("add_light", name, type_, **attributes))

    async def _remove_light(
        self, request: RemoveLight.Request, response: RemoveLight.Response
    ) -> None:
        await self._ask("remove_light", request.name)

    async def _get_light(self, request: GetLight.Request, response: GetLight.Response) -> None:
        response.light = light_to_msg(light_named(request.name, await self._ask("lights")))

    async def _set_light(self, request: SetLight.Request, response: SetLight.Response) -> None:
        changes = light_changes_from_msg(request.light, request.fields)
        response.light = light_to_msg(await self._ask("set_light", request.light.name, **changes))

    async def _get_ambient_light(
        self, request: GetAmbientLight.Request, response: GetAmbientLight.Response
    ) -> None:
        response.colour = colour_to_msg(self._ask.info.environment.ambient)

    async def _set_ambient_light(
        self, request: SetAmbientLight.Request, response: SetAmbientLight.Response
    ) -> None:
        await self._ask("set_ambient_light", rgb_from_msg(request.colour))

    async def _set_background(
        self, request: SetBackground.Request, response: SetBackground.Response
    ) -> None:
        kind = "sky" if request.sky else "colour"
        # With the sky, the colour that was shown before is kept for the next time.
        await self._ask(
            "set_background", kind, None if request.sky else rgb_from_msg(request.colour)
        )
