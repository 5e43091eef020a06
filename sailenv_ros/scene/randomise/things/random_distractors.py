"""Distractors: objects that float in a box and belong to nothing (Tobin et al. 2017)."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from sailenv_ros.scene.field_types import Number, Text, Vector, optional
from sailenv_ros.scene.fields import LinearColour, Position, Rule
from sailenv_ros.scene.randomise.drawn import Draw, Drawn
from sailenv_ros.scene.randomise.random_rules import box_in_order
from sailenv_ros.scene.randomise.randomisation import (
    MOST_ADDED,
    EpochRandomisation,
    Pick,
    RandomTargets,
    Values,
)

__all__ = ["RandomDistractors"]

_Asset = Annotated[str, Text(r"[^\x00-\x1f]{1,100}", "the name of an asset")]
_Count = Annotated[int, Number(least=0, most=MOST_ADDED, whole=True)]
_Factor = Annotated[float, Number(least=1e-3, most=1e3)]
_Share = Annotated[float, Number(least=0.0, most=1.0)]


class RandomDistractors(EpochRandomisation):
    """Objects in the air, turned in any way."""

    KEY: ClassVar[str] = "added"

    rules: ClassVar[tuple[Rule, ...]] = (box_in_order,)

    type: Literal["distractors"]
    assets: tuple[_Asset, ...] = Field(
        min_length=1, max_length=1000, description="what they may be: names of the catalogue"
    )
    count: Annotated[Draw, Drawn(_Count)] = Field(description="how many there are, 0 to 200")
    within: Annotated[
        tuple[Position, Position], Vector(2, "two corners [lowest, highest] of a box in [m]")
    ] = Field(description="lowest and highest corner of the box that they float in [m]")
    scale: Annotated[Draw, Drawn(_Factor)] | None = optional("one factor for all axes")
    colour: Annotated[Draw, Drawn(LinearColour)] | None = optional(
        "paints each of them; drawn in linear numbers"
    )

    def may_add(self) -> tuple[str, ...]:
        """Return the names of the assets that may come to the scene by it."""
        return self.assets

    def values(self, targets: RandomTargets, pick: Pick) -> Values:
        """Return entries of objects as a scene file has them."""
        one = Drawn(_Share).check({"uniform": [0.0, 1.0]})
        which = Drawn(_Asset).check({"choice": list(self.assets)})
        added = []
        for number in range(1, int(pick("", "count", self.count)) + 1):
            name = f"{self.name} {number}"
            low, high = self.within
            shares = [pick(name, axis, one) for axis in "xyz"]
            place = [a + (b - a) * s for a, b, s in zip(low, high, shares, strict=True)]
            entry: dict[str, Any] = {
                "name": name,
                "asset": pick(name, "asset", which),
                "position": place,
                "orientation": _turned(*(pick(name, f"turn {n}", one) for n in range(3))),
                "static": True,
            }
            for key, draw in (("scale", self.scale), ("colour", self.colour)):
                if draw is not None:
                    entry[key] = pick(name, key, draw)
            added.append(entry)
        return {"added": added}


def _turned(first: float, second: float, third: float) -> tuple[float, ...]:
    """Return a quaternion x, y, z, w; every turn is as likely (Shoemake 1992)."""
    a, b = math.sqrt(1.0 - first), math.sqrt(first)
    one, two = 2.0 * math.pi * second, 2.0 * math.pi * third
    return a * math.sin(one), a * math.cos(one), b * math.sin(two), b * math.cos(two)
