"""Operations on lights; colours are linear, as in `Light`."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

from typing_extensions import Unpack

from sailenv_ros.errors import NameTaken, UnknownName
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import HasLibrary, HasWorld
from sailenv_ros.types.lights import (
    LIGHT_ATTRIBUTES,
    Light,
    LightAttributes,
    LightChanges,
    LightType,
    light_named,
)

__all__ = ["LightOperations"]


def _known(given: Mapping[str, object], names: Collection[str]) -> dict[str, Any]:
    for key in given:
        if key not in names:
            raise UnknownName("attribute of a light", key, names)
    return dict(given)


class LightOperations(Caller):
    """Lights."""

    @property
    def lights(self) -> tuple[Light, ...]:
        """The scene's lights, as announced."""
        return self.info.lights

    @operation(light_name=check.text)
    @staticmethod
    def get_light(core: HasWorld, light_name: str) -> Light:
        """Return a light as it is now."""
        return light_named(light_name, core.world.contents.lights)

    @operation(light_name=check.text)
    @staticmethod
    def set_light(core: HasWorld, light_name: str, /, **changes: Unpack[LightChanges]) -> Light:
        """Change attributes of a light, by their names in `Light`; return it as it is then.

        >>> agent.set_light("sun", intensity=2.0, direction=(0.3, 0.0, -1.0))  # doctest: +SKIP
        """
        lights = core.world.contents.lights
        present = light_named(light_name, lights)
        changed: Light = replace(present, **_known(changes, LIGHT_ATTRIBUTES))
        if changes:
            core.world.set_lights([changed if light is present else light for light in lights])
            core.announce()
        return changed

    @operation(light_name=check.text, light_type=check.text)
    @staticmethod
    def add_light(
        core: HasLibrary,
        light_name: str,
        light_type: LightType,
        /,
        **attributes: Unpack[LightAttributes],
    ) -> Light:
        """Add a light to the scene; return it.

        Parameters
        ----------
        light_name : str
            Unique in the scene.
        light_type : {'directional', 'point', 'spot', 'area'}
        **attributes
            By their names in `Light`; the rest are its defaults.

        Raises
        ------
        NameTaken, UnknownName, InvalidRequest, InvalidEntry
            If there is one of that name, or it cannot be such a light.

        >>> agent.add_light("lamp", "point", position_m=(0, 1, 2))  # doctest: +SKIP
        """
        lights = core.world.contents.lights
        given = _known(attributes, tuple(LightAttributes.__annotations__))
        if any(light.name == light_name for light in lights):
            raise NameTaken("light", light_name)
        added = Light(name=light_name, type=light_type, **given)
        core.library.check_lights((*lights, added))
        core.world.set_lights((*lights, added))
        core.announce()
        return added

    @operation(light_name=check.text)
    @staticmethod
    def remove_light(core: HasWorld, light_name: str) -> None:
        """Remove a light from the scene."""
        lights = core.world.contents.lights
        removed = light_named(light_name, lights)
        core.world.set_lights([light for light in lights if light is not removed])
        core.announce()
