"""A field of a scene file that holds a value or a distribution of values.

``Annotated[Draw, Drawn(Fraction)]`` checks with the sentences of the field type inside.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, TypeAdapter, ValidationError
from pydantic_core import PydanticCustomError, core_schema

from sailenv_ros.scene.field_types import field_error
from sailenv_ros.scene.messages import shown, suggestion
from sailenv_ros.scene.randomise.distributions import DISTRIBUTIONS

__all__ = ["Draw", "Drawn"]


@dataclass(frozen=True, slots=True)
class Draw:
    """A value to be drawn.

    Attributes
    ----------
    distribution : str
        Its name; empty for a value that is always the same.
    kept : object
        What the distribution was given, checked; the value.
    given : object
        The same as a file has it.
    accept : callable
        Checks a value.
    """

    distribution: str
    kept: Any
    given: Any
    accept: Any

    def sample(self, generator: np.random.Generator) -> Any:
        """Return a value; tuples of numbers, numbers, texts or truth values."""
        if not self.distribution:
            return self.kept
        return DISTRIBUTIONS[self.distribution].draw(self.kept, generator, self.accept)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Draw):
            return NotImplemented
        return (self.distribution, self.kept) == (other.distribution, other.kept)

    def __hash__(self) -> int:
        return hash((self.distribution, self.kept))


class Drawn:
    """Lets a value or a mapping with one distribution pass; for ``Annotated[Draw, Drawn(...)]``.

    Parameters
    ----------
    inner : type
        Of a single value, with its annotation.
    """

    def __init__(self, inner: Any) -> None:
        self._adapter: TypeAdapter[Any] = TypeAdapter(inner)

    def check(self, value: object) -> Draw:
        """Return what is to be drawn, or raise a `field_error`."""
        if isinstance(value, Draw):
            return value
        if not isinstance(value, Mapping):
            return Draw("", self.accept(value), value, self.accept)
        names = ", ".join(DISTRIBUTIONS)
        if len(value) != 1:
            raise field_error(
                f"must be a value, or a mapping with one distribution ({names}), got {shown(value)}"
            )
        ((name, given),) = value.items()
        if name not in DISTRIBUTIONS:
            near = suggestion(str(name), DISTRIBUTIONS)
            raise field_error(f"must be a value or a distribution, got {shown(name)}; {near}")
        kind = DISTRIBUTIONS[name]
        try:
            kept = kind.check(given, self.accept)
        except PydanticCustomError as problem:
            raise field_error(f"is refused: each value of {name} {problem.message()}") from None
        if kept is None:
            raise field_error(f"must give {name} {kind.takes}, got {shown(given)}")
        return Draw(name, kept, value, self.accept)

    def accept(self, value: object) -> Any:
        """Return a single value as it is kept, or raise a `field_error`."""
        try:
            return self._adapter.validate_python(value)
        except ValidationError as problem:
            first = problem.errors(include_url=False)[0]
            sentence = first.get("ctx", {}).get("sentence", first["msg"])
            raise field_error(str(sentence)) from None

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        writing = core_schema.plain_serializer_function_ser_schema(
            lambda draw: draw.given, when_used="json-unless-none"
        )
        return core_schema.no_info_plain_validator_function(self.check, serialization=writing)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        value = self._adapter.json_schema()
        kinds = {
            name: {**kind.json_schema(value), "description": kind.takes}
            for name, kind in DISTRIBUTIONS.items()
        }
        mapping = {
            "type": "object",
            "properties": kinds,
            "minProperties": 1,
            "maxProperties": 1,
            "additionalProperties": False,
        }
        return {"anyOf": [value, mapping]}
