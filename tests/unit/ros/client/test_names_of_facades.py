"""Every public name of `Simulation` and `Agent` has its place: in a group, or for old scripts."""

from __future__ import annotations

import inspect
import re
from collections import Counter
from pathlib import Path

from sailenv_ros import Agent, Simulation
from sailenv_ros.simulation.operations.sailenv_names import SailenvNames

DOCS = Path(__file__).parents[4] / "docs"
GROUPS, PORTING = DOCS / "api" / "operations.md", DOCS / "porting.md"

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


def public(kind: type) -> set[str]:
    """Return the public names of a class."""
    return {name for name in dir(kind) if not name.startswith("_")}


def cells(text: str) -> dict[str, list[str]]:
    """Return the rows of a text's tables by the names in their first cells, each once."""
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in text.splitlines()
        if line.startswith("|`")
    ]
    assert [name for name, count in Counter(row[0] for row in rows).items() if count > 1] == []
    return {row[0].strip("`"): row[1:] for row in rows}


def grouped_names() -> dict[str, str]:
    """Return the names of the lists, each once, with what is said of them."""
    listed = re.findall(r"^- `(\w+)`: (.+)$", GROUPS.read_text(), re.MULTILINE)
    assert len(dict(listed)) == len(listed)
    return dict(listed)


def old_names() -> tuple[str, dict[str, list[str]]]:
    """Return the text before the table of names for scripts of the client, and the table."""
    section = PORTING.read_text().split("\n## Names for its scripts\n")[1]
    before, _, table = section.partition("|name|")
    return before, cells(table)


def test_every_name_stands_in_one_group_or_is_for_old_scripts() -> None:
    """What a group says of where a name is to be had is so."""
    both = {"Simulation": public(Simulation), "Agent": public(Agent)}
    grouped, (_, old) = grouped_names(), old_names()
    assert grouped.keys() | old.keys() == both["Simulation"] | both["Agent"]
    assert not grouped.keys() & old.keys()
    for name, what in grouped.items():
        only = re.findall(r"\(only `(\w+)`\)$", what)
        have = [kind for kind, names in both.items() if name in names]
        assert have == (only or ["Simulation", "Agent"]), name
    groups = re.findall(r"^## (.+)$", GROUPS.read_text(), re.MULTILINE)
    assert len(groups) == len(set(groups)) > 10


def test_duplicates_for_old_scripts_are_one_class_and_one_page() -> None:
    """Each tells the name that it stands for, which is in a group."""
    _, old = old_names()
    assert old.keys() == {name for name in vars(SailenvNames) if not name.startswith("_")}
    for name, (_, instead) in old.items():
        found = re.match(r"`(?:info\.)?([a-z_]+)", instead)
        assert found, name
        assert found[1] == "spawnables" or found[1] in grouped_names(), name


def test_names_of_the_original_client_are_told() -> None:
    """Those that are the same here, and those that stand for others."""
    before, old = old_names()
    same = before.split("the client has ")[1]
    told = {*re.findall(r"`([a-z_]+)`", same), *(n for n, row in old.items() if row[0] == "yes")}
    assert told == ORIGINAL


def test_every_name_is_documented() -> None:
    """By a docstring, which the reference shows."""
    for kind in (Simulation, Agent):
        assert [name for name in public(kind) if not inspect.getdoc(getattr(kind, name))] == []
