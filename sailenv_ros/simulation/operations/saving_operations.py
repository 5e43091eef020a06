"""Operations that write the present world as a scene file."""

from __future__ import annotations

from collections.abc import Collection

from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import HasSceneWriter

__all__ = ["SavingOperations"]


class SavingOperations(Caller):
    """Scene files of the present world."""

    @operation(cameras=check.texts)
    @staticmethod
    def scene_text(
        core: HasSceneWriter, *, title: str | None = None, cameras: Collection[str] = ()
    ) -> str:
        """Return the YAML text that `save_scene` would write; see there for the arguments."""
        return core.scene_writer.text(core.world.scene, title, cameras)

    @operation(
        deadline_s=60.0,
        cameras=check.texts,
    )
    @staticmethod
    def save_scene(
        core: HasSceneWriter,
        name: str,
        *,
        overwrite: bool = False,
        title: str | None = None,
        cameras: Collection[str] = (),
        keep_models: bool = False,
    ) -> str:
        """Write the present world as a scene file; return its path on the simulator's machine.

        `change_scene` takes the name from then on, and begins with the world as it is now.

        Parameters
        ----------
        name : str
            Of the scene: letters, digits, spaces, ``_`` or ``-``. Not that of a scene elsewhere.
        overwrite : bool
            True replaces a saved scene of that name.
        title : str or None
            One line for people; None or empty leaves that of the present scene.
        cameras : collection of str
            Agents to be saved beside those that the scene brought along.
        keep_models : bool
            True puts uploaded models that the scene holds into the user's own pack, without which
            it could not be loaded again.

        Raises
        ------
        InvalidRequest, InvalidEntry, UnknownName
            If the name cannot be used, or something cannot be said in a scene file; nothing is
            written then.
        """
        path = core.scene_writer.save(
            name, overwrite=overwrite, title=title, cameras=cameras, keep_models=keep_models
        )
        core.announce()
        return str(path)
