"""Rooms from a seed: rules in data in, scene files out that have passed all checks."""

from sailenv_ros.authoring.generation.generator import GeneratedScene, Generator, generate_scene
from sailenv_ros.authoring.generation.names import PREFIX, drawn_kind, parsed_name
from sailenv_ros.authoring.generation.rule_files import Rules, read_rules, room_kinds

__all__ = [
    "PREFIX",
    "GeneratedScene",
    "Generator",
    "Rules",
    "drawn_kind",
    "generate_scene",
    "parsed_name",
    "read_rules",
    "room_kinds",
]
