"""Robots of a scene file: which file each is read from, how it stands, what drives its joints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal, get_args

from pydantic import Field

from sailenv_ros.scene.field_types import Choice, Number, Switch, Text, optional
from sailenv_ros.scene.fields import JointCoordinate, Name, Position, Rule, SceneModel
from sailenv_ros.scene.placing import Turned
from sailenv_ros.scene.rules import distinct
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.robots import MOUNTS, DriveMode, Mount

__all__ = ["RobotJointSpec", "RobotSpec", "SensorSpec", "WheelsSpec", "robots_stand"]

_JointName = Annotated[str, Text(r"[^\x00-\x1f]{1,80}", "the name of a joint")]
_LinkName = Annotated[str, Text(r"[A-Za-z0-9 _.-]{1,40}", "the name of a link")]


class RobotJointSpec(SceneModel):
    """A joint of a robot at the start, and its motor."""

    name: _JointName = Field(description="of the file")
    position: JointCoordinate | None = optional("at the start [rad], [m]; default: the file's")
    mode: Annotated[DriveMode, Choice(get_args(DriveMode))] = Field(
        default="position", description="what its motor follows; off: its friction holds it"
    )
    target: JointCoordinate | None = optional("of the motor; default: it stays")
    gain: Annotated[float, Number(above=0.0, most=240.0)] = Field(
        default=24.0, description="speed over error [1/s]"
    )
    effort: Annotated[float, Number(above=0.0, most=1e6)] | None = optional(
        "at most [N m], [N]; default: the file's"
    )
    speed: Annotated[float, Number(above=0.0, most=100.0)] | None = optional(
        "at most [rad/s], [m/s]; default: the file's"
    )


class WheelsSpec(SceneModel):
    """Wheels of a mobile robot: what they roll with, and how fast."""

    joints: tuple[_JointName, ...] = Field(
        default=(), max_length=32, description="default: those that turn without end"
    )
    mover: Name | None = optional("a mover to which they take the robot, when told nothing else")
    radius: Annotated[float, Number(above=0.0, most=10.0, unit="m")] | None = optional(
        "default: of the geometry [m]"
    )
    track: Annotated[float, Number(above=0.0, most=10.0, unit="m")] | None = optional(
        "between left and right; default: of the joints [m]"
    )
    wheelbase: Annotated[float, Number(above=0.0, most=10.0, unit="m")] | None = optional(
        "between front and rear; default: of the joints [m]"
    )
    speed: Annotated[float, Number(above=0.0, most=10.0, unit="m/s")] = Field(
        default=1.0, description="at most [m/s]"
    )
    turn: Annotated[float, Number(above=0.0, most=20.0)] = Field(
        default=2.0, description="at most [rad/s]"
    )
    acceleration: Annotated[float, Number(above=0.0, most=100.0)] = Field(
        default=2.0, description="at most; traction gives no more [m/s2]"
    )
    steering: Annotated[float, Number(above=0.0, most=1.5)] = Field(
        default=0.6, description="at most, of ackermann [rad]"
    )


class SensorSpec(Turned):
    """A laser scanner or an inertial sensor on a link."""

    name: Annotated[str, Text(r"[a-z][a-z0-9_]{0,62}", "a lower-case name of ROS")] = Field(
        description="of its topic"
    )
    type: Annotated[Literal["lidar", "imu"], Choice(("lidar", "imu"))] = Field(
        description="laser scanner, or inertial sensor"
    )
    link: _LinkName | None = optional("default: the first")
    position: Position = Field(default=(0.0, 0.0, 0.0), description="on the link [m]")
    rate: Annotated[float, Number(above=0.0, most=240.0, unit="Hz")] = Field(
        default=10.0, description="of its topic [Hz]"
    )
    rays: Annotated[int, Number(least=1, most=10000, whole=True)] = Field(
        default=360, description="of a lidar"
    )
    field: Annotated[float, Number(above=0.0, most=360.0, unit="deg")] = Field(
        default=360.0, description="of a lidar [deg]"
    )
    range: Annotated[float, Number(above=0.0, most=1000.0, unit="m")] = Field(
        default=12.0, description="of a lidar [m]"
    )
    near: Annotated[float, Number(least=0.0, most=10.0, unit="m")] = Field(
        default=0.05, description="least range [m]"
    )

    @property
    def pose(self) -> Pose:
        """Pose in the link's frame."""
        return self.pose_at(self.position)


class RobotSpec(Turned):
    """A robot: an articulated machine of a URDF or MJCF file."""

    rules: ClassVar[tuple[Rule, ...]] = (
        *Turned.rules,
        distinct("name", "joints", "sensors"),
    )

    name: Name = Field(description="unique")
    file: Annotated[str, Text(r"[^\x00-\x1f]{1,1000}", "the path of a file")] = Field(
        description="a path from the scene file's folder, or PACKAGE:path"
    )
    mount: Annotated[Mount, Choice(MOUNTS)] | None = optional(
        "default: as the file says, else fixed"
    )
    parent: Name | None = optional("a static object that carries it")
    position: Position = Field(
        default=(0.0, 0.0, 0.0), description="of its first link; from its parent [m]"
    )
    joints: tuple[RobotJointSpec, ...] = Field(
        default=(), max_length=200, description="how they begin; others hold their positions"
    )
    wheels: WheelsSpec = Field(default_factory=WheelsSpec, description="of a robot on wheels")
    self_collision: Annotated[bool, Switch()] = Field(
        default=True, description="false: links pass through one another"
    )
    sensors: tuple[SensorSpec, ...] = Field(default=(), max_length=16, description="on its links")

    @property
    def pose(self) -> Pose:
        """Where it begins."""
        return self.pose_at(self.position)


def robots_stand(scene: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Refuse robots with names of objects, on what is missing or moves, and carried on wheels."""
    objects = scene.get("objects")
    named = {
        entry.get("name"): entry
        for entry in (objects if isinstance(objects, list | tuple) else ())
        if isinstance(entry, Mapping) and isinstance(entry.get("name"), str)
    }
    robots = scene.get("robots")
    for index, robot in enumerate(robots if isinstance(robots, list | tuple) else ()):
        if not isinstance(robot, Mapping):
            continue
        if isinstance(robot.get("name"), str) and robot["name"] in named:
            yield ("robots", index, "name"), "is the name of an object, too"
        if not isinstance(robot.get("parent"), str):
            continue
        place = ("robots", index, "parent")
        carrier = named.get(robot["parent"])
        if carrier is None:
            yield place, f"the scene has no object {robot['parent']!r}"
        elif carrier.get("static") is not True:
            yield place, f"must be static, and {robot['parent']!r} moves"
        elif robot.get("mount") not in (None, "fixed"):
            yield place, f"cannot be given to a robot whose mount is {robot['mount']}"
