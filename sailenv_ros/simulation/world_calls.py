"""The blocking methods about what a scene holds; part of `Requests`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

from numpy.typing import ArrayLike

from sailenv_ros.geometry import Pose
from sailenv_ros.lights import Light, LightType
from sailenv_ros.objects import ObjectState
from sailenv_ros.simulation.calls import Calls

__all__ = ["WorldCalls"]


class WorldCalls(Calls):
    """The requests of `WorldRequests`: objects, lights, surroundings."""

    def spawn_object(
        self,
        asset: str,
        *,
        name: str | None = None,
        pose: Pose,
        scale: ArrayLike = (1.0, 1.0, 1.0),
        static: bool = False,
        category: str | None = None,
        behaviours: Sequence[Mapping[str, Any]] = (),
        mass_kg: float | None = None,
        timeout_s: float = 30.0,
    ) -> int:
        """Put one more object into the scene; give its instance id, the value of its pixels.

        Parameters
        ----------
        asset : str
            Catalogue or display name.
        name : str or None
            Unique in the scene; None makes one of the asset's.
        pose : Pose
            Of the asset's origin, world frame.
        scale : float or (3,) array-like
            Along the asset's axes, 0.001 to 1000.
        static : bool
            True if physics shall never move it.
        category : str or None
            Instead of the asset's.
        behaviours : sequence of mapping
            What moves it of itself, as in a scene file: ``type`` and the parameters. They start
            now.
        mass_kg : float or None
            None takes the asset's, scaled [kg].

        Raises
        ------
        UnknownName, NameTaken, InvalidEntry, AssetError
            If it cannot be placed; the scene is as it was then.
        """
        result: int = self._ask(
            "spawn_object",
            timeout_s,
            asset,
            name=name,
            pose=pose,
            scale=scale,
            static=static,
            category=category,
            behaviours=behaviours,
            mass_kg=mass_kg,
        )
        return result

    def despawn_object(self, obj: int | str, *, timeout_s: float = 30.0) -> None:
        """Take an object, named by id or name, out of the scene; its id is not used again."""
        self._ask("despawn_object", timeout_s, obj)

    def move_object(
        self, obj: int | str, pose: Pose, *, teleport: bool = False, timeout_s: float = 30.0
    ) -> None:
        """Move an object and stop it; that is motion, which flow shows, unless it teleports."""
        self._ask("move_object", timeout_s, obj, pose, teleport=teleport)

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

    def get_object(self, obj: int | str, *, timeout_s: float = 30.0) -> ObjectState:
        """Say what and where an object is."""
        result: ObjectState = self._ask("get_object", timeout_s, obj)
        return result

    def spawnable_display_names(self, *, timeout_s: float = 30.0) -> tuple[str, ...]:
        """Give the names of what can be spawned as people write them, e.g. ``Chair 01``."""
        result: tuple[str, ...] = self._ask("spawnable_display_names", timeout_s)
        return result

    def lights(self, *, timeout_s: float = 30.0) -> tuple[Light, ...]:
        """Give the lights as they are now."""
        result: tuple[Light, ...] = self._ask("lights", timeout_s)
        return result

    def set_light(self, name: str, *, timeout_s: float = 30.0, **changes: Any) -> Light:
        """Change attributes of a light, by their names in `Light`; give the light as it is then."""
        result: Light = self._ask("set_light", timeout_s, name, **changes)
        return result

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

    def set_ambient_light(self, colour: ArrayLike, *, timeout_s: float = 30.0) -> None:
        """Set the light that arrives from everywhere (linear radiance)."""
        self._ask("set_ambient_light", timeout_s, colour)

    def set_background(
        self,
        kind: Literal["sky", "colour"],
        colour: ArrayLike | None = None,
        *,
        timeout_s: float = 30.0,
    ) -> None:
        """Show the sky or a linear colour where nothing is hit; no colour keeps the last one."""
        self._ask("set_background", timeout_s, kind, colour)

    def set_environment(self, /, *, timeout_s: float = 30.0, **changes: Any) -> None:
        """Change the surroundings, by the keys of `environment` in a scene file.

        Raises
        ------
        UnknownName, InvalidEntry
            If there is no such key, or a value cannot be accepted.
        """
        self._ask("set_environment", timeout_s, **changes)

    def load_scenario(
        self, scenario: str | Mapping[str, Any], *, timeout_s: float = 120.0
    ) -> tuple[int, ...]:
        """Begin a scene with more objects than its own; give their instance ids, in order.

        Parameters
        ----------
        scenario : str or mapping
            A scene's name, or a mapping with `scene` (its name; the present one if left out) and
            `objects` (as in a scene file).
        """
        result: tuple[int, ...] = self._ask("load_scenario", timeout_s, scenario)
        return result
