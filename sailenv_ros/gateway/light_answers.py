"""Answers about lights and surroundings.

Colours on the wire are red, green, blue from 0 to 255 (sRGB); ours are linear.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Any

from sailenv_ros.colour import linear_from_srgb8, srgb8_from_linear
from sailenv_ros.errors import SailenvError
from sailenv_ros.gateway.codec import pack_floats, pack_ints, pack_string, pack_strings
from sailenv_ros.gateway.steps import Answer, Ask, Step, in_words, one_line
from sailenv_ros.gateway.unity import unity_from_vector, vector_from_unity
from sailenv_ros.lights import Light
from sailenv_ros.operations import Operations
from sailenv_ros.scene_info import SceneInfo

__all__ = ["LightAnswers"]

LIGHT_NOT_FOUND = "light_not_found"
"""Answer by which clients recognise an unknown light, in place of its type."""

Vector3 = tuple[float, float, float]


class LightAnswers:
    """Answers about lights; the method's name is the command's.

    Parameters
    ----------
    info : callable
        Returns the scene as it was announced last.
    """

    def __init__(self, info: Callable[[], SceneInfo]) -> None:
        self._info = info

    def get_lights(self) -> Answer:
        """Return the lights' names."""
        yield from ()
        return [pack_strings(light.name for light in self._info().lights)]

    def get_light_type(self, light: str) -> Answer:
        """Return a light's type."""
        try:
            found: Light = yield Ask(Operations.get_light, light)
        except SailenvError:
            return [pack_string(LIGHT_NOT_FOUND)]
        return [pack_string(found.type)]

    def get_light_colour(self, light: str) -> Answer:
        """Return a light's colour."""
        return (yield from _read(light, lambda it: pack_ints(*srgb8_from_linear(it.colour))))

    def set_light_colour(self, light: str, red: int, green: int, blue: int) -> Answer:
        """Change a light's colour."""
        return (yield from _written(light, lambda: {"colour": _linear(red, green, blue)}))

    def get_light_intensity(self, light: str) -> Answer:
        """Return a light's intensity."""
        return (yield from _read(light, lambda it: pack_floats(it.intensity)))

    def set_light_intensity(self, light: str, value: float) -> Answer:
        """Change a light's intensity."""
        return (yield from _written(light, lambda: {"intensity": value}))

    def get_light_indirect(self, light: str) -> Answer:
        """Return the factor of a light's bounced part."""
        return (yield from _read(light, lambda it: pack_floats(it.indirect_multiplier)))

    def set_light_indirect(self, light: str, value: float) -> Answer:
        """Change the factor of a light's bounced part."""
        return (yield from _written(light, lambda: {"indirect_multiplier": value}))

    def get_light_position(self, light: str) -> Answer:
        """Return where a light is."""
        return (yield from _read(light, lambda it: pack_floats(*unity_from_vector(it.position_m))))

    def set_light_position(self, light: str, vector: Vector3) -> Answer:
        """Move a light."""
        position = ("position", vector)
        return (yield from _written(light, lambda: {"position_m": vector_from_unity(*position)}))

    def get_light_direction(self, light: str) -> Answer:
        """Return where a light travels to."""
        return (yield from _read(light, lambda it: pack_floats(*unity_from_vector(it.direction))))

    def set_light_direction(self, light: str, vector: Vector3) -> Answer:
        """Change where a light travels to; a direction of any length."""
        direction = ("direction", vector)
        return (yield from _written(light, lambda: {"direction": vector_from_unity(*direction)}))

    def get_ambient_colour(self) -> Answer:
        """Return the colour of the light that arrives from everywhere."""
        yield from ()
        return [pack_string("ok"), pack_ints(*srgb8_from_linear(self._info().environment.ambient))]

    def set_ambient_colour(self, red: int, green: int, blue: int) -> Answer:
        """Change the colour of the light that arrives from everywhere."""
        return (yield from in_words(_with_ambient(red, green, blue)))

    def set_background(self, red: int, green: int, blue: int) -> Answer:
        """Show a colour where nothing is hit, or the sky if one channel is negative."""
        return (yield from in_words(_with_background(red, green, blue)))


def _read(name: str, pack: Callable[[Light], bytes]) -> Answer:
    try:
        light: Light = yield Ask(Operations.get_light, name)
        return [pack_string("ok"), pack(light)]
    except SailenvError as error:
        return [pack_string(one_line(error))]


def _written(name: str, changes: Callable[[], dict[str, Any]]) -> Answer:
    return (yield from in_words(_changed(name, changes)))


def _changed(name: str, changes: Callable[[], dict[str, Any]]) -> Generator[Step, Any, None]:
    yield Ask(Operations.set_light, name, **changes())


def _with_ambient(red: int, green: int, blue: int) -> Generator[Step, Any, None]:
    yield Ask(Operations.set_ambient_light, _linear(red, green, blue))


def _with_background(red: int, green: int, blue: int) -> Generator[Step, Any, None]:
    if min(red, green, blue) < 0:
        yield Ask(Operations.set_background, "sky")
    else:
        yield Ask(Operations.set_background, "colour", _linear(red, green, blue))


def _linear(red: int, green: int, blue: int) -> Vector3:
    return linear_from_srgb8("colour", (red, green, blue))
