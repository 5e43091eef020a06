"""The blocking methods by which an editor changes a scene and saves it; part of `Requests`."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

from sailenv_ros.geometry import Pose
from sailenv_ros.lights import Light, LightType

__all__ = ["EditRequests"]


class EditRequests:
    """What a scene is edited by, beside spawning, moving and lights; see `Requests`."""

    def change_object(self, obj: int | str, /, *, timeout_s: float = 30.0, **changes: Any) -> None:
        """Change what an object is; its id, its place and its motion stay.

        Parameters
        ----------
        obj : int or str
            Its id or name; not a part of a room.
        **changes
            By the keys of an object in a scene file: ``name``, ``category``, ``scale``,
            ``static``, ``mass``, ``gravity``, ``friction``, ``restitution``, ``colour``,
            ``metallic``, ``roughness``. None takes the asset's own. Another scale cuts its past
            off: the next frame has no flow there.

        Raises
        ------
        UnknownName, NameTaken, InvalidEntry, InvalidRequest
            If it cannot be such an object; it is as it was then.
        """
        self._ask("change_object", timeout_s, obj, **changes)

    def add_light(
        self, name: str, type_: LightType, /, *, timeout_s: float = 30.0, **attributes: Any
    ) -> Light:
        """Put one more light into the scene; give it.

        Parameters
        ----------
        name : str
            Unique in the scene.
        type_ : {'directional', 'point', 'spot', 'area'}
        **attributes
            By their names in `Light`; the rest are its defaults.

        Raises
        ------
        NameTaken, UnknownName, InvalidRequest, InvalidEntry
            If there is one of that name, or it cannot be such a light.
        """
        result: Light = self._ask("add_light", timeout_s, name, type_, **attributes)
        return result

    def remove_light(self, name: str, *, timeout_s: float = 30.0) -> None:
        """Take a light out of the scene."""
        self._ask("remove_light", timeout_s, name)

    def set_environment(self, /, *, timeout_s: float = 30.0, **changes: Any) -> None:
        """Change the surroundings, by the keys of `environment` in a scene file.

        Raises
        ------
        UnknownName, InvalidEntry
            If there is no such key, or a value cannot be accepted.
        """
        self._ask("set_environment", timeout_s, **changes)

    def set_waypoints(
        self,
        waypoints: Sequence[Pose],
        *,
        mover: str = "",
        append: bool = False,
        total_time_s: float | None = None,
        loop: bool | None = None,
        timeout_s: float = 30.0,
    ) -> None:
        """Give a mover another track; `scene_info` tells the one that it has.

        Parameters
        ----------
        waypoints : sequence of Pose
            At most 1000; none leaves it where it is.
        mover : str
            The empty name means the scene's first.
        append : bool
            True adds them to those that it has.
        total_time_s : float or None
            Time to run through all of them once [s]; None leaves it.
        loop : bool or None
            True if the last leads on to the first; None leaves it.

        Notes
        -----
        What follows the mover moves with it, and flow shows that as motion. It goes on from the
        leg, and the part of it, that it had reached.
        """
        self._ask(
            "set_waypoints",
            timeout_s,
            waypoints,
            mover=mover,
            append=append,
            total_time_s=total_time_s,
            loop=loop,
        )

    def mover_pose(self, mover: str = "", *, timeout_s: float = 30.0) -> Pose:
        """Say where a mover is; the empty name means the scene's first."""
        result: Pose = self._ask("mover_pose", timeout_s, mover)
        return result

    def thumbnail(self, asset: str, *, timeout_s: float = 60.0) -> bytes:
        """Give a picture of an object of the catalogue: PNG, 160 by 120 pixels.

        Drawn at the first request by a process beside the simulator, which goes on meanwhile, and
        kept in the user's cache for the next time.

        Parameters
        ----------
        asset : str
            Catalogue or display name.

        Raises
        ------
        UnknownName
            If there is no such asset.
        RenderError, DeadlineExceeded
            If it cannot be drawn.
        """
        result: bytes = self._ask("thumbnail", timeout_s, asset)
        return result

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

    def _ask(self, name: str, timeout_s: float, /, *args: Any, **kwargs: Any) -> Any:
        """Queue a request and wait for its result."""
        raise NotImplementedError
