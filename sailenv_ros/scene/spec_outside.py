"""Surroundings of a room, seen through its windows and open doors."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, model_validator

from sailenv_ros.scene.field_types import Choice, Number
from sailenv_ros.scene.fields import NamedModel

__all__ = ["NO_OUTSIDE", "OUTSIDE", "OUTSIDE_KINDS", "OutsideSpec"]

OUTSIDE = "outside"
"""Name of the part of a room that it is, and of its category."""

NO_OUTSIDE = "none"

OUTSIDE_KINDS = (NO_OUTSIDE, "garden", "street")
"""Each but the first is a module in `assets/outside/kinds`."""


class OutsideSpec(NamedModel):
    """Surroundings of a room at their real size; a name alone stands for its kind."""

    key = "kind"

    kind: Annotated[str, Choice(OUTSIDE_KINDS)] = Field(
        default=NO_OUTSIDE,
        description="`street`: houses opposite the wall with the largest windows, gardens at the "
        "other sides; `garden`: lawn, hedges and trees all around; `none`: the sky alone",
    )
    seed: Annotated[int, Number(least=0, most=2**31 - 1, whole=True)] = Field(
        default=0, description="others give other houses, trees and colours"
    )

    @model_validator(mode="before")
    @classmethod
    def _none_for_false(cls, value: Any) -> Any:
        # false is what is written where it was taken out of a room.
        return {"kind": NO_OUTSIDE} if value is False else value
