"""The base of all scene models, and the types of their fields with bounds and units.

Builds on `field_types`; knows no particular scene entry.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Annotated, Any, ClassVar, Self, TypeAlias

from pydantic import (
    BaseModel,
    ConfigDict,
    GetJsonSchemaHandler,
    ModelWrapValidatorHandler,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)
from pydantic_core import PydanticCustomError, core_schema

from sailenv_ros.scene.field_types import Colour, Number, Text, Vector
from sailenv_ros.types.lights import MAX_RADIANCE

__all__ = [
    "BROKEN_RULE",
    "Acceleration",
    "DegreesPerSecond",
    "Direction",
    "Force",
    "Fraction",
    "Heights",
    "JointCoordinate",
    "JointLimits",
    "LinearColour",
    "MetresPerSecond",
    "Name",
    "NamedModel",
    "Orientation",
    "Position",
    "Radiance",
    "Rotation",
    "Rule",
    "Scale",
    "SceneModel",
    "Torque",
]

BROKEN_RULE = "scene_rule"
"""Pydantic's type of the errors that come of a model's `rules`."""


Rule: TypeAlias = Callable[[Mapping[str, Any]], Iterator[tuple[tuple[str | int, ...], str]]]
"""Yields what is wrong between the keys of one entry, however wrong the values are themselves.

Takes the entry as plain data, yields places inside it with finished sentences.
"""


class SceneModel(BaseModel):
    """Base of all entries of a scene file: no unknown keys, immutable, finite numbers.

    `rules` are what must hold between the keys of an entry. They see plain data, so that the
    loader can report them beside the errors of single values.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)

    rules: ClassVar[tuple[Rule, ...]] = ()

    @model_validator(mode="after")
    def _obey_rules(self) -> SceneModel:
        entry = self.model_dump(exclude_unset=True)
        for rule in type(self).rules:
            for place, sentence in rule(entry):
                raise PydanticCustomError(
                    BROKEN_RULE,
                    "{field} {sentence}",
                    {"field": ".".join(map(str, place)), "sentence": sentence},
                )
        return self


class NamedModel(SceneModel):
    """An entry that a name alone stands for: the value of its field `key`, all else as it is."""

    key: ClassVar[str]

    @model_validator(mode="wrap")
    @classmethod
    def _by_name(cls, value: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        return handler({cls.key: value} if isinstance(value, str) else value)

    @model_serializer(mode="wrap", when_used="json")
    def _to_name(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any] | str:
        dumped: dict[str, Any] = handler(self)
        return dumped[self.key] if set(dumped) == {self.key} else dumped

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        described = handler.resolve_ref_schema(handler(schema))
        described["type"] = ["object", "string"]
        return described


LinearColour: TypeAlias = Annotated[tuple[float, float, float], Colour()]
Radiance: TypeAlias = Annotated[tuple[float, float, float], Colour(most=MAX_RADIANCE)]
Fraction: TypeAlias = Annotated[float, Number(least=0.0, most=1.0)]

Name: TypeAlias = Annotated[
    str,
    Text(
        r"[A-Za-z0-9][A-Za-z0-9 _.-]{0,62}",
        "a name of letters, digits, spaces, '_', '-' or '.', at most 63 characters",
    ),
]

_Metres = Annotated[float, Number(least=-1e4, most=1e4, unit="m")]
_Degrees = Annotated[float, Number(least=-1e6, most=1e6, unit="deg")]
_Unitless = Annotated[float, Number(least=-1e6, most=1e6)]
_Factor = Annotated[float, Number(least=1e-3, most=1e3)]
_Speed = Annotated[float, Number(least=-1e3, most=1e3, unit="m/s")]
_Acceleration = Annotated[float, Number(least=-1e3, most=1e3, unit="m/s2")]
_Newtons = Annotated[float, Number(least=-1e6, most=1e6, unit="N")]
_NewtonMetres = Annotated[float, Number(least=-1e6, most=1e6, unit="N m")]
_Turn = Annotated[float, Number(least=-1e5, most=1e5, unit="deg/s")]

Position: TypeAlias = Annotated[
    tuple[_Metres, _Metres, _Metres], Vector(3, "three numbers [x, y, z] in [m]")
]
Rotation: TypeAlias = Annotated[
    tuple[_Degrees, _Degrees, _Degrees], Vector(3, "three numbers [roll, pitch, yaw] in [deg]")
]
Orientation: TypeAlias = Annotated[
    tuple[_Unitless, _Unitless, _Unitless, _Unitless], Vector(4, "four numbers [x, y, z, w]")
]
Direction: TypeAlias = Annotated[
    tuple[_Unitless, _Unitless, _Unitless], Vector(3, "three numbers [x, y, z], not all 0")
]
Scale: TypeAlias = Annotated[
    tuple[_Factor, _Factor, _Factor],
    Vector(3, "one number, or three [x, y, z], from 0.001 to 1000", one_for_all=True),
]
Acceleration: TypeAlias = Annotated[
    tuple[_Acceleration, _Acceleration, _Acceleration],
    Vector(3, "three numbers [x, y, z] in [m/s2]"),
]
MetresPerSecond: TypeAlias = Annotated[
    tuple[_Speed, _Speed, _Speed], Vector(3, "three numbers [x, y, z] in [m/s]")
]
Force: TypeAlias = Annotated[
    tuple[_Newtons, _Newtons, _Newtons], Vector(3, "three numbers [x, y, z] in [N]")
]
Torque: TypeAlias = Annotated[
    tuple[_NewtonMetres, _NewtonMetres, _NewtonMetres],
    Vector(3, "three numbers [x, y, z] in [N m]"),
]
DegreesPerSecond: TypeAlias = Annotated[
    tuple[_Turn, _Turn, _Turn], Vector(3, "three numbers [x, y, z] in [deg/s]")
]
Heights: TypeAlias = Annotated[
    tuple[_Metres, _Metres], Vector(2, "two numbers [least, most] in [m]")
]
JointCoordinate: TypeAlias = Annotated[float, Number(least=-1e4, most=1e4)]
JointLimits: TypeAlias = Annotated[
    tuple[JointCoordinate, JointCoordinate], Vector(2, "two numbers [low, high] in [rad] or [m]")
]
