"""Operations of a history of changes: objects, lights and surroundings taken down and put back.

They belong to the keeper of such a history, here the web viewer; a program has the operations that
make the changes.
"""

from __future__ import annotations

from sailenv_ros.simulation.editing import edit_records
from sailenv_ros.simulation.editing.edit_records import ObjectRecord, SurroundingsRecord
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import HasEditor, HasWorld
from sailenv_ros.simulation.robot_entries import RobotRecord, robot_record
from sailenv_ros.types.geometry import Pose

__all__ = ["EditOperations"]


class EditOperations(Caller):
    """Operations of a history of changes."""

    @operation(obj=check.object_reference)
    @staticmethod
    def object_record(core: HasWorld, obj: int | str) -> ObjectRecord:
        """Take down an object as it is now."""
        return edit_records.record_of(core.world, core.world.find(obj))

    @operation()
    @staticmethod
    def restore_object(
        core: HasEditor, present: ObjectRecord | None, wanted: ObjectRecord | None
    ) -> int:
        """Make of an object what a record says; return its instance id, 0 for none.

        Parameters
        ----------
        present : ObjectRecord or None
            As it was after the change that is undone; None if it was taken out.
        wanted : ObjectRecord or None
            None takes it out.

        Raises
        ------
        UnknownName, NameTaken, InvalidEntry
            If others have changed it so that it cannot be done; nothing is done then.
        """
        if present is None:
            return 0 if wanted is None else edit_records.bring_back(core.editor, wanted)
        if wanted is None:
            core.world.despawn(core.world.find(present.name))
            core.announce()
            return 0
        return edit_records.change_back(core.editor, present, wanted)

    @operation(obj=check.object_reference)
    @staticmethod
    def robot_of_object(core: HasWorld, obj: int | str) -> str:
        """Return the name of the robot of which an object is a link; empty for none."""
        return core.world.body(core.world.find(obj)).placement.robot

    @operation(robot=check.text)
    @staticmethod
    def robot_record(core: HasWorld, robot: str) -> RobotRecord:
        """Take down a robot as it is now."""
        return robot_record(core.world.robots[robot])

    @operation(deadline_s=120.0)
    @staticmethod
    def restore_robot(
        core: HasEditor, present: RobotRecord | None, wanted: RobotRecord | None
    ) -> int:
        """Take a robot out, or bring one back; return the id of its first link, 0 for none.

        Raises
        ------
        UnknownName, NameTaken, InvalidEntry, AssetError
            If others have changed it so that it cannot be done; nothing is done then.
        """
        if present is not None:
            core.world.despawn_robot(core.world.robots[present.name].name)
            core.announce()
        if wanted is None:
            return 0
        name = core.editor.spawn_robot(wanted.entry, wanted.pose)
        return next(iter(core.world.robot_state(name).links.values()))

    @operation(obj=check.object_reference, pose=check.pose)
    @staticmethod
    def set_down(core: HasEditor, obj: int | str, pose: Pose) -> bool:
        """Stand an object on what is drawn there; tell if it is held there.

        Parameters
        ----------
        obj : int or str
        pose : Pose
            Where its lowest point is on or just below what shall carry it.

        Returns
        -------
        held : bool
            True if it was made static: hulls are coarser than what is drawn, and physics would
            have pushed it out of that of its carrier, a shelf for example.
        """
        return edit_records.set_down(core.editor, core.world.find(obj), pose)

    @operation()
    @staticmethod
    def surroundings_record(core: HasWorld) -> SurroundingsRecord:
        """Take down lights and surroundings as they are now."""
        return edit_records.surroundings_of(core.world)

    @operation()
    @staticmethod
    def restore_surroundings(
        core: HasEditor, present: SurroundingsRecord, wanted: SurroundingsRecord
    ) -> None:
        """Put back what differs between two records, and nothing else."""
        edit_records.restore_surroundings(core.editor.scene, present, wanted)
