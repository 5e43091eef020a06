"""Surroundings of a room, seen through its windows and open doors."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import (
    Field,
    GetJsonSchemaHandler,
    ModelWrapValidatorHandler,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)
from pydantic_core import core_schema

from sailenv_ros.scene.field_types import Choice, Number
from sailenv_ros.scene.fields import SceneModel

__all__ = ["NO_OUTSIDE", "OUTSIDE", "OUTSIDE_KINDS", "OutsideSpec"]

OUTSIDE = "outside"
"""Name of the part of a room that it is, and of its category."""

NO_OUTSIDE = "none"

OUTSIDE_KINDS = (NO_OUTSIDE, "garden", "street")
"""Each but the first is a module in `assets/outside/kinds`."""


class OutsideSpec(SceneModel):
    """Surroundings of a room at their real size; a name alone stands for its kind."""

    kind: Annotated[str, Choice(OUTSIDE_KINDS)] = Field(
        default=NO_OUTSIDE,
        description="`street`: houses opposite the wall with the largest windows, gardens at the "
        "other sides; `garden`: lawn, hedges and trees all around; `none`: the sky alone",
    )
    seed: Annotated[int, Number(least=0, most=2**31 - 1, whole=True)] = Field(
        default=0, description="others give other houses, trees and colours"
    )

    @model_validator(mode="wrap")
    @classmethod
    def _by_name(cls, value: Any, handler: ModelWrapValidatorHandler[OutsideSpec]) -> OutsideSpec:
        # false is what is written where it was taken out of a room.
        value = NO_OUTSIDE if value is False else value
        return handler({"kind": value} if isinstance(value, str) else value)

    @model_serializer(mode="wrap", when_used="json")
    def _to_name(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any] | str:
        dumped: dict[str, Any] = handler(self)
        return dumped["kind"] if set(dumped) == {"kind"} else dumped

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        described = handler.resolve_ref_schema(handler(schema))
        described["type"] = ["object", "string"]
        return described
