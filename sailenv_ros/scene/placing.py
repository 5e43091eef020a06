"""Position and orientation of the entries of a scene file."""

from __future__ import annotations

from typing import ClassVar

from sailenv_ros.scene.field_types import optional
from sailenv_ros.scene.fields import Orientation, Position, Rotation, Rule, SceneModel
from sailenv_ros.scene.rules import at_most_one, away_from_position, unit_quaternion
from sailenv_ros.types.geometry import Pose, look_at, quat_xyzw_from_rpy_deg

__all__ = ["Aimed", "Turned"]

Vector3 = tuple[float, float, float]


class Turned(SceneModel):
    """An entry that is turned by angles or by a quaternion, or not at all."""

    rules: ClassVar[tuple[Rule, ...]] = (at_most_one("rotation", "orientation"), unit_quaternion)

    rotation: Rotation | None = optional("[roll, pitch, yaw] about the fixed axes x, y, z [deg]")
    orientation: Orientation | None = optional("unit quaternion [x, y, z, w], instead of rotation")

    def pose_at(self, position_m: Vector3) -> Pose:
        """Return the pose at a position [m]."""
        if self.orientation is not None:
            return Pose(position_m, self.orientation)
        return Pose(position_m, quat_xyzw_from_rpy_deg(self.rotation or (0.0, 0.0, 0.0)))


class Aimed(Turned):
    """An entry that may face a point instead of being turned."""

    rules: ClassVar[tuple[Rule, ...]] = (
        at_most_one("rotation", "orientation", "look_at"),
        unit_quaternion,
        away_from_position,
    )

    look_at: Position | None = optional("the point that it faces [m], instead of rotation")

    def pose_at(self, position_m: Vector3) -> Pose:
        """Return the pose at a position [m]."""
        if self.look_at is not None:
            return look_at(position_m, self.look_at)
        return super().pose_at(position_m)
