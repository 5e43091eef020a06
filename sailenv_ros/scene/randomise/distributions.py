"""Distributions by name: each says what it takes, checks it, and draws a value.

A new distribution is one class here and its entry in `DISTRIBUTIONS`. Values are numbers, tuples of
numbers (drawn one by one), texts or truth values, as a scene file has them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Protocol

import numpy as np

from sailenv_ros.types.validation import is_finite_number, is_integer

__all__ = ["DISTRIBUTIONS", "Distribution"]

Accept = Callable[[object], Any]
"""Returns a value as the thing takes it, or raises a `field_error`."""

TRIES = 64
"""A normal value beyond what is accepted is drawn again so often; then it is the mean."""


class Distribution(Protocol):
    """One way to draw a value."""

    takes: str
    """The values that it accepts, in words."""

    def check(self, given: object, accept: Accept) -> Any:
        """Return what is kept of what was given; None if it is not what it takes."""

    def draw(self, kept: Any, generator: np.random.Generator, accept: Accept) -> Any:
        """Return a value."""

    def json_schema(self, value: Mapping[str, Any]) -> dict[str, Any]:
        """Describe what it takes, where `value` describes a single value."""


class Uniform:
    """Every value between two is as likely; of whole numbers both are among them."""

    takes = "[lowest, highest]"

    def check(self, given: object, accept: Accept) -> Any:
        """Return both ends; None unless they are numbers in their order."""
        ends = _pair(given, accept)
        if ends is None or any(low > high for low, high in zip(*map(_each, ends), strict=True)):
            return None
        return ends

    def draw(self, kept: Any, generator: np.random.Generator, accept: Accept) -> Any:
        """Return a value between the ends."""

        def one(low: float, high: float) -> float:
            if is_integer(low) and is_integer(high):
                return int(generator.integers(low, high, endpoint=True))
            return float(generator.uniform(low, high))

        return _like(kept[0], [one(*ends) for ends in zip(*map(_each, kept), strict=True)])

    def json_schema(self, value: Mapping[str, Any]) -> dict[str, Any]:
        """Describe two values."""
        return {"type": "array", "items": dict(value), "minItems": 2, "maxItems": 2}


class LogUniform(Uniform):
    """Every factor between two values is as likely; both above 0."""

    takes = "[lowest, highest], both above 0"

    def check(self, given: object, accept: Accept) -> Any:
        """Return both ends; None unless they are numbers above 0 in their order."""
        ends = super().check(given, accept)
        return None if ends is None or min(_each(ends[0])) <= 0.0 else ends

    def draw(self, kept: Any, generator: np.random.Generator, accept: Accept) -> Any:
        """Return a value between the ends."""
        logs = [[math.log(number) for number in _each(end)] for end in kept]
        drawn = [math.exp(generator.uniform(low, high)) for low, high in zip(*logs, strict=True)]
        low, high = (_each(end) for end in kept)
        within = [min(max(x, a), b) for x, a, b in zip(drawn, low, high, strict=True)]
        return _like(kept[0], within)


class Normal:
    """The normal distribution, without what the thing does not accept."""

    takes = "[mean, standard deviation]"

    def check(self, given: object, accept: Accept) -> Any:
        """Return the mean and the deviation of each of its numbers; None for anything else."""
        if not isinstance(given, list | tuple) or len(given) != 2:
            return None
        mean, spread = accept(given[0]), given[1]
        if not _is_numeric(mean):
            return None
        spreads = list(spread) if isinstance(spread, list | tuple) else [spread] * len(_each(mean))
        if len(spreads) != len(_each(mean)) or not all(map(is_finite_number, spreads)):
            return None
        return None if min(spreads) < 0 else (mean, tuple(float(one) for one in spreads))

    def draw(self, kept: Any, generator: np.random.Generator, accept: Accept) -> Any:
        """Return a value that is accepted."""
        mean, spreads = kept
        pairs = list(zip(_each(mean), spreads, strict=True))
        for _ in range(TRIES):
            drawn = [(m, float(generator.normal(m, spread))) for m, spread in pairs]
            value = _like(mean, [round(x) if is_integer(m) else x for m, x in drawn])
            try:
                accept(list(value) if isinstance(value, tuple) else value)
            except ValueError:
                continue
            return value
        return mean

    def json_schema(self, value: Mapping[str, Any]) -> dict[str, Any]:
        """Describe a value and how far it spreads."""
        spread = {"anyOf": [{"type": "number", "minimum": 0}, {"type": "array"}]}
        either = {"anyOf": [dict(value), spread]}
        return {"type": "array", "items": either, "minItems": 2, "maxItems": 2}


class OneOf:
    """One of some values; each as likely, or by its weight."""

    takes = "a list of values, or {of: [...], weights: [...]}"

    def check(self, given: object, accept: Accept) -> Any:
        """Return the values and their shares; None for anything else."""
        values, weights = given, None
        if isinstance(given, Mapping):
            if set(given) != {"of", "weights"}:
                return None
            values, weights = given["of"], given["weights"]
        if not isinstance(values, list | tuple) or not values:
            return None
        if weights is None:
            weights = [1.0] * len(values)
        if not isinstance(weights, list | tuple) or len(weights) != len(values):
            return None
        if not all(is_finite_number(w) and w >= 0 for w in weights) or sum(weights) <= 0:
            return None
        return tuple(accept(value) for value in values), tuple(float(w) for w in weights)

    def draw(self, kept: Any, generator: np.random.Generator, accept: Accept) -> Any:
        """Return one of the values."""
        values, weights = kept
        at = generator.uniform(0.0, sum(weights))
        for value, weight in zip(values, weights, strict=True):
            at -= weight
            if at < 0.0:
                return value
        return next(v for v, w in zip(values[::-1], weights[::-1], strict=True) if w > 0)

    def json_schema(self, value: Mapping[str, Any]) -> dict[str, Any]:
        """Describe the values."""
        listed = {"type": "array", "items": dict(value), "minItems": 1}
        weighted = {
            "type": "object",
            "properties": {
                "of": {**listed, "description": "the values"},
                "weights": {
                    "type": "array",
                    "items": {"type": "number", "minimum": 0},
                    "description": "how likely each is, against the others",
                },
            },
            "required": ["of", "weights"],
            "additionalProperties": False,
        }
        return {"anyOf": [listed, weighted]}


DISTRIBUTIONS: Mapping[str, Distribution] = MappingProxyType(
    {
        "uniform": Uniform(),
        "log_uniform": LogUniform(),
        "normal": Normal(),
        "choice": OneOf(),
    }
)
"""Every distribution by the name that it has in a scene file."""


def _pair(given: object, accept: Accept) -> Any:
    """Return two accepted values that are numbers; None for anything else."""
    if not isinstance(given, list | tuple) or len(given) != 2:
        return None
    ends = tuple(accept(end) for end in given)
    same = len(_each(ends[0])) == len(_each(ends[1]))
    return ends if same and all(map(_is_numeric, ends)) else None


def _is_numeric(value: Any) -> bool:
    return all(is_finite_number(number) for number in _each(value))


def _each(value: Any) -> tuple[Any, ...]:
    return value if isinstance(value, tuple) else (value,)


def _like(shape: Any, numbers: list[Any]) -> Any:
    return tuple(numbers) if isinstance(shape, tuple) else numbers[0]
