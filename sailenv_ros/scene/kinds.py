"""Kinds of values in a scene file: numbers with bounds, lists, colours, switches, texts.

Each is an annotation for a model's field: it checks a value, says in one plain sentence what it
accepts, and describes itself to JSON Schema. They know no particular scene entry.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import PydanticCustomError, core_schema

from sailenv_ros.scene.wording import nearest, shown, shown_number

__all__ = [
    "FAULT",
    "Choice",
    "Colour",
    "Number",
    "Several",
    "Switch",
    "Text",
    "fault",
    "linear_from_srgb",
]

FAULT = "scene_fault"
"""Pydantic's type of the errors whose message is a finished sentence of ours."""


def fault(sentence: str) -> PydanticCustomError:
    """Make a pydantic error that carries a finished sentence."""
    return PydanticCustomError(FAULT, "{sentence}", {"sentence": sentence})


class _Kind:
    """Lets pydantic use `check` instead of its own validation."""

    __slots__ = ()

    def check(self, value: object) -> object:
        """Return the value as it is kept, or raise a `fault`."""
        raise NotImplementedError

    def json_schema(self) -> dict[str, Any]:
        """Describe it to JSON Schema."""
        raise NotImplementedError

    def written(self, value: Any) -> Any:
        """Give a value as a file has it, in the shortest form that `check` reads as the same."""
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
class Number(_Kind):
    """A finite number within bounds; for ``Annotated[float, Number(...)]``.

    Attributes
    ----------
    above : float or None
        Exclusive lower bound.
    least, most : float or None
        Inclusive bounds.
    unit : str
        Shown in brackets; empty for pure numbers.
    whole : bool
        True if only integers are accepted.
    hint : str
        Added to the sentence of a refusal.
    """

    above: float | None = None
    least: float | None = None
    most: float | None = None
    unit: str = ""
    whole: bool = False
    hint: str = ""

    @property
    def accepted(self) -> str:
        """All that is accepted, e.g. ``"a number above 0 and at most 100 [kg]"``."""
        return self._phrase(self._low(), self.most)

    def check(self, value: object) -> float | int:
        """Return the number, or raise a `fault`."""
        if (
            isinstance(value, bool)
            or not isinstance(value, int | float)
            or (self.whole and not isinstance(value, int))
        ):
            raise fault(f"must be {self.accepted}, got {shown(value)}")
        try:
            number = value if self.whole else float(value)
        except OverflowError:
            number = math.inf
        accepted = self._missed(number)
        if accepted:
            hint = f" {self.hint}" if self.hint else ""
            raise fault(f"must be {accepted}, got {shown(value)}{hint}")
        return number

    def _missed(self, number: float | int) -> str:
        """Say what the number should have been; nothing if it is accepted."""
        if not math.isfinite(number):
            return self.accepted
        if (self.above is not None and number <= self.above) or (
            self.least is not None and number < self.least
        ):
            # Only the bound that was missed is told, where it is not one of a close pair.
            return self._phrase(self._low(), None) if self.least is None else self.accepted
        return self.accepted if self.most is not None and number > self.most else ""

    def _low(self) -> float | None:
        return self.least if self.above is None else self.above

    def _phrase(self, low: float | None, most: float | None) -> str:
        noun = "an integer" if self.whole else "a number"
        unit = f" [{self.unit}]" if self.unit else ""
        if low is not None and low == most:
            return f"{shown_number(low)}{unit}"
        if low is None:
            bounds = "" if most is None else f" of at most {shown_number(most)}"
        elif self.above is not None:
            bounds = f" above {shown_number(low)}"
            bounds += "" if most is None else f" and at most {shown_number(most)}"
        else:
            bounds = f" from {shown_number(low)}"
            bounds += " up" if most is None else f" to {shown_number(most)}"
        return f"{noun}{bounds}{unit}"

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
class Several:
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
        """Return a tuple of `count` unchecked entries, or raise a `fault`."""
        if self.one_for_all and isinstance(value, int | float) and not isinstance(value, bool):
            return (value,) * self.count
        if not isinstance(value, list | tuple) or len(value) != self.count:
            raise fault(f"must be {self.what}, got {shown(value)}")
        return tuple(value)

    def written(self, value: tuple[Any, ...]) -> Any:
        """Give the entries as a file has them; equal ones as one where that is accepted."""
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
class Colour(_Kind):
    """A colour: ``#rrggbb`` in sRGB, or three linear numbers up to `most`; kept linear."""

    most: float = 1.0

    @property
    def accepted(self) -> str:
        """What is accepted."""
        return (
            "a colour such as '#ff8800' (quoted, sRGB) or [r, g, b] of linear numbers "
            f"from 0 to {shown_number(self.most)}"
        )

    def check(self, value: object) -> tuple[float, float, float]:
        """Return linear red, green, blue, or raise a `fault`."""
        if isinstance(value, str) and re.fullmatch(r"#[0-9a-fA-F]{6}", value):
            return linear_from_srgb(value)
        number = Number(least=0.0, most=self.most)
        try:
            if isinstance(value, list | tuple) and len(value) == 3:
                red, green, blue = (float(number.check(entry)) for entry in value)
                return red, green, blue
        except PydanticCustomError:
            pass
        hint = "; an unquoted # begins a comment in YAML" if value is None else ""
        raise fault(f"must be {self.accepted}, got {shown(value)}{hint}")

    def written(self, value: Any) -> Any:
        """Give ``#rrggbb`` where it stands for exactly these numbers, else the numbers."""
        if max(value) > 1.0:
            return list(value)
        encoded = "#" + "".join(f"{round(255 * _encoded(part)):02x}" for part in value)
        return encoded if linear_from_srgb(encoded) == tuple(value) else list(value)

    def json_schema(self) -> dict[str, Any]:
        """Describe it to JSON Schema."""
        number = {"type": "number", "minimum": 0, "maximum": self.most}
        linear = {"type": "array", "items": number, "minItems": 3, "maxItems": 3}
        return {"anyOf": [{"type": "string", "pattern": "^#[0-9a-fA-F]{6}$"}, linear]}


@dataclass(frozen=True, slots=True)
class Switch(_Kind):
    """True or false, and nothing that only resembles them."""

    def check(self, value: object) -> bool:
        """Return the value, or raise a `fault`."""
        if not isinstance(value, bool):
            raise fault(f"must be true or false, got {shown(value)}")
        return value

    def json_schema(self) -> dict[str, Any]:
        """Describe it to JSON Schema."""
        return {"type": "boolean"}


@dataclass(frozen=True, slots=True)
class Text(_Kind):
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
        """Return the text, or raise a `fault`."""
        if not isinstance(value, str) or not re.fullmatch(self.pattern, value):
            raise fault(f"must be {self.accepted}, got {shown(value)}")
        return value

    def json_schema(self) -> dict[str, Any]:
        """Describe it to JSON Schema."""
        return {"type": "string", "pattern": f"^(?:{self.pattern})$"}


@dataclass(frozen=True, slots=True)
class Choice(_Kind):
    """One of some words."""

    options: tuple[str, ...]

    def check(self, value: object) -> str:
        """Return the word, or raise a `fault`."""
        if isinstance(value, str) and value in self.options:
            return value
        near = nearest(value, self.options) if isinstance(value, str) else None
        hint = f" (did you mean {near!r}?)" if near else ""
        raise fault(f"must be one of: {', '.join(self.options)}{hint}, got {shown(value)}")

    def json_schema(self) -> dict[str, Any]:
        """Describe it to JSON Schema."""
        return {"enum": list(self.options)}


def linear_from_srgb(colour: str) -> tuple[float, float, float]:
    """Turn ``#rrggbb`` into linear red, green, blue, 0 to 1 (IEC 61966-2-1)."""
    red, green, blue = (int(colour[start : start + 2], 16) / 255.0 for start in (1, 3, 5))
    return _linear(red), _linear(green), _linear(blue)


def _linear(encoded: float) -> float:
    if encoded <= 0.04045:
        return encoded / 12.92
    return float(((encoded + 0.055) / 1.055) ** 2.4)


def _encoded(linear: float) -> float:
    if linear <= 0.0031308:
        return 12.92 * linear
    return float(1.055 * linear ** (1.0 / 2.4) - 0.055)
