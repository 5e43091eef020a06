"""Fields and rules that several models of sensor files share."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, TypeAlias

from sailenv_ros.scene.field_types import Number
from sailenv_ros.scene.fields import Rule

__all__ = ["Metres", "ascending"]

Metres: TypeAlias = Annotated[float, Number(least=0.0, most=100.0, unit="m")]


def ascending(low: str, high: str) -> Rule:
    """Return the rule that one number of an entry is less than another."""

    def rule(entry: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
        least, most = entry.get(low), entry.get(high)
        if isinstance(least, int | float) and isinstance(most, int | float) and least >= most:
            yield (low,), f"must be less than {high} = {most:g}, got {least:g}"

    return rule
