"""Numbers that are drawn relative to the scene's own value: ``{times: …}``, ``{add: …}``.

What stands below `times` or `add` is a number or a distribution of numbers, three for a vector.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated, Any

import numpy as np
from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import PydanticCustomError, core_schema

from sailenv_ros.scene.field_types import Number, field_error
from sailenv_ros.scene.messages import shown
from sailenv_ros.scene.randomise.distributions import TRIES
from sailenv_ros.scene.randomise.drawn import Draw, Drawn

__all__ = ["RELATIONS", "DrawnNumber", "RelativeDraw"]

RELATIONS: Mapping[str, Callable[[float, float], float]] = MappingProxyType(
    {"times": lambda own, amount: own * amount, "add": lambda own, amount: own + amount}
)
"""Ways to combine the scene's own number and a drawn amount, by their names in a file."""

_NUMBER = Number(least=-1e6, most=1e6)


class RelativeDraw(Draw):
    """A value that is drawn relative to another; `distribution` names the relation.

    What it keeps is the draw of the amount by which the own value is changed.
    """

    __slots__ = ()

    def sample_from(self, own: Any, generator: np.random.Generator) -> tuple[Any, Any]:
        """Draw an amount; return it, and the own value changed by it.

        Amounts are drawn again while the key does not accept what comes out, as of a normal
        distribution; after `TRIES` the own value stays, and the amount changes nothing.
        """
        change = RELATIONS[self.distribution]
        for _ in range(TRIES):
            amount = self.kept.sample(generator)
            result = _changed(own, amount, change)
            if self._is_accepted(result, like=own):
                return amount, result
        return (1.0 if self.distribution == "times" else 0.0), own

    def _is_accepted(self, result: Any, *, like: Any) -> bool:
        try:
            self.accept(list(result) if isinstance(like, tuple) else result)
        except PydanticCustomError:
            return False
        return True


class DrawnNumber(Drawn):
    """Lets a `Drawn` value pass, or one relative to the scene's own.

    Parameters
    ----------
    inner : type
        Of a single value: a number or a vector of numbers.
    own : type or None
        Of the scene's own value, where it differs; results are checked by it.
    vector : bool
        True where the own value has three numbers: the amount may have as many.
    """

    def __init__(self, inner: Any, own: Any = None, *, vector: bool = False) -> None:
        super().__init__(inner)
        self._own = Drawn(inner if own is None else own)
        self._amount = Drawn(Annotated[Any, _Amount(vector=vector)])

    def check(self, value: object) -> Draw:
        """Return what is to be drawn, or raise a `field_error`."""
        if not isinstance(value, Mapping) or len(value) != 1 or not set(value) <= set(RELATIONS):
            return super().check(value)
        ((relation, amount),) = value.items()
        try:
            kept = self._amount.check(amount)
        except PydanticCustomError as problem:
            raise field_error(f"is refused: {relation} {problem.message()}") from None
        return RelativeDraw(relation, kept, value, self._own.accept)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        described = super().__get_pydantic_json_schema__(schema, handler)
        amount = self._amount.__get_pydantic_json_schema__(schema, handler)
        described["anyOf"][-1]["properties"] |= {
            "times": {**amount, "description": "the scene's own value is multiplied by it"},
            "add": {**amount, "description": "is added to the scene's own value"},
        }
        return described


@dataclass(frozen=True, slots=True)
class _Amount:
    """One finite number; for a vector one for all, or three."""

    vector: bool

    def check(self, value: object) -> Any:
        if not isinstance(value, list | tuple):
            return _NUMBER.check(value)
        if not self.vector:
            raise field_error(f"must be a number, got {shown(value)}")
        if len(value) != len(("x", "y", "z")):
            raise field_error(f"must be one number or three, got {shown(value)}")
        return tuple(_NUMBER.check(one) for one in value)

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.check)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        number = _NUMBER.json_schema()
        three = {"type": "array", "items": number, "minItems": 3, "maxItems": 3}
        return {"anyOf": [number, three]} if self.vector else number


def _changed(own: Any, amount: Any, change: Callable[[float, float], float]) -> Any:
    """Return a number changed by a number, a vector by a number or by its own."""
    if not isinstance(own, tuple):
        return change(own, amount)
    amounts = amount if isinstance(amount, tuple) else (amount,) * len(own)
    return tuple(change(one, by) for one, by in zip(own, amounts, strict=True))
