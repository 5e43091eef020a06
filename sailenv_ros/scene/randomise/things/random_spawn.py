"""Spawns: objects of the catalogue that come to a scene, stand or fall in it and may move."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from sailenv_ros.scene.field_types import Number, Switch, Text, Vector, optional
from sailenv_ros.scene.fields import LinearColour, MetresPerSecond, Position, Rule
from sailenv_ros.scene.randomise.drawn import Draw, Drawn
from sailenv_ros.scene.randomise.random_rules import box_in_order
from sailenv_ros.scene.randomise.randomisation import (
    EpochRandomisation,
    Pick,
    RandomTargets,
    Values,
)
from sailenv_ros.scene.rules import at_most_one
from sailenv_ros.scene.spec_objects import BehaviourSpec

__all__ = ["FLOOR", "RandomSpawn"]

FLOOR = "floor"
"""Key of a drawn object that has no place yet: seed, height and turn upon the free floor."""

_Asset = Annotated[str, Text(r"[^\x00-\x1f]{1,100}", "the name of an asset")]
_Count = Annotated[int, Number(least=0, most=100, whole=True)]
_Factor = Annotated[float, Number(least=1e-3, most=1e3)]
_Degrees = Annotated[float, Number(least=-360.0, most=360.0, unit="deg")]
_Metres = Annotated[float, Number(least=0.0, most=100.0, unit="m")]
_Seed = Annotated[int, Number(least=0, most=2**31 - 1, whole=True)]

_ONE = Drawn(_Count).check(1)
_ANY_TURN = Drawn(_Degrees).check({"uniform": [-180.0, 180.0]})
_ON_FLOOR = Drawn(_Metres).check(0.0)


class RandomSpawn(EpochRandomisation):
    """Objects of the catalogue, upon the free floor or in a box."""

    KEY: ClassVar[str] = "added"

    rules: ClassVar[tuple[Rule, ...]] = (box_in_order, at_most_one("within", "height"))

    type: Literal["spawn"]
    assets: tuple[_Asset, ...] = Field(
        min_length=1, max_length=1000, description="what they may be: names of the catalogue"
    )
    count: Annotated[Draw, Drawn(_Count)] | None = optional("how many there are; 1 if left out")
    within: (
        Annotated[
            tuple[Position, Position], Vector(2, "two corners [lowest, highest] of a box in [m]")
        ]
        | None
    ) = optional(
        "lowest and highest corner of the box of their origins [m]; default: they "
        "stand on the free floor"
    )
    height: Annotated[Draw, Drawn(_Metres)] | None = optional(
        "of their lowest point above the free floor; 0 if left out [m]"
    )
    turn: Annotated[Draw, Drawn(_Degrees)] | None = optional(
        "about the vertical; any if left out [deg]"
    )
    scale: Annotated[Draw, Drawn(_Factor)] | None = optional("one factor for all axes")
    colour: Annotated[Draw, Drawn(LinearColour)] | None = optional(
        "paints each of them; drawn in linear numbers"
    )
    velocity: Annotated[Draw, Drawn(MetresPerSecond)] | None = optional(
        "at the start, in the world's axes [m/s]"
    )
    static: Annotated[bool, Switch()] = Field(
        default=False, description="true for what physics never moves"
    )
    gravity: Annotated[bool, Switch()] = Field(default=True, description="false: it floats")
    behaviours: tuple[BehaviourSpec, ...] = Field(
        default=(), max_length=16, description="their motion by themselves"
    )

    def may_add(self) -> tuple[str, ...]:
        """Return the names of the assets that may come to the scene by it."""
        return self.assets

    def values(self, targets: RandomTargets, pick: Pick) -> Values:
        """Return entries of objects as a scene file has them; see `FLOOR`."""
        which = Drawn(_Asset).check({"choice": list(self.assets)})
        seed = Drawn(_Seed).check({"uniform": [0, 2**31 - 1]})
        added = []
        for number in range(1, int(pick("", "count", self.count or _ONE)) + 1):
            name = f"{self.name} {number}"
            turn = pick(name, "turn", self.turn or _ANY_TURN)
            entry: dict[str, Any] = {"name": name, "asset": pick(name, "asset", which)}
            if self.within is None:
                height = pick(name, "height", self.height or _ON_FLOOR)
                entry[FLOOR] = {"seed": pick(name, FLOOR, seed), "height": height, "turn": turn}
            else:
                box = Drawn(Position).check({"uniform": list(self.within)})
                entry |= {"position": pick(name, "position", box), "rotation": [0.0, 0.0, turn]}
            entry |= {"static": self.static, "gravity": self.gravity}
            for key, draw in self.draws("count", "turn", "height").items():
                entry[key] = pick(name, key, draw)
            if self.behaviours:
                entry["behaviours"] = [
                    one.model_dump(mode="json", exclude_unset=True) for one in self.behaviours
                ]
            added.append(entry)
        return {"added": added}
