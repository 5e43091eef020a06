"""Movers and agents of a scene file: what looks at the objects, and on which track."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, TypeAlias, get_args

from pydantic import Field

from sailenv_ros.scene.field_types import Choice, Number, Switch, Text, optional
from sailenv_ros.scene.fields import Name, Position, Rule
from sailenv_ros.scene.placing import Aimed, Turned
from sailenv_ros.scene.rules import below, distinct, distinct_values, turned_where_placed
from sailenv_ros.scene.spec_body import BodySpec, forces_or_waypoints
from sailenv_ros.scene.spec_lens import LensSpec
from sailenv_ros.scene.spec_look_at import LookAtSpec
from sailenv_ros.scene.spec_picture import PictureSpec
from sailenv_ros.types.agents import RATE, AgentSpec
from sailenv_ros.types.camera import INTRINSICS_LIMITS, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.rigs import RigCamera
from sailenv_ros.types.views import FIVE_VIEWS, RENDERED_VIEWS

__all__ = ["AgentSpecModel", "MoverSpec", "RigCameraSpec", "WaypointSpec"]

_Clip: TypeAlias = Annotated[float, Number.within(INTRINSICS_LIMITS["near_m"])]
_ViewName: TypeAlias = Annotated[str, Choice(RENDERED_VIEWS)]

Controller = Literal["waypoint", "rigidbody"]

_DEFAULTS = CameraIntrinsics()
_START = (0.0, 0.0, 1.0)


class WaypointSpec(Aimed):
    """One pose of a mover's track."""

    position: Position = Field(description="where the mover comes by [m]")

    @property
    def pose(self) -> Pose:
        """Pose of the mover there."""
        return self.pose_at(self.position)


class MoverSpec(Aimed):
    """A mover: a rig that moves and that agents follow."""

    rules: ClassVar[tuple[Rule, ...]] = (*Aimed.rules, forces_or_waypoints)

    name: Name = Field(default="mover", description="unique among the movers of the scene")
    position: Position | None = optional(
        "where it starts without waypoints [m]; (0, 0, 1) if left out"
    )
    waypoints: tuple[WaypointSpec, ...] = Field(
        default=(), max_length=1000, description="its track, run through at equal times"
    )
    total_time: Annotated[float, Number(above=0.0, most=1e6, unit="s")] = Field(
        default=30.0, description="time to run through all the waypoints once [s]"
    )
    loop: Annotated[bool, Switch()] = Field(
        default=True, description="true: the last waypoint leads on to the first"
    )
    controller: Annotated[Controller, Choice(get_args(Controller))] = Field(
        default="waypoint",
        description="at the start: moved by waypoints, or by commands and set poses",
    )
    keep_looking_at: LookAtSpec | None = optional(
        "look-at constraint, replaces the track's rotation"
    )
    body: BodySpec | None = optional("makes it a rigid body, moved by forces")

    @property
    def waypoint_poses(self) -> tuple[Pose, ...]:
        """The poses of the track, in order."""
        return tuple(waypoint.pose for waypoint in self.waypoints)

    @property
    def pose(self) -> Pose:
        """Initial pose: the given one, else that of the first waypoint."""
        if self.position is None and self.waypoints:
            return self.waypoints[0].pose
        return self.pose_at(_START if self.position is None else self.position)


class _CameraEntry(LensSpec, Turned):
    """Base of entries that describe a camera with a name."""

    rules: ClassVar[tuple[Rule, ...]] = (
        *LensSpec.rules,
        *Turned.rules,
        below("near", "far", {"near": _DEFAULTS.near_m, "far": _DEFAULTS.far_m}),
        below("near", "depth_range", {"near": _DEFAULTS.near_m, "depth_range": 10.0}),
        distinct_values("views"),
    )

    name: Annotated[
        str,
        Text(
            r"[a-z][a-z0-9_]{0,62}",
            "a lower-case letter, then lower-case letters, digits or underscores, at most 63",
        ),
    ] = Field(description="unique among agents, or cameras of its rig; a part of its topics' names")
    near: _Clip = Field(default=_DEFAULTS.near_m, description="nearest depth that is seen [m]")
    far: _Clip = Field(default=_DEFAULTS.far_m, description="farthest depth that is seen [m]")
    depth_range: _Clip = Field(
        default=10.0, description="depth that the 8-bit depth picture shows as black [m]"
    )
    views: tuple[_ViewName, ...] = Field(
        default=FIVE_VIEWS, min_length=1, description="what its frames hold"
    )
    picture: PictureSpec = Field(
        default_factory=PictureSpec, description="exposure, tone curve, noise of its pictures"
    )


class RigCameraSpec(_CameraEntry):
    """A camera of a rig: where it is on the body of its agent."""

    position: Position = Field(
        default=(0.0, 0.0, 0.0), description="in the frame of the agent's body [m]"
    )

    def to_camera(self) -> RigCamera:
        """Return the data type that the simulation takes."""
        return RigCamera(
            intrinsics=self.lens(near_m=self.near, far_m=self.far),
            extrinsics=self.pose_at(self.position),
            views=self.views,
            depth_range_m=self.depth_range,
            picture=self.picture.to_settings(),
        )


class AgentSpecModel(_CameraEntry):
    """A camera that the scene brings along, or a rig of several."""

    rules: ClassVar[tuple[Rule, ...]] = (
        *_CameraEntry.rules,
        turned_where_placed,
        distinct("name", "cameras"),
    )

    rate: Annotated[float, Number.within(RATE)] = Field(
        default=30.0, description="frames per simulated second [Hz]; 0: on request only"
    )
    following: Annotated[bool, Switch()] = Field(
        default=True, description="true if it goes where its mover goes"
    )
    mover: Name | None = optional("the mover it follows; the scene's first if left out")
    carrier: Name | None = optional(
        "object that carries it, such as a link of a robot: position is in its frame"
    )
    position: Position | None = optional("where it starts when it does not follow [m]")
    keep_looking_at: LookAtSpec | None = optional("look-at constraint")
    cameras: Annotated[tuple[RigCameraSpec, ...], Field(min_length=1, max_length=15)] | None = (
        optional("makes it a rig: more cameras on its body, captured at one instant")
    )

    def to_agent_spec(self) -> AgentSpec:
        """Return the data type that the simulation takes."""
        return AgentSpec(
            name=self.name,
            intrinsics=self.lens(near_m=self.near, far_m=self.far),
            depth_range_m=self.depth_range,
            rate_hz=self.rate,
            views=self.views,
            picture=self.picture.to_settings(),
            following=self.following,
            mover=self.mover or "",
            look_at=None if self.keep_looking_at is None else self.keep_looking_at.to_look_at(),
            pose=None if self.position is None else self.pose_at(self.position),
            carrier=self.carrier or "",
            cameras={one.name: one.to_camera() for one in self.cameras or ()} or None,
        )
