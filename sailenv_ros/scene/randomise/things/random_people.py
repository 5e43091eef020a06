"""People who live in a scene: they stand on the free floor when it begins."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from sailenv_ros.scene.field_types import Choice, Number, Switch, Text, optional
from sailenv_ros.scene.randomise.drawn import Draw, Drawn
from sailenv_ros.scene.randomise.randomisation import (
    EpochRandomisation,
    Pick,
    RandomTargets,
    Values,
)
from sailenv_ros.scene.randomise.things.random_spawn import FLOOR

__all__ = ["ACTIVITIES", "PEOPLE", "RandomPeople"]

PEOPLE: tuple[str, ...] = tuple(f"person_{number:02d}" for number in range(1, 29))
"""Names of the people that there are."""

ACTIVITIES = {"walk": "walk_around", "sit": "sit", "lie": "lie", "visit": "visit", "stand": ""}
"""Behaviours by the words for what people do."""

IN_PARTS = "_in_parts"

_Asset = Annotated[str, Text(r"[^\x00-\x1f]{1,100}", "the name of an asset")]
_Activity = Annotated[str, Choice(tuple(ACTIVITIES))]
_Count = Annotated[int, Number(least=0, most=16, whole=True)]
_Degrees = Annotated[float, Number(least=-360.0, most=360.0, unit="deg")]
_Seed = Annotated[int, Number(least=0, most=2**31 - 1, whole=True)]

_ANY_TURN = Drawn(_Degrees).check({"uniform": [-180.0, 180.0]})


class RandomPeople(EpochRandomisation):
    """People who walk, sit, lie, visit things or stand."""

    KEY: ClassVar[str] = "added"

    type: Literal["people"]
    count: Annotated[Draw, Drawn(_Count)] = Field(description="how many there are, 0 to 16")
    activity: tuple[_Activity, ...] = Field(
        default=("walk", "sit"), min_length=1, max_length=16, description="what each may do"
    )
    assets: tuple[_Asset, ...] = Field(
        default=PEOPLE, min_length=1, max_length=1000, description="who they may be"
    )
    in_parts: Annotated[bool, Switch()] = Field(
        default=False, description="true: hair and clothes have labels of their own"
    )
    turn: Annotated[Draw, Drawn(_Degrees)] | None = optional(
        "about the vertical; any if left out [deg]"
    )

    def may_add(self) -> tuple[str, ...]:
        """Return the names of the assets that may come to the scene by it."""
        return tuple(map(self._worn, self.assets))

    def values(self, targets: RandomTargets, pick: Pick) -> Values:
        """Return entries of objects as a scene file has them; see `FLOOR`."""
        which = Drawn(_Asset).check({"choice": list(self.assets)})
        does = Drawn(_Activity).check({"choice": list(self.activity)})
        seed = Drawn(_Seed).check({"uniform": [0, 2**31 - 1]})
        added = []
        for number in range(1, int(pick("", "count", self.count)) + 1):
            name = f"{self.name} {number}"
            asset = str(pick(name, "asset", which))
            turn = pick(name, "turn", self.turn or _ANY_TURN)
            entry: dict[str, Any] = {
                "name": name,
                "asset": self._worn(asset),
                FLOOR: {"seed": pick(name, FLOOR, seed), "height": 0.0, "turn": turn},
            }
            behaviour = ACTIVITIES[str(pick(name, "activity", does))]
            if behaviour:
                entry["behaviours"] = [{"type": behaviour}]
            added.append(entry)
        return {"added": added}

    def _worn(self, asset: str) -> str:
        return f"{asset}{IN_PARTS}" if self.in_parts else asset
