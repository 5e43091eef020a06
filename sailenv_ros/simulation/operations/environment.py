"""Operations on the surroundings of a scene: ambient light, background, sky, exposure."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

from numpy.typing import ArrayLike
from typing_extensions import Unpack

from sailenv_ros.errors import UnknownName
from sailenv_ros.scene.requested_changes import EnvironmentChanges
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import HasEditor, HasWorld
from sailenv_ros.types.validation import vector

__all__ = ["EnvironmentOperations"]

MAX_GRAVITY = 1000.0
"""Greatest gravity, as in a scene file [m/s²]."""

_BACKGROUNDS = ("sky", "colour")


def _background(what: str, value: object) -> str:
    if value not in _BACKGROUNDS:
        raise UnknownName("background", str(value), _BACKGROUNDS)
    return str(value)


def _gravity(what: str, value: ArrayLike) -> tuple[float, float, float]:
    return vector(what, value, limit=MAX_GRAVITY)


class EnvironmentOperations(Caller):
    """Surroundings; colours are linear."""

    @operation()
    @staticmethod
    def get_ambient_light(core: HasWorld) -> tuple[float, float, float]:
        """Return the linear radiance that arrives from everywhere."""
        return core.world.contents.environment.ambient

    @operation(colour=check.radiance)
    @staticmethod
    def set_ambient_light(core: HasWorld, colour: ArrayLike) -> None:
        """Set the linear radiance that arrives from everywhere."""
        environment: Any = core.world.contents.environment
        core.world.set_environment(replace(environment, ambient=colour))
        core.announce()

    @operation(kind=_background, colour=check.optional(check.radiance))
    @staticmethod
    def set_background(
        core: HasWorld, kind: Literal["sky", "colour"], colour: ArrayLike | None = None
    ) -> None:
        """Show the sky, or a linear colour, where nothing is hit; None keeps the last colour."""
        environment: Any = core.world.contents.environment
        chosen = environment.background_colour if colour is None else colour
        changed = replace(environment, background=kind, background_colour=chosen)
        core.world.set_environment(changed)
        core.announce()

    @operation()
    @staticmethod
    def set_environment(core: HasEditor, /, **changes: Unpack[EnvironmentChanges]) -> None:
        """Change the surroundings, by the keys of `environment` in a scene file.

        Raises
        ------
        UnknownName, InvalidEntry
            If there is no such key, or a value cannot be accepted.

        >>> agent.set_environment(sky_map="forest", exposure=0.5)  # doctest: +SKIP
        """
        core.editor.change_environment(changes)

    @operation()
    @staticmethod
    def get_gravity(core: HasWorld) -> tuple[float, float, float]:
        """Return the acceleration that pulls every body with gravity, world frame [m/s²]."""
        return core.world.gravity

    @operation(gravity=_gravity)
    @staticmethod
    def set_gravity(core: HasWorld, gravity: ArrayLike) -> None:
        """Change the acceleration that pulls every body with gravity, until the next reset.

        Parameters
        ----------
        gravity : (3,) array-like
            World frame, each within 1000 [m/s²]. What sleeps wakes.
        """
        core.world.set_gravity(vector("gravity", gravity))
