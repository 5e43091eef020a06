"""What a client may ask for about chance: the scene drawn anew; a part of `commands.py`."""

from __future__ import annotations

from typing import Any

from sailenv_ros.errors import InvalidState
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.viewer.command_context import CommandContext, CommandTable
from sailenv_ros.viewer.request_arguments import Arguments

__all__ = ["CHANCE_COMMANDS", "things_of_any_scene"]

CHANCE_COMMANDS = CommandTable()

_WALLS = ["plaster", "roughcast", "wallpaper_stripes", "wallpaper_damask"]
_FLOORS = ["oak_planks", "walnut_planks", "oak_parquet", "walnut_parquet", "stone_tiles", "carpet"]


@CHANCE_COMMANDS.changes
async def randomise(context: CommandContext, given: Arguments) -> Any:
    """Draw the next epoch, by what the scene draws or by what suits any scene; tell its index."""
    try:
        record = await context.run(Operations.randomise)
    except InvalidState:
        things = things_of_any_scene(context.info)
        record = await context.run(Operations.randomise, index=0, things=things)
    return record["index"]


def things_of_any_scene(info: SceneInfo) -> list[dict[str, Any]]:
    """Return what can be drawn in a scene that says nothing of it: materials, lights, exposure."""
    names = {instance.name for instance in info.instances if instance.painted}
    things: list[dict[str, Any]] = [
        {"name": "exposure", "type": "environment",
         "exposure": {"normal": [info.environment.exposure, 0.3]}},
    ]  # fmt: skip
    if "north wall" in names:
        things.append(
            {"name": "walls", "type": "material", "of": "* wall", "material": {"choice": _WALLS},
             "colour": {"uniform": [[0.3, 0.3, 0.3], [0.85, 0.85, 0.85]]}}
        )  # fmt: skip
    if "floor" in names and "north wall" in names:
        things.append(
            {"name": "floor", "type": "material", "of": "floor", "material": {"choice": _FLOORS}}
        )
    things += [
        {"name": f"light {number}", "type": "light", "of": light.name,
         "intensity": {"log_uniform": [light.intensity * 0.4, light.intensity * 2.0]}}
        for number, light in enumerate(info.lights)
        if light.intensity > 0.0
    ]  # fmt: skip
    return things
