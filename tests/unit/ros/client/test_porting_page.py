"""`docs/porting.md` beside the Agent: every public name, and every name of SAILenv's."""

from __future__ import annotations

import inspect
from pathlib import Path

from sailenv_ros import Agent

PAGE = Path(__file__).parents[4] / "docs" / "porting.md"

ORIGINAL = {
    "register", "delete", "get_frame", "change_scene", "get_categories", "get_position",
    "set_position", "get_rotation", "set_rotation", "toggle_follow", "spawn_object",
    "despawn_object", "move_object", "load_scenario", "send_obj_zip",
    "change_main_camera_clear_flags", "get_light_color", "set_light_color", "get_light_position",
    "set_light_position", "get_light_direction", "set_light_direction", "get_light_intensity",
    "set_light_intensity", "get_light_indirect_multiplier", "set_light_indirect_multiplier",
    "get_light_type", "get_ambient_light_color", "set_ambient_light_color", "id", "scenes",
    "categories", "spawnable_objects_names", "lights_names",
}  # fmt: skip
"""Public methods and attributes of the SAILenv client's Agent, as of its last revision."""


def rows() -> dict[str, bool]:
    """Return the names of the page's last table, and whether SAILenv had them."""
    lines = PAGE.read_text().split("\n## Every method\n")[1].splitlines()
    cells = [line.strip("|").split(" | ") for line in lines if line.startswith("| `")]
    return {name.strip(" `"): original.strip() == "yes" for name, original, *_ in cells}


def test_the_page_has_every_method_and_those_of_the_original() -> None:
    """The table lists the Agent's public names, each documented, and SAILenv's among them."""
    listed = rows()
    assert set(listed) == {name for name in dir(Agent) if not name.startswith("_")}
    assert {name for name, original in listed.items() if original} == ORIGINAL
    undocumented = [name for name in listed if not inspect.getdoc(getattr(Agent, name))]
    assert undocumented == []
