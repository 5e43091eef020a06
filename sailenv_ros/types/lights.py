"""Lights and surroundings of a scene, as the renderer takes them.

Colours are linear RGB. Positions and directions are in the world frame.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import TypedDict

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.native.lamp import LAMP
from sailenv_ros.types.validation import Bounds, check_bounds, checked_flag, vector

__all__ = [
    "ENVIRONMENT_LIMITS",
    "LAMP_TYPES",
    "LIGHT_ATTRIBUTES",
    "LIGHT_KINDS",
    "LIGHT_LIMITS",
    "LUMENS_PER_WATT",
    "MAX_RADIANCE",
    "Environment",
    "Light",
    "LightAttributes",
    "LightChanges",
    "LightType",
    "SkyMap",
    "area_sides",
    "lamp_rows",
    "light_named",
]

LightType = Literal["directional", "point", "spot", "area"]

LAMP_TYPES: tuple[LightType, ...] = ("point", "spot")
"""Types of lights that belong to lamps; area lights stand for windows."""

LIGHT_LIMITS: Mapping[str, Bounds] = {
    "intensity": Bounds(least=0.0, most=1e6),
    "indirect_multiplier": Bounds(least=0.0, most=1e6),
    "range_m": Bounds(above=0.0, most=1e3, unit="m"),
    "inner_cone_deg": Bounds(least=0.0, most=89.0, unit="deg"),
    "outer_cone_deg": Bounds(least=0.0, most=89.0, unit="deg"),
    "exponent": Bounds(least=0.0, most=128.0),
    "width_m": Bounds(above=0.0, most=1e3, unit="m"),
    "height_m": Bounds(above=0.0, most=1e3, unit="m"),
}
"""Bounds of each number of a light."""

ENVIRONMENT_LIMITS: Mapping[str, Bounds] = {
    "sky_share": Bounds(least=0.0, most=1.0),
    "outside_factor": Bounds(least=0.0, most=100.0),
    "sky_rotation": Bounds(least=-360.0, most=360.0, unit="deg"),
    "exposure": Bounds(least=-20.0, most=20.0, unit="stops"),
}
"""Bounds of each number of an environment."""

LUMENS_PER_WATT = 683.0
"""Candela, lux and nits of other programs are as many times our watts."""

MAX_RADIANCE = 1e6
"""Greatest value of each channel of a linear colour."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Light:
    """One light.

    Attributes
    ----------
    name : str
        Unique in its scene.
    type : {'directional', 'point', 'spot', 'area'}
    colour : (3,) tuple of float
        Linear red, green, blue, each 0 or more.
    intensity : float
        Irradiance at normal incidence [W/m²] of a directional light; radiant intensity [W/sr] of
        a point, spot light; radiance [W/(m² sr)] of an area light. 0 or more, unitless scale:
        exposure maps it to the picture.
    indirect_multiplier : float
        Scales the light's bounced part only.
    position_m : (3,) tuple of float
        Of point, spot and area lights [m].
    direction : (3,) tuple of float
        Where the light travels to; of directional, spot and area lights. Unit length.
    range_m : float
        Beyond it a point or spot light has no effect, above 0 and at most 1000 [m].
    inner_cone_deg, outer_cone_deg : float
        Half angles of a spot light's full and vanishing brightness [deg].
    exponent : float
        A spot light's intensity falls with the cosine of the angle to its direction to this power;
        0 to 128, 0 for a cone that is evenly bright.
    width_m, height_m : float
        Size of an area light, above 0 and at most 1000 [m].
    """

    name: str
    type: LightType
    colour: tuple[float, float, float] = (1.0, 1.0, 1.0)
    intensity: float = 1.0
    indirect_multiplier: float = 1.0
    position_m: tuple[float, float, float] = (0.0, 0.0, 3.0)
    direction: tuple[float, float, float] = (0.0, 0.0, -1.0)
    range_m: float = 20.0
    inner_cone_deg: float = 20.0
    outer_cone_deg: float = 35.0
    exponent: float = 0.0
    width_m: float = 1.0
    height_m: float = 1.0

    def __post_init__(self) -> None:
        if self.type not in get_args(LightType):
            raise UnknownName(f"type of light {self.name!r}", str(self.type), get_args(LightType))
        colour = _radiance(f"colour of light {self.name!r}", self.colour)
        check_bounds(self, LIGHT_LIMITS, after=f" of light {self.name!r}")
        if self.inner_cone_deg > self.outer_cone_deg:
            accepted = f"at most outer_cone_deg = {self.outer_cone_deg:g} [deg]"
            what = f"inner_cone_deg of light {self.name!r}"
            raise InvalidRequest(what, self.inner_cone_deg, accepted)
        x, y, z = vector(f"direction of light {self.name!r}", self.direction, limit=1e6)
        length = (x * x + y * y + z * z) ** 0.5
        if length < 1e-9:
            raise InvalidRequest(f"direction of light {self.name!r}", (x, y, z), "not all zero")
        position = vector(f"position of light {self.name!r}", self.position_m, limit=1e4)
        object.__setattr__(self, "colour", colour)
        if abs(length - 1.0) > UNIT_TOLERANCE:
            x, y, z = x / length, y / length, z / length
        object.__setattr__(self, "direction", (x, y, z))
        object.__setattr__(self, "position_m", position)

    @property
    def power(self) -> tuple[float, float, float]:
        """Colour times intensity, (3,): of the unit of `intensity`."""
        red, green, blue = self.colour
        return red * self.intensity, green * self.intensity, blue * self.intensity


UNIT_TOLERANCE = 1e-12
"""A direction whose length differs from 1 by no more stays as it is: dividing a unit vector by its
length again changes last bits, and a light that only became brighter must not seem to have turned.
"""

LIGHT_ATTRIBUTES: tuple[str, ...] = tuple(f.name for f in fields(Light) if f.name != "name")
"""Names of everything that can be changed of a light, in their order."""

LIGHT_KINDS: dict[LightType, int] = {kind: k for k, kind in enumerate(get_args(LightType))}
"""Number of each type of light in kernels and shaders, as light_law.h has them."""


def lamp_rows(
    lights: Sequence[Light], frame_from_world: NDArray[np.float64] | None = None
) -> NDArray[np.void]:
    """Return lights as kernels and shaders take them.

    Parameters
    ----------
    lights : sequence of Light
    frame_from_world : (4, 4) float64 or None
        Rigid transform to the frame that positions and directions are wanted in; None for the
        world's.

    Returns
    -------
    rows : (N,) LAMP
        The colour is radiant intensity, of directional lights irradiance. Seen from afar an area
        light is a point with the area's radiant intensity.
    """
    rows = np.zeros(len(lights), LAMP)
    for row, light in zip(rows, lights, strict=True):
        area_m2 = light.width_m * light.height_m if light.type == "area" else 1.0
        position, direction = np.array(light.position_m), np.array(light.direction)
        if frame_from_world is not None:
            turn = frame_from_world[:3, :3]
            position, direction = turn @ position + frame_from_world[:3, 3], turn @ direction
        row["colour"] = np.array(light.power) * area_m2
        row["kind"] = LIGHT_KINDS[light.type]
        row["position"], row["direction"] = position, direction
        # The law divides by the range; within a millimetre nothing is lit by it.
        row["range_m"] = max(light.range_m, 1e-3)
        row["inner_cosine"] = np.cos(np.radians(light.inner_cone_deg))
        row["outer_cosine"] = np.cos(np.radians(light.outer_cone_deg))
        row["exponent"] = light.exponent
    return rows


def area_sides(light: Light) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the vectors along an area light's width and height, as long as these are.

    The width is horizontal; of a light that shines straight up or down it lies along y.
    """
    forward = np.asarray(light.direction)
    across = np.array([-forward[1], forward[0], 0.0])
    if np.linalg.norm(across) < 1e-6:
        across = np.array([0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    return across * light.width_m, np.cross(forward, across) * light.height_m


class LightAttributes(TypedDict, total=False):
    """Attributes of a light of a given type, by their names in `Light`."""

    colour: ArrayLike
    intensity: float
    indirect_multiplier: float
    position_m: ArrayLike
    direction: ArrayLike
    range_m: float
    inner_cone_deg: float
    outer_cone_deg: float
    exponent: float
    width_m: float
    height_m: float


class LightChanges(LightAttributes, total=False):
    """Everything that can be changed of a light, by its names in `Light`."""

    type: LightType


def light_named(name: str, lights: Iterable[Light]) -> Light:
    """Find a light by its name.

    Raises
    ------
    UnknownName
        If there is none of that name.
    """
    by_name = {light.name: light for light in lights}
    if not isinstance(name, str) or name not in by_name:
        raise UnknownName("light", str(name), by_name)
    return by_name[name]


@dataclass(frozen=True, eq=False, kw_only=True)
class SkyMap:
    """A picture of the whole sky; compared by identity: the same object is uploaded once.

    Attributes
    ----------
    radiance : (H, 2 H, 3) float16
        Linear radiance in equirectangular projection: row 0 is the zenith, the middle column lies
        towards +x, columns run clockwise as seen from above.
    zenith, horizon, ground : (3,) tuple of float
        Mean radiance of its parts, for light that comes from everywhere.
    """

    radiance: NDArray[np.float16]
    zenith: tuple[float, float, float]
    horizon: tuple[float, float, float]
    ground: tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Environment:
    """Surroundings of the objects: ambient light, sky or background colour, exposure.

    Attributes
    ----------
    ambient : (3,) tuple of float
        Linear radiance that arrives from everywhere, besides the sky's.
    background : {'sky', 'colour'}
        What pixels show where nothing was hit.
    background_colour : (3,) tuple of float
        Linear colour for ``background = 'colour'``.
    sky_zenith, sky_horizon, sky_ground : (3,) tuple of float
        Linear radiance of the analytic sky, used while no picture of a sky is named.
    sky_share : float
        Share of the sky's light that reaches the objects: 1 outdoors, less in a room.
    sky : SkyMap or None
        What is seen of the sky instead of the three colours, which still light the objects.
    sky_map : str
        Name of a sky picture, empty for the analytic sky.
    sky_rotation : float
        By what the picture is turned about the vertical, counter-clockwise as seen from above
        [deg]; `sky` is turned already.
    sky_blend : bool
        Whether the picture of a sky is shown as bright as a photographer would blend it with the
        room; False shows its radiance as it is. It lights the objects alike.
    outside_factor : float
        Factor of the brightness with which the picture of a sky, and what lies outside a room,
        are seen. What lights the objects is not changed.
    exposure : float
        Stops that the picture is brightened by (factor 2**exposure).
    """

    ambient: tuple[float, float, float] = (0.0, 0.0, 0.0)
    background: Literal["sky", "colour"] = "sky"
    background_colour: tuple[float, float, float] = (0.2, 0.2, 0.2)
    sky_zenith: tuple[float, float, float] = (0.22, 0.38, 0.72)
    sky_horizon: tuple[float, float, float] = (0.75, 0.82, 0.90)
    sky_ground: tuple[float, float, float] = (0.30, 0.28, 0.26)
    sky_share: float = 1.0
    sky: SkyMap | None = None
    sky_map: str = ""
    sky_rotation: float = 0.0
    sky_blend: bool = True
    outside_factor: float = 1.0
    exposure: float = 0.0

    def __post_init__(self) -> None:
        if self.background not in ("sky", "colour"):
            raise UnknownName("background", str(self.background), ("sky", "colour"))
        for name in ("ambient", "background_colour", "sky_zenith", "sky_horizon", "sky_ground"):
            object.__setattr__(self, name, _radiance(name, getattr(self, name)))
        check_bounds(self, ENVIRONMENT_LIMITS)
        checked_flag("sky_blend", self.sky_blend)


def _radiance(what: str, colour: ArrayLike) -> tuple[float, float, float]:
    checked = vector(what, colour, limit=MAX_RADIANCE)
    if min(checked) < 0.0:
        raise InvalidRequest(what, checked, f"three numbers from 0 to {MAX_RADIANCE:.10g}")
    return checked
