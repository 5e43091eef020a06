"""Changes that pages have made, in their order, to be undone and done again.

One history for all pages of a simulation. It ends with the scene: what was changed in a scene that
has been left or begun again cannot be undone.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, replace
from typing import ParamSpec, Protocol, TypeAlias, TypeVar

from sailenv_ros.errors import InvalidState
from sailenv_ros.simulation.editing.edit_records import ObjectRecord, SurroundingsRecord
from sailenv_ros.simulation.editing.room_edits import RoomRecord
from sailenv_ros.simulation.operations import Operation
from sailenv_ros.simulation.operations.edits import EditOperations
from sailenv_ros.simulation.operations.rooms import RoomOperations
from sailenv_ros.simulation.robot_entries import RobotRecord
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["Conversation", "EditHistory", "EditStep", "Record"]

Record: TypeAlias = ObjectRecord | RobotRecord | SurroundingsRecord | RoomRecord | None
"""State of the edited part before or after a change; None for what was not there."""

MOST_STEPS = 200

MERGED_S = 1.0
"""Changes of one thing that follow as fast are one step, as those of a slider are [s]."""


P = ParamSpec("P")
R = TypeVar("R")


class Conversation(Protocol):
    """A simulation that carries operations out for a page."""

    @property
    def info(self) -> SceneInfo:
        """The scene as it was announced last."""

    async def run(self, operation: Operation[P, R], /, *args: P.args, **kwargs: P.kwargs) -> R:
        """Have the simulation do something; wait for its result."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EditStep:
    """One change.

    Attributes
    ----------
    what : str
        In words, for the page.
    of : tuple
        What was changed of which thing: changes of the same are merged.
    epoch : int
        Of the scene.
    before, after : ObjectRecord, RobotRecord, SurroundingsRecord, RoomRecord or None
        None where the object or robot was not there.
    time_s : float
        Of the loop's clock [s].
    """

    what: str
    of: tuple[str, ...]
    epoch: int
    before: Record
    after: Record
    time_s: float


class EditHistory:
    """Edits that can be undone, and undone edits that can be redone.

    Attributes
    ----------
    busy : asyncio.Lock
        Held while a change is made or undone, so that an undo that is asked for right after a
        change waits until that has been taken down.
    """

    def __init__(self) -> None:
        self._done: list[EditStep] = []
        self._undone: list[EditStep] = []
        self.busy = asyncio.Lock()

    @property
    def undo_what(self) -> str:
        """Description of the edit that would be undone next; empty for none."""
        return self._done[-1].what if self._done else ""

    @property
    def redo_what(self) -> str:
        """Description of the edit that would be redone next; empty for none."""
        return self._undone[-1].what if self._undone else ""

    def forget_other_scenes(self, epoch: int) -> None:
        """Drop what belongs to a scene that has been left."""
        # In place: a step that is being undone meanwhile is put into the very same lists.
        for steps in (self._done, self._undone):
            steps[:] = [step for step in steps if step.epoch == epoch]

    def add(self, step: EditStep) -> None:
        """Take a change down; what was undone before cannot be done again then."""
        self.forget_other_scenes(step.epoch)
        if step.before == step.after:
            return
        last = self._done[-1] if self._done and not self._undone else None
        if last is not None and last.of == step.of and step.time_s - last.time_s < MERGED_S:
            self._done[-1] = replace(last, after=step.after, time_s=step.time_s)
        else:
            self._done[:] = [*self._done[1 - MOST_STEPS :], step]
        self._undone.clear()

    async def undo(self, context: Conversation) -> tuple[str, int]:
        """Undo the last change; return what it was, and the object's id or 0.

        Raises
        ------
        InvalidState
            If there is nothing to undo.
        SailenvError
            If others have changed the same meanwhile so that it cannot be undone; it is dropped.
        """
        return await self._step(context, backwards=True)

    async def redo(self, context: Conversation) -> tuple[str, int]:
        """Do again what was undone last; as `undo`."""
        return await self._step(context, backwards=False)

    async def _step(self, context: Conversation, *, backwards: bool) -> tuple[str, int]:
        async with self.busy:
            self.forget_other_scenes(context.info.epoch)
            taken, put = (self._done, self._undone)[:: 1 if backwards else -1]
            if not taken:
                raise InvalidState(f"there is nothing to {'undo' if backwards else 'do again'}")
            step = taken.pop()
            now, then = (step.after, step.before)[:: 1 if backwards else -1]
            number = await _restored(context, now, then)
            put.append(replace(step, time_s=float("-inf")))
            return step.what, number


async def _restored(context: Conversation, now: Record, then: Record) -> int:
    if isinstance(now, SurroundingsRecord) and isinstance(then, SurroundingsRecord):
        await context.run(EditOperations.restore_surroundings, now, then)
        return 0
    if isinstance(now, RoomRecord) and isinstance(then, RoomRecord):
        await context.run(RoomOperations.restore_room, now, then)
        return 0
    if isinstance(now, RobotRecord) or isinstance(then, RobotRecord):
        assert now is None or isinstance(now, RobotRecord)
        assert then is None or isinstance(then, RobotRecord)
        return await context.run(EditOperations.restore_robot, now, then)
    assert not isinstance(now, SurroundingsRecord | RoomRecord)
    assert not isinstance(then, SurroundingsRecord | RoomRecord)
    return await context.run(EditOperations.restore_object, now, then)
