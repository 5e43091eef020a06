"""The history of changes, whatever else happens while one is undone."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace
from typing import Any, cast

from sailenv_ros.simulation.editing.room_edits import RoomRecord
from sailenv_ros.simulation.operations import Operation, Operations
from sailenv_ros.simulation.operations.edits import EditOperations
from sailenv_ros.viewer.command_context import CommandContext
from sailenv_ros.viewer.edit_history import Conversation, EditHistory, EditStep
from sailenv_ros.viewer.recorded_commands import edits_object
from sailenv_ros.viewer.request_arguments import Arguments


def test_a_step_is_kept_when_scenes_are_looked_at_while_it_is_undone() -> None:
    """The server drops the steps of other scenes twice a second, also in the middle of an undo."""
    history = EditHistory()

    async def run(*_: Any) -> None:
        history.forget_other_scenes(3)

    context = cast(Conversation, SimpleNamespace(info=SimpleNamespace(epoch=3), run=run))
    records = RoomRecord(room=None), RoomRecord(room=None, objects=(cast(Any, "floor"),))
    for what in ("first", "second"):
        step = EditStep(
            what=what, of=(what,), epoch=3, before=records[0], after=records[1], time_s=0.0
        )
        history.add(step)

    async def back_and_forth() -> None:
        await history.undo(context)
        assert (history.undo_what, history.redo_what) == ("first", "second")
        await history.undo(context)
        assert (history.undo_what, history.redo_what) == ("", "first")
        await history.redo(context)
        assert (history.undo_what, history.redo_what) == ("first", "second")

    asyncio.run(back_and_forth())


def test_an_undo_waits_for_the_change_before_it() -> None:
    """Pressed while the change is being taken down, it was told that there is nothing to undo."""
    history = EditHistory()
    told: list[object] = []

    async def run(asked: Operation[..., Any], *_: Any) -> Any:
        for _ in range(3):  # the simulation answers later
            await asyncio.sleep(0.0)
        told.append(asked)
        record = SimpleNamespace(name="door", at=len(told))
        return 7 if asked is EditOperations.restore_object else record

    async def change(context: CommandContext, given: Arguments) -> dict[str, int]:
        await context.run(Operations.pause)
        return {"id": 7}

    async def press_both() -> object:
        info = SimpleNamespace(epoch=1)
        context = cast(CommandContext, SimpleNamespace(info=info, run=run, history=history))
        changed = edits_object("opening")(change)(context, Arguments({"obj": 7}, "message"))
        begun = asyncio.ensure_future(changed)
        await asyncio.sleep(0.0)
        undone = await history.undo(context)
        await begun
        return undone

    assert asyncio.run(press_both()) == ("opening door", 7)
    assert told[-1] is EditOperations.restore_object
