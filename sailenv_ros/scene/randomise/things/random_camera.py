"""Cameras: where they stand, where they look, their lens and exposure."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from sailenv_ros.scene.field_types import Number, Text, optional
from sailenv_ros.scene.fields import Position, Rotation, Rule
from sailenv_ros.scene.randomise.drawn import Draw, Drawn
from sailenv_ros.scene.randomise.randomisation import (
    Pick,
    Randomisation,
    RandomTargets,
    Values,
)
from sailenv_ros.scene.randomise.relative import DrawnNumber
from sailenv_ros.scene.randomise.selectors import Which
from sailenv_ros.scene.rules import at_most_one, only_beside
from sailenv_ros.types.lens_settings import PINHOLE_FOV
from sailenv_ros.types.picture_settings import LIMITS

__all__ = ["RandomCamera"]

_Angle = Annotated[float, Number.within(PINHOLE_FOV)]
_Stops = Annotated[float, Number.within(LIMITS["exposure"])]
_RuleName = Annotated[str, Text(r"[a-z][a-z0-9_]{0,62}", "the name of a camera rule")]
_Seed = Annotated[int, Number(least=0, most=2**31 - 1, whole=True)]
_Well = Annotated[float, Number.within(LIMITS["full_well"])]


class RandomCamera(Randomisation):
    """Cameras, those of the scene and those that programs have registered."""

    KEY: ClassVar[str] = "agents"

    rules: ClassVar[tuple[Rule, ...]] = (
        at_most_one("look_at", "rotation"),
        only_beside("position", "look_at", "rotation"),
        at_most_one("position", "rule"),
        only_beside("rule", "settings"),
    )

    type: Literal["camera"]
    of: Which = Field(default=("*",), description="names of agents; * and ?")
    position: Annotated[Draw, Drawn(Position)] | None = optional(
        "where it stands, in the world [m]"
    )
    look_at: Annotated[Draw, Drawn(Position)] | None = optional("the point that it faces [m]")
    rotation: Annotated[Draw, Drawn(Rotation)] | None = optional(
        "[roll, pitch, yaw], instead of look_at [deg]"
    )
    rule: _RuleName | None = optional(
        "instead of a position: the camera rule that places it, such as `room_view`"
    )
    settings: dict[str, Any] = Field(
        default_factory=dict, description="of the rule, those that differ from its own"
    )
    vertical_fov: Annotated[Draw, DrawnNumber(_Angle)] | None = optional(
        "full vertical angle of view [deg]"
    )
    exposure: Annotated[Draw, DrawnNumber(_Stops)] | None = optional(
        "of its pictures, on top of the scene's [stops]"
    )
    full_well: Annotated[Draw, DrawnNumber(_Well)] | None = optional(
        "of its pictures, see the keys of a picture; 0: no noise"
    )

    def values(self, targets: RandomTargets, pick: Pick) -> Values:
        """Return the keys of each camera; a rule with its settings and the seed that was drawn."""
        seed = Drawn(_Seed).check({"uniform": [0, 2**31 - 1]})
        agents = self.drawn(self.of, targets.agents, pick)
        if self.rule is not None:
            for name, values in agents.items():
                values["rule"] = {
                    "name": self.rule,
                    "settings": dict(self.settings),
                    "seed": pick(name, "rule", seed),
                }
        return {"agents": agents}
