"""Objects: which they are, whether they are there, how large, where and how they stand."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from sailenv_ros.scene.field_types import Number, Switch, Text, optional
from sailenv_ros.scene.fields import Position, Scale
from sailenv_ros.scene.randomise.drawn import Draw, Drawn
from sailenv_ros.scene.randomise.randomisation import (
    EpochRandomisation,
    Pick,
    RandomTargets,
    Values,
)
from sailenv_ros.scene.randomise.relative import DrawnNumber
from sailenv_ros.scene.randomise.selectors import WhichObjects

__all__ = ["RandomObject"]

_Asset = Annotated[str, Text(r"[^\x00-\x1f]{1,100}", "the name of an asset")]
_Degrees = Annotated[float, Number(least=-360.0, most=360.0, unit="deg")]
_Factor = Annotated[float, Number(least=1e-3, most=1e3)]
_Bool = Annotated[bool, Switch()]


class RandomObject(EpochRandomisation):
    """Objects of the scene; what stands on one goes with it."""

    KEY: ClassVar[str] = "objects"

    type: Literal["object"]
    of: WhichObjects = Field(description="names of objects; * and ?; or {category: chair}")
    asset: Annotated[Draw, Drawn(_Asset)] | None = optional("what it is: names of the catalogue")
    there: Annotated[Draw, Drawn(_Bool)] | None = optional(
        "false takes it out, with what stands on it"
    )
    scale: Annotated[Draw, DrawnNumber(_Factor, Scale, vector=True)] | None = optional(
        "instead of its scale: one factor for all axes"
    )
    offset: Annotated[Draw, Drawn(Position)] | None = optional(
        "from where the file puts it, in the world's axes [m]"
    )
    turn: Annotated[Draw, Drawn(_Degrees)] | None = optional(
        "about the vertical, counter-clockwise [deg]"
    )

    def values(self, targets: RandomTargets, pick: Pick) -> Values:
        """Return asset, there, scale, offset and turn for each object."""
        return {"objects": self.drawn(self.of, targets.with_categories(targets.objects), pick)}
