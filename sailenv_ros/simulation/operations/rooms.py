"""Operations of an editor upon the room; like `operations.edits` for one that keeps a history."""

from __future__ import annotations

from sailenv_ros.simulation.editing import room_edits
from sailenv_ros.simulation.editing.room_edits import FloorPlan, RoomRecord
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import HasEditor, HasWorld

__all__ = ["RoomOperations"]


class RoomOperations(Caller):
    """Operations of an editor upon the room."""

    @operation()
    @staticmethod
    def floor_plan(core: HasWorld) -> FloorPlan:
        """Return the room and its objects as they lie in a plan now."""
        return room_edits.floor_plan_of(core.world)

    @operation(deadline_s=60.0)
    @staticmethod
    def set_room_size(
        core: HasEditor, size_m: tuple[float, float, float]
    ) -> tuple[RoomRecord, RoomRecord]:
        """Resize the room, or make one with the usual materials where there is none.

        A new room takes the place of static objects that are called as its parts are.

        Parameters
        ----------
        size_m : (3,) tuple of float
            Inside: along x, along y, height [m].

        Returns
        -------
        before, after : RoomRecord
            For `restore_room`.

        Raises
        ------
        InvalidRequest, InvalidEntry, NameTaken
            If an opening does not fit, a part was moved or taken out, the size is out of range, or
            an object that moves is called as a part is; nothing is changed then.
        """
        return room_edits.resize_room(core.editor, size_m)

    @operation(deadline_s=60.0)
    @staticmethod
    def restore_room(core: HasEditor, present: RoomRecord, wanted: RoomRecord) -> None:
        """Make of the room what a record says.

        Raises
        ------
        UnknownName, NameTaken
            If others have changed objects so that it cannot be done; nothing is done then.
        """
        room_edits.restore_room(core.editor, present, wanted)
