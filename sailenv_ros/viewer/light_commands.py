"""What a client may ask for about light and pictures: lights, sky, what is done to a picture.

Arguments as JSON has them in, requests to a `Simulation` out. Part of the table of `commands.py`.
"""

from __future__ import annotations

from typing import Any

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.viewer.arguments import Arguments
from sailenv_ros.viewer.desk import CommandTable, Desk

__all__ = ["LIGHT_COMMANDS"]

LIGHT_COMMANDS = CommandTable()


@LIGHT_COMMANDS.changes
async def add_light(desk: Desk, given: Arguments) -> Any:
    """Hang a light where the watched camera is, shining where it looks."""
    camera = desk.frame(None).camera
    place = {
        "position_m": camera.pose.position_m,
        "direction": tuple(float(x) for x in camera.pose.matrix()[:3, 0]),
    }
    attributes = {**place, **given.mapping("attributes")}
    await desk.ask("add_light", given.text("light"), given.text("type"), **attributes)


@LIGHT_COMMANDS.changes
async def remove_light(desk: Desk, given: Arguments) -> Any:
    """Take a light out of the scene."""
    await desk.ask("remove_light", given.text("light"))


@LIGHT_COMMANDS.changes
async def set_light(desk: Desk, given: Arguments) -> Any:
    """Change attributes of a light."""
    changes = given.mapping("changes")
    if "name" in changes:
        raise InvalidRequest("change of a light", "name", "another attribute")
    await desk.ask("set_light", given.text("light"), **changes)


@LIGHT_COMMANDS.changes
async def set_environment(desk: Desk, given: Arguments) -> Any:
    """Change the surroundings, by the keys of a scene file."""
    await desk.ask("set_environment", **given.mapping("changes"))


@LIGHT_COMMANDS.changes
async def set_picture(desk: Desk, given: Arguments) -> Any:
    """Change what is done to an agent's picture, by the names of its settings."""
    await desk.ask("set_picture", given.text("agent"), **given.mapping("changes"))
