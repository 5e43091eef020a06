"""The blocking methods that give a scene as text, or write it; part of `Requests`."""

from __future__ import annotations

from collections.abc import Collection

from sailenv_ros.simulation.calls import Calls

__all__ = ["SaveCalls"]


class SaveCalls(Calls):
    """The requests of `SaveRequests`."""

    def scene_text(
        self,
        *,
        title: str | None = None,
        cameras: Collection[str] = (),
        timeout_s: float = 30.0,
    ) -> str:
        """Give the YAML text that `save_scene` would write; see there for the arguments."""
        result: str = self._ask("scene_text", timeout_s, title=title, cameras=tuple(cameras))
        return result

    def save_scene(
        self,
        name: str,
        *,
        overwrite: bool = False,
        title: str | None = None,
        cameras: Collection[str] = (),
        keep_models: bool = False,
        timeout_s: float = 60.0,
    ) -> str:
        """Write the present world as a scene file of one's own; give its path.

        `change_scene` takes the name from then on, and begins with the world as it is now.

        Parameters
        ----------
        name : str
            Of the scene: letters, digits, spaces, ``_`` or ``-``. Not that of a scene elsewhere.
        overwrite : bool
            True replaces a scene of one's own of that name.
        title : str or None
            One line for people; None leaves that of the present scene.
        cameras : collection of str
            Agents to be saved beside those that the scene brought along.
        keep_models : bool
            True puts uploaded models that the scene holds into one's own pack, without which it
            could not be loaded again.

        Raises
        ------
        InvalidRequest, InvalidEntry, UnknownName
            If the name cannot be used, or something cannot be said in a scene file; nothing is
            written then.
        """
        result: str = self._ask(
            "save_scene",
            timeout_s,
            name,
            overwrite=overwrite,
            title=title,
            cameras=tuple(cameras),
            keep_models=keep_models,
        )
        return result
