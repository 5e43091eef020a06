"""Answers about lights and surroundings.

Colours on the wire are red, green, blue from 0 to 255 (sRGB); ours are linear.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from sailenv_ros.errors import SailenvError
from sailenv_ros.gateway.codec import pack_floats, pack_ints, pack_string, pack_strings
from sailenv_ros.gateway.steps import Request, Response, errors_as_text, one_line
from sailenv_ros.gateway.unity import unity_from_vector, vector_from_unity
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.types.colour import linear_from_srgb8, srgb8_from_linear
from sailenv_ros.types.lights import Light
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["LightAnswers"]

LIGHT_NOT_FOUND = "light_not_found"
"""Answer by which clients recognise an unknown light, in place of its type."""

Vector3 = tuple[float, float, float]


def _linear(red: int, green: int, blue: int) -> Vector3:
    return linear_from_srgb8("colour", (red, green, blue))


def _attribute(
    name: str, pack: Callable[[Any], bytes], unpack: Callable[..., Any]
) -> tuple[Callable[..., Response], Callable[..., Response]]:
    """Return the answers that read and write an attribute of a light, by its name in `Light`."""

    def read(self: LightAnswers, light: str) -> Response:
        try:
            found: Light = yield Request(Operations.get_light, light)
            return [pack_string("ok"), pack(getattr(found, name))]
        except SailenvError as error:
            return [pack_string(one_line(error))]

    def write(self: LightAnswers, light: str, **fields: Any) -> Response:
        return errors_as_text(
            lambda: Request(Operations.set_light, light, **{name: unpack(**fields)})
        )

    return read, write


class LightAnswers:
    """Answers about lights; the method's name is the command's.

    Parameters
    ----------
    info : callable
        Returns the scene as it was announced last.
    """

    def __init__(self, info: Callable[[], SceneInfo]) -> None:
        self._info = info

    get_light_colour, set_light_colour = _attribute(
        "colour", lambda colour: pack_ints(*srgb8_from_linear(colour)), _linear
    )
    get_light_intensity, set_light_intensity = _attribute(
        "intensity", pack_floats, lambda value: value
    )
    get_light_indirect, set_light_indirect = _attribute(
        "indirect_multiplier", pack_floats, lambda value: value
    )
    get_light_position, set_light_position = _attribute(
        "position_m",
        lambda ours: pack_floats(*unity_from_vector(ours)),
        lambda vector: vector_from_unity("position", vector),
    )
    get_light_direction, set_light_direction = _attribute(
        "direction",
        lambda ours: pack_floats(*unity_from_vector(ours)),
        lambda vector: vector_from_unity("direction", vector),
    )

    def get_lights(self) -> Response:
        """Return the lights' names."""
        yield from ()
        return [pack_strings(light.name for light in self._info().lights)]

    def get_light_type(self, light: str) -> Response:
        """Return a light's type."""
        try:
            found: Light = yield Request(Operations.get_light, light)
        except SailenvError:
            return [pack_string(LIGHT_NOT_FOUND)]
        return [pack_string(found.type)]

    def get_ambient_colour(self) -> Response:
        """Return the colour of the light that arrives from everywhere."""
        yield from ()
        return [pack_string("ok"), pack_ints(*srgb8_from_linear(self._info().environment.ambient))]

    def set_ambient_colour(self, red: int, green: int, blue: int) -> Response:
        """Change the colour of the light that arrives from everywhere."""
        return errors_as_text(
            lambda: Request(Operations.set_ambient_light, _linear(red, green, blue))
        )

    def set_background(self, red: int, green: int, blue: int) -> Response:
        """Show a colour where nothing is hit, or the sky if one channel is negative."""
        if min(red, green, blue) < 0:
            return errors_as_text(lambda: Request(Operations.set_background, "sky"))
        return errors_as_text(
            lambda: Request(Operations.set_background, "colour", _linear(red, green, blue))
        )
