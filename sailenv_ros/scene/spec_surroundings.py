"""Surroundings and lights of a scene file; they become `Environment` and `Light`."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, TypeAlias

from pydantic import Field

from sailenv_ros.scene.field_types import Choice, Number, Switch
from sailenv_ros.scene.fields import Direction, Name, Position, Radiance, Rule, SceneModel
from sailenv_ros.scene.rules import below, without_zero_length
from sailenv_ros.types.lights import ENVIRONMENT_LIMITS, LIGHT_LIMITS, Environment, Light

__all__ = [
    "AreaLightSpec",
    "DirectionalLightSpec",
    "EnvironmentSpec",
    "LightSpec",
    "PointLightSpec",
    "SpotLightSpec",
]

_STANDARD = Environment()


def _of_light(name: str) -> Number:
    return Number.within(LIGHT_LIMITS[name])


def _of_environment(name: str) -> Number:
    return Number.within(ENVIRONMENT_LIMITS[name])


_KEYS = {
    "position": "position_m",
    "range": "range_m",
    "inner_cone": "inner_cone_deg",
    "outer_cone": "outer_cone_deg",
    "width": "width_m",
    "height": "height_m",
}
"""Attributes of `Light` by the keys that have not their unit."""


class EnvironmentSpec(SceneModel):
    """Surroundings of the objects: ambient light, sky or background colour, exposure."""

    ambient: Radiance = Field(
        default=_STANDARD.ambient,
        description="light that arrives from everywhere, besides the sky's (radiance)",
    )
    background: Annotated[Literal["sky", "colour"], Choice(("sky", "colour"))] = Field(
        default=_STANDARD.background, description="shown where there is no object"
    )
    background_colour: Radiance = Field(
        default=_STANDARD.background_colour, description="the colour for `background: colour`"
    )
    sky_zenith: Radiance = Field(default=_STANDARD.sky_zenith, description="sky straight above")
    sky_horizon: Radiance = Field(default=_STANDARD.sky_horizon, description="sky at the horizon")
    sky_ground: Radiance = Field(
        default=_STANDARD.sky_ground, description="below the horizon, where there is no object"
    )
    sky_share: Annotated[float, _of_environment("sky_share")] = Field(
        default=_STANDARD.sky_share,
        description="share of the sky's light that reaches the objects: 1 outdoors, about 0.2 in "
        "a room",
    )
    sky_map: str = Field(
        default=_STANDARD.sky_map,
        max_length=200,
        description="name of a photographed sky, e.g. forest; empty for that of the three colours",
    )
    sky_rotation: Annotated[float, _of_environment("sky_rotation")] = Field(
        default=_STANDARD.sky_rotation,
        description="turns the photographed sky counter-clockwise as seen from above [deg]",
    )
    sky_blend: Annotated[bool, Switch()] = Field(
        default=_STANDARD.sky_blend,
        description="true: the photographed sky is darkened to suit a room; false: its true "
        "radiance, mostly white behind windows",
    )
    outside_factor: Annotated[float, _of_environment("outside_factor")] = Field(
        default=_STANDARD.outside_factor,
        description="factor of the brightness of what is seen outside; 0: a black night",
    )
    exposure: Annotated[float, _of_environment("exposure")] = Field(
        default=_STANDARD.exposure,
        description="the picture is brightened by 2 to the power of it [stops]",
    )
    meter_exposure: Annotated[bool, Switch()] = Field(
        default=False,
        description="true: in baked light `exposure` is lowered as far as highlights need, so that "
        "they are not white; a room without `exposure` has a measured one",
    )

    @property
    def is_metered(self) -> bool:
        """Whether the exposure depends on what is measured in baked light."""
        return self.meter_exposure or self.wanted_exposure is None

    @property
    def wanted_exposure(self) -> float | None:
        """The exposure that the entry names [stops], None if it leaves that to a meter."""
        return self.exposure if "exposure" in self.model_fields_set else None

    def to_environment(self) -> Environment:
        """Return the data type that the renderer takes."""
        return Environment(**self.model_dump(exclude={"meter_exposure"}))


class _LightBase(SceneModel):
    """Base of all lights."""

    name: Name = Field(description="unique among the lights of the scene")
    colour: Radiance = Field(default=(1.0, 1.0, 1.0), description="colour of the light")
    intensity: Annotated[float, _of_light("intensity")] = Field(
        default=1.0,
        description="directional: irradiance at normal incidence [W/m2]; point, spot: radiant "
        "intensity [W/sr]; area: radiance [W/(m2 sr)]",
    )
    indirect_multiplier: Annotated[float, _of_light("indirect_multiplier")] = Field(
        default=1.0, description="scales only the light that bounces"
    )

    def to_light(self) -> Light:
        """Return the data type that the renderer takes."""
        given: dict[str, Any] = self.model_dump()
        return Light(**{_KEYS.get(key, key): value for key, value in given.items()})


class DirectionalLightSpec(_LightBase):
    """Parallel light from far away, such as the sun's."""

    rules: ClassVar[tuple[Rule, ...]] = (without_zero_length,)

    type: Literal["directional"]
    direction: Direction = Field(
        default=(0.0, 0.0, -1.0), description="where the light travels to, any length"
    )


class PointLightSpec(_LightBase):
    """A light that shines to all sides."""

    type: Literal["point"]
    position: Position = Field(default=(0.0, 0.0, 3.0), description="where it is [m]")
    range: Annotated[float, _of_light("range_m")] = Field(
        default=20.0, description="beyond it the light has no effect [m]"
    )


class SpotLightSpec(PointLightSpec):
    """A cone of light."""

    rules: ClassVar[tuple[Rule, ...]] = (
        without_zero_length,
        below("inner_cone", "outer_cone", {"inner_cone": 20.0, "outer_cone": 35.0}, equal=True),
    )

    type: Literal["spot"]  # type: ignore[assignment]
    direction: Direction = Field(
        default=(0.0, 0.0, -1.0), description="where the light travels to, any length"
    )
    inner_cone: Annotated[float, _of_light("inner_cone_deg")] = Field(
        default=20.0, description="half angle of the full brightness [deg]"
    )
    outer_cone: Annotated[float, _of_light("outer_cone_deg")] = Field(
        default=35.0, description="half angle where the brightness has gone to 0 [deg]"
    )
    exponent: Annotated[float, _of_light("exponent")] = Field(
        default=0.0,
        description="the intensity falls with the cosine of the angle to this power; 0: an "
        "evenly bright cone",
    )


class AreaLightSpec(_LightBase):
    """A shining rectangle."""

    rules: ClassVar[tuple[Rule, ...]] = (without_zero_length,)

    type: Literal["area"]
    position: Position = Field(default=(0.0, 0.0, 3.0), description="its centre [m]")
    direction: Direction = Field(
        default=(0.0, 0.0, -1.0), description="where its front looks, any length"
    )
    width: Annotated[float, _of_light("width_m")] = Field(default=1.0, description="its size [m]")
    height: Annotated[float, _of_light("height_m")] = Field(default=1.0, description="its size [m]")


LightSpec: TypeAlias = Annotated[
    DirectionalLightSpec | PointLightSpec | SpotLightSpec | AreaLightSpec,
    Field(discriminator="type"),
]
