"""What a client may ask for about lessons: begin and stop them; a part of `commands.py`."""

from __future__ import annotations

from typing import Any

from sailenv_ros.simulation.operations import Operations
from sailenv_ros.viewer.command_context import CommandContext, CommandTable
from sailenv_ros.viewer.request_arguments import Arguments

__all__ = ["LESSON_COMMANDS"]

LESSON_COMMANDS = CommandTable()


@LESSON_COMMANDS.changes
async def start_lessons(context: CommandContext, given: Arguments) -> Any:
    """Begin the lessons of the scene with the first one; tell which that is."""
    return str(await context.run(Operations.start_lessons))


@LESSON_COMMANDS.changes
async def stop_lessons(context: CommandContext, given: Arguments) -> Any:
    """Stop the lessons."""
    await context.run(Operations.stop_lessons)
