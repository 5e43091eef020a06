"""The surroundings: sky, ambient light, background, exposure."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from sailenv_ros.scene.field_types import Number, Text, optional
from sailenv_ros.scene.fields import Radiance
from sailenv_ros.scene.randomise.drawn import Draw, Drawn
from sailenv_ros.scene.randomise.randomisation import Pick, Randomisation, RandomTargets, Values
from sailenv_ros.scene.randomise.relative import DrawnNumber
from sailenv_ros.types.lights import ENVIRONMENT_LIMITS

__all__ = ["RandomEnvironment"]

_Stops = Annotated[float, Number.within(ENVIRONMENT_LIMITS["exposure"])]
_Share = Annotated[float, Number.within(ENVIRONMENT_LIMITS["sky_share"])]
_Sky = Annotated[str, Text(r"[^\x00-\x1f]{0,200}", "the name of a sky, or an empty text")]


class RandomEnvironment(Randomisation):
    """Keys of `environment`."""

    KEY: ClassVar[str] = "environment"

    type: Literal["environment"]
    sky_map: Annotated[Draw, Drawn(_Sky)] | None = optional(
        "name of a photographed sky; empty for that of the three colours"
    )
    exposure: Annotated[Draw, DrawnNumber(_Stops)] | None = optional(
        "the picture is brightened by 2 to the power of it [stops]"
    )
    sky_share: Annotated[Draw, DrawnNumber(_Share)] | None = optional(
        "share of the sky's light that reaches the objects"
    )
    ambient: Annotated[Draw, DrawnNumber(Radiance, vector=True)] | None = optional(
        "light that arrives from everywhere"
    )
    background_colour: Annotated[Draw, DrawnNumber(Radiance, vector=True)] | None = optional(
        "the colour for `background: colour`"
    )
    sky_zenith: Annotated[Draw, DrawnNumber(Radiance, vector=True)] | None = optional(
        "sky straight above"
    )
    sky_horizon: Annotated[Draw, DrawnNumber(Radiance, vector=True)] | None = optional(
        "sky at the horizon"
    )
    sky_ground: Annotated[Draw, DrawnNumber(Radiance, vector=True)] | None = optional(
        "below the horizon"
    )

    def values(self, targets: RandomTargets, pick: Pick) -> Values:
        """Return keys of `environment`."""
        return {"environment": {key: pick("", key, draw) for key, draw in self.draws().items()}}
