"""The history of changes, whatever else happens while one is undone."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace
from typing import Any, cast

from sailenv_ros.simulation.room_edits import RoomRecord
from sailenv_ros.viewer.edit_history import Conversation, EditHistory, EditStep


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
