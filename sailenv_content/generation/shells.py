"""The shell of any kind of room, with its materials: one room, or an apartment of several."""

from __future__ import annotations

from sailenv_content.generation.apartments import apartment
from sailenv_content.generation.room_shapes import Shell, materials_of, single_room
from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.authoring.room_rules.rule_files import Rules

__all__ = ["Shell", "shell_of"]


def shell_of(kind: str, rules: Rules, dice: RandomStream) -> Shell:
    """Draw the shell of a room."""
    file = rules.kind(kind)
    if file.layouts:
        return apartment(kind, rules, dice)
    materials = rules.materials[dice.one(file.materials)]
    shell = single_room(kind, file, materials, dice)
    for key, value in materials_of(shell, materials, dice):
        shell.entry[key] = value
    return shell
