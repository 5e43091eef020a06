"""Operations on lights, by the names of the SAILenv client.

`set_light` and `get_light` have linear colours, as `Light` does; the SAILenv client's methods have
red, green, blue from 0 to 255 (sRGB).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from sailenv_ros.errors import NameTaken, UnknownName
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.types.colour import linear_from_srgb8, srgb8_from_linear
from sailenv_ros.types.lights import LIGHT_ATTRIBUTES, Light, LightType, light_named

if TYPE_CHECKING:
    from sailenv_ros.simulation.core import SimulationCore

__all__ = ["LightOperations"]

Vector3 = tuple[float, float, float]


class LightOperations(Caller):
    """Lights."""

    @property
    def lights(self) -> tuple[Light, ...]:
        """The scene's lights, as announced."""
        return self.info.lights

    @property
    def lights_names(self) -> list[str]:
        """Names of the scene's lights."""
        return [light.name for light in self.lights]

    @operation(light_name=check.text)
    @staticmethod
    def get_light(core: SimulationCore, light_name: str) -> Light:
        """Return a light as it is now."""
        return light_named(light_name, core.world.contents.lights)

    @operation(light_name=check.text)
    @staticmethod
    def set_light(core: SimulationCore, light_name: str, /, **changes: Any) -> Light:
        """Change attributes of a light, by their names in `Light`; return it as it is then.

        >>> agent.set_light("sun", intensity=2.0, direction=(0.3, 0.0, -1.0))  # doctest: +SKIP
        """
        lights = core.world.contents.lights
        present = light_named(light_name, lights)
        for key in changes:
            if key not in LIGHT_ATTRIBUTES:
                raise UnknownName("attribute of a light", key, LIGHT_ATTRIBUTES)
        changed = replace(present, **changes)
        if changes:
            core.world.set_lights([changed if light is present else light for light in lights])
            core.announce()
        return changed

    @operation(light_name=check.text, light_type=check.text)
    @staticmethod
    def add_light(
        core: SimulationCore, light_name: str, light_type: LightType, /, **attributes: Any
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
        for key in attributes:
            if key not in LIGHT_ATTRIBUTES or key == "type":
                raise UnknownName("attribute of a light", key, LIGHT_ATTRIBUTES)
        if any(light.name == light_name for light in lights):
            raise NameTaken("light", light_name)
        added = Light(name=light_name, type=light_type, **attributes)
        core.library.check_lights((*lights, added))
        core.world.set_lights((*lights, added))
        core.announce()
        return added

    @operation(light_name=check.text)
    @staticmethod
    def remove_light(core: SimulationCore, light_name: str) -> None:
        """Remove a light from the scene."""
        lights = core.world.contents.lights
        removed = light_named(light_name, lights)
        core.world.set_lights([light for light in lights if light is not removed])
        core.announce()

    # -- by the names of the SAILenv client ------------------------------------------------

    def get_light_color(self, light_name: str) -> tuple[int, int, int]:
        """Return a light's red, green, blue, 0 to 255."""
        return srgb8_from_linear(self.get_light(light_name).colour)

    def set_light_color(self, light_name: str, r: int, g: int, b: int) -> None:
        """Set a light's red, green, blue, 0 to 255."""
        self.set_light(light_name, colour=linear_from_srgb8("colour", (r, g, b)))

    def get_light_intensity(self, light_name: str) -> float:
        """Return a light's intensity (see `Light` for its unit)."""
        return self.get_light(light_name).intensity

    def set_light_intensity(self, light_name: str, intensity: float) -> None:
        """Set a light's intensity, 0 or more."""
        self.set_light(light_name, intensity=intensity)

    def get_light_indirect_multiplier(self, light_name: str) -> float:
        """Return the factor of a light's bounced part."""
        return self.get_light(light_name).indirect_multiplier

    def set_light_indirect_multiplier(self, light_name: str, indirect_multiplier: float) -> None:
        """Set the factor of a light's bounced part, 0 or more."""
        self.set_light(light_name, indirect_multiplier=indirect_multiplier)

    def get_light_position(self, light_name: str) -> Vector3:
        """Return a light's world coordinates [m]."""
        return self.get_light(light_name).position_m

    def set_light_position(self, light_name: str, position: ArrayLike) -> None:
        """Put a light at world coordinates [m]."""
        self.set_light(light_name, position_m=position)

    def get_light_direction(self, light_name: str) -> Vector3:
        """Return the unit vector that a light travels along."""
        return self.get_light(light_name).direction

    def set_light_direction(self, light_name: str, direction: ArrayLike) -> None:
        """Set the vector, of any length, that a light travels along."""
        self.set_light(light_name, direction=direction)

    def get_light_type(self, light_name: str) -> str:
        """Return a light's type: directional, point, spot or area."""
        return self.get_light(light_name).type

    def set_light_type(self, light_name: str, light_type: str) -> None:
        """Make a light directional, point, spot or area."""
        self.set_light(light_name, type=light_type)
