"""What a user asks about lights and surroundings, by the original client's names.

Part of `SimulatorClient`. The original's methods take and give colours as red, green, blue from 0
to 255 (sRGB); `set_light` and `get_light` have them linear, as `Light` does.
"""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike
from std_msgs.msg import ColorRGBA

from sailenv_msgs.srv import (
    AddLight,
    GetAmbientLight,
    GetLight,
    RemoveLight,
    SetAmbientLight,
    SetBackground,
    SetLight,
)
from sailenv_msgs_py.objects import LIGHT_FIELDS
from sailenv_msgs_py.scene_info import colour_to_msg, light_from_msg, light_to_msg, rgb_from_msg
from sailenv_ros.agent.asking import Asking, text_of
from sailenv_ros.errors import UnknownName
from sailenv_ros.geometry import vector
from sailenv_ros.lights import Light
from sailenv_ros.pictures.srgb import linear_from_srgb8, srgb8_from_linear

__all__ = ["LightRequests"]

_FIELDS = {attribute: field for field, attribute in LIGHT_FIELDS.items()}

Vector3 = tuple[float, float, float]


class LightRequests(Asking):
    """Requests about lights and surroundings; see `SimulatorClient`."""

    @property
    def lights_names(self) -> list[str]:
        """Names of the scene's lights."""
        return [light.name for light in self._info.lights]

    def get_light(self, light_name: str) -> Light:
        """Give a light as it is now."""
        request = GetLight.Request(name=text_of("light_name", light_name))
        return light_from_msg(self._call(GetLight, "get_light", request).light)

    def set_light(self, light_name: str, **changes: Any) -> Light:
        """Change attributes of a light, by their names in `Light`; give the light as it is then.

        >>> agent.set_light("sun", intensity=2.0, direction=(0.3, 0.0, -1.0))  # doctest: +SKIP
        """
        for name in changes:
            if name not in _FIELDS:
                raise UnknownName("attribute of a light", name, _FIELDS)
        if not changes:
            return self.get_light(light_name)
        # What is not named is not looked at; the noun checks what is.
        unnamed = {"type": "spot", "inner_cone_deg": 0.0, "outer_cone_deg": 89.0}
        wanted = Light(**{"name": text_of("light_name", light_name), **unnamed, **changes})
        request = SetLight.Request(
            light=light_to_msg(wanted), fields=[_FIELDS[name] for name in changes]
        )
        return light_from_msg(self._call(SetLight, "set_light", request).light)

    def add_light(self, light_name: str, light_type: str, /, **attributes: Any) -> Light:
        """Put one more light into the scene; give it.

        Parameters
        ----------
        light_name : str
            Unique in the scene.
        light_type : {'directional', 'point', 'spot', 'area'}
        **attributes
            By their names in `Light`; the rest are its defaults.

        >>> agent.add_light("lamp", "point", position_m=(0, 1, 2))  # doctest: +SKIP
        """
        for name in attributes:
            if name not in _FIELDS or name == "type":
                raise UnknownName("attribute of a light", name, _FIELDS)
        given: dict[str, Any] = {"name": text_of("light_name", light_name), "type": light_type}
        request = AddLight.Request(light=light_to_msg(Light(**{**given, **attributes})), fields=[])
        added = light_from_msg(self._call(AddLight, "add_light", request).light)
        self._await_info(
            lambda info: any(light.name == light_name for light in info.lights),
            f"the light {light_name!r}",
        )
        return added

    def remove_light(self, light_name: str) -> None:
        """Take a light out of the scene."""
        request = RemoveLight.Request(name=text_of("light_name", light_name))
        self._call(RemoveLight, "remove_light", request)
        self._await_info(
            lambda info: all(light.name != light_name for light in info.lights),
            f"the end of light {light_name!r}",
        )

    # -- the original client's -------------------------------------------------------------

    def get_light_color(self, light_name: str) -> tuple[int, int, int]:
        """Give a light's red, green, blue, 0 to 255."""
        return srgb8_from_linear(self.get_light(light_name).colour)

    def set_light_color(self, light_name: str, r: int, g: int, b: int) -> None:
        """Set a light's red, green, blue, 0 to 255."""
        self.set_light(light_name, colour=linear_from_srgb8("colour", (r, g, b)))

    def get_light_intensity(self, light_name: str) -> float:
        """Give a light's intensity (see `Light` for its unit)."""
        return self.get_light(light_name).intensity

    def set_light_intensity(self, light_name: str, intensity: float) -> None:
        """Set a light's intensity, 0 or more."""
        self.set_light(light_name, intensity=intensity)

    def get_light_indirect_multiplier(self, light_name: str) -> float:
        """Give the factor of a light's bounced part."""
        return self.get_light(light_name).indirect_multiplier

    def set_light_indirect_multiplier(self, light_name: str, indirect_multiplier: float) -> None:
        """Set the factor of a light's bounced part, 0 or more."""
        self.set_light(light_name, indirect_multiplier=indirect_multiplier)

    def get_light_position(self, light_name: str) -> Vector3:
        """Give a light's world coordinates [m]."""
        return self.get_light(light_name).position_m

    def set_light_position(self, light_name: str, position: ArrayLike) -> None:
        """Put a light at world coordinates [m]."""
        self.set_light(light_name, position_m=position)

    def get_light_direction(self, light_name: str) -> Vector3:
        """Give the unit vector that a light travels along."""
        return self.get_light(light_name).direction

    def set_light_direction(self, light_name: str, direction: ArrayLike) -> None:
        """Set the vector, of any length, that a light travels along."""
        self.set_light(light_name, direction=direction)

    def get_light_type(self, light_name: str) -> str:
        """Give a light's type: directional, point, spot or area."""
        return self.get_light(light_name).type

    def set_light_type(self, light_name: str, light_type: str) -> None:
        """Make a light directional, point, spot or area."""
        self.set_light(light_name, type=light_type)

    # -- surroundings ----------------------------------------------------------------------

    def get_ambient_light_color(self) -> tuple[int, int, int]:
        """Give red, green, blue, 0 to 255, of the light that arrives from everywhere."""
        answer = self._call(GetAmbientLight, "get_ambient_light", GetAmbientLight.Request())
        return srgb8_from_linear(rgb_from_msg(answer.colour))

    def set_ambient_light_color(self, r: int, g: int, b: int) -> None:
        """Set red, green, blue, 0 to 255, of the light that arrives from everywhere."""
        self.set_ambient_light(linear_from_srgb8("colour", (r, g, b)))

    def set_ambient_light(self, colour: ArrayLike) -> None:
        """Set the linear radiance that arrives from everywhere."""
        request = SetAmbientLight.Request(colour=_colour("colour", colour))
        self._call(SetAmbientLight, "set_ambient_light", request)

    def change_main_camera_clear_flags(self, r: int, g: int, b: int) -> None:
        """Show a colour (0 to 255 each) where nothing is hit; the sky if one is negative."""
        if min(r, g, b) < 0:
            self.set_background("sky")
        else:
            self.set_background("colour", linear_from_srgb8("colour", (r, g, b)))

    def set_background(self, kind: str, colour: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Show the ``sky``, or a linear ``colour``, where nothing is hit."""
        if kind not in ("sky", "colour"):
            raise UnknownName("background", str(kind), ("sky", "colour"))
        request = SetBackground.Request(sky=kind == "sky", colour=_colour("colour", colour))
        self._call(SetBackground, "set_background", request)


def _colour(what: str, colour: ArrayLike) -> ColorRGBA:
    message: ColorRGBA = colour_to_msg(vector(what, colour, limit=1e6))
    return message
