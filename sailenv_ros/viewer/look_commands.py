"""What a client may ask for about what agents look at; a part of `commands.py`."""

from __future__ import annotations

from typing import Any

from sailenv_ros.simulation.operations import Operations
from sailenv_ros.viewer.command_context import CommandContext, CommandTable
from sailenv_ros.viewer.request_arguments import Arguments

__all__ = ["LOOK_COMMANDS"]

LOOK_COMMANDS = CommandTable()


@LOOK_COMMANDS.changes
async def look_at(context: CommandContext, given: Arguments) -> Any:
    """Have an agent face an object from now on; with 0, nothing any more."""
    faced = given.integer("object") or None
    await context.run(Operations.set_look_at, faced, agent=given.text("agent"))
