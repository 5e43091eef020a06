"""Selectors: how an entry says which objects it is about, by names, patterns or categories.

``chair 1``, ``"chair *"``, ``{category: couch}``, ``{category: [couch, chair]}``, or a list of
these.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Annotated, Any, TypeAlias

from sailenv_ros.scene.field_types import FieldType, Text, field_error
from sailenv_ros.scene.messages import shown

__all__ = ["OfCategory", "Selector", "Which", "WhichObjects", "is_meant", "selectors_in"]


@dataclass(frozen=True, slots=True)
class OfCategory:
    """All objects of a category."""

    category: str

    def __str__(self) -> str:
        return f"category {self.category}"


Selector: TypeAlias = str | OfCategory
"""A name or a pattern with * and ?, or a category."""


def is_meant(selector: Selector, name: str, category: str = "") -> bool:
    """Return whether a selector means what has that name, and that category if it is known."""
    if isinstance(selector, OfCategory):
        return selector.category == category
    return name == selector or fnmatchcase(name, selector)


def selectors_in(value: object) -> list[Selector]:
    """Return the selectors of plain data that may be wrong; what is none is left out."""
    found: list[Selector] = []
    for one in value if isinstance(value, list | tuple) else [value]:
        if isinstance(one, str | OfCategory):
            found.append(one)
        elif isinstance(one, Mapping) and set(one) == {"category"}:
            named = one["category"]
            listed = named if isinstance(named, list | tuple) else [named]
            found += [OfCategory(each) for each in listed if isinstance(each, str)]
    return found


class _Selectors(FieldType):
    """One selector or several; kept as a tuple."""

    _text = Text(r"[^\x00-\x1f]{1,100}", "a name, or a pattern with * and ?")
    _category = Text(r"[^\x00-\x1f]{1,100}", "the name of a category")

    def __init__(self, *, by_category: bool) -> None:
        self._by_category = by_category

    def check(self, value: object) -> tuple[Selector, ...]:
        given = value if isinstance(value, list | tuple) else [value]
        if not given or (isinstance(value, Mapping) and not self._by_category):
            raise field_error(f"must be a name or a list of names, got {shown(value)}")
        return tuple(selector for one in given for selector in self._checked(one))

    def _checked(self, one: object) -> Iterable[Selector]:
        if isinstance(one, OfCategory) and self._by_category:
            return (one,)
        if not isinstance(one, Mapping) or not self._by_category:
            return (self._text.check(one),)
        if set(one) != {"category"}:
            raise field_error(f"must be a name, a pattern or {{category: name}}, got {shown(one)}")
        named = one["category"]
        listed = named if isinstance(named, list | tuple) else [named]
        if not listed:
            raise field_error("must name a category, got an empty list")
        return [OfCategory(self._category.check(each)) for each in listed]

    def written(self, selectors: tuple[Selector, ...]) -> Any:
        """Return selectors as a file has them."""
        plain = [
            {"category": one.category} if isinstance(one, OfCategory) else one for one in selectors
        ]
        return plain[0] if len(plain) == 1 else plain

    def json_schema(self) -> dict[str, Any]:
        """Describe them to JSON Schema."""
        text = self._text.json_schema()
        one: dict[str, Any] = text
        if self._by_category:
            several = {"type": "array", "items": text, "minItems": 1}
            category = {
                "type": "object",
                "properties": {
                    "category": {"anyOf": [text, several], "description": "all objects of it"}
                },
                "required": ["category"],
                "additionalProperties": False,
            }
            one = {"anyOf": [text, category]}
        return {"anyOf": [one, {"type": "array", "items": one, "minItems": 1}]}


Which: TypeAlias = Annotated[tuple[str, ...], _Selectors(by_category=False)]
WhichObjects: TypeAlias = Annotated[tuple[Selector, ...], _Selectors(by_category=True)]
