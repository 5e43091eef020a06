"""Parameters of a style: which values there are, and how a seed draws one of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np

from sailenv_ros.errors import AssetError

__all__ = ["Choice", "Parameter", "Span", "Values", "Whole", "drawn"]


@dataclass(frozen=True, slots=True)
class Span:
    """A number, any between two with equal chance, rounded to a millimetre or a thousandth."""

    least: float
    most: float

    def problem(self) -> str:
        """Return what is impossible about it; empty if nothing is."""
        if not (math.isfinite(self.least) and math.isfinite(self.most)):
            return f"its limits must be finite numbers, got {self.least} and {self.most}"
        if self.least > self.most:
            return f"its least value {self.least} is above its greatest, {self.most}"
        return ""

    def draw(self, rng: np.random.Generator) -> float:
        """Draw a value."""
        return round(float(rng.uniform(self.least, self.most)), 3)


@dataclass(frozen=True, slots=True)
class Whole:
    """A whole number, each between two with equal chance."""

    least: int
    most: int

    def problem(self) -> str:
        """Return what is impossible about it; empty if nothing is."""
        if self.least > self.most:
            return f"its least value {self.least} is above its greatest, {self.most}"
        return ""

    def draw(self, rng: np.random.Generator) -> int:
        """Draw a value."""
        return int(rng.integers(self.least, self.most + 1))


class Choice:
    """One of some values, each with equal chance."""

    def __init__(self, *values: Any) -> None:
        self.values = values

    def problem(self) -> str:
        """Return what is impossible about it; empty if nothing is."""
        return "" if self.values else "it has no value to choose from"

    def draw(self, rng: np.random.Generator) -> Any:
        """Draw a value."""
        return self.values[int(rng.integers(len(self.values)))]


Parameter: TypeAlias = Span | Whole | Choice


class Values:
    """Drawn values, as attributes of the parameters' names."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self.all = MappingProxyType(dict(values))

    def __getattr__(self, name: str) -> Any:
        """Return the value of a parameter."""
        try:
            return self.all[name]
        except KeyError:
            raise AttributeError(name) from None


def drawn(owner: str, parameters: Mapping[str, Any], rng: np.random.Generator) -> Values:
    """Draw a value for each parameter, in their order; what is no `Parameter` stands for itself.

    Raises
    ------
    AssetError
        If a parameter is impossible; `owner` is named.
    """
    for name, parameter in parameters.items():
        problem = parameter.problem() if isinstance(parameter, Span | Whole | Choice) else ""
        if problem:
            raise AssetError(owner, f"its parameter {name!r} is impossible: {problem}")
    return Values(
        {
            name: parameter.draw(rng) if isinstance(parameter, Span | Whole | Choice) else parameter
            for name, parameter in parameters.items()
        }
    )
