"""Lights: how bright, of which colour, where."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from sailenv_ros.scene.field_types import Number
from sailenv_ros.scene.fields import Direction, Position, Radiance
from sailenv_ros.scene.randomise.drawn import Draw, Drawn
from sailenv_ros.scene.randomise.randomisation import (
    Pick,
    Randomisation,
    RandomTargets,
    Values,
    Which,
    chosen,
)
from sailenv_ros.types.lights import LIGHT_LIMITS

__all__ = ["RandomLight"]

_Intensity = Annotated[float, Number.within(LIGHT_LIMITS["intensity"])]
_Indirect = Annotated[float, Number.within(LIGHT_LIMITS["indirect_multiplier"])]


class RandomLight(Randomisation):
    """Attributes of lights."""

    KEY: ClassVar[str] = "lights"

    type: Literal["light"]
    of: Which = Field(description="names of lights; * and ?")
    intensity: Annotated[Draw, Drawn(_Intensity)] | None = Field(
        default=None, description="as of a light"
    )
    colour: Annotated[Draw, Drawn(Radiance)] | None = Field(
        default=None, description="drawn in linear numbers"
    )
    indirect_multiplier: Annotated[Draw, Drawn(_Indirect)] | None = Field(
        default=None, description="scales only the light that bounces"
    )
    offset: Annotated[Draw, Drawn(Position)] | None = Field(
        default=None, description="from where the light is in the file [m]"
    )
    direction: Annotated[Draw, Drawn(Direction)] | None = Field(
        default=None, description="where the light travels to, any length but 0"
    )

    def values(self, targets: RandomTargets, pick: Pick) -> Values:
        """Return attributes of `Light` for each target."""
        draws = self.draws("offset")
        lights: Values = {}
        for name in chosen(self.of, targets.lights):
            lights[name] = {key: pick(name, key, draw) for key, draw in draws.items()}
            if self.offset is not None:
                offset, place = pick(name, "offset", self.offset), targets.lights[name]
                lights[name]["position_m"] = tuple(
                    a + b for a, b in zip(place, offset, strict=True)
                )
        return {"lights": lights}
