"""Random values for scenes that say nothing of chance: materials, lights, exposure."""

from __future__ import annotations

from typing import Any

from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["things_of_any_scene"]

_WALLS = ["plaster", "roughcast", "wallpaper_stripes", "wallpaper_damask"]
_FLOORS = ["oak_planks", "walnut_planks", "oak_parquet", "walnut_parquet", "stone_tiles", "carpet"]


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
