"""Commands of the editor that can be undone: what they change is taken down before and after."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from functools import wraps
from typing import Any

from sailenv_ros.simulation.editing.edit_records import ObjectRecord
from sailenv_ros.simulation.operations.edits import EditOperations
from sailenv_ros.viewer.command_context import CommandContext, Run
from sailenv_ros.viewer.edit_history import EditStep, Record
from sailenv_ros.viewer.request_arguments import Arguments

__all__ = ["edits_object", "edits_surroundings", "take_down"]


def _one_at_a_time(run: Run) -> Run:
    async def alone(context: CommandContext, given: Arguments) -> Any:
        async with context.history.busy:
            return await run(context, given)

    return alone


def edits_object(words: str) -> Callable[[Run], Run]:
    """Have a command that changes one object be undoable.

    The object is named by the argument ``obj``, or by ``id`` in the answer where the command adds
    it. `words` say what was done, before the object's name.
    """

    def declare(run: Run) -> Run:
        @wraps(run)
        @_one_at_a_time
        async def recorded(context: CommandContext, given: Arguments) -> Any:
            before: ObjectRecord | None = None
            if given.get("obj") is not None:
                before = await context.run(EditOperations.object_record, given.get("obj"))
            epoch = context.info.epoch
            result = await run(context, given)
            after: ObjectRecord | None = None
            if isinstance(result, dict):
                after = await context.run(EditOperations.object_record, int(result["id"]))
            name = next(record.name for record in (after, before) if record is not None)
            take_down(context, f"{words} {name}", (words, name), epoch, before, after)
            return result

        return recorded

    return declare


def edits_surroundings(words: str) -> Callable[[Run], Run]:
    """Have a command that changes lights or surroundings be undoable; see `edits_object`.

    A light is named by the argument ``light_name``, or by the answer where that is its name.
    """

    def declare(run: Run) -> Run:
        @wraps(run)
        @_one_at_a_time
        async def recorded(context: CommandContext, given: Arguments) -> Any:
            before = await context.run(EditOperations.surroundings_record)
            epoch = context.info.epoch
            result = await run(context, given)
            after = await context.run(EditOperations.surroundings_record)
            made = result if isinstance(result, str) else ""
            name = given.optional_text("light_name") or made
            keys = tuple(sorted(given.mapping("changes")))
            what = f"{words} {name}".strip()
            take_down(context, what, (words, name, *keys), epoch, before, after)
            return result

        return recorded

    return declare


def take_down(
    context: CommandContext,
    what: str,
    of: tuple[str, ...],
    epoch: int,
    before: Record,
    after: Record,
) -> None:
    """Add a change that was made to the history; see `EditStep` for the arguments."""
    step = EditStep(
        what=what,
        of=of,
        epoch=epoch,
        before=before,
        after=after,
        time_s=asyncio.get_running_loop().time(),
    )
    context.history.add(step)
