"""Lights: how bright, of which colour, where."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from sailenv_ros.scene.field_types import Number, optional
from sailenv_ros.scene.fields import Direction, Position, Radiance
from sailenv_ros.scene.randomise.drawn import Draw, Drawn
from sailenv_ros.scene.randomise.randomisation import (
    Pick,
    Randomisation,
    RandomTargets,
    Values,
)
from sailenv_ros.scene.randomise.relative import DrawnNumber
from sailenv_ros.scene.randomise.selectors import Which
from sailenv_ros.types.lights import LIGHT_LIMITS

__all__ = ["RandomLight"]

_Intensity = Annotated[float, Number.within(LIGHT_LIMITS["intensity"])]
_Indirect = Annotated[float, Number.within(LIGHT_LIMITS["indirect_multiplier"])]


class RandomLight(Randomisation):
    """Attributes of lights."""

    KEY: ClassVar[str] = "lights"

    type: Literal["light"]
    of: Which = Field(description="names of lights; * and ?")
    intensity: Annotated[Draw, DrawnNumber(_Intensity)] | None = optional("as of a light")
    colour: Annotated[Draw, DrawnNumber(Radiance, vector=True)] | None = optional(
        "drawn in linear numbers"
    )
    indirect_multiplier: Annotated[Draw, DrawnNumber(_Indirect)] | None = optional(
        "scales only the light that bounces"
    )
    offset: Annotated[Draw, Drawn(Position)] | None = optional(
        "from where the light is in the file [m]"
    )
    direction: Annotated[Draw, Drawn(Direction)] | None = optional(
        "where the light travels to, any length but 0"
    )

    def values(self, targets: RandomTargets, pick: Pick) -> Values:
        """Return attributes of `Light` for each target."""
        lights = self.drawn(self.of, targets.lights, pick, "offset")
        if self.offset is not None:
            for name, values in lights.items():
                offset, place = pick(name, "offset", self.offset), targets.lights[name]
                values["position_m"] = tuple(a + b for a, b in zip(place, offset, strict=True))
        return {"lights": lights}
