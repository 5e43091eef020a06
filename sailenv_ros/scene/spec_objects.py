"""Objects and behaviours of a scene file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Annotated, Any, ClassVar

from pydantic import ConfigDict, Field

from sailenv_ros.scene.field_types import Choice, Number, Switch, Text, optional
from sailenv_ros.scene.fields import (
    DegreesPerSecond,
    Fraction,
    Heights,
    LinearColour,
    MetresPerSecond,
    Name,
    Position,
    Rule,
    Scale,
    SceneModel,
)
from sailenv_ros.scene.lesson_rules import leaves_after_it_appears
from sailenv_ros.scene.placing import Turned
from sailenv_ros.scene.room_rules import WALLS
from sailenv_ros.scene.rules import (
    at_most_one,
    distinct,
    only_beside,
    spans_ascend,
    static_never_moves,
)
from sailenv_ros.scene.spec_joints import JointSpec, on_a_joint
from sailenv_ros.scene.spec_materials import MaterialSpec
from sailenv_ros.scene.spec_room import WallName
from sailenv_ros.types.geometry import Pose

__all__ = ["BehaviourSpec", "ObjectSpec"]


class BehaviourSpec(SceneModel):
    """Behaviour of an object; all keys but `type` are the behaviour's parameters.

    Examples
    --------
    >>> BehaviourSpec(type="rotate_rigidbody", angular_velocity=[0, 0, 45]).parameters
    mappingproxy({'angular_velocity': [0, 0, 45]})
    """

    model_config = ConfigDict(extra="allow")

    type: Annotated[
        str,
        Text(
            r"[a-z][a-z0-9_]{0,62}|[A-Za-z_][A-Za-z0-9_.]{0,200}:[A-Za-z_][A-Za-z0-9_]{0,62}",
            "the name of a behaviour, or module:name of one of yours",
        ),
    ] = Field(description="name of the behaviour, e.g. rotate_rigidbody")

    @property
    def parameters(self) -> Mapping[str, Any]:
        """The keys beside `type`, unchecked; read-only."""
        return MappingProxyType(self.model_extra or {})


class ObjectSpec(Turned):
    """One object: what it is, where it stands, how it behaves in physics."""

    rules: ClassVar[tuple[Rule, ...]] = (
        *Turned.rules,
        at_most_one("position", "wall"),
        at_most_one("on", "wall"),
        only_beside("wall", "at", "height", "gap"),
        only_beside("on", "level"),
        spans_ascend,
        static_never_moves,
        on_a_joint,
        distinct("part", "materials"),
        leaves_after_it_appears,
    )

    name: Name = Field(description="unique among the objects of the scene")
    asset: Annotated[str, Text(r"[^\x00-\x1f]{1,100}", "the name of an asset")] = Field(
        description="name in the catalogue, e.g. cube or Chair 01"
    )
    position: Position = Field(default=(0.0, 0.0, 0.0), description="of the asset's origin [m]")
    on: Name | None = optional(
        "object below: position and rotation are relative to it, z to its upper side"
    )
    level: Heights | None = optional(
        "where that upper side is, above the other's origin: a worktop below cupboards [m]"
    )
    wall: Annotated[WallName, Choice(WALLS)] | None = optional(
        "wall at its back, instead of position: north (+y), east (+x), south (-y) or west (-x)"
    )
    at: Annotated[float, Number(least=-50.0, most=50.0, unit="m")] = Field(
        default=0.0,
        description="place along that wall, from its middle, towards +x or +y [m]",
    )
    height: Annotated[float, Number(least=0.0, most=100.0, unit="m")] = Field(
        default=0.0, description="of its origin above the floor, for hanging objects [m]"
    )
    gap: Annotated[float, Number(least=0.0, most=50.0, unit="m")] = Field(
        default=0.0, description="between its back and the wall [m]"
    )
    scale: Scale = Field(
        default=(1.0, 1.0, 1.0), description="one factor, or three along the asset's x, y, z"
    )
    static: Annotated[bool, Switch()] = Field(
        default=False, description="never moves: floors, walls, heavy furniture"
    )
    mass: (
        Annotated[
            float,
            Number(above=0.0, most=1e6, unit="kg", hint="(static: true is for what never moves)"),
        ]
        | None
    ) = optional("[kg]; the asset's own if left out")
    gravity: Annotated[bool, Switch()] = Field(default=True, description="false: it floats")
    friction: Annotated[float, Number(least=0.0, most=10.0)] = Field(
        default=0.5, description="coefficient of sliding friction"
    )
    restitution: Fraction = Field(default=0.0, description="bounce: 0 none, 1 full speed")
    joint: JointSpec | None = optional("hinge, slide or fixed connection")
    category: Annotated[str, Text(r"[^\x00-\x1f]{1,100}", "the name of a category")] | None = (
        optional("instead of the asset's category")
    )
    part_of: Name | None = optional(
        "its parent object, for ground truth alone; nothing holds them together"
    )
    colour: LinearColour | None = optional("of the whole object, instead of the asset's")
    metallic: Fraction | None = optional("0: paint, plastic, wood; 1: bare metal")
    roughness: Fraction | None = optional("0: a mirror; 1: chalk")
    materials: tuple[MaterialSpec, ...] = Field(
        default=(),
        max_length=64,
        description="replacements of its materials, applied in order",
    )
    velocity: MetresPerSecond = Field(
        default=(0.0, 0.0, 0.0), description="at the start, in the world's axes [m/s]"
    )
    angular_velocity: DegreesPerSecond = Field(
        default=(0.0, 0.0, 0.0), description="at the start, about the world's axes [deg/s]"
    )
    behaviours: tuple[BehaviourSpec, ...] = Field(
        default=(), max_length=16, description="its motion by itself"
    )
    appear: Annotated[float, Number(least=0.0, most=1e6, unit="s")] = Field(
        default=0.0,
        description="when it appears, since the beginning of the scene or its lesson [s]",
    )
    leave: Annotated[float, Number(above=0.0, most=1e6, unit="s")] | None = optional(
        "when it disappears; counted as appear [s]"
    )

    @property
    def pose(self) -> Pose:
        """Initial pose."""
        return self.pose_at(self.position)

    def placed(self, pose: Pose) -> ObjectSpec:
        """Return the entry of the same object in free space at a pose."""
        place = {"position": pose.position_m, "orientation": pose.orientation_xyzw}
        return self.model_copy(update=place)

    @property
    def angular_velocity_rad_s(self) -> tuple[float, float, float]:
        """Initial angular velocity, about the world's axes [rad/s]."""
        x, y, z = (math.radians(rate) for rate in self.angular_velocity)
        return x, y, z
