"""Materials, pictures, colours and finishes of objects and of parts of the room."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from sailenv_ros.scene.field_types import Number, Text, optional
from sailenv_ros.scene.fields import Fraction, LinearColour
from sailenv_ros.scene.randomise.drawn import Draw, Drawn
from sailenv_ros.scene.randomise.randomisation import (
    Pick,
    Randomisation,
    RandomTargets,
    Values,
)
from sailenv_ros.scene.randomise.selectors import WhichObjects
from sailenv_ros.scene.spec_materials import ALL_PARTS, MaterialName, PictureName

__all__ = ["RandomMaterial"]

_Turn = Annotated[float, Number(least=-360.0, most=360.0, unit="deg")]
_Seed = Annotated[int, Number(least=0, most=2**31 - 1, whole=True)]


class RandomMaterial(Randomisation):
    """Material of objects, walls, the floor or the ceiling."""

    KEY: ClassVar[str] = "materials"

    type: Literal["material"]
    of: WhichObjects = Field(
        description="names of objects, `floor`, `ceiling`, `north wall` …; * and ?; or a category"
    )
    part: Annotated[str, Text(r"[^\x00-\x1f]{1,200}", "the name of a material")] = Field(
        default=ALL_PARTS, description="name of one of its materials; `all` for every one"
    )
    material: Annotated[Draw, Drawn(MaterialName)] | None = optional(
        "a material of rooms, or asset/material of a model"
    )
    picture: Annotated[Draw, Drawn(PictureName)] | None = optional(
        "PNG or JPEG file beside the scene file"
    )
    colour: Annotated[Draw, Drawn(LinearColour)] | None = optional(
        "instead of its own; drawn in linear numbers"
    )
    tint: Annotated[Draw, Drawn(LinearColour)] | None = optional(
        "its colours and patterns are multiplied by it"
    )
    roughness: Annotated[Draw, Drawn(Fraction)] | None = optional("0: a mirror; 1: chalk")
    metallic: Annotated[Draw, Drawn(Fraction)] | None = optional(
        "0: paint, plastic, wood; 1: bare metal"
    )
    turn: Annotated[Draw, Drawn(_Turn)] | None = optional(
        "by which it is laid counter-clockwise [deg]"
    )
    seed: Annotated[Draw, Drawn(_Seed)] | None = optional(
        "of the grain, clouds and tones of a material of rooms"
    )

    def values(self, targets: RandomTargets, pick: Pick) -> Values:
        """Return the keys of a material for each target."""
        names = targets.with_categories((*targets.objects, *targets.surfaces))
        drawn = self.drawn(self.of, names, pick)
        return {"materials": {name: {self.part: values} for name, values in drawn.items()}}
