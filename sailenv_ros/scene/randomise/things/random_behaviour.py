"""Behaviours: which objects of the scene move of themselves, and how."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from sailenv_ros.scene.field_types import Choice, Switch, optional
from sailenv_ros.scene.randomise.drawn import Draw, Drawn
from sailenv_ros.scene.randomise.randomisation import (
    EpochRandomisation,
    Pick,
    RandomTargets,
    Values,
)
from sailenv_ros.scene.randomise.selectors import WhichObjects
from sailenv_ros.scene.spec_objects import BehaviourSpec

__all__ = ["RandomBehaviour"]

_Bool = Annotated[bool, Switch()]


class RandomBehaviour(EpochRandomisation):
    """Behaviours of objects, which physics moves from then on, whatever the scene says."""

    KEY: ClassVar[str] = "behaviours"

    type: Literal["behaviour"]
    of: WhichObjects = Field(description="names of objects; * and ?; or {category: chair}")
    behaviours: tuple[BehaviourSpec, ...] = Field(
        min_length=1, max_length=16, description="with the keys of an object's behaviours"
    )
    choose: Annotated[Literal["all", "one"], Choice(("all", "one"))] = Field(
        default="all", description="`one`: each object gets one of them, drawn for it"
    )
    moves: Annotated[Draw, Drawn(_Bool)] | None = optional(
        "false leaves an object as it is; true if left out"
    )

    def values(self, targets: RandomTargets, pick: Pick) -> Values:
        """Return the behaviours that each object gets."""
        names = targets.with_categories(targets.objects)
        places = list(range(len(self.behaviours)))
        one = Drawn(int).check({"choice": places})
        given: dict[str, list[object]] = {}
        for name, drawn in self.drawn(self.of, names, pick).items():
            if drawn.get("moves", True):
                chosen = places if self.choose == "all" else [pick(name, "choose", one)]
                given[name] = [
                    self.behaviours[place].model_dump(mode="json", exclude_unset=True)
                    for place in chosen
                ]
        return {"behaviours": given} if given else {}
