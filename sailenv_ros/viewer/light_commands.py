"""What a client may ask for about light and pictures: lights, sky, what is done to a picture.

Arguments as JSON has them in, requests to a `Simulation` out. Part of the table of `commands.py`.
"""

from __future__ import annotations

from typing import Any, get_args

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.types.lights import LightType
from sailenv_ros.viewer.command_context import CommandContext, CommandTable
from sailenv_ros.viewer.recorded_commands import edits_surroundings
from sailenv_ros.viewer.request_arguments import Arguments

__all__ = ["LIGHT_COMMANDS"]

LIGHT_COMMANDS = CommandTable()


@LIGHT_COMMANDS.changes
@edits_surroundings("adding the light")
async def add_light(context: CommandContext, given: Arguments) -> Any:
    """Add a light where the watched camera is, shining where it looks."""
    camera = context.frame(None).camera
    place = {
        "position_m": camera.pose.position_m,
        "direction": tuple(float(x) for x in camera.pose.matrix()[:3, 0]),
    }
    attributes = {**place, **given.mapping("attributes")}
    await context.run(
        Operations.add_light,
        given.text("light"),
        given.choice("type", get_args(LightType)),
        **attributes,
    )


@LIGHT_COMMANDS.changes
@edits_surroundings("deleting the light")
async def remove_light(context: CommandContext, given: Arguments) -> Any:
    """Take a light out of the scene."""
    await context.run(Operations.remove_light, given.text("light"))


@LIGHT_COMMANDS.changes
@edits_surroundings("changing the light")
async def set_light(context: CommandContext, given: Arguments) -> Any:
    """Change attributes of a light."""
    changes = given.mapping("changes")
    if "name" in changes:
        raise InvalidRequest("change of a light", "name", "another attribute")
    await context.run(Operations.set_light, given.text("light"), **changes)


@LIGHT_COMMANDS.changes
@edits_surroundings("changing the surroundings")
async def set_environment(context: CommandContext, given: Arguments) -> Any:
    """Change the surroundings, by the keys of a scene file."""
    await context.run(Operations.set_environment, **given.mapping("changes"))


@LIGHT_COMMANDS.changes
async def set_picture(context: CommandContext, given: Arguments) -> Any:
    """Change what is done to an agent's picture, by the names of its settings."""
    changes = given.mapping("changes")
    if "agent" in changes:
        raise InvalidRequest("change of a picture", "agent", "a setting of pictures")
    await context.run(Operations.set_picture, agent=given.text("agent"), **changes)
