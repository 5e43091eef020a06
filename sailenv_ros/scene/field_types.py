"""Field types of a scene file: numbers with bounds, lists, colours, switches, texts.

Each is an annotation for a model's field: it checks a value, says in one plain sentence what it
accepts, and describes itself to JSON Schema. They know no particular scene entry.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, fields
from typing import Any

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import PydanticCustomError, core_schema

from sailenv_ros.scene.messages import nearest, shown
from sailenv_ros.types.colour import hex_from_linear, linear_from_hex
from sailenv_ros.types.validation import Bounds, is_number, shown_number

__all__ = [
    "FIELD_ERROR",
    "Choice",
    "Colour",
    "FieldType",
    "Number",
    "Vector",
    "Switch",
    "Text",
    "field_error",
    "optional",
]

FIELD_ERROR = "scene_error"
"""Pydantic's type of the errors whose message is a finished sentence of ours."""


def optional(description: str) -> Any:
    """Return a field that may be left out, and is None then."""
    return Field(default=None, description=description)


def field_error(sentence: str) -> PydanticCustomError:
    """Make a pydantic error that carries a finished sentence."""
    return PydanticCustomError(FIELD_ERROR, "{sentence}", {"sentence": sentence})


class FieldType:
    """Lets pydantic use `check` instead of its own validation."""

    __slots__ = ()

    def check(self, value: object) -> object:
        """Return the value as it is kept, or raise a `field_error`."""
        raise NotImplementedError

    def json_schema(self) -> dict[str, Any]:
        """Describe it to JSON Schema."""
        raise NotImplementedError

    def written(self, value: Any) -> Any:
        """Return a value as a file has it, in the shortest form that `check` reads as the same."""
        return value

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        writing = core_schema.plain_serializer_function_ser_schema(
            self.written, when_used="json-unless-none"
        )
        return core_schema.no_info_plain_validator_function(self.check, serialization=writing)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return self.json_schema()


@dataclass(frozen=True, slots=True, kw_only=True)
class Number(Bounds, FieldType):
    """A finite number within bounds; for ``Annotated[float, Number(...)]``.

    Attributes
    ----------
    hint : str
        Added to the sentence of a refusal.
    """

    hint: str = ""

    @classmethod
    def within(cls, bounds: Bounds) -> Number:
        """Return the field of a number that a data class has these bounds for."""
        return cls(**{each.name: getattr(bounds, each.name) for each in fields(Bounds)})

    def check(self, value: object) -> float | int:
        """Return the number, or raise a `field_error`."""
        accepted = self.refused(value)
        if accepted or not is_number(value):
            hint = f" {self.hint}" if self.hint and is_number(value) else ""
            raise field_error(f"must be {accepted}, got {shown(value)}{hint}")
        return value if self.whole else float(value)

    def json_schema(self) -> dict[str, Any]:
        """Describe it to JSON Schema."""
        bounds = {
            "exclusiveMinimum": self.above,
            "minimum": self.least,
            "maximum": self.most,
        }
        described: dict[str, Any] = {"type": "integer" if self.whole else "number"}
        described.update({key: bound for key, bound in bounds.items() if bound is not None})
        return described


@dataclass(frozen=True, slots=True)
class Vector:
    """Checks that a value is a list of so many entries; the entries check themselves.

    Attributes
    ----------
    count : int
    what : str
        E.g. ``"three numbers [x, y, z] in [m]"``.
    one_for_all : bool
        True if a single number stands for `count` equal ones.
    """

    count: int
    what: str
    one_for_all: bool = False

    def check(self, value: object) -> object:
        """Return a tuple of `count` unchecked entries, or raise a `field_error`."""
        if self.one_for_all and is_number(value):
            return (value,) * self.count
        if not isinstance(value, list | tuple) or len(value) != self.count:
            raise field_error(f"must be {self.what}, got {shown(value)}")
        return tuple(value)

    def written(self, value: tuple[Any, ...]) -> Any:
        """Return the entries as a file has them; equal ones as one where that is accepted."""
        return value[0] if self.one_for_all and len(set(value)) == 1 else list(value)

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        writing = core_schema.plain_serializer_function_ser_schema(
            self.written, when_used="json-unless-none"
        )
        return core_schema.no_info_before_validator_function(
            self.check, handler(source), serialization=writing
        )

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        # Drafts of JSON Schema spell tuples differently; equal entries need no tuple.
        entry = handler(schema)["prefixItems"][0]
        listed = {"type": "array", "items": entry, "minItems": self.count, "maxItems": self.count}
        return {"anyOf": [entry, listed]} if self.one_for_all else listed


@dataclass(frozen=True, slots=True)
class Colour(FieldType):
    """A colour: ``#rrggbb`` in sRGB, or three linear numbers up to `most`; kept linear."""

    most: float = 1.0

    @property
    def accepted(self) -> str:
        """The accepted values, in words."""
        return (
            "a colour such as '#ff8800' (quoted, sRGB) or [r, g, b] of linear numbers "
            f"from 0 to {shown_number(self.most)}"
        )

    def check(self, value: object) -> tuple[float, float, float]:
        """Return linear red, green, blue, or raise a `field_error`."""
        if isinstance(value, str) and re.fullmatch(r"#[0-9a-fA-F]{6}", value):
            return linear_from_hex(value)
        number = Number(least=0.0, most=self.most)
        try:
            if isinstance(value, list | tuple) and len(value) == 3:
                red, green, blue = (float(number.check(entry)) for entry in value)
                return red, green, blue
        except PydanticCustomError:
            pass
        hint = "; an unquoted # begins a comment in YAML" if value is None else ""
        raise field_error(f"must be {self.accepted}, got {shown(value)}{hint}")

    def written(self, value: Any) -> Any:
        """Return ``#rrggbb`` where it stands for exactly these numbers, else the numbers."""
        if max(value) > 1.0:
            return list(value)
        encoded = hex_from_linear(value)
        return encoded if linear_from_hex(encoded) == tuple(value) else list(value)

    def json_schema(self) -> dict[str, Any]:
        """Describe it to JSON Schema."""
        number = {"type": "number", "minimum": 0, "maximum": self.most}
        linear = {"type": "array", "items": number, "minItems": 3, "maxItems": 3}
        return {"anyOf": [{"type": "string", "pattern": "^#[0-9a-fA-F]{6}$"}, linear]}


@dataclass(frozen=True, slots=True)
class Switch(FieldType):
    """True or false, and nothing that only resembles them."""

    def check(self, value: object) -> bool:
        """Return the value, or raise a `field_error`."""
        if not isinstance(value, bool):
            raise field_error(f"must be true or false, got {shown(value)}")
        return value

    def json_schema(self) -> dict[str, Any]:
        """Describe it to JSON Schema."""
        return {"type": "boolean"}


@dataclass(frozen=True, slots=True)
class Text(FieldType):
    """A text that matches a pattern.

    Attributes
    ----------
    pattern : str
        A regular expression that both Python and JSON Schema understand, without anchors.
    accepted : str
        The pattern in words.
    """

    pattern: str
    accepted: str

    def check(self, value: object) -> str:
        """Return the text, or raise a `field_error`."""
        if not isinstance(value, str) or not re.fullmatch(self.pattern, value):
            raise field_error(f"must be {self.accepted}, got {shown(value)}")
        return value

    def json_schema(self) -> dict[str, Any]:
        """Describe it to JSON Schema."""
        return {"type": "string", "pattern": f"^(?:{self.pattern})$"}


@dataclass(frozen=True, slots=True)
class Choice(FieldType):
    """One of some words."""

    options: tuple[str, ...]

    def check(self, value: object) -> str:
        """Return the word, or raise a `field_error`."""
        if isinstance(value, str) and value in self.options:
            return value
        near = nearest(value, self.options) if isinstance(value, str) else None
        hint = f" (did you mean {near!r}?)" if near else ""
        raise field_error(f"must be one of: {', '.join(self.options)}{hint}, got {shown(value)}")

    def json_schema(self) -> dict[str, Any]:
        """Describe it to JSON Schema."""
        return {"enum": list(self.options)}
